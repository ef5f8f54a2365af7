// The scene as structure-of-arrays tables. World space is glTF's: right-handed, +Y up, metres. Indices are plain 32-bit
// row numbers; `none` stands for "no row". Nothing here knows the GPU.
#pragma once

#include <array>
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

// All vertex streams have the same length; streams a file lacks are filled: normals are the triangles' own (flat, as
// glTF asks), tangents are (0,0,0,0) where the material needs none, UVs 0, colours 1.
struct Geometry {
  std::vector<vec3> position;  // object space
  std::vector<vec3> normal;    // unit
  std::vector<vec4> tangent;   // xyz unit, w = handedness (+-1), glTF's convention
  std::vector<vec2> uv0, uv1;
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
  Bounds bounds;          // object space, without deformation
  // Vertex v of the primitive has row first_influence + v of Influences; none = not made for a skin.
  uint32_t first_influence = none;
  uint32_t first_joint_box = 0, joint_box_count = 0;  // rows of JointBoxes
  // Vertex v has row first_delta + target * vertex_count + v of MorphDeltas.
  uint32_t first_delta = 0, first_target = 0, target_count = 0;
};

// The four joints that move a vertex: joints count from the first of the instance's skin, weights sum to 1.
struct Influences {
  std::vector<glm::u16vec4> joint;
  std::vector<vec4> weight;
  size_t size() const { return joint.size(); }
};

// For each joint of a skinned primitive the box of the vertices it has a weight in (object space): a skinned vertex is
// a convex combination of its joints' images of it, so it lies in the hull of these boxes' images.
struct JointBoxes {
  std::vector<uint32_t> joint;
  std::vector<vec3> center, extent;
};

// A skin is a range of joints. Joint j takes a vertex to the world by matrix[j] = world[node[j]] * inverse_bind[j]; the
// transform of the skinned instance's own node plays no part, as glTF has it.
struct Skin {
  uint32_t first_joint = 0, joint_count = 0;
};
struct Joints {
  std::vector<uint32_t> node;
  std::vector<mat4> inverse_bind, matrix, previous_matrix;
  size_t size() const { return node.size(); }
};

// What a target at weight 1 adds to a vertex, in object space; a target's box bounds its position deltas.
struct MorphDeltas {
  std::vector<vec3> position, normal, tangent;
  std::vector<Bounds> target_bounds;  // by Primitive::first_target + target
};
// A node with a morphed mesh owns a range of weights, one a target. `wanted` is what the next update makes of `value`.
struct MorphWeights {
  std::vector<float> value, previous, wanted;
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
  std::vector<uint32_t> first_weight, weight_count;  // rows of MorphWeights
  // 1 where the local transform was set after the last update; 1 where the last update changed `world`.
  std::vector<uint8_t> touched, moved;
  std::vector<std::string> name;
  size_t size() const { return parent.size(); }
};

// What is drawn: a primitive at a node. SoA, because culling reads only the bounds.
struct Instances {
  std::vector<uint32_t> node, primitive;
  std::vector<uint32_t> skin;        // row of Scene::skins, or none; a skinned instance's vertices end in world space
  std::vector<vec3> center, extent;  // world-space box: centre and half size
  std::vector<uint8_t> mirrored;     // 1 where the world matrix has a negative determinant: front faces are clockwise
  size_t size() const { return node.size(); }
};

enum class AlphaMode : uint8_t { Opaque, Mask, Blend };

// What a material's texture is for; a row of Material::mapping each.
enum class Slot : uint8_t { BaseColor, MetallicRoughness, Normal, Emissive, Occlusion, Specular, SpecularColor, Count };

// Where a texture is looked up: uv' = linear * uv + offset, with uv of one of the two sets.
struct UvMapping {
  uint32_t set = 0;
  glm::mat2 linear{1};
  vec2 offset{0};
  bool operator==(const UvMapping&) const = default;
};

struct Material {
  std::string name;
  vec4 base_color{1};
  float metallic = 1, roughness = 1;
  vec3 emissive{0};  // radiance: emissiveFactor * KHR_materials_emissive_strength
  float normal_scale = 1;
  float occlusion_strength = 1;
  // The dielectric part's F0 is min(((ior - 1) / (ior + 1))^2 * specular_color, 1) * specular, its F90 is specular.
  float ior = 1.5f;
  float specular = 1;
  vec3 specular_color{1};
  float alpha_cutoff = 0.5f;
  AlphaMode alpha = AlphaMode::Opaque;
  bool double_sided = false;
  bool unlit = false;  // the base colour is shown as it is
  // Rows of Scene::textures, or none.
  uint32_t base_color_texture = none, metallic_roughness_texture = none, normal_texture = none, emissive_texture = none;
  uint32_t occlusion_texture = none;       // red
  uint32_t specular_texture = none;        // alpha
  uint32_t specular_color_texture = none;  // sRGB
  std::array<UvMapping, size_t(Slot::Count)> mapping;
  const UvMapping& mapping_of(Slot slot) const { return mapping[size_t(slot)]; }
};

// KHR_materials_variants: with variant `variant` the primitive has this material.
struct VariantMaterial {
  uint32_t primitive = 0, variant = 0, material = 0;
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
  float angle_deg = 0;   // angular diameter
  uint32_t node = none;  // the node that aims it, or none
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
  uint32_t node = none;  // the node that places and aims it, or none
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
  uint32_t node = none;
};

enum class Interpolation : uint8_t { Step, Linear, CubicSpline };
enum class AnimatedPath : uint8_t { Translation, Rotation, Scale, Weights };

// Keys of one animated property: times at [first_key, +key_count), and for each key `width` values from
// first_value + key * width on; three times as many for cubic splines (in-tangent, value, out-tangent).
struct AnimationSampler {
  uint32_t first_key = 0, key_count = 0, first_value = 0, width = 0;
  Interpolation interpolation = Interpolation::Linear;
};
struct AnimationChannel {
  uint32_t sampler = 0;
  uint32_t target = 0;  // row of rest_node, or for weights the first row of MorphWeights
  AnimatedPath path = AnimatedPath::Translation;
};
struct Clip {
  std::string name;
  uint32_t first_channel = 0, channel_count = 0;
  float duration = 0;  // seconds, of its last key
  bool plays = true;
};
struct Animations {
  std::vector<Clip> clips;
  std::vector<AnimationChannel> channels;
  std::vector<AnimationSampler> samplers;
  std::vector<float> time, value;
  // What every animated node is where no playing clip says otherwise; rest_weight is as long as MorphWeights.
  std::vector<uint32_t> rest_node;
  std::vector<vec3> rest_translation, rest_scale;
  std::vector<quat> rest_rotation;
  std::vector<float> rest_weight;
};

struct Scene {
  std::string path;
  Geometry geometry;
  std::vector<Primitive> primitives;
  Influences influences;
  JointBoxes joint_boxes;
  std::vector<Skin> skins;
  Joints joints;
  MorphDeltas morph_deltas;
  MorphWeights morph_weights;
  Animations animations;
  Nodes nodes;
  Instances instances;
  std::vector<Material> materials;
  std::vector<Picture> pictures;
  std::vector<Texture> textures;
  std::vector<std::string> variants;
  std::vector<uint32_t> default_material;  // by primitive: what it has without a variant
  std::vector<VariantMaterial> variant_materials;
  std::vector<DirectionalLight> directional;
  std::vector<PunctualLight> punctual;
  Environment environment;
  std::vector<Camera> cameras;
  Bounds bounds;  // world space, of all instances
  uint64_t triangles() const { return geometry.index.size() / 3; }
};

// world = parent's world * local for every node, touched or not, and all that follows from it (update.h); for use after
// writing local_matrix directly. previous_world is set to the world before the call.
void update_transforms(Scene& scene);

// Gives every primitive the material it has in a variant (a row of Scene::variants), or its own with none. Afterwards
// all instance rows differ from those uploaded.
void select_variant(Scene& scene, uint32_t variant);

}  // namespace nf::scene
