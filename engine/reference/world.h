// The scene as rays see it: triangles in world space, one range an instance, with what is at a point of them. Textures
// are read at their finest level, so a picture's mips are the one thing in which the renderer differs.
#pragma once

#include <vector>

#include "reference/reference.h"
#include "scene/scene.h"

namespace nf::reference {

using glm::mat3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float pi = 3.14159265358979f;

struct Hit {
  uint32_t instance = scene::none, triangle = 0;
  float t = 0, u = 0, v = 0;  // weights of the second and third vertex
  bool any() const { return instance != scene::none; }
};

struct WorldInstance {
  std::vector<vec3> position;  // world, one more than there are vertices: the ray structure reads past the end
  // Of skinned and morphed instances, world; of others empty, and the scene's own in object space count.
  std::vector<vec3> normal;
  std::vector<vec4> tangent;
  mat3 cofactor{1}, linear{1};  // of the world matrix, for normals and tangents in object space
  float mirrored = 1;           // -1 where the matrix mirrors
  const scene::Primitive* primitive = nullptr;
  const scene::Material* material = nullptr;
  bool masked = false, blended = false;
};

// Surface at a hit, seen from the side the ray came from: both normals are on that side.
struct Surface {
  vec3 position{0};
  vec3 ng{0}, n{0};  // geometric and shading normal, unit
  vec3 albedo{0};    // base colour
  vec3 diffuse{0};   // diffuse reflectance
  vec3 f0{0};
  vec3 emission{0};  // radiance towards where the ray came from
  float roughness = 1;
  float epsilon = 0;  // metres: how wrong `position` may be
};

class World {
 public:
  World(const scene::Scene& scene, const Settings& settings);

  const scene::Scene& scene() const { return scene_; }
  const std::vector<WorldInstance>& instances() const { return instances_; }
  bool lambert() const { return lambert_; }

  // Corners of a triangle, in world space.
  struct Corners {
    vec3 a, b, c;
  };
  Corners corners(uint32_t instance, uint32_t triangle) const;
  // Unit normal of the front side.
  vec3 front_normal(uint32_t instance, uint32_t triangle) const;
  Surface surface(const Hit& hit, vec3 direction) const;
  float alpha(uint32_t instance, uint32_t triangle, float u, float v) const;
  // Whether a cut-out has a hole there.
  bool hole(uint32_t instance, uint32_t triangle, float u, float v) const;
  // Radiance that leaves the point towards the front.
  vec3 emission(uint32_t instance, uint32_t triangle, float u, float v) const;
  // Radiance that comes from the direction, out of nowhere.
  vec3 environment(vec3 direction) const;
  vec4 texture(uint32_t row, vec2 uv) const;

 private:
  struct Vertex {
    uint32_t a, b, c;  // rows of scene::Geometry
  };
  Vertex vertices(uint32_t instance, uint32_t triangle) const;
  vec2 uv(const scene::Material& material, scene::Slot slot, const Vertex& vertex, float u, float v) const;

  const scene::Scene& scene_;
  bool lambert_;
  float albedo_scale_, emissive_scale_;
  std::vector<WorldInstance> instances_;
};

}  // namespace nf::reference
