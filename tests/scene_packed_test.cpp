// glTF import of what comes packed: quantized, compressed by meshoptimizer, compressed by Draco. The encoders are the
// libraries' own; what they were given is the truth.
#include <glm/gtc/packing.hpp>

#include "moving_files.h"
#include "scene/scene.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::test::f32;
using nf::test::Folder;
using nf::test::Gltf;
using nf::test::Grid;
using nf::test::json;
using nf::test::load_binary;

constexpr int i8 = 5120, i16 = 5122;

void expect_grid(const Scene& scene, const Grid& grid, float tolerance) {
  ASSERT_EQ(scene.geometry.index.size(), grid.index.size());
  ASSERT_EQ(scene.geometry.position.size(), grid.position.size());
  // Both coders may turn a triangle's corners and reorder triangles and vertices: every corner must be somewhere near,
  // with its normal and UV, and the surface must have its area.
  double area = 0, expected = 0;
  for (size_t i = 0; i < grid.index.size(); i += 3) {
    const auto size_of = [&](const std::vector<vec3>& p, const std::vector<uint32_t>& index) {
      return double(glm::length(glm::cross(p[index[i + 1]] - p[index[i]], p[index[i + 2]] - p[index[i]])));
    };
    area += size_of(scene.geometry.position, scene.geometry.index);
    expected += size_of(grid.position, grid.index);
  }
  EXPECT_NEAR(area, expected, 1e-6 + double(tolerance) * 20);
  for (size_t i = 0; i < grid.position.size(); ++i) {
    float nearest = 1;
    for (size_t k = 0; k < scene.geometry.position.size(); ++k) {
      nearest = std::min(nearest, glm::distance(scene.geometry.position[k], grid.position[i]) +
                                      glm::distance(scene.geometry.uv0[k], grid.uv[i]) +
                                      glm::distance(scene.geometry.normal[k], grid.normal[i]));
    }
    EXPECT_LE(nearest, tolerance) << i;
  }
}

TEST(Packed, MeshoptBuffersAndFallback) {
  const Grid grid = test::make_grid(9);
  for (const bool sequence : {false, true}) {
    Gltf file = test::meshopt_file(grid, sequence);
    const Scene scene = load_binary(file);
    expect_grid(scene, grid, 0);
    EXPECT_EQ(scene.geometry.position, grid.position);
    if (sequence) {
      EXPECT_EQ(scene.geometry.index, grid.index);
    }
  }
}

TEST(Packed, MeshoptFilters) {
  // Octahedral normals in 8 bits, and positions with a shared exponent.
  const Grid grid = test::make_grid(5);
  const size_t count = grid.position.size();
  std::vector<vec4> normals;
  for (size_t i = 0; i < count; ++i) {
    normals.emplace_back(glm::normalize(vec3(std::sin(float(i)), std::cos(float(i)), 1)), 0);
  }
  test::Bytes oct(count * 4), exponential(count * 12);
  meshopt_encodeFilterOct(oct.data(), count, 4, 8, &normals[0].x);
  meshopt_encodeFilterExp(exponential.data(), count, 12, 15, &grid.position[0].x);

  Gltf file = test::meshopt_file(grid);
  const auto packed_normals = test::pack_vertices(oct, 4), packed_positions = test::pack_vertices(exponential, 12);
  test::pack_view(file, 0, packed_positions, 12, count, "ATTRIBUTES", "EXPONENTIAL");
  test::pack_view(file, 1, packed_normals, 4, count, "ATTRIBUTES", "OCTAHEDRAL");
  file.doc["accessors"][1]["componentType"] = i8;
  file.doc["accessors"][1]["normalized"] = true;
  test::add_fallback_buffer(file, 100000);
  file.doc["extensionsUsed"].push_back("KHR_mesh_quantization");
  const Scene scene = load_binary(file);
  ASSERT_EQ(scene.geometry.normal.size(), count);
  for (size_t i = 0; i < count; ++i) {
    EXPECT_GT(glm::dot(scene.geometry.normal[i], vec3(normals[i])), 0.999f);
    EXPECT_LT(glm::distance(scene.geometry.position[i], grid.position[i]), 2e-4f);
  }
}

TEST(Packed, DracoMeshes) {
  const Grid grid = test::make_grid(9);
  for (const int method : {int(draco::MESH_SEQUENTIAL_ENCODING), int(draco::MESH_EDGEBREAKER_ENCODING)}) {
    Gltf file = test::draco_file(grid, method);
    expect_grid(load_binary(file), grid, 0.004f);
  }
}

TEST(Packed, DamagedDataIsRefused) {
  const Grid grid = test::make_grid(4);
  const Folder folder;
  const auto error = [&](Gltf file, const std::function<void(Gltf&)>& damage) {
    damage(file);
    return test::load_error(folder.write("bad.glb", file.glb()));
  };
  const auto expect = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << "got: " << text;
  };
  const auto extension = [](Gltf& f) -> json& {
    return f.doc["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  };
  expect(error(test::meshopt_file(grid), [](Gltf& f) { f.bin[0] = 0; }), "cannot be decoded");
  expect(error(test::meshopt_file(grid), [&](Gltf& f) { extension(f)["byteStride"] = 10; }), "no multiple of 4");
  expect(error(test::meshopt_file(grid), [&](Gltf& f) { extension(f)["filter"] = "QUATERNION"; }), "filter");
  expect(error(test::meshopt_file(grid), [&](Gltf& f) { extension(f)["count"] = 4000000000u; }), "far more than");
  expect(error(test::meshopt_file(grid), [&](Gltf& f) { extension(f)["mode"] = "POINTS"; }), "mode is 'POINTS'");
  expect(error(test::meshopt_file(grid), [&](Gltf& f) { extension(f)["byteLength"] = 1000000; }), "ends at byte");
  expect(error(test::meshopt_file(grid), [&](Gltf& f) { f.doc["bufferViews"][0].erase("extensions"); }), "buffer");
  const auto draco = [&] { return test::draco_file(grid, draco::MESH_EDGEBREAKER_ENCODING); };
  expect(error(draco(), [](Gltf& f) { f.bin[0] = 'X'; }), "not Draco data");
  expect(error(draco(), [](Gltf& f) { f.bin[6] = 1; }), "Draco version 2.1");
  expect(error(draco(), [](Gltf& f) { f.doc["accessors"][3]["count"] = 3; }), "its accessor says 3 indices");
  expect(error(draco(), [](Gltf& f) { f.doc["accessors"][0]["count"] = 3; }), "its accessors only 3");
  expect(error(draco(),
               [](Gltf& f) {
                 test::quad_primitive(f)["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 77;
               }),
         "no attribute 77");
}

TEST(Packed, QuantizedAttributes) {
  Gltf file;
  const auto attribute = [&](const auto& values, int type, const char* shape, int stride, bool normalized) {
    const int row = file.accessor(file.view(test::bytes_of(values), stride), type, shape, 4);
    file.doc["accessors"][size_t(row)]["normalized"] = normalized;
    return row;
  };
  // Positions as plain integers, which the node scales; normals, UVs and colours as fractions.
  const std::vector<int16_t> positions = {0, 0, -7, 0, 100, 0, -7, 0, 100, 100, -7, 0, 0, 100, -7, 0};
  const std::vector<int8_t> normals = {0, 0, 127, 0, 0, 0, -128, 0, 127, 0, 0, 0, 0, 127, 0, 0};
  const std::vector<uint16_t> uvs = {0, 4, 4, 4, 4, 0, 0, 0};
  const int position = attribute(positions, i16, "VEC3", 8, false), normal = attribute(normals, i8, "VEC3", 4, true);
  const int uv = attribute(uvs, test::u16, "VEC2", 4, false);
  file.show({{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
             {"indices", file.indices(test::quad_indices)}},
            {{"scale", {0.01, 0.01, 0.01}}});
  const Folder folder;
  EXPECT_NE(test::load_error(folder.write("a.glb", file.glb())).find("component type i16"), std::string::npos);
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
  const Scene scene = load_binary(file);
  EXPECT_EQ(scene.geometry.position[2], vec3(100, 100, -7));
  EXPECT_EQ(scene.geometry.normal[0], vec3(0, 0, 1));
  EXPECT_EQ(scene.geometry.normal[1], vec3(0, 0, -1));
  EXPECT_EQ(scene.geometry.uv0[1], vec2(4, 4));
  EXPECT_LT(glm::distance(scene.bounds.max, vec3(1, 1, -0.07f)), 1e-6f);
}

}  // namespace
