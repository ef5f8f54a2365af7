// Sums of triangle frames at the vertices. The sums are in double: positions may be large or tiny, and products of four
// lengths leave float's range quickly.
#include "scene/tangents.h"

#include <cmath>

namespace nf::scene {

namespace {

using glm::dvec2;
using glm::dvec3;

// False where v is too short to have a direction.
bool to_unit(dvec3 v, vec3& unit) {
  const double largest = std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
  if (!(largest > 1e-150) || !std::isfinite(largest)) return false;
  unit = vec3(glm::normalize(v / largest));
  return true;
}

struct Frame {
  dvec3 tangent{0}, up{0};
};

// The triangle's +u and -v directions, weighted by its area; zero where the UVs span no area.
Frame triangle_frame(const dvec3* p, const dvec2* uv) {
  const dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
  const dvec2 d1 = uv[1] - uv[0], d2 = uv[2] - uv[0];
  const double determinant = d1.x * d2.y - d2.x * d1.y;
  if (determinant == 0) return {};
  const double sign = determinant < 0 ? -1 : 1;
  const double area = glm::length(glm::cross(e1, e2));
  Frame frame;
  vec3 unit;
  if (to_unit(sign * (d2.y * e1 - d1.y * e2), unit)) frame.tangent = area * dvec3(unit);
  if (to_unit(-sign * (d1.x * e2 - d2.x * e1), unit)) frame.up = area * dvec3(unit);
  return frame;
}

}  // namespace

vec3 any_orthogonal(vec3 normal) {
  const vec3 axis = std::abs(normal.x) < 0.5f ? vec3(1, 0, 0) : vec3(0, 0, 1);
  return glm::normalize(axis - normal * glm::dot(normal, axis));
}

void generate_normals(std::span<const vec3> position, std::span<const uint32_t> index, std::vector<vec3>& normal) {
  std::vector<dvec3> sum(position.size(), dvec3(0));
  for (size_t i = 0; i + 2 < index.size(); i += 3) {
    const dvec3 a(position[index[i]]), b(position[index[i + 1]]), c(position[index[i + 2]]);
    const dvec3 area = glm::cross(b - a, c - a);
    for (size_t corner = 0; corner < 3; ++corner) sum[index[i + corner]] += area;
  }
  for (size_t i = 0; i < normal.size(); ++i) {
    if (normal[i] == vec3(0) && !to_unit(sum[i], normal[i])) normal[i] = vec3(0, 1, 0);
  }
}

std::vector<vec4> generate_tangents(std::span<const vec3> position, std::span<const vec3> normal,
                                    std::span<const vec2> uv, std::span<const uint32_t> index) {
  std::vector<Frame> sum(position.size());
  for (size_t i = 0; i + 2 < index.size(); i += 3) {
    dvec3 p[3];
    dvec2 t[3];
    for (size_t corner = 0; corner < 3; ++corner) {
      p[corner] = dvec3(position[index[i + corner]]);
      t[corner] = dvec2(uv[index[i + corner]]);
    }
    const Frame frame = triangle_frame(p, t);
    for (size_t corner = 0; corner < 3; ++corner) {
      sum[index[i + corner]].tangent += frame.tangent;
      sum[index[i + corner]].up += frame.up;
    }
  }
  std::vector<vec4> tangents(position.size());
  for (size_t i = 0; i < tangents.size(); ++i) {
    const dvec3 n(normal[i]);
    vec3 tangent;
    // Gram-Schmidt; a remainder that is rounding noise counts as none.
    const dvec3 across = sum[i].tangent - n * glm::dot(n, sum[i].tangent);
    const bool usable = glm::length(across) > 1e-6 * glm::length(sum[i].tangent) && to_unit(across, tangent);
    if (!usable) tangent = any_orthogonal(normal[i]);
    const bool flipped = glm::dot(glm::cross(n, dvec3(tangent)), sum[i].up) < 0;
    tangents[i] = vec4(tangent, flipped ? -1.f : 1.f);
  }
  return tangents;
}

}  // namespace nf::scene
