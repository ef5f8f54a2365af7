// SSIM (Wang, Bovik, Sheikh, Simoncelli 2004, "Image Quality Assessment: From Error Visibility to Structural
// Similarity", eq 13 with the window of section III.C).
#include <cmath>

#include "image/filter.h"
#include "image/metrics.h"

namespace nf::image {
namespace {

std::vector<float> window() {
  std::vector<float> weights;
  double sum = 0;
  for (int i = -5; i <= 5; ++i) {
    weights.push_back(float(std::exp(-double(i) * i / (2 * 1.5 * 1.5))));
    sum += double(weights.back());
  }
  for (float& weight : weights) weight = float(double(weight) / sum);
  return weights;
}

// Luminance of three channels (Rec. 709), else their mean.
Plane luminance(const Image& image) {
  Plane plane{image.width, image.height, std::vector<float>(size_t(image.width) * image.height)};
  for (size_t i = 0; i < plane.values.size(); ++i) {
    const float* p = image.pixels.data() + i * image.channels;
    if (image.channels == 3) {
      plane.values[i] = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
    } else {
      for (uint32_t c = 0; c < image.channels; ++c) plane.values[i] += p[c] / float(image.channels);
    }
  }
  return plane;
}

Plane product(const Plane& a, const Plane& b) {
  Plane out = a;
  for (size_t i = 0; i < out.values.size(); ++i) out.values[i] *= b.values[i];
  return out;
}

}  // namespace

Image ssim_error(const Pair& pair) {
  const std::vector<float> w = window();
  const Plane a = luminance(pair.test), b = luminance(pair.reference);
  const Plane mean_a = filtered(a, w, w), mean_b = filtered(b, w, w);
  const Plane aa = filtered(product(a, a), w, w), bb = filtered(product(b, b), w, w),
              ab = filtered(product(a, b), w, w);
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  Image map{pair.test.width, pair.test.height, 1, std::vector<float>(a.values.size())};
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    const double ma = double(mean_a.values[i]), mb = double(mean_b.values[i]);
    const double va = double(aa.values[i]) - ma * ma, vb = double(bb.values[i]) - mb * mb;
    const double covariance = double(ab.values[i]) - ma * mb;
    const double ssim = (2 * ma * mb + c1) * (2 * covariance + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    map.pixels[i] = std::isfinite(ssim) ? float(1 - ssim) : 1.0f;
  }
  return map;
}

}  // namespace nf::image
