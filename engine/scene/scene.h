// The scene as structure-of-arrays tables. World space is glTF's: right-handed, +Y up, metres. Indices are plain 32-bit
// row numbers; `none` stands for "no row". Nothing here knows the GPU.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "scene/environment.h"

namespace nf::scene {

using glm::mat4;
using glm::quat;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr uint32_t none = 0xffffffffu;

// All vertex streams have the same length; streams a file lacks are filled: normals are generated (area-weighted from
// the triangles), tangents are (0,0,0,0) where the material needs none, UVs 0, colours 1.
struct Geometry {
  std::vector<vec3> position;  // object space
  std::vector<vec3> normal;    // unit
  std::vector<vec4> tangent;   // xyz unit, w = handedness (+-1), glTF's convention
  std::vector<vec2> uv0;
  std::vector<vec4> color;      // linear
  std::vector<uint32_t> index;  // triangle lists, relative to the primitive's vertex_offset
};

struct Bounds {
  vec3 min{0}, max{0};
};

// One glTF primitive: a range of triangles with one material.
struct Primitive {
  uint32_t first_index = 0, index_count = 0, vertex_offset = 0, vertex_count = 0;
  uint32_t material = 0;  // always a row: primitives without one use a default material
  Bounds bounds;          // object space
};

// Nodes in topological order: parent[i] < i, or none.
struct Nodes {
  std::vector<uint32_t> parent;
  std::vector<vec3> translation;
  std::vector<quat> rotation;
  std::vector<vec3> scale;
  std::vector<mat4> local_matrix;  // from TRS, or the file's matrix
  std::vector<mat4> world;         // world_from_object
  std::vector<mat4> previous_world;
  std::vector<std::string> name;
  size_t size() const { return parent.size(); }
};

// What is drawn: a primitive at a node. SoA, because culling reads only the bounds.
struct Instances {
  std::vector<uint32_t> node, primitive;
  std::vector<vec3> center, extent;  // world-space box: centre and half size
  std::vector<uint8_t> mirrored;     // 1 where the world matrix has a negative determinant: front faces are clockwise
  size_t size() const { return node.size(); }
};

enum class AlphaMode : uint8_t { Opaque, Mask, Blend };

struct Material {
  std::string name;
  vec4 base_color{1};
  float metallic = 1, roughness = 1;
  vec3 emissive{0};  // radiance: emissiveFactor * KHR_materials_emissive_strength
  float normal_scale = 1;
  float alpha_cutoff = 0.5f;
  AlphaMode alpha = AlphaMode::Opaque;
  bool double_sided = false;
  // Rows of Scene::textures, or none.
  uint32_t base_color_texture = none, metallic_roughness_texture = none, normal_texture = none, emissive_texture = none;
};

enum class Filter : uint8_t { Nearest, Linear };
enum class Wrap : uint8_t { Repeat, Mirror, Clamp };

struct Sampler {
  Filter mag = Filter::Linear, min = Filter::Linear, mip = Filter::Linear;
  bool mips = true;
  Wrap u = Wrap::Repeat, v = Wrap::Repeat;
  bool operator==(const Sampler&) const = default;
};

// A decoded picture: 8-bit RGBA, row 0 the first row of the file (glTF's v = 0). `srgb` says how its RGB is encoded; a
// picture used both ways appears twice.
struct Picture {
  std::string name;
  uint32_t width = 0, height = 0;
  bool srgb = false;
  std::vector<uint8_t> rgba;
};

struct Texture {
  uint32_t picture = 0;
  Sampler sampler;
};

// direction is the way the light travels. irradiance in W/m2 on a facing surface; color is multiplied in.
struct DirectionalLight {
  vec3 direction{0, -1, 0};
  vec3 color{1};
  float irradiance = 1;
  float angle_deg = 0;  // angular diameter
};
// intensity in W/sr. range 0 = infinite. Spot cones are half angles in radians; a point light has outer_cone = pi.
struct PunctualLight {
  vec3 position{0};
  vec3 direction{0, 0, -1};
  vec3 color{1};
  float intensity = 1;
  float range = 0;
  float radius = 0;
  float inner_cone = 3.14159265f, outer_cone = 3.14159265f;
};

// Looks along `forward` (unit); vfov in radians.
struct Camera {
  std::string name;
  vec3 position{0, 0, 3};
  vec3 forward{0, 0, -1};
  vec3 up{0, 1, 0};
  float vfov = 1.0471976f;
  float near = 0.05f;
  float far = 100;  // only a hint (shadow fitting): the projection's far plane is infinite
};

struct Scene {
  std::string path;
  Geometry geometry;
  std::vector<Primitive> primitives;
  Nodes nodes;
  Instances instances;
  std::vector<Material> materials;
  std::vector<Picture> pictures;
  std::vector<Texture> textures;
  std::vector<DirectionalLight> directional;
  std::vector<PunctualLight> punctual;
  Environment environment;
  std::vector<Camera> cameras;
  Bounds bounds;  // world space, of all instances
  uint64_t triangles() const { return geometry.index.size() / 3; }
};

// world = parent's world * local for every node, then the world bounds and `mirrored` of every instance, and the bounds
// of the scene.
// previous_world is set to the world before the call.
void update_transforms(Scene& scene);

}  // namespace nf::scene
