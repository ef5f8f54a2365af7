// Skinning and morphing on the CPU: the truth a GPU pass is checked against, and the boxes culling needs.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace nf::scene {

enum class Moment : uint8_t { Now, Before };  // Before: at the update before the last, for velocity

// One row a vertex of the instance's primitive, in world space; normals and tangents are unit vectors, tangent.w is
// the file's handedness (0 where the material needs no tangents).
struct Deformed {
  std::vector<vec3> position, normal;
  std::vector<vec4> tangent;
};

// Morphs by the node's weights, then skins by the instance's skin, or else transforms by the node:
//   p = base + sum over targets of weight * delta
//   world = (sum over joints of weight * joint matrix) * p
// (glTF 2.0 sections 3.7.2.2 and 3.7.3.3). Normals use the inverse transpose of the linear part.
Deformed deform(const Scene& scene, uint32_t instance, Moment moment);

// Where one vertex (0 .. vertex_count) is, as above.
vec3 deformed_position(const Scene& scene, uint32_t instance, uint32_t vertex, Moment moment);

// A world-space box around the deformed instance as it is now. Exact for what is only transformed, but for the box's
// turning; conservative for skins and morphs.
Bounds deformed_bounds(const Scene& scene, uint32_t instance);

}  // namespace nf::scene
