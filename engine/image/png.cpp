// PNG through libpng. libpng reports errors by longjmp, so between setjmp and the last call into it no object with a
// destructor lives in the frames that are jumped over: everything is in one struct that the caller owns.
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <png.h>

#include "core/error.h"
#include "image/file.h"
#include "image/image.h"

namespace nf::image {
namespace {

// Deflate cannot shrink more than this, so a header that claims more pixels than the file can hold is found out before
// memory is spent on them.
constexpr uint64_t deflate_ratio = 1040;

struct Reading {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::span<const uint8_t> bytes;  // what is still to be read
  uint64_t file_size = 0;
  char error[160] = "out of memory";
  Image8 image;
  std::vector<png_bytep> rows;

  Reading() = default;
  ~Reading() { png_destroy_read_struct(&png, &info, nullptr); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* reading = static_cast<Reading*>(png_get_error_ptr(png));
  std::snprintf(reading->error, sizeof reading->error, "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, size_t size) {
  auto* reading = static_cast<Reading*>(png_get_io_ptr(png));
  if (size > reading->bytes.size()) png_error(png, "the file is truncated");
  std::memcpy(to, reading->bytes.data(), size);
  reading->bytes = reading->bytes.subspan(size);
}

bool decode(Reading& r) {
  r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, on_error, on_warning);
  if (r.png) r.info = png_create_info_struct(r.png);
  if (!r.info) return false;
  if (setjmp(png_jmpbuf(r.png))) return false;

  png_set_read_fn(r.png, &r, on_read);
  png_read_info(r.png, r.info);
  if (uint64_t(png_get_rowbytes(r.png, r.info)) * png_get_image_height(r.png, r.info) > r.file_size * deflate_ratio)
    png_error(r.png, "the file is truncated");

  png_set_expand(r.png);  // palettes, 1 to 4 bits and tRNS become 8-bit components
  png_set_scale_16(r.png);
  if (png_get_color_type(r.png, r.info) == PNG_COLOR_TYPE_GRAY_ALPHA ||
      (png_get_color_type(r.png, r.info) == PNG_COLOR_TYPE_GRAY && png_get_valid(r.png, r.info, PNG_INFO_tRNS)))
    png_set_gray_to_rgb(r.png);
  png_set_interlace_handling(r.png);
  png_read_update_info(r.png, r.info);

  r.image.width = png_get_image_width(r.png, r.info);
  r.image.height = png_get_image_height(r.png, r.info);
  r.image.channels = png_get_channels(r.png, r.info);
  const size_t row = size_t(r.image.width) * r.image.channels;
  if (png_get_rowbytes(r.png, r.info) != row) png_error(r.png, "an unexpected pixel layout");
  r.image.pixels.resize(row * r.image.height);
  r.rows.resize(r.image.height);
  for (size_t y = 0; y < r.rows.size(); ++y) r.rows[y] = r.image.pixels.data() + y * row;
  png_read_image(r.png, r.rows.data());
  png_read_end(r.png, nullptr);
  return true;
}

}  // namespace

std::vector<uint8_t> encode_png(const Image8& image) {
  NF_CHECK(image.channels == 1 || image.channels == 3 || image.channels == 4, "{} channels", image.channels);
  NF_CHECK(
      image.width > 0 && image.height > 0 && image.pixels.size() == size_t(image.width) * image.height * image.channels,
      "{}x{} with {} channels, {} bytes", image.width, image.height, image.channels, image.pixels.size());
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  png.format = image.channels == 1 ? PNG_FORMAT_GRAY : image.channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  std::vector<uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = bytes.size();
  const int done = png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr);
  NF_CHECK(done, "libpng: {}", png.message);
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& path, const Image8& image) {
  write_file(path, encode_png(image));
}

Image8 read_png(const std::filesystem::path& path) {
  const std::vector<uint8_t> bytes = read_file(path);
  if (bytes.size() < 8 || png_sig_cmp(bytes.data(), 0, 8) != 0)
    fail(Exit::Input, "cannot read '{}': it is not a PNG file; check the path", path.string());
  Reading reading;
  reading.bytes = bytes;
  reading.file_size = bytes.size();
  if (!decode(reading)) fail(Exit::Input, "cannot read '{}': {}; make the file again", path.string(), reading.error);
  return std::move(reading.image);
}

}  // namespace nf::image
