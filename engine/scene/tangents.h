// Normals and tangents for meshes that come without. Indices are triangles, checked by the caller.
#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"

namespace nf::scene {

// Fills the zero normals with the area-weighted mean of their triangles' normals; +Y where those cancel or are
// degenerate.
void generate_normals(std::span<const vec3> position, std::span<const uint32_t> index, std::vector<vec3>& normal);

// One unit tangent a vertex along +u, orthogonal to the normal; w makes cross(normal, tangent) * w point towards -v,
// the picture's up, as glTF's normal maps expect. Any orthogonal tangent where the UVs are degenerate.
std::vector<vec4> generate_tangents(std::span<const vec3> position, std::span<const vec3> normal,
                                    std::span<const vec2> uv, std::span<const uint32_t> index);

// A unit vector orthogonal to the unit vector `normal`.
vec3 any_orthogonal(vec3 normal);

}  // namespace nf::scene
