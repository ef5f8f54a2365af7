// Measures on float images, and the sRGB curve.
#include "image/image.h"

#include <cmath>
#include <limits>

#include "core/error.h"

namespace nf::image {

NonFinite find_non_finite(const Image& image) {
  NonFinite found;
  const size_t row = size_t(image.width) * image.channels;
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    if (std::isfinite(image.pixels[i])) continue;
    if (!found.any()) {
      found.first_y = uint32_t(i / row);
      found.first_x = uint32_t(i % row / image.channels);
      found.first_channel = uint32_t(i % image.channels);
    }
    ++(std::isnan(image.pixels[i]) ? found.nan : found.inf);
  }
  return found;
}

Difference difference(const Image& a, const Image& b, float threshold) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) {
    fail(Exit::Input,
         "cannot compare the images: one is {}x{} with {} channels, the other {}x{} with {}; render both alike",
         a.width, a.height, a.channels, b.width, b.height, b.channels);
  }
  Difference result;
  if (a.pixels.empty()) return result;
  double sum = 0, sum_of_squares = 0;
  uint64_t above = 0;
  for (uint32_t y = 0; y < a.height; ++y) {
    for (uint32_t x = 0; x < a.width; ++x) {
      bool pixel_above = false;
      for (uint32_t c = 0; c < a.channels; ++c) {
        const float va = a.at(x, y, c), vb = b.at(x, y, c);
        double delta = va == vb ? 0 : std::abs(double(va) - double(vb));
        if (std::isnan(delta)) delta = std::numeric_limits<double>::infinity();
        sum += delta;
        sum_of_squares += delta * delta;
        pixel_above |= delta > double(threshold);
        if (delta > result.max_abs) {
          result.max_abs = delta;
          result.worst_x = x;
          result.worst_y = y;
        }
      }
      above += pixel_above;
    }
  }
  const double count = double(a.pixels.size());
  result.mean_abs = sum / count;
  result.rmse = std::sqrt(sum_of_squares / count);
  result.fraction_above = double(above) / (double(a.width) * a.height);
  return result;
}

const Layer* find_layer(std::span<const Layer> layers, std::string_view name) {
  for (const Layer& layer : layers)
    if (layer.name == name) return &layer;
  return nullptr;
}

float srgb_from_linear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

float linear_from_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace nf::image
