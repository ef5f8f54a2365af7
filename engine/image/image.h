// Pictures on the CPU: linear float images with named layers, and the files they come from and go to. Row 0 is the top.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nf::image {

// Interleaved floats, pixels[(y * width + x) * channels + c].
struct Image {
  uint32_t width = 0, height = 0, channels = 0;
  std::vector<float> pixels;
  float& at(uint32_t x, uint32_t y, uint32_t c) { return pixels[(size_t(y) * width + x) * channels + c]; }
  float at(uint32_t x, uint32_t y, uint32_t c) const { return pixels[(size_t(y) * width + x) * channels + c]; }
};

// 8-bit, interleaved, as displayed (no colour conversion is done here).
struct Image8 {
  uint32_t width = 0, height = 0, channels = 0;  // 1, 3 or 4 channels
  std::vector<uint8_t> pixels;
};

// A layer of an EXR file. `channels` are the letters after "name." ("RGB", "XYZ", "V", "XY"), one a component of
// `image`. The layer named "" is the default one: its channels are plain "R","G","B".
struct Layer {
  std::string name;
  std::string channels;
  Image image;
};
// nullptr: there is none of this name.
const Layer* find_layer(std::span<const Layer> layers, std::string_view name);

// Half saturates: what is beyond +-65504, infinity included, becomes +-65504; NaN stays NaN.
enum class Precision { Half, Float };

// All writers write to a temporary file beside the target and rename it: no half-written output. They throw nf::Error
// (Exit::Output) naming the file and why. Same input, same bytes (no time stamps).
void write_png(const std::filesystem::path& path, const Image8& image);
std::vector<uint8_t> encode_png(const Image8& image);  // the same bytes, in memory
void write_exr(const std::filesystem::path& path, std::span<const Layer> layers,
               const std::map<std::string, std::string>& header, Precision precision);

// Readers throw nf::Error (Exit::Input) for a missing, truncated or unknown file.
Image8 read_png(const std::filesystem::path& path);
struct ExrFile {
  std::vector<Layer> layers;  // sorted by name; the default layer first
  std::map<std::string, std::string> header;
};
ExrFile read_exr(const std::filesystem::path& path);
Image read_hdr(const std::filesystem::path& path);  // Radiance .hdr, 3 channels

// Where a picture stops being one.
struct NonFinite {
  uint64_t nan = 0, inf = 0;
  uint32_t first_x = 0, first_y = 0, first_channel = 0;  // meaningful when nan + inf > 0
  bool any() const { return nan + inf > 0; }
};
NonFinite find_non_finite(const Image& image);

// Difference of two images of the same size and channel count; throws nf::Error (Exit::Input) when they differ in size.
// A NaN in either differs by infinity; equal infinities do not differ. Means are over all components.
struct Difference {
  double mean_abs = 0, rmse = 0, max_abs = 0;
  uint32_t worst_x = 0, worst_y = 0;
  double fraction_above = 0;  // share of pixels with any channel above `threshold`
};
Difference difference(const Image& a, const Image& b, float threshold);

// sRGB transfer function (IEC 61966-2-1), both ways.
float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);

}  // namespace nf::image
