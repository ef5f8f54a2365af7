// Radiance .hdr, decoded here: the stb_image of Debian 12 loops for ever on some damaged files and takes truncated ones
// for pictures that end in black. Format: Ward, "Real Pixels", Graphics Gems II (1991), and Radiance's color.c.
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/error.h"
#include "image/file.h"
#include "image/image.h"

namespace nf::image {
namespace {

using Rgbe = std::array<uint8_t, 4>;

struct Reader {
  std::span<const uint8_t> rest;

  uint8_t byte() {
    if (rest.empty()) throw std::runtime_error("the file is truncated");
    const uint8_t value = rest[0];
    rest = rest.subspan(1);
    return value;
  }
  std::string line() {
    std::string text;
    for (char c = char(byte()); c != '\n'; c = char(byte())) text += c;
    return text;
  }
};

struct Size {
  uint32_t width = 0, height = 0;
};

Size read_header(Reader& reader) {
  const std::string magic = reader.line();
  if (magic != "#?RADIANCE" && magic != "#?RGBE") throw std::runtime_error("it is not a Radiance .hdr file");
  for (std::string line = reader.line(); !line.empty(); line = reader.line()) {
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      throw std::runtime_error("its pixels are not RGBE");
  }
  Size size;
  char end = 0;
  if (std::sscanf(reader.line().c_str(), "-Y %9u +X %9u%c", &size.height, &size.width, &end) != 2 || size.width == 0 ||
      size.height == 0)
    throw std::runtime_error("its resolution is not of the form '-Y height +X width'");
  return size;
}

// The first pixel (2, 2, high, low), high < 128, announces four components one after the other, each in runs and
// copies.
void read_row(Reader& reader, std::span<Rgbe> row) {
  const Rgbe first{reader.byte(), reader.byte(), reader.byte(), reader.byte()};
  // Narrower or wider pictures are never encoded, so there it is just a pixel.
  if (first[0] != 2 || first[1] != 2 || first[2] >= 128 || row.size() < 8 || row.size() > 32767) {
    row[0] = first;
    for (Rgbe& pixel : row.subspan(1)) pixel = {reader.byte(), reader.byte(), reader.byte(), reader.byte()};
    return;
  }
  if (size_t(first[2]) * 256 + first[3] != row.size())
    throw std::runtime_error("a row has another length than the picture");
  for (size_t component = 0; component < 4; ++component) {
    for (size_t x = 0; x < row.size();) {
      const uint8_t code = reader.byte();
      const bool run = code > 128;
      const size_t count = run ? code - 128u : code;
      if (count == 0 || count > row.size() - x) throw std::runtime_error("a run has an impossible length");
      uint8_t value = 0;
      for (size_t i = 0; i < count; ++i) {
        if (i == 0 || !run) value = reader.byte();
        row[x++][component] = value;
      }
    }
  }
}

Image decode(std::span<const uint8_t> bytes) {
  Reader reader{bytes};
  const Size size = read_header(reader);
  // Found out before memory is spent: 2 bytes become at most 127 of the 4 of a pixel.
  if (uint64_t(size.width) * size.height * 4 > uint64_t(bytes.size()) * 64)
    throw std::runtime_error("the file is truncated");

  Image image{.width = size.width, .height = size.height, .channels = 3, .pixels = {}};
  image.pixels.reserve(size_t(size.width) * size.height * 3);
  std::vector<Rgbe> row(size.width);
  for (uint32_t y = 0; y < size.height; ++y) {
    read_row(reader, row);
    for (const Rgbe& pixel : row) {
      const float unit = pixel[3] == 0 ? 0 : std::ldexp(1.0f, int(pixel[3]) - (128 + 8));
      for (size_t c = 0; c < 3; ++c) image.pixels.push_back(float(pixel[c]) * unit);
    }
  }
  return image;
}

}  // namespace

Image read_hdr(const std::filesystem::path& path) {
  const std::vector<uint8_t> bytes = read_file(path);
  std::string why;
  try {
    return decode(bytes);
  } catch (const std::exception& e) {
    why = e.what();
  }
  fail(Exit::Input, "cannot read '{}': {}; use a Radiance .hdr picture", path.string(), why);
}

}  // namespace nf::image
