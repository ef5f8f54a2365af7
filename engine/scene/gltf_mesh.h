// One glTF primitive on its way into the tables; shared by the parts that read meshes.
#pragma once

#include "scene/gltf_accessor.h"

namespace nf::scene::gltf {

// A primitive before it joins the tables: triangles, and the streams of its vertices. `used` lists the file's vertices
// it takes, in order; empty = all.
struct Draft {
  std::vector<uint32_t> index, used;
  size_t vertex_count = 0;
  std::vector<vec3> position, normal;
  std::vector<vec4> tangent, color;
  std::vector<vec2> uv0, uv1;
  // Skinned primitives only.
  std::vector<glm::u16vec4> joint;
  std::vector<vec4> weight;
  // Target by target, vertex_count rows each.
  size_t target_count = 0;
  std::vector<vec3> delta_position, delta_normal, delta_tangent;

  size_t file_vertex(size_t i) const { return used.empty() ? i : used[i]; }
};

// What a primitive's accessors are read from: its attributes, or one morph target's.
struct AttributeSource {
  const std::map<std::string, int>& attributes;
  size_t file_vertices;
  std::string where;
};

bool finite(const vec4& v);

// The accessor of an attribute; refuses one whose count is not that of POSITION. False when there is none.
bool open_attribute(Importer& importer, const AttributeSource& source, const std::string& name, unsigned allowed,
                    int least, int most, Elements& elements);

// JOINTS_n and WEIGHTS_n: the four strongest influences of each vertex.
void draft_influences(Importer& importer, const AttributeSource& source, Draft& draft);
void draft_targets(Importer& importer, const tinygltf::Primitive& source, size_t file_vertices,
                   const std::string& where, Draft& draft);
// Joins what the two above drafted to the tables.
void append_influences(Scene& scene, const Draft& draft, Primitive& primitive);
void append_targets(Scene& scene, const Draft& draft, Primitive& primitive);

}  // namespace nf::scene::gltf
