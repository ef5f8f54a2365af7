// Meshes into the geometry streams. Only the vertices a primitive uses are copied, so primitives may share one big
// vertex buffer without multiplying it.
#include "scene/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "scene/tangents.h"

namespace nf::scene::gltf {

bool finite(const vec4& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

bool open_attribute(Importer& importer, const AttributeSource& source, const std::string& name, unsigned allowed,
                    int least, int most, Elements& elements) {
  const auto attribute = source.attributes.find(name);
  if (attribute == source.attributes.end()) return false;
  elements = open_accessor(importer, attribute->second, allowed, least, most, source.where + " " + name);
  if (elements.count != source.file_vertices) {
    refuse("{} {} has {} elements, POSITION has {}", source.where, name, elements.count, source.file_vertices);
  }
  return true;
}

namespace {

// Strips and fans as triangle lists of the same winding.
std::vector<uint32_t> triangulate(const std::vector<uint32_t>& index, int mode) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return index;
  std::vector<uint32_t> list;
  for (size_t i = 2; i < index.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      list.insert(list.end(), {index[0], index[i - 1], index[i]});
    } else {
      const size_t odd = i % 2;
      list.insert(list.end(), {index[i - 2], index[i - 1 + odd], index[i - odd]});
    }
  }
  return list;
}

void draft_indices(Importer& importer, const tinygltf::Primitive& source, size_t vertex_count, const std::string& where,
                   Draft& draft) {
  std::vector<uint32_t> index;
  if (source.indices >= 0) {
    const Elements elements =
        open_accessor(importer, source.indices, as_u8 | as_u16 | as_u32, 1, 1, where + " indices");
    importer.budget.take(uint64_t(elements.count) * 12, "triangles");
    index = read_indices(elements);
    const auto worst = std::max_element(index.begin(), index.end());
    if (worst != index.end() && *worst >= vertex_count) {
      refuse("{} has the index {}, but only {} vertices", where, *worst, vertex_count);
    }
  } else {
    importer.budget.take(uint64_t(vertex_count) * 12, "triangles");
    index.resize(vertex_count);
    std::iota(index.begin(), index.end(), 0u);
  }
  if (source.mode == TINYGLTF_MODE_TRIANGLES && index.size() % 3 != 0) {
    refuse("{} has {} indices, which is no whole number of triangles", where, index.size());
  }
  draft.index = triangulate(index, source.mode);
}

// Renumbers the indices to the vertices in use when that makes fewer. Without normals in the file the triangles share
// no vertices: their normals are flat.
void draft_vertices(size_t vertex_count, bool flat, Draft& draft) {
  draft.vertex_count = vertex_count;
  if (flat) {
    draft.vertex_count = draft.index.size();
    draft.used = std::move(draft.index);
    draft.index.resize(draft.vertex_count);
    std::iota(draft.index.begin(), draft.index.end(), 0u);
    return;
  }
  if (draft.index.size() >= vertex_count) return;
  draft.used = draft.index;
  std::sort(draft.used.begin(), draft.used.end());
  draft.used.erase(std::unique(draft.used.begin(), draft.used.end()), draft.used.end());
  for (uint32_t& index : draft.index) {
    index = uint32_t(std::lower_bound(draft.used.begin(), draft.used.end(), index) - draft.used.begin());
  }
  draft.vertex_count = draft.used.size();
}

// vec3(0) where there is no direction in v.
vec3 unit_or_zero(const vec3& v) {
  const float length = glm::length(v);
  return length > 1e-6f && std::isfinite(length) ? v / length : vec3(0);
}

// Calls `each(i, value)` for the draft's vertices; does nothing when the primitive lacks the attribute. Without
// KHR_mesh_quantization integers are always fractions, whatever the accessor says.
template <class Each>
bool for_attribute(Importer& importer, const AttributeSource& source, const char* name, unsigned allowed, int least,
                   int most, const Draft& draft, const Each& each) {
  Elements elements;
  if (!open_attribute(importer, source, name, allowed, least, most, elements)) return false;
  elements.normalized |= !importer.quantized;
  for (size_t i = 0; i < draft.vertex_count; ++i) each(i, read_float4(elements, draft.file_vertex(i)));
  return true;
}

void draft_tangents(Importer& importer, const AttributeSource& source, const uint32_t normal_mapped, bool normals,
                    Draft& draft) {
  draft.tangent.assign(draft.vertex_count, vec4(0));
  const unsigned allowed = as_float | (importer.quantized ? as_i8 | as_i16 : 0);
  // Tangents belong to the normals they were made with: without those, glTF has us make our own.
  const bool tangents =
      normals && for_attribute(importer, source, "TANGENT", allowed, 4, 4, draft, [&](size_t i, const vec4& value) {
        const vec3 unit = unit_or_zero(vec3(value));
        draft.tangent[i] = vec4(unit == vec3(0) ? any_orthogonal(draft.normal[i]) : unit, value.w < 0 ? -1.f : 1.f);
      });
  if (tangents || normal_mapped == none) return;
  const UvMapping& mapping = importer.scene.materials[normal_mapped].mapping_of(Slot::Normal);
  std::vector<vec2> uv = mapping.set == 1 ? draft.uv1 : draft.uv0;
  for (vec2& value : uv) value = mapping.linear * value + mapping.offset;
  draft.tangent = generate_tangents(draft.position, draft.normal, uv, draft.index);
}

// `normal_mapped` is a material with a normal map that the primitive may have, or none.
void draft_streams(Importer& importer, const AttributeSource& source, uint32_t normal_mapped, Draft& draft) {
  const auto read = [&](const char* name, unsigned allowed, int least, int most, const auto& each) {
    return for_attribute(importer, source, name, allowed, least, most, draft, each);
  };
  const unsigned quantized = importer.quantized ? as_i8 | as_i16 : 0;
  draft.position.resize(draft.vertex_count);
  read("POSITION", as_float | quantized | (quantized ? as_u8 | as_u16 : 0), 3, 3, [&](size_t i, const vec4& value) {
    if (!finite(value)) refuse("{} has a position that is not finite (vertex {})", source.where, i);
    draft.position[i] = vec3(value);
  });
  draft.normal.assign(draft.vertex_count, vec3(0));
  const bool normals = read("NORMAL", as_float | quantized, 3, 3,
                            [&](size_t i, const vec4& value) { draft.normal[i] = unit_or_zero(vec3(value)); });
  if (!normals || std::find(draft.normal.begin(), draft.normal.end(), vec3(0)) != draft.normal.end()) {
    generate_normals(draft.position, draft.index, draft.normal);
  }
  const unsigned packed = as_float | as_u8 | as_u16;
  bool broken = false;
  const auto read_uvs = [&](const char* name, std::vector<vec2>& stream) {
    stream.assign(draft.vertex_count, vec2(0));
    read(name, packed | quantized, 2, 2, [&](size_t i, const vec4& value) {
      if (finite(value)) stream[i] = vec2(value);
      broken |= !finite(value);
    });
  };
  read_uvs("TEXCOORD_0", draft.uv0);
  read_uvs("TEXCOORD_1", draft.uv1);
  draft.color.assign(draft.vertex_count, vec4(1));
  read("COLOR_0", packed, 3, 4, [&](size_t i, const vec4& value) {
    if (finite(value)) draft.color[i] = value;
    broken |= !finite(value);
  });
  if (broken) importer.warn_once("UVs or colours that are not finite are replaced");
  draft_tangents(importer, source, normal_mapped, normals, draft);
}

template <class T>
void append(std::vector<T>& table, const std::vector<T>& rows) {
  table.insert(table.end(), rows.begin(), rows.end());
}

void append_draft(Scene& scene, const Draft& draft, uint32_t material) {
  Geometry& geometry = scene.geometry;
  Primitive primitive;
  primitive.first_index = uint32_t(geometry.index.size());
  primitive.index_count = uint32_t(draft.index.size());
  primitive.vertex_offset = uint32_t(geometry.position.size());
  primitive.vertex_count = uint32_t(draft.vertex_count);
  primitive.material = material;
  primitive.bounds = {draft.position[draft.index[0]], draft.position[draft.index[0]]};
  for (const uint32_t index : draft.index) {
    primitive.bounds.min = glm::min(primitive.bounds.min, draft.position[index]);
    primitive.bounds.max = glm::max(primitive.bounds.max, draft.position[index]);
  }
  append(geometry.position, draft.position);
  append(geometry.normal, draft.normal);
  append(geometry.tangent, draft.tangent);
  append(geometry.uv0, draft.uv0);
  append(geometry.uv1, draft.uv1);
  append(geometry.color, draft.color);
  append(geometry.index, draft.index);
  append_influences(scene, draft, primitive);
  append_targets(scene, draft, primitive);
  scene.primitives.push_back(primitive);
  scene.default_material.push_back(material);
}

// The row of the material that primitives without one use; made on first use.
uint32_t default_material(Importer& importer) {
  std::vector<Material>& materials = importer.scene.materials;
  if (materials.size() == importer.model.materials.size()) {
    materials.emplace_back();
    materials.back().name = "default";
  }
  return uint32_t(materials.size() - 1);
}

bool skip_primitive(Importer& importer, const tinygltf::Primitive& source) {
  if (source.mode < TINYGLTF_MODE_TRIANGLES) {
    importer.warn_once("points and lines are skipped");
    return true;
  }
  if (!source.attributes.contains("POSITION")) {
    importer.warn_once("primitives without POSITION are skipped");
    return true;
  }
  return false;
}

// The materials that KHR_materials_variants gives the primitive, by variant.
std::vector<VariantMaterial> variants_of(const Importer& importer, const nlohmann::json& primitive) {
  std::vector<VariantMaterial> rows;
  const nlohmann::json* extension = extension_of(primitive, "KHR_materials_variants");
  if (!extension || importer.scene.variants.empty()) return rows;
  for (const nlohmann::json& mapping : (*extension)["mappings"]) {
    for (const nlohmann::json& variant : mapping["variants"]) {
      rows.push_back(
          {uint32_t(importer.scene.primitives.size()), variant.get<uint32_t>(), mapping["material"].get<uint32_t>()});
    }
  }
  return rows;
}

uint32_t find_normal_mapped(const Importer& importer, uint32_t material, std::span<const VariantMaterial> variants) {
  const auto mapped = [&](uint32_t row) { return importer.scene.materials[row].normal_texture != none; };
  if (mapped(material)) return material;
  for (const VariantMaterial& row : variants) {
    if (mapped(row.material)) return row.material;
  }
  return none;
}

void import_primitive(Importer& importer, const tinygltf::Primitive& source, const nlohmann::json& json,
                      const std::string& where) {
  if (skip_primitive(importer, source)) return;
  const unsigned quantized = importer.quantized ? as_i8 | as_i16 | as_u8 | as_u16 : 0;
  const int position = source.attributes.at("POSITION");
  const size_t file_vertices = open_accessor(importer, position, as_float | quantized, 3, 3, where + " POSITION").count;
  Draft draft;
  draft_indices(importer, source, file_vertices, where, draft);
  if (draft.index.empty()) return;
  draft_vertices(file_vertices, !source.attributes.contains("NORMAL"), draft);
  importer.budget.take(uint64_t(draft.vertex_count) * 72, "vertices");
  const Geometry& geometry = importer.scene.geometry;
  const uint64_t most = std::numeric_limits<int32_t>::max();
  if (geometry.position.size() + draft.vertex_count > most || geometry.index.size() + draft.index.size() > most) {
    refuse_advising("split the scene", "it has more than {} vertices or indices", most);
  }
  const uint32_t material = source.material >= 0 ? uint32_t(source.material) : default_material(importer);
  const std::vector<VariantMaterial> variants = variants_of(importer, json);
  const AttributeSource attributes{source.attributes, file_vertices, where};
  draft_streams(importer, attributes, find_normal_mapped(importer, material, variants), draft);
  draft_influences(importer, attributes, draft);
  draft_targets(importer, source, file_vertices, where, draft);
  append_draft(importer.scene, draft, material);
  append(importer.scene.variant_materials, variants);
}

}  // namespace

PrimitiveRange import_mesh(Importer& importer, size_t row) {
  const tinygltf::Mesh& mesh = importer.model.meshes.at(row);
  const nlohmann::json& primitives = importer.source.document["meshes"][row]["primitives"];
  PrimitiveRange range{uint32_t(importer.scene.primitives.size()), 0};
  for (size_t i = 0; i < mesh.primitives.size(); ++i) {
    import_primitive(importer, mesh.primitives[i], primitives[i], fmt::format("meshes[{}].primitives[{}]", row, i));
  }
  range.count = uint32_t(importer.scene.primitives.size()) - range.first;
  return range;
}

}  // namespace nf::scene::gltf
