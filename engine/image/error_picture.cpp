// Maps of error as pictures: a heat map with a labelled bar, and the signed difference.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "image/metrics.h"

namespace nf::image {
namespace {

struct Glyph {
  char letter;
  uint16_t rows;  // 3 x 5 bits, the top left one first
};
constexpr Glyph glyphs[] = {{'0', 0b111'101'101'101'111}, {'1', 0b010'110'010'010'111}, {'2', 0b111'001'111'100'111},
                            {'3', 0b111'001'111'001'111}, {'4', 0b101'101'111'001'001}, {'5', 0b111'100'111'001'111},
                            {'6', 0b111'100'111'101'111}, {'7', 0b111'001'010'010'010}, {'8', 0b111'101'111'101'111},
                            {'9', 0b111'101'111'001'111}, {'.', 0b000'000'000'000'010}, {'-', 0b000'000'111'000'000},
                            {'+', 0b000'010'111'010'000}, {'e', 0b011'101'111'100'011}};

void put(Image8& image, uint32_t x, uint32_t y, Rgb8 color) {
  if (x >= image.width || y >= image.height) return;
  uint8_t* p = image.pixels.data() + (size_t(y) * image.width + x) * 3;
  p[0] = color.r, p[1] = color.g, p[2] = color.b;
}

void write_text(Image8& image, uint32_t left, uint32_t top, const std::string& text, uint32_t scale) {
  for (const char letter : text) {
    for (const Glyph& glyph : glyphs) {
      if (glyph.letter != letter) continue;
      for (uint32_t bit = 0; bit < 15; ++bit) {
        if (!(glyph.rows >> (14 - bit) & 1)) continue;
        for (uint32_t y = 0; y < scale; ++y)
          for (uint32_t x = 0; x < scale; ++x)
            put(image, left + bit % 3 * scale + x, top + bit / 3 * scale + y, {255, 255, 255});
      }
    }
    left += 4 * scale;
  }
}

constexpr Rgb8 outside{64, 64, 64};

}  // namespace

Rgb8 heat_color(float t) {
  static constexpr Rgb8 stops[] = {{0, 0, 0},     {46, 12, 102},  {134, 24, 112},
                                   {212, 60, 68}, {248, 142, 32}, {255, 250, 180}};
  constexpr int last = int(std::size(stops)) - 1;
  const float at = (std::isnan(t) ? 1.0f : std::clamp(t, 0.0f, 1.0f)) * float(last);
  const int low = std::min(int(at), last - 1);
  const float f = at - float(low);
  const auto mix = [&](uint8_t a, uint8_t b) { return uint8_t(std::lround(float(a) + (float(b) - float(a)) * f)); };
  const Rgb8 a = stops[low], b = stops[low + 1];
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

// The fit is Matt Zucker's (shadertoy.com/view/WlfXRN, CC0).
Rgb8 magma_color(float t) {
  static constexpr float c[3][7] = {
      {-0.002136485f, 0.251660541f, 8.353717279f, -27.668733086f, 52.176139812f, -50.768525365f, 18.655705066f},
      {-0.000749655f, 0.677523244f, -3.577719515f, 14.264730781f, -27.943606072f, 29.046582821f, -11.489773520f},
      {-0.005386128f, 2.494026599f, 0.314467903f, -13.649213188f, 12.944169442f, 4.234152994f, -5.601961509f}};
  const float x = std::isnan(t) ? 1.0f : std::clamp(t, 0.0f, 1.0f);
  const auto channel = [&](const float* k) {
    float sum = 0;
    for (int i = 6; i >= 0; --i) sum = sum * x + k[i];
    return uint8_t(std::lround(255 * std::clamp(sum, 0.0f, 1.0f)));
  };
  return {channel(c[0]), channel(c[1]), channel(c[2])};
}

Image8 heat_picture(const Image& map, const std::vector<uint8_t>& mask, float range) {
  const uint32_t scale = std::max(1u, map.width / 400), bar = 6 * scale, foot = bar + 9 * scale;
  Image8 out{map.width, map.height + foot, 3, {}};
  out.pixels.resize(size_t(out.width) * out.height * 3);
  for (uint32_t y = 0; y < map.height; ++y) {
    for (uint32_t x = 0; x < map.width; ++x) {
      const size_t i = size_t(y) * map.width + x;
      const bool counts = mask.empty() || mask[i];
      put(out, x, y,
          counts ? heat_color(range > 0 ? map.pixels[i] / range : (map.pixels[i] > 0 ? 1.0f : 0.0f)) : outside);
    }
  }
  const uint32_t top = map.height + scale;
  for (uint32_t x = 0; x < map.width; ++x)
    for (uint32_t y = 0; y < bar; ++y) put(out, x, top + y, heat_color(float(x) / float(std::max(map.width - 1, 1u))));
  const auto label = [&](float share) {
    const std::string text = fmt::format("{:.3g}", double(range) * double(share));
    const uint32_t width = uint32_t(text.size()) * 4 * scale;
    const float middle = share * float(map.width) - float(width) / 2;
    const float left = std::clamp(middle, 0.0f, std::max(float(map.width) - float(width), 0.0f));
    write_text(out, uint32_t(left), top + bar + scale, text, scale);
  };
  label(0);
  if (map.width >= 100) label(0.5f);
  if (map.width >= 40) label(1);
  return out;
}

Image8 signed_picture(const Pair& pair, float range) {
  const Image& test = pair.test;
  Image8 out{test.width, test.height, 3, std::vector<uint8_t>(size_t(test.width) * test.height * 3)};
  for (uint32_t y = 0; y < test.height; ++y) {
    for (uint32_t x = 0; x < test.width; ++x) {
      if (!pair.counts(size_t(y) * test.width + x)) {
        put(out, x, y, outside);
        continue;
      }
      float difference = 0;
      for (uint32_t c = 0; c < test.channels; ++c) {
        static constexpr float rec709[] = {0.2126f, 0.7152f, 0.0722f};
        const float weight = test.channels == 3 ? rec709[c] : 1 / float(test.channels);
        difference += weight * (test.at(x, y, c) - pair.reference.at(x, y, c));
      }
      const float t = std::isnan(difference) ? 1.0f : std::clamp(difference / range, -1.0f, 1.0f);
      const auto fade = [&](float share) { return uint8_t(std::lround(255 * (1 - share))); };
      const uint8_t faded = fade(std::abs(t));
      put(out, x, y, t > 0 ? Rgb8{255, faded, faded} : Rgb8{faded, faded, 255});
    }
  }
  return out;
}

}  // namespace nf::image
