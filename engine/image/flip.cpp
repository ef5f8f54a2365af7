// FLIP: P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. Fairchild, "FLIP: A Difference
// Evaluator for Alternating Images", HPG 2020 (numbers of sections and equations below are this paper's), and Andersson
// et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021.
#include <algorithm>
#include <array>
#include <cmath>

#include "image/filter.h"
#include "image/metrics.h"

namespace nf::image {
namespace {

struct Vec {
  float x = 0, y = 0, z = 0;
};

// Linear Rec. 709 to XYZ, and the white that it gives to (1, 1, 1). Divided by the white, each row sums to 1.
constexpr double matrix[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                 {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                 {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
constexpr double white(int row) {
  return matrix[row][0] + matrix[row][1] + matrix[row][2];
}

Vec relative_xyz(Vec c) {
  const auto row = [&](int r) {
    return float((matrix[r][0] * double(c.x) + matrix[r][1] * double(c.y) + matrix[r][2] * double(c.z)) / white(r));
  };
  return {row(0), row(1), row(2)};
}

// The inverse of relative_xyz, by cofactors.
Vec rgb_of_relative(Vec v) {
  static const std::array<double, 9> inverse = [] {
    double m[3][3];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m[r][c] = matrix[r][c] / white(r);
    const auto minor = [&](int r, int c) {
      const int r0 = (r + 1) % 3, r1 = (r + 2) % 3, c0 = (c + 1) % 3, c1 = (c + 2) % 3;
      return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
    };
    const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    std::array<double, 9> out{};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) out[size_t(r * 3 + c)] = minor(c, r) / determinant;
    return out;
  }();
  const auto row = [&](size_t r) {
    return float(inverse[r * 3] * double(v.x) + inverse[r * 3 + 1] * double(v.y) + inverse[r * 3 + 2] * double(v.z));
  };
  return {row(0), row(1), row(2)};
}

// The linear opponent space YCxCz of section 4.1.1.
Vec opponent(Vec rgb) {
  const Vec v = relative_xyz(rgb);
  return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
}
Vec rgb_of_opponent(Vec c) {
  const float y = (c.x + 16) / 116;
  return rgb_of_relative({y + c.y / 500, y, y - c.z / 200});
}

// L*a*b* with the Hunt effect, eq 7.
Vec hunt_lab(Vec rgb) {
  const auto f = [](float t) {
    constexpr float d = 6.0f / 29;
    return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0f / 29;
  };
  const Vec v = relative_xyz(rgb);
  const float x = f(v.x), y = f(v.y), z = f(v.z), l = 116 * y - 16;
  return {l, 0.01f * l * 500 * (x - y), 0.01f * l * 200 * (y - z)};
}

// Eq 6: city block in lightness, Euclid in the plane of a and b.
float hyab(Vec a, Vec b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

constexpr float qc = 0.7f, pc = 0.4f, pt = 0.95f;   // section 4.1.3
constexpr float feature_width = 0.082f, qf = 0.5f;  // sections 4.2, 4.3

std::array<Plane, 3> opponent_planes(const Image& image) {
  std::array<Plane, 3> planes;
  for (Plane& plane : planes) plane = {image.width, image.height, {}};
  for (size_t i = 0; i < size_t(image.width) * image.height; ++i) {
    float rgb[3];
    for (uint32_t c = 0; c < 3; ++c) {
      const float value = image.pixels[i * image.channels + (c < image.channels ? c : image.channels - 1)];
      rgb[c] = std::isnan(value) ? 0.0f : std::clamp(value, 0.0f, 1.0f);
    }
    const Vec v = opponent({rgb[0], rgb[1], rgb[2]});
    planes[0].values.push_back(v.x);
    planes[1].values.push_back(v.y);
    planes[2].values.push_back(v.z);
  }
  return planes;
}

// The contrast sensitivity functions as Gaussians in space, section 4.1.1 with the constants of table 1. A sum of two
// Gaussians is not separable, each of the two is.
Plane csf(const Plane& plane, int channel, float ppd) {
  struct Gauss {
    double a, b;
  };
  static constexpr Gauss table[3][2] = {
      {{1, 0.0047}, {0, 1e-5}}, {{1, 0.0053}, {0, 1e-5}}, {{34.1, 0.04}, {13.5, 0.025}}};
  constexpr double pi = 3.14159265358979;
  const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * double(ppd)));
  Plane sum{plane.width, plane.height, std::vector<float>(plane.values.size())};
  double total = 0;
  for (const Gauss& g : table[channel]) {
    if (g.a == 0) continue;
    std::vector<float> kernel;
    double line = 0;
    for (int i = -radius; i <= radius; ++i) {
      const double x = i / double(ppd);
      kernel.push_back(float(std::exp(-pi * pi * x * x / g.b)));
      line += double(kernel.back());
    }
    const double scale = g.a * std::sqrt(pi / g.b);
    total += scale * line * line;
    const Plane part = filtered(plane, kernel, kernel);
    for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += float(scale * double(part.values[i]));
  }
  for (float& value : sum.values) value = float(double(value) / total);
  return sum;
}

// What the eye is left with at this distance, as Hunt-adjusted L*a*b*.
std::vector<Vec> perceived(const std::array<Plane, 3>& planes, float ppd) {
  const Plane y = csf(planes[0], 0, ppd), cx = csf(planes[1], 1, ppd), cz = csf(planes[2], 2, ppd);
  std::vector<Vec> out(y.values.size());
  for (size_t i = 0; i < out.size(); ++i) {
    Vec rgb = rgb_of_opponent({y.values[i], cx.values[i], cz.values[i]});
    rgb = {std::clamp(rgb.x, 0.0f, 1.0f), std::clamp(rgb.y, 0.0f, 1.0f), std::clamp(rgb.z, 0.0f, 1.0f)};
    out[i] = hunt_lab(rgb);
  }
  return out;
}

// Eq 8 to 10: the colour difference, compressed to [0, 1].
float color_difference(Vec a, Vec b) {
  static const float cmax = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), qc);
  const float e = std::pow(hyab(a, b), qc), limit = pc * cmax;
  return e < limit ? pt / limit * e : pt + (e - limit) / (cmax - limit) * (1 - pt);
}

// The strength of edges (first derivative of a Gaussian) and points (second), section 4.2.
struct Features {
  std::vector<float> edge, point;
};
Features features(const Plane& y, float ppd) {
  const float sigma = 0.5f * feature_width * ppd;
  const int radius = int(std::ceil(3 * sigma));
  std::vector<float> gauss, first, second;
  for (int i = -radius; i <= radius; ++i) {
    const float x = float(i), g = std::exp(-x * x / (2 * sigma * sigma));
    gauss.push_back(g);
    first.push_back(-x * g);
    second.push_back((x * x / (sigma * sigma) - 1) * g);
  }
  // Positive weights sum to 1, negative ones to -1, in the plane.
  float line = 0;
  for (const float g : gauss) line += g;
  const auto normalise = [&](std::vector<float>& kernel) {
    float positive = 0, negative = 0;
    for (const float k : kernel) (k > 0 ? positive : negative) += std::abs(k);
    for (float& k : kernel) k /= (k > 0 ? positive : negative);
  };
  normalise(first);
  normalise(second);
  for (float& g : gauss) g /= line;
  Plane unit = y;
  for (float& value : unit.values) value = (value + 16) / 116;
  const auto strength = [&](const std::vector<float>& kernel) {
    const Plane x = filtered(unit, kernel, gauss), down = filtered(unit, gauss, kernel);
    std::vector<float> out(x.values.size());
    for (size_t i = 0; i < out.size(); ++i) out[i] = std::hypot(x.values[i], down.values[i]);
    return out;
  };
  return {strength(first), strength(second)};
}

float luminance(const Image& image, size_t pixel) {
  const float* p = image.pixels.data() + pixel * image.channels;
  const float value = image.channels >= 3 ? 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2] : p[0];
  return std::isfinite(value) ? std::max(value, 0.0f) : 0.0f;
}

// Narkowicz' fit of ACES with its input scaled by 0.6, as in the HDR paper's section 4: (k0 x^2 + k1 x) / (k2 x^2 + k3
// x + k4).
constexpr float k0 = 0.6f * 0.6f * 2.51f, k1 = 0.6f * 0.03f, k2 = 0.6f * 0.6f * 2.43f, k3 = 0.6f * 0.59f, k4 = 0.14f;

float tone(float x) {
  if (std::isnan(x)) return 0;
  x = std::clamp(x, 0.0f, 1e15f);
  return std::clamp((k0 * x * x + k1 * x) / (k2 * x * x + k3 * x + k4), 0.0f, 1.0f);
}

Image exposed(const Image& image, float ev) {
  Image out = image;
  const float scale = std::exp2(ev);
  for (float& value : out.pixels) value = tone(value * scale);
  return out;
}

// Whatever is not a number is seen.
void mark_non_finite(Image& map, const Image& test, const Image& reference) {
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    for (size_t c = 0; c < test.channels; ++c) {
      const float t = test.pixels[i * test.channels + c], r = reference.pixels[i * reference.channels + c];
      if (t != r && !(std::isfinite(t) && std::isfinite(r))) map.pixels[i] = 1;
    }
  }
}

}  // namespace

Image flip_ldr(const Image& test, const Image& reference, float ppd) {
  const std::array<Plane, 3> planes_t = opponent_planes(test), planes_r = opponent_planes(reference);
  const std::vector<Vec> lab_t = perceived(planes_t, ppd), lab_r = perceived(planes_r, ppd);
  const Features ft = features(planes_t[0], ppd), fr = features(planes_r[0], ppd);
  Image map{test.width, test.height, 1, std::vector<float>(lab_t.size())};
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    const float color = std::clamp(color_difference(lab_t[i], lab_r[i]), 0.0f, 1.0f);
    const float edges = std::abs(ft.edge[i] - fr.edge[i]), points = std::abs(ft.point[i] - fr.point[i]);
    const float feature = std::pow(std::clamp(std::max(edges, points) / std::sqrt(2.0f), 0.0f, 1.0f), qf);
    map.pixels[i] = std::pow(color, 1 - feature);
  }
  mark_non_finite(map, test, reference);
  return map;
}

Exposures flip_exposures(const Image& reference) {
  std::vector<float> values(size_t(reference.width) * reference.height);
  for (size_t i = 0; i < values.size(); ++i) values[i] = luminance(reference, i);
  if (values.empty()) return {0, 0, 1};
  std::sort(values.begin(), values.end());
  const float floor = 1e-6f;  // a black picture has no exposure of its own
  const size_t half = values.size() / 2;
  const float median = std::max(values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2, floor);
  const float brightest = std::max(values.back(), floor);
  // The input that the tone curve maps to t = 0.85: the larger root of the quadratic.
  constexpr float t = 0.85f;
  constexpr float a = k0 - t * k2, b = k1 - t * k3, c = -t * k4;
  const float white = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
  Exposures e{std::log2(white / brightest), std::log2(white / median), 2};
  e.count = std::max(2, int(std::ceil(e.stop - e.start)));
  return e;
}

Image flip_hdr(const Image& test, const Image& reference, float ppd) {
  const Exposures e = flip_exposures(reference);
  Image map{test.width, test.height, 1, std::vector<float>(size_t(test.width) * test.height)};
  for (int i = 0; i < e.count; ++i) {
    const float ev = e.start + (e.stop - e.start) * float(i) / float(std::max(e.count - 1, 1));
    const Image one = flip_ldr(exposed(test, ev), exposed(reference, ev), ppd);
    for (size_t p = 0; p < map.pixels.size(); ++p) map.pixels[p] = std::max(map.pixels[p], one.pixels[p]);
  }
  mark_non_finite(map, test, reference);
  return map;
}

}  // namespace nf::image
