// The noise table: making, keeping, uploading.
#include "noise.h"

#include <array>
#include <cstring>

#include "core/error.h"
#include "gpu/upload.h"
#include "image/blue_noise.h"
#include "image/file.h"

namespace nf::passes {
namespace {

// To be changed with whatever changes the table.
constexpr const char* file_name = "noise-1.bin";
constexpr size_t table_size = size_t(noise_side) * noise_side * (1 + noise_frames);

// Where in the tile each of the three numbers is read.
constexpr std::array<std::array<uint32_t, 2>, 3> places = {{{0, 0}, {23, 37}, {45, 13}}};

void append(std::vector<uint32_t>& table, uint32_t slices, uint32_t seed) {
  const std::vector<uint32_t> ranks = image::void_and_cluster(noise_side, slices, seed);
  const uint32_t unit = uint32_t(ranks.size()) / 1024;
  for (uint32_t slice = 0; slice < slices; ++slice)
    for (uint32_t y = 0; y < noise_side; ++y)
      for (uint32_t x = 0; x < noise_side; ++x) {
        uint32_t texel = 0;
        for (uint32_t c = 0; c < 3; ++c) {
          const uint32_t row = slice * noise_side + (y + places[c][1]) % noise_side;
          texel |= ranks[row * noise_side + (x + places[c][0]) % noise_side] / unit << 10 * c;
        }
        table.push_back(texel);
      }
}

}  // namespace

std::vector<uint32_t> make_noise_table() {
  std::vector<uint32_t> table;
  append(table, 1, 1);
  append(table, noise_frames, 2);
  return table;
}

std::vector<uint32_t> load_noise_table(const std::filesystem::path& cache) {
  const std::filesystem::path file = cache / file_name;
  std::error_code error;
  if (!cache.empty() && std::filesystem::is_regular_file(file, error)) {
    try {
      const std::vector<uint8_t> bytes = image::read_file(file);
      if (bytes.size() == table_size * sizeof(uint32_t)) {
        std::vector<uint32_t> table(table_size);
        std::memcpy(table.data(), bytes.data(), bytes.size());
        return table;
      }
    } catch (const Error&) {
    }
  }
  const std::vector<uint32_t> table = make_noise_table();
  if (cache.empty()) return table;
  // A cache that cannot be written costs time, nothing else.
  try {
    std::filesystem::create_directories(cache, error);
    image::write_file(file, {reinterpret_cast<const uint8_t*>(table.data()), table.size() * sizeof(uint32_t)});
  } catch (const Error&) {
  }
  return table;
}

Noise::~Noise() {
  gpu::destroy(device_, image_);
}

void Noise::feed(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface) {
  if (!interface.find("noise_table")) return;
  if (!image_.handle) {
    const std::vector<uint32_t> table = load_noise_table(cache_);
    const gpu::ImagePart part{0, 0, std::as_bytes(std::span(table))};
    image_ = gpu::upload_image(device_,
                               {.extent = {noise_side, noise_side * (1 + noise_frames)}, .format = VK_FORMAT_R32_UINT},
                               {&part, 1}, "noise.table", gpu::WholeView::Flat);
  }
  pass.in("noise_table", graph.import("noise.table", image_));
}

}  // namespace nf::passes
