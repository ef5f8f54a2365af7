// Decoding of the scene's PNG and JPEG pictures, on all cores. Sizes are read and bounded before anything is decoded.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <stb/stb_image.h>
#include <thread>

#include "core/parallel.h"
#include "scene/gltf_import.h"

namespace nf::scene::gltf {

namespace {

using Bytes = std::span<const uint8_t>;

constexpr uint32_t side_limit = 16384;
constexpr uint64_t total_limit = uint64_t(4) << 30;
// A 1-bit PNG at deflate's best ratio; no picture holds more pixels a byte.
constexpr uint64_t pixels_per_byte = 8300;
constexpr size_t scan_limit = 200;  // of a progressive JPEG: each costs a walk over all pixels

struct Job {
  size_t image = 0;
  uint32_t row = none, copy_row = none;  // rows of Scene::pictures; the copy is the other encoding
  Bytes bytes;
  std::string where, error;
};

Bytes encoded_bytes(const Importer& importer, const ImageSource& image, const std::string& where) {
  if (image.buffer_view < 0) return image.bytes;
  const tinygltf::BufferView& view = importer.model.bufferViews.at(size_t(image.buffer_view));
  const std::vector<uint8_t>& buffer = importer.model.buffers.at(size_t(view.buffer)).data;
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    refuse("{} lies beyond its buffer", where);
  }
  return Bytes(buffer).subspan(view.byteOffset, view.byteLength);
}

bool starts_with(Bytes bytes, std::initializer_list<uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

size_t count_scans(Bytes bytes) {
  size_t scans = 0;
  for (size_t i = 0; i + 1 < bytes.size(); ++i) scans += bytes[i] == 0xff && bytes[i + 1] == 0xda;
  return scans;
}

// The picture's size; refuses what must not be decoded.
glm::uvec2 check_picture(Bytes bytes, uint64_t at_once, const std::string& where) {
  const bool png = starts_with(bytes, {0x89, 'P', 'N', 'G'}), jpeg = starts_with(bytes, {0xff, 0xd8});
  if (!png && !jpeg) {
    refuse_advising("convert the picture and export again", "{} is neither PNG nor JPEG (or is truncated)", where);
  }
  int width = 0, height = 0, channels = 0;
  const bool known = bytes.size() < size_t(1) << 31 &&
                     stbi_info_from_memory(bytes.data(), int(bytes.size()), &width, &height, &channels) != 0;
  if (!known || width < 1 || height < 1) refuse("{} is damaged: its header cannot be read", where);
  if (uint32_t(width) > side_limit || uint32_t(height) > side_limit) {
    refuse_advising("scale the picture down", "{} is {} x {} pixels; {} a side is the limit", where, width, height,
                    side_limit);
  }
  if (uint64_t(width) * uint64_t(height) > 4096 + pixels_per_byte * bytes.size()) {
    refuse("{} says it is {} x {} pixels, but has only {} bytes", where, width, height, bytes.size());
  }
  // 16-bit pictures are unpacked at full width before they are narrowed.
  const uint64_t pixel = stbi_is_16_bit_from_memory(bytes.data(), int(bytes.size())) ? 8 : 4;
  if (uint64_t(width) * uint64_t(height) * pixel > at_once) {
    refuse_advising("scale the picture down", "{} is {} x {} pixels, too many for a file of this size", where, width,
                    height);
  }
  if (jpeg && count_scans(bytes) > scan_limit) refuse("{} is a JPEG of more than {} scans", where, scan_limit);
  return {width, height};
}

void decode(Job& job, std::vector<Picture>& pictures) {
  Picture& picture = pictures[job.row];
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels = stbi_load_from_memory(job.bytes.data(), int(job.bytes.size()), &width, &height, &channels, 4);
  const bool complete = pixels && uint32_t(width) == picture.width && uint32_t(height) == picture.height;
  if (complete) {
    std::memcpy(picture.rgba.data(), pixels, picture.rgba.size());
  } else {
    job.error = stbi_failure_reason() ? stbi_failure_reason() : "unknown reason";
  }
  stbi_image_free(pixels);
  if (complete && job.copy_row != none) pictures[job.copy_row].rgba = picture.rgba;
}

std::vector<Job> make_jobs(const Importer& importer) {
  std::vector<Job> jobs;
  // The rows are sorted by image, so an image's two encodings are neighbours.
  for (const auto& [key, row] : importer.picture_rows) {
    const size_t image = key.first;
    if (!jobs.empty() && jobs.back().image == image) {
      jobs.back().copy_row = row;
      continue;
    }
    const std::string where = describe("image", image, importer.source.images[image].name);
    jobs.push_back({image, row, none, encoded_bytes(importer, importer.source.images[image], where), where, {}});
  }
  return jobs;
}

}  // namespace

void import_pictures(Importer& importer, const PictureProgress& progress) {
  std::vector<Picture>& pictures = importer.scene.pictures;
  std::vector<Job> jobs = make_jobs(importer);
  uint64_t total = 0;
  for (Job& job : jobs) {
    const glm::uvec2 size = check_picture(job.bytes, importer.budget.at_once, job.where);
    for (const uint32_t row : {job.row, job.copy_row}) {
      if (row == none) continue;
      pictures[row].width = size.x;
      pictures[row].height = size.y;
      total += uint64_t(size.x) * size.y * 4;
    }
  }
  if (total > total_limit) {
    refuse_advising("scale them down", "its pictures need {} MiB; {} is the limit", total >> 20, total_limit >> 20);
  }

  if (progress && !jobs.empty()) progress(0, jobs.size());
  std::atomic<size_t> done = 0;
  const std::thread::id here = std::this_thread::get_id();
  for_rows(uint32_t(jobs.size()), 0, [&](uint32_t i) {
    Picture& picture = pictures[jobs[i].row];
    picture.rgba.resize(size_t(picture.width) * picture.height * 4);
    decode(jobs[i], pictures);
    ++done;
    if (progress && std::this_thread::get_id() == here) progress(done, jobs.size());
  });
  if (progress && !jobs.empty()) progress(jobs.size(), jobs.size());
  for (const Job& job : jobs) {
    if (!job.error.empty()) refuse("{} cannot be decoded ({}): it is damaged or truncated", job.where, job.error);
  }
}

}  // namespace nf::scene::gltf
