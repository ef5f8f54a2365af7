// Curved shapes with smooth normals.
#include <cmath>
#include <numbers>

#include "builder.h"
#include "core/error.h"

namespace nf::content {
namespace {

// First derivatives of a surface by differences; one-sided at its borders.
struct Slope {
  vec3 along_s, along_t;
  vec2 uv_s, uv_t;
};

Slope slope_at(const std::function<SurfacePoint(float, float)>& point, float s, float t, vec2 step) {
  const float s0 = std::max(s - step.x, 0.0f), s1 = std::min(s + step.x, 1.0f);
  const float t0 = std::max(t - step.y, 0.0f), t1 = std::min(t + step.y, 1.0f);
  const SurfacePoint left = point(s0, t), right = point(s1, t), below = point(s, t0), above = point(s, t1);
  return {(right.position - left.position) / (s1 - s0), (above.position - below.position) / (t1 - t0),
          (right.uv - left.uv) / (s1 - s0), (above.uv - below.uv) / (t1 - t0)};
}

vec4 tangent_of(const Slope& slope, vec3 normal) {
  const float area = slope.uv_s.x * slope.uv_t.y - slope.uv_s.y * slope.uv_t.x;
  const float sign = area < 0 ? -1.0f : 1.0f;
  vec3 along = sign * (slope.along_s * slope.uv_t.y - slope.along_t * slope.uv_s.y);
  const vec3 up = sign * (slope.along_s * slope.uv_t.x - slope.along_t * slope.uv_s.x);  // -v
  along -= normal * glm::dot(normal, along);
  if (!(glm::length(along) > 1e-9f)) along = slope.along_s - normal * glm::dot(normal, slope.along_s);
  along = glm::normalize(along);
  return vec4(along, glm::dot(glm::cross(normal, along), up) < 0 ? -1.0f : 1.0f);
}

}  // namespace

void Builder::surface(uint32_t columns, uint32_t rows, const std::function<SurfacePoint(float, float)>& point,
                      MaterialId material) {
  Primitive& to = primitive(material);
  const uint32_t base = uint32_t(to.position.size());
  const vec2 step(0.02f / float(columns), 0.02f / float(rows));
  for (uint32_t row = 0; row <= rows; ++row) {
    for (uint32_t column = 0; column <= columns; ++column) {
      const float s = float(column) / float(columns), t = float(row) / float(rows);
      const SurfacePoint here = point(s, t);
      const Slope slope = slope_at(point, s, t, step);
      const vec3 cross = glm::cross(slope.along_s, slope.along_t);
      NF_CHECK(glm::length(cross) > 0, "a surface without a normal at {}, {}", s, t);
      const vec3 normal = glm::normalize(cross);
      to.position.push_back(here.position);
      to.normal.push_back(normal);
      to.tangent.push_back(tangent_of(slope, normal));
      to.uv.push_back(here.uv);
    }
  }
  for (uint32_t row = 0; row < rows; ++row) {
    for (uint32_t column = 0; column < columns; ++column) {
      const uint32_t a = base + row * (columns + 1) + column, b = a + columns + 1;
      to.index.insert(to.index.end(), {a, a + 1, b + 1, a, b + 1, b});
    }
  }
}

void Builder::revolve(std::span<const vec2> line, uint32_t sides, vec3 foot, MaterialId material, vec2 uv_repeat) {
  NF_CHECK(line.size() >= 2 && sides >= 3, "{} points, {} sides", line.size(), sides);
  const auto direction = [&](size_t i) { return glm::normalize(line[i + 1] - line[i]); };
  float length = 0;
  for (size_t first = 0; first + 1 < line.size();) {
    size_t last = first + 1;
    while (last + 1 < line.size() && glm::dot(direction(last - 1), direction(last)) > 0.82f) ++last;
    // One smooth run of the line.
    Primitive& to = primitive(material);
    const uint32_t base = uint32_t(to.position.size());
    for (size_t i = first; i <= last; ++i) {
      const vec2 before = i > first ? direction(i - 1) : direction(i), after = i < last ? direction(i) : before;
      const vec2 along = glm::normalize(before + after);
      for (uint32_t side = 0; side <= sides; ++side) {
        const float angle = 2 * std::numbers::pi_v<float> * float(side) / float(sides);
        // Seen from outside, rising angles run to the right.
        const vec3 out(std::sin(angle), 0, std::cos(angle));
        to.position.push_back(foot + line[i].x * out + vec3(0, line[i].y, 0));
        to.normal.push_back(glm::normalize(along.y * out - vec3(0, along.x, 0)));
        to.tangent.emplace_back(out.z, 0, -out.x, 1);
        to.uv.emplace_back(uv_repeat.x * float(side) / float(sides), -uv_repeat.y * length);
      }
      if (i < last) length += glm::length(line[i + 1] - line[i]);
    }
    for (uint32_t row = 0; row < uint32_t(last - first); ++row) {
      for (uint32_t side = 0; side < sides; ++side) {
        const uint32_t a = base + row * (sides + 1) + side, b = a + sides + 1;
        // At the axis a ring is one point, and half of its faces are nothing.
        if (line[first + row].x > 0) to.index.insert(to.index.end(), {a, a + 1, b + 1});
        if (line[first + row + 1].x > 0) to.index.insert(to.index.end(), {a, b + 1, b});
      }
    }
    first = last;
  }
}

}  // namespace nf::content
