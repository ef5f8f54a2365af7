// Box-filtered mip chains.
#include "mips.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"
#include "image/image.h"

namespace nf::passes {
namespace {

// sRGB <-> linear through tables: 256 entries one way, 4096 the other (half an 8-bit step everywhere above black's
// toe).
struct SrgbTables {
  std::array<float, 256> linear;
  std::array<uint8_t, 4096> encoded;
  SrgbTables() {
    for (size_t i = 0; i < linear.size(); ++i) linear[i] = image::linear_from_srgb(float(i) / 255.0f);
    for (size_t i = 0; i < encoded.size(); ++i)
      encoded[i] = uint8_t(image::srgb_from_linear(float(i) / float(encoded.size() - 1)) * 255.0f + 0.5f);
  }
};

}  // namespace

MipChain make_mips(const scene::Picture& picture) {
  static const SrgbTables tables;
  MipChain levels{picture.rgba};
  uint32_t width = picture.width, height = picture.height;
  while (width > 1 || height > 1) {
    const uint32_t w = std::max(width / 2, 1u), h = std::max(height / 2, 1u);
    const std::vector<uint8_t>& from = levels.back();
    std::vector<uint8_t> to(size_t(w) * h * 4);
    for (uint32_t y = 0; y < h; ++y)
      for (uint32_t x = 0; x < w; ++x) {
        const uint32_t x0 = x * width / w, y0 = y * height / h;
        const uint32_t x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
        const uint8_t* texel[4] = {&from[(size_t(y0) * width + x0) * 4], &from[(size_t(y0) * width + x1) * 4],
                                   &from[(size_t(y1) * width + x0) * 4], &from[(size_t(y1) * width + x1) * 4]};
        for (uint32_t c = 0; c < 4; ++c) {
          uint8_t& out = to[(size_t(y) * w + x) * 4 + c];
          if (picture.srgb && c < 3) {
            const float mean = (tables.linear[texel[0][c]] + tables.linear[texel[1][c]] + tables.linear[texel[2][c]] +
                                tables.linear[texel[3][c]]) *
                               0.25f;
            out = tables.encoded[size_t(mean * float(tables.encoded.size() - 1) + 0.5f)];
          } else {
            out = uint8_t((texel[0][c] + texel[1][c] + texel[2][c] + texel[3][c] + 2) / 4);
          }
        }
      }
    levels.push_back(std::move(to));
    width = w, height = h;
  }
  return levels;
}

std::vector<MipChain> make_mips(std::span<const scene::Picture> pictures, std::span<const uint32_t> rows) {
  std::vector<MipChain> chains(rows.size());
  for_rows(uint32_t(rows.size()), 0, [&](uint32_t i) { chains[i] = make_mips(pictures[rows[i]]); });
  return chains;
}

}  // namespace nf::passes
