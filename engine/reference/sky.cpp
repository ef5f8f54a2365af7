// Texels of an equirectangular map as a table of probabilities: a row by its light, then a texel of the row; within it
// even by solid angle.
#include "reference/sky.h"

#include <algorithm>
#include <cmath>

#include "reference/world.h"

namespace nf::reference {
namespace {

// Makes running sums of `sums[first, first + count)` that end at 1; returns the total. Nothing at all is spread evenly.
double accumulate(std::vector<float>& sums, size_t first, size_t count) {
  double total = 0;
  for (size_t i = first; i < first + count; ++i) total += double(sums[i]);
  double sum = 0;
  for (size_t i = first; i < first + count; ++i) {
    sum += total > 0 ? double(sums[i]) / total : 1 / double(count);
    sums[i] = float(sum);
  }
  sums[first + count - 1] = 1;
  return total;
}

// The entry of the running sums that holds u, and where in it, 0 to 1.
uint32_t find(const float* sums, uint32_t count, float u, float& inside) {
  const uint32_t i = std::min(uint32_t(std::upper_bound(sums, sums + count, u) - sums), count - 1);
  const float before = i ? sums[i - 1] : 0, share = sums[i] - before;
  inside = share > 0 ? std::clamp((u - before) / share, 0.0f, 0.99999994f) : 0.5f;
  return i;
}

// Height (y) of the edge above row `row`.
float edge(uint32_t row, uint32_t height) {
  return std::cos(pi * float(row) / float(height));
}

}  // namespace

Sky::Sky(const scene::Environment& e) : width_(e.width), height_(e.height), rotation_(e.rotation) {
  if (e.kind != scene::EnvironmentKind::Map || e.texels.empty()) return;
  columns_.resize(e.texels.size());
  rows_.resize(height_);
  for (uint32_t y = 0; y < height_; ++y) {
    for (uint32_t x = 0; x < width_; ++x) {
      const vec3 t = e.texels[size_t(y) * width_ + x];
      columns_[size_t(y) * width_ + x] = glm::dot(t, vec3(0.2126f, 0.7152f, 0.0722f));
    }
    rows_[y] = float(accumulate(columns_, size_t(y) * width_, width_) * double(solid_angle(y)));
  }
  if (accumulate(rows_, 0, height_) <= 0) columns_.clear();
}

float Sky::solid_angle(uint32_t y) const {
  return 2 * pi / float(width_) * (edge(y, height_) - edge(y + 1, height_));
}

float Sky::probability(uint32_t x, uint32_t y) const {
  const float* row = columns_.data() + size_t(y) * width_;
  return (rows_[y] - (y ? rows_[y - 1] : 0)) * (row[x] - (x ? row[x - 1] : 0));
}

Sky::Choice Sky::choose(vec2 u) const {
  float down = 0, along = 0;
  const uint32_t y = find(rows_.data(), height_, u.x, down);
  const uint32_t x = find(columns_.data() + size_t(y) * width_, width_, u.y, along);
  const float height = glm::mix(edge(y, height_), edge(y + 1, height_), down);
  const float phi = 2 * pi * ((float(x) + along) / float(width_) - 0.5f) - rotation_;
  const float r = std::sqrt(std::max(0.0f, 1 - height * height));
  return {{r * std::cos(phi), height, r * std::sin(phi)}, probability(x, y) / solid_angle(y)};
}

float Sky::density(vec3 d) const {
  const float u = 0.5f + (std::atan2(d.z, d.x) + rotation_) / (2 * pi);
  const float v = std::acos(std::clamp(d.y, -1.0f, 1.0f)) / pi;
  const uint32_t x = std::min(uint32_t((u - std::floor(u)) * float(width_)), width_ - 1);
  const uint32_t y = std::min(uint32_t(v * float(height_)), height_ - 1);
  return probability(x, y) / solid_angle(y);
}

}  // namespace nf::reference
