// Small glTF files of things that move or are compressed: an arm with two joints, a square with morph targets, a square
// whose buffers are packed. The tests of motion and those of damaged files share them.
#pragma once

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include "scene_files.h"

namespace nf::test {

inline constexpr float half_root = 0.70710678f;  // of a quarter turn's quaternion

template <class T>
int plain_accessor(Gltf& file, const std::vector<T>& values, int component, const char* type, size_t count) {
  const int row = file.attribute(values, component, type, count);
  file.doc["accessors"][size_t(row)].erase("normalized");
  return row;
}

// Adds an animation of one channel; `values` are the sampler's floats.
inline void add_clip(Gltf& file, int node, const char* path, const std::vector<float>& times,
                     const std::vector<float>& values, const char* type, size_t count,
                     const char* interpolation = "LINEAR") {
  const int input = file.attribute(times, f32, "SCALAR", times.size());
  const int output = file.attribute(values, f32, type, count);
  json samplers = json::array({{{"input", input}, {"output", output}, {"interpolation", interpolation}}});
  json channels = json::array({{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}});
  file.add("animations", {{"samplers", samplers}, {"channels", channels}});
}

// A strip in the xy plane from y = 0 to 2, two vertices at each of y = 0, 1, 2 (x = 0 and 1). Joint 0 ("shoulder", node
// 1) stands at the origin, joint 1 ("elbow", node 2) at y = 1 below it. The vertices at y = 0 follow the shoulder,
// those at y = 2 the elbow, those at y = 1 both by half. Node 0 shows the mesh and is moved, which must not matter. The
// elbow turns a quarter about z from 0 to 1 s.
inline Gltf arm_file() {
  Gltf file;
  const int positions = file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {1, 2, 0}});
  const int normals = file.positions(std::vector<glm::vec3>(6, {0, 0, 1}));
  const std::vector<uint8_t> joints = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 9, 0, 0, 1, 9, 0, 0};
  const std::vector<glm::vec4> weights = {{1, 0, 0, 0},       {1, 0, 0, 0}, {0.5f, 0.5f, 0, 0},
                                          {0.5f, 0.5f, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}};
  const int joint_row = plain_accessor(file, joints, u8, "VEC4", 6);
  const int weight_row = file.attribute(weights, f32, "VEC4", 6);
  const int indices = file.indices({0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4});
  const std::vector<glm::mat4> inverse_binds = {glm::mat4(1),
                                                {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 1}}};
  const int matrices = file.attribute(inverse_binds, f32, "MAT4", 2);
  file.show({{"attributes",
              {{"POSITION", positions}, {"NORMAL", normals}, {"JOINTS_0", joint_row}, {"WEIGHTS_0", weight_row}}},
             {"indices", indices}},
            {{"skin", 0}, {"translation", {5, 6, 7}}});
  file.add_root({{"name", "shoulder"}, {"children", {2}}});
  file.add("nodes", {{"name", "elbow"}, {"translation", {0, 1, 0}}});
  file.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", matrices}});
  add_clip(file, 2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, half_root, half_root}, "VEC4", 2);
  return file;
}

// The square with two morph targets: the first lifts two corners by 2 in y, through a sparse accessor; the second moves
// all by 1 in z and tilts the normals to +x. The mesh's weights are 0.5 and 0; a clip takes the second from 0 to 1 in 2
// s.
inline Gltf morph_file() {
  Gltf file = make_quad();
  add_normals(file);
  const int rows = file.view(bytes_of(std::vector<uint16_t>{2, 3}));
  const int values = file.view(bytes_of(std::vector<glm::vec3>{{0, 2, 0}, {0, 2, 0}}));
  const int sparse = file.accessor(-1, f32, "VEC3", 4);
  file.doc["accessors"][size_t(sparse)]["sparse"] = {
      {"count", 2}, {"indices", {{"bufferView", rows}, {"componentType", u16}}}, {"values", {{"bufferView", values}}}};
  const int lift = file.positions(std::vector<glm::vec3>(4, {0, 0, 1}));
  const int tilt = file.positions(std::vector<glm::vec3>(4, {1, 0, -1}));
  quad_primitive(file)["targets"] = json::array({{{"POSITION", sparse}}, {{"POSITION", lift}, {"NORMAL", tilt}}});
  file.doc["meshes"][0]["weights"] = {0.5, 0};
  add_clip(file, 0, "weights", {0, 2}, {0.5f, 0, 0.5f, 1}, "SCALAR", 4);
  return file;
}

// Makes the view of an accessor a compressed one (EXT_meshopt_compression) over a fallback buffer without data.
inline void pack_view(Gltf& file, int accessor_row, const Bytes& packed, size_t stride, size_t count, const char* mode,
                      const char* filter = "NONE") {
  const int plain = file.doc["accessors"][size_t(accessor_row)]["bufferView"];
  const int view = file.view(packed);
  json extension = file.doc["bufferViews"][size_t(view)];
  extension["byteStride"] = stride;
  extension["count"] = count;
  extension["mode"] = mode;
  extension["filter"] = filter;
  json& row = file.doc["bufferViews"][size_t(plain)];
  row = {{"buffer", 1}, {"byteOffset", 0}, {"byteLength", stride * count}};
  if (std::string(mode) == "ATTRIBUTES") row["byteStride"] = stride;
  row["extensions"]["EXT_meshopt_compression"] = extension;
  file.doc["bufferViews"].erase(size_t(view));
}

inline void add_fallback_buffer(Gltf& file, size_t size) {
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {"EXT_meshopt_compression"};
  file.doc["buffers"] =
      json::array({{{"byteLength", file.bin.size()}},
                   {{"byteLength", size}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}});
}

inline Bytes pack_vertices(const Bytes& plain, size_t stride) {
  const size_t count = plain.size() / stride;
  Bytes packed(meshopt_encodeVertexBufferBound(count, stride));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), plain.data(), count, stride));
  return packed;
}

// A grid of n x n squares in the xy plane from 0 to 1, with normals and UVs.
struct Grid {
  std::vector<glm::vec3> position, normal;
  std::vector<glm::vec2> uv;
  std::vector<uint32_t> index;
};
inline Grid make_grid(uint32_t n) {
  Grid grid;
  for (uint32_t y = 0; y <= n; ++y) {
    for (uint32_t x = 0; x <= n; ++x) {
      const glm::vec2 at = glm::vec2(x, y) / float(n);
      grid.position.emplace_back(at, 0.25f * at.x * at.y);
      grid.normal.emplace_back(0, 0, 1);
      grid.uv.push_back(at);
    }
  }
  for (uint32_t y = 0; y < n; ++y) {
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t a = y * (n + 1) + x, b = a + n + 1;
      grid.index.insert(grid.index.end(), {a, a + 1, b + 1, a, b + 1, b});
    }
  }
  return grid;
}

inline Gltf grid_file(const Grid& grid) {
  Gltf file;
  const int positions = file.positions(grid.position), normals = file.positions(grid.normal);
  const int uvs = file.attribute(grid.uv, f32, "VEC2", grid.uv.size());
  const int indices = file.indices(grid.index);
  file.show(
      {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}}, {"indices", indices}});
  return file;
}

// The grid with every view compressed. `sequence` packs the indices as a sequence instead of as triangles.
inline Gltf meshopt_file(const Grid& grid, bool sequence = false) {
  Gltf file = grid_file(grid);
  file.bin.clear();
  const size_t vertices = grid.position.size(), count = grid.index.size();
  pack_view(file, 0, pack_vertices(bytes_of(grid.position), 12), 12, vertices, "ATTRIBUTES");
  pack_view(file, 1, pack_vertices(bytes_of(grid.normal), 12), 12, vertices, "ATTRIBUTES");
  pack_view(file, 2, pack_vertices(bytes_of(grid.uv), 8), 8, vertices, "ATTRIBUTES");
  Bytes packed;
  if (sequence) {
    packed.resize(meshopt_encodeIndexSequenceBound(count, vertices));
    packed.resize(meshopt_encodeIndexSequence(packed.data(), packed.size(), grid.index.data(), count));
  } else {
    packed.resize(meshopt_encodeIndexBufferBound(count, vertices));
    packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), grid.index.data(), count));
  }
  pack_view(file, 3, packed, 4, count, sequence ? "INDICES" : "TRIANGLES");
  add_fallback_buffer(file, vertices * 32 + count * 4);
  return file;
}

// The grid through Draco; `method` is draco::MESH_EDGEBREAKER_ENCODING or draco::MESH_SEQUENTIAL_ENCODING.
inline Gltf draco_file(const Grid& grid, int method) {
  draco::TriangleSoupMeshBuilder builder;
  const int faces = int(grid.index.size() / 3);
  builder.Start(faces);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (int face = 0; face < faces; ++face) {
    const uint32_t* i = &grid.index[size_t(face) * 3];
    const draco::FaceIndex row{uint32_t(face)};
    builder.SetAttributeValuesForFace(position, row, &grid.position[i[0]], &grid.position[i[1]], &grid.position[i[2]]);
    builder.SetAttributeValuesForFace(normal, row, &grid.normal[i[0]], &grid.normal[i[1]], &grid.normal[i[2]]);
    builder.SetAttributeValuesForFace(uv, row, &grid.uv[i[0]], &grid.uv[i[1]], &grid.uv[i[2]]);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  const Bytes packed(buffer.data(), buffer.data() + buffer.size());

  Gltf file;
  json attributes, ids;
  const std::pair<const char*, int> names[] = {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}};
  for (const auto& [name, id] : names) {
    const char* type = id == uv ? "VEC2" : "VEC3";
    attributes[name] = file.add("accessors", {{"componentType", f32}, {"type", type}, {"count", mesh->num_points()}});
    ids[name] = mesh->attribute(id)->unique_id();
  }
  const int indices = file.add("accessors", {{"componentType", u32}, {"type", "SCALAR"}, {"count", grid.index.size()}});
  const int view = file.view(packed);
  file.show({{"attributes", attributes},
             {"indices", indices},
             {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", ids}}}}}});
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return file;
}

}  // namespace nf::test
