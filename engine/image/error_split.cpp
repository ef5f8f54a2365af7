// The two parts of an error, as numbers and as a picture.
#include "image/error_split.h"

#include <algorithm>
#include <cmath>

namespace nf::image {
namespace {

// The mean over channels of the pixels that count.
template <class Value>
double mean_over(const Image& shape, const std::vector<uint8_t>& mask, const Value& value) {
  double sum = 0;
  uint64_t count = 0;
  for (size_t i = 0; i < shape.pixels.size(); ++i) {
    if (!mask.empty() && !mask[i / shape.channels]) continue;
    sum += value(i);
    ++count;
  }
  return count ? sum / double(count) : 0;
}

bool counts(uint8_t mask) {
  return mask != 0;
}

double at(const Image& image, size_t i) {
  return double(image.pixels[i]);
}

}  // namespace

Image mean_of(const Halves& halves) {
  Image out = halves.a;
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = 0.5f * (out.pixels[i] + halves.b.pixels[i]);
  return out;
}

double noise_of(const Halves& halves, const std::vector<uint8_t>& mask) {
  return std::sqrt(mean_over(halves.a, mask,
                             [&](size_t i) {
                               const double apart = at(halves.a, i) - at(halves.b, i);
                               return apart * apart;
                             })) /
         2;
}

std::vector<uint8_t> common_surfaces(const std::vector<float>& seen, const std::vector<float>& traced,
                                     uint64_t& left_out) {
  std::vector<uint8_t> mask(seen.size());
  for (size_t i = 0; i < seen.size(); ++i) {
    mask[i] = seen[i] > 0 && traced[i] > 0 && std::abs(seen[i] - traced[i]) <= 0.02f * traced[i];
    left_out += !mask[i] && (seen[i] > 0 || traced[i] > 0);
  }
  return mask;
}

ErrorPart error_between(const Halves& test, const Halves& reference, const std::vector<uint8_t>& mask) {
  ErrorPart part;
  part.bias = mean_over(test.a, mask, [&](size_t i) {
    return (at(test.a, i) + at(test.b, i) - at(reference.a, i) - at(reference.b, i)) / 2;
  });
  const auto product = [&](size_t i) {
    return (at(test.a, i) - at(reference.a, i)) * (at(test.b, i) - at(reference.b, i));
  };
  const double square = mean_over(test.a, mask, product);
  part.rmse = std::isnan(square) ? square : std::sqrt(std::max(square, 0.0));
  const double spread =
      mean_over(test.a, mask, [&](size_t i) { return (product(i) - square) * (product(i) - square); });
  const double pixels =
      mask.empty() ? double(test.a.width) * test.a.height : double(std::count_if(mask.begin(), mask.end(), counts));
  part.floor = std::sqrt(2 * std::sqrt(spread / std::max(pixels, 1.0)));
  return part;
}

ErrorSplit split_error(const Halves& test, const Halves& same, const Halves& reference,
                       const std::vector<uint8_t>& mask) {
  return {error_between(test, reference, mask), error_between(test, same, mask), error_between(same, reference, mask)};
}

Image8 split_picture(const Image& test, const Image& same, const Image& reference, const std::vector<uint8_t>& mask,
                     float range) {
  const Image maps[] = {absolute_error({test, reference, {}}), absolute_error({test, same, {}}),
                        absolute_error({same, reference, {}})};
  if (!(range > 0)) {
    range = float(pool(maps[0], mask).p95);
    if (!(range > 0 && std::isfinite(range))) range = 1;
  }
  const uint32_t width = test.width, gap = 4, step = width + gap;
  Image all{3 * width + 2 * gap, test.height, 1, {}};
  all.pixels.resize(size_t(all.width) * all.height);
  std::vector<uint8_t> counts(all.pixels.size());
  for (uint32_t part = 0; part < 3; ++part) {
    for (uint32_t y = 0; y < test.height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        const size_t from = size_t(y) * width + x, to = size_t(y) * all.width + part * step + x;
        all.pixels[to] = maps[part].pixels[from];
        counts[to] = mask.empty() || mask[from];
      }
    }
  }
  return heat_picture(all, counts, range);
}

}  // namespace nf::image
