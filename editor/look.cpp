#include "look.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>

#include "image/file.h"
#include "image/image.h"

namespace nf::editor {
namespace {

glm::vec3 map_color(ui::Map map, float x) {
  const float t = std::clamp(x, 0.0f, 1.0f);
  switch (map) {
    case ui::Map::Viridis: {
      constexpr float c[7][3] = {{0.277727f, 0.005407f, 0.334100f},   {0.105093f, 1.404614f, 1.384590f},
                                 {-0.330862f, 0.214848f, 0.095095f},  {-4.634230f, -5.799101f, -19.332441f},
                                 {6.228270f, 14.179933f, 56.690553f}, {4.776385f, -13.745145f, -65.353033f},
                                 {-5.435456f, 4.645853f, 26.312435f}};
      glm::vec3 sum(0);
      for (int i = 6; i >= 0; --i) sum = sum * t + glm::vec3(c[i][0], c[i][1], c[i][2]);
      return sum;
    }
    case ui::Map::Diverging: {
      const glm::vec3 low(0.230f, 0.299f, 0.754f), middle(0.865f), high(0.706f, 0.016f, 0.150f);
      return t < 0.5f ? glm::mix(low, middle, 2 * t) : glm::mix(middle, high, 2 * t - 1);
    }
    case ui::Map::FalseColor:
      return {1.9f * t, 2.2f * t * t - 0.45f * t,
              t < 0.35f ? 2.2f * t : 0.77f - 1.7f * (t - 0.35f) + 6 * std::max(t - 0.75f, 0.0f)};
    default:
      return glm::vec3(t);
  }
}

float in_range(float value, const ui::PictureLook& look) {
  if (!look.logarithmic) return (value - look.low) / std::max(look.high - look.low, 1e-20f);
  const float base = std::max({look.low, 1e-6f * look.high, 1e-30f});
  return std::log2(std::max(value, base) / base) / std::max(std::log2(std::max(look.high, base) / base), 1e-20f);
}

bool is_one(const ui::PictureLook& look) {
  return look.map != ui::Map::Grey || std::has_single_bit(look.channels);
}
uint32_t first_of(const ui::PictureLook& look) {
  return look.channels ? uint32_t(std::countr_zero(look.channels)) : 0;
}
// Those that count in the range.
uint32_t ranged(const ui::PictureLook& look) {
  return is_one(look) ? 1u << first_of(look) : look.channels & ui::Rgb;
}

}  // namespace

std::array<float, 3> shown_color(const float* value, const ui::PictureLook& look) {
  bool below = false, above = false;
  for (uint32_t c = 0; c < 4; ++c) {
    if (!std::isfinite(value[c])) return {1, 0, 1};
    below |= (ranged(look) >> c & 1) && value[c] < look.low;
    above |= (ranged(look) >> c & 1) && value[c] > look.high;
  }
  if (look.mark_outside && below) return {0, 0.2f, 1};
  if (look.mark_outside && above) return {1, 0.1f, 0};
  glm::vec3 x;
  if (is_one(look)) {
    x = map_color(look.map, in_range(value[first_of(look)], look));
  } else {
    const float alpha = look.channels & ui::Alpha ? std::clamp(value[3], 0.0f, 1.0f) : 1.0f;
    for (int c = 0; c < 3; ++c)
      x[c] = look.channels >> c & 1 ? std::clamp(in_range(value[c], look) * alpha, 0.0f, 1.0f) : 0.0f;
  }
  if (look.srgb && look.map == ui::Map::Grey)
    for (int c = 0; c < 3; ++c) x[c] = image::srgb_from_linear(x[c]);
  return {x.x, x.y, x.z};
}

std::string channels_text(const ui::PictureLook& look) {
  std::string text;
  for (uint32_t c = 0; c < 4; ++c)
    if (look.channels >> c & 1) text += "RGBA"[c];
  return text.empty() ? "none" : text;
}

void choose_channels(const live::Pixels& pixels, ui::PictureLook& look) {
  if (pixels.floats.empty() || look.chosen_for == pixels.channels) return;
  look.chosen_for = uint8_t(pixels.channels);
  look.channels = uint8_t((1u << std::min(pixels.channels, 3u)) - 1);
}

void fit_range(const live::Pixels& pixels, ui::PictureLook& look) {
  float low = INFINITY, high = -INFINITY;
  const size_t count = pixels.floats.size() / 4;
  const uint32_t channels = ranged(look);
  for (size_t i = 0; i < count; ++i)
    for (uint32_t c = 0; c < 4; ++c) {
      const float x = pixels.floats[i * 4 + c];
      if (!(channels >> c & 1) || !std::isfinite(x) || (look.logarithmic && x <= 0)) continue;
      low = std::min(low, x);
      high = std::max(high, x);
    }
  if (low > high) low = 0, high = 1;
  // Colours and shares begin at nothing.
  if (!look.logarithmic && low > 0 && low < 0.5f * high) low = 0;
  if (look.map == ui::Map::Diverging && low < 0 && high > 0) {
    high = std::max(high, -low);
    low = -high;
  }
  if (high <= low) high = low + 1;
  look.low = low;
  look.high = high;
}

void save_pixels(const std::string& path, const live::Pixels& pixels, const ui::PictureLook& look) {
  const size_t count = size_t(pixels.size.x) * pixels.size.y;
  if (std::filesystem::path(path).extension() == ".exr") {
    const uint32_t channels = std::min(pixels.channels, 4u);
    image::Layer layer{.name = "",
                       .channels = std::string("RGBA").substr(0, channels),
                       .image = {pixels.size.x, pixels.size.y, channels, {}}};
    if (channels == 1) layer.channels = "V";
    for (size_t i = 0; i < count; ++i)
      for (uint32_t c = 0; c < channels; ++c) layer.image.pixels.push_back(pixels.floats[i * 4 + c]);
    image::write_exr(path, {&layer, 1}, {{"nearfield.resource", pixels.name}}, image::Precision::Float);
    return;
  }
  image::Image8 out{pixels.size.x, pixels.size.y, 3, {}};
  for (size_t i = 0; i < count; ++i)
    for (const float x : shown_color(&pixels.floats[i * 4], look))
      out.pixels.push_back(uint8_t(std::lround(std::clamp(x, 0.0f, 1.0f) * 255)));
  image::write_png(path, out);
}

}  // namespace nf::editor
