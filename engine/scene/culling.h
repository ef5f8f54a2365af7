// Frustum culling over the structure-of-arrays bounds.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace nf::scene {

// Planes point inwards: a point p is inside when dot(xyz, p) + w >= 0. Works for perspective (reverse-Z, infinite far:
// that plane is dropped) and orthographic clip matrices.
struct Frustum {
  std::array<vec4, 6> plane;
  uint32_t count = 0;
};
Frustum frustum_from_clip(const mat4& clip_from_world);

// Appends the rows whose box touches the frustum, in rising order.
void cull(const Frustum& frustum, std::span<const vec3> center, std::span<const vec3> extent,
          std::vector<uint32_t>& visible);

}  // namespace nf::scene
