// glTF import on good input: geometry, materials, external files.
#include "scene/scene.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/gltf.h"
#include "scene_files.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::test::f32;
using nf::test::Folder;
using nf::test::Gltf;
using nf::test::json;
using nf::test::load;
using nf::test::u16;
using nf::test::u32;
using nf::test::u8;

#define EXPECT_NEAR_VEC(a, b) EXPECT_LT(glm::distance((a), (b)), 1e-5f) << (a).x << " " << (a).y << " " << (a).z

TEST(Gltf, FillsWhatTheFileLacks) {
  Gltf file = test::make_quad();
  const Scene scene = load(file);
  EXPECT_EQ(scene.triangles(), 2u);
  ASSERT_EQ(scene.geometry.position.size(), 6u);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(scene.geometry.position[scene.geometry.index[i]], test::quad_positions[test::quad_indices[i]]);
    EXPECT_NEAR_VEC(scene.geometry.normal[i], vec3(0, 0, 1));
    EXPECT_EQ(scene.geometry.tangent[i], vec4(0));
    EXPECT_EQ(scene.geometry.uv0[i], vec2(0));
    EXPECT_EQ(scene.geometry.uv1[i], vec2(0));
    EXPECT_EQ(scene.geometry.color[i], vec4(1));
  }
  ASSERT_EQ(scene.primitives.size(), 1u);
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.primitives[0].material, 0u);
  EXPECT_EQ(scene.materials[0].name, "default");
  EXPECT_EQ(scene.bounds.min, vec3(0));
  EXPECT_EQ(scene.bounds.max, vec3(1, 1, 0));
  EXPECT_TRUE(scene.cameras.empty());
}

TEST(Gltf, GlbAndGltfGiveTheSame) {
  Gltf file = test::make_quad();
  const Folder folder;
  const Scene a = load_gltf(folder.write("a.gltf", file.text())), b = load_gltf(folder.write("b.glb", file.glb()));
  EXPECT_EQ(a.geometry.position, b.geometry.position);
  EXPECT_EQ(a.geometry.index, b.geometry.index);
}

TEST(Gltf, ReadsEveryIndexWidth) {
  for (const int width : {u8, u16, u32}) {
    Gltf file;
    const int positions = file.positions(test::quad_positions);
    int indices = -1;
    const auto as = [&]<class T>(T) {
      const std::vector<T> narrow(test::quad_indices.begin(), test::quad_indices.end());
      indices = file.attribute(narrow, width, "SCALAR", 6);
    };
    if (width == u8) as(uint8_t());
    if (width == u16) as(uint16_t());
    if (width == u32) as(uint32_t());
    file.show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    test::add_normals(file);
    EXPECT_EQ(load(file).geometry.index, test::quad_indices) << width;
  }
}

TEST(Gltf, ReadsNonIndexed) {
  Gltf file;
  file.show({{"attributes", {{"POSITION", file.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}});
  EXPECT_EQ(load(file).geometry.index, (std::vector<uint32_t>{0, 1, 2}));
}

TEST(Gltf, ReadsInterleavedStreams) {
  Gltf file;
  std::vector<float> mixed;
  for (size_t i = 0; i < 4; ++i) {
    const vec3 p = test::quad_positions[i];
    const vec2 t = test::quad_uvs[i];
    mixed.insert(mixed.end(), {p.x, p.y, p.z, 0, 0, -2, t.x, t.y});
  }
  const int view = file.view(test::bytes_of(mixed), 32);
  const int position = file.accessor(view, f32, "VEC3", 4), normal = file.accessor(view, f32, "VEC3", 4, 12),
            uv = file.accessor(view, f32, "VEC2", 4, 24);
  file.show({{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
             {"indices", file.indices(test::quad_indices)}});
  const Scene scene = load(file);
  EXPECT_EQ(scene.geometry.position, test::quad_positions);
  EXPECT_EQ(scene.geometry.uv0, test::quad_uvs);
  EXPECT_EQ(scene.geometry.normal[3], vec3(0, 0, -1));
}

TEST(Gltf, ReadsSparseAccessors) {
  Gltf file = test::make_quad();
  const int rows = file.view(test::bytes_of(std::vector<uint16_t>{1, 3}));
  const int values = file.view(test::bytes_of(std::vector<vec3>{{5, 0, 0}, {0, 7, 0}}));
  file.doc["accessors"][0]["sparse"] = {
      {"count", 2}, {"indices", {{"bufferView", rows}, {"componentType", u16}}}, {"values", {{"bufferView", values}}}};
  test::add_normals(file);
  const Scene scene = load(file);
  EXPECT_EQ(scene.geometry.position, (std::vector<vec3>{{0, 0, 0}, {5, 0, 0}, {1, 1, 0}, {0, 7, 0}}));
}

TEST(Gltf, ConvertsStripsAndFans) {
  // Both orders make the same square facing +z.
  const std::vector<uint32_t> strip = {0, 1, 3, 2}, fan = {0, 1, 2, 3};
  for (const int mode : {5, 6}) {
    Gltf file;
    const int positions = file.positions(test::quad_positions);
    file.show({{"attributes", {{"POSITION", positions}}},
               {"indices", file.indices(mode == 5 ? strip : fan)},
               {"mode", mode}});
    const Scene scene = load(file);
    EXPECT_EQ(scene.triangles(), 2u);
    for (const vec3 normal : scene.geometry.normal) EXPECT_NEAR_VEC(normal, vec3(0, 0, 1));
  }
}

TEST(Gltf, SkipsPointsAndLines) {
  Gltf file = test::make_quad();
  json points = test::quad_primitive(file);
  points["mode"] = 0;
  file.doc["meshes"][0]["primitives"].push_back(points);
  const Scene scene = load(file);
  EXPECT_EQ(scene.primitives.size(), 1u);
  EXPECT_EQ(scene.instances.size(), 1u);
}

TEST(Gltf, ReadsNormalizedUvsAndColors) {
  Gltf file = test::make_quad();
  test::add_normals(file);
  json& attributes = test::quad_primitive(file)["attributes"];
  // A stride of 4 keeps the elements aligned, as glTF wants.
  const std::vector<uint8_t> uv8 = {0, 255, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0};
  attributes["TEXCOORD_0"] = file.accessor(file.view(uv8, 4), u8, "VEC2", 4);
  const std::vector<uint16_t> colors = {65535, 0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0, 0, 0, 0};
  attributes["COLOR_0"] = file.accessor(file.view(test::bytes_of(colors), 8), u16, "VEC3", 4);
  const Scene scene = load(file);
  EXPECT_EQ(scene.geometry.uv0, test::quad_uvs);
  EXPECT_EQ(scene.geometry.color[0], vec4(1, 0, 0, 1));
  EXPECT_EQ(scene.geometry.color[3], vec4(0, 0, 0, 1));

  Gltf other = test::make_quad();
  test::add_normals(other);
  json& more = test::quad_primitive(other)["attributes"];
  const std::vector<uint16_t> uv16 = {0, 65535, 65535, 65535, 65535, 0, 0, 0};
  more["TEXCOORD_0"] = other.attribute(uv16, u16, "VEC2", 4);
  more["COLOR_0"] =
      other.attribute(std::vector<uint8_t>{255, 0, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, u8, "VEC4", 4);
  const Scene second = load(other);
  EXPECT_EQ(second.geometry.uv0, test::quad_uvs);
  EXPECT_NEAR_VEC(second.geometry.color[0], vec4(1, 0, 0, 0.2f));
}

TEST(Gltf, PrimitivesMayShareAVertexBuffer) {
  Gltf file;
  const int positions = file.positions(test::quad_positions),
            normals = file.positions(std::vector<vec3>(4, vec3(0, 0, 1)));
  json primitives = json::array();
  for (const std::vector<uint32_t>& triangle : {std::vector<uint32_t>{0, 1, 2}, std::vector<uint32_t>{3, 0, 2}}) {
    primitives.push_back(
        {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", file.indices(triangle)}});
  }
  file.add_root({{"mesh", file.add("meshes", {{"primitives", primitives}})}});
  const Scene scene = load(file);
  ASSERT_EQ(scene.primitives.size(), 2u);
  EXPECT_EQ(scene.geometry.position.size(), 6u);  // only the vertices in use
  const Primitive& second = scene.primitives[1];
  EXPECT_EQ(second.vertex_offset, 3u);
  EXPECT_EQ(second.vertex_count, 3u);
  std::vector<vec3> corners;
  for (uint32_t i = 0; i < 3; ++i) {
    corners.push_back(scene.geometry.position[second.vertex_offset + scene.geometry.index[second.first_index + i]]);
  }
  EXPECT_EQ(corners, (std::vector<vec3>{{0, 1, 0}, {0, 0, 0}, {1, 1, 0}}));
}

TEST(Gltf, WithoutNormalsTrianglesAreFlat) {
  Gltf file;
  const int positions = file.positions({{0, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -10, 0}});
  file.show({{"attributes", {{"POSITION", positions}}}, {"indices", file.indices({0, 2, 1, 0, 1, 3})}});
  const Scene scene = load(file);
  ASSERT_EQ(scene.geometry.normal.size(), 6u);
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR_VEC(scene.geometry.normal[i], i < 3 ? vec3(0, 1, 0) : vec3(1, 0, 0));
}

TEST(Gltf, MissingSmoothNormalsAreAreaWeighted) {
  Gltf file;
  // A roof whose right side is ten times as large; its ridge has no normals.
  const int positions = file.positions({{0, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -10, 0}});
  const int normals = file.positions({{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}});
  file.show(
      {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", file.indices({0, 2, 1, 0, 1, 3})}});
  EXPECT_NEAR_VEC(load(file).geometry.normal[0], glm::normalize(vec3(10, 1, 0)));
}

// A quad with UVs and a normal-mapped material.
Gltf mapped_quad(const std::vector<vec2>& uvs) {
  Gltf file = test::make_quad();
  test::quad_primitive(file)["attributes"]["TEXCOORD_0"] = file.attribute(uvs, f32, "VEC2", 4);
  test::quad_primitive(file)["material"] = 0;
  file.add("images", {{"uri", test::data_uri(test::make_png(2, 2, {128, 128, 255, 255}), "image/png")}});
  file.add("textures", {{"source", 0}});
  file.add("materials", {{"normalTexture", {{"index", 0}, {"scale", 0.5}}}});
  return file;
}

TEST(Gltf, GeneratesTangents) {
  Gltf upright = mapped_quad(test::quad_uvs);
  for (const vec4 tangent : load(upright).geometry.tangent) EXPECT_NEAR_VEC(tangent, vec4(1, 0, 0, 1));

  Gltf mirrored = mapped_quad({{1, 1}, {0, 1}, {0, 0}, {1, 0}});
  for (const vec4 tangent : load(mirrored).geometry.tangent) EXPECT_NEAR_VEC(tangent, vec4(-1, 0, 0, -1));

  Gltf degenerate = mapped_quad({{0, 0}, {0, 0}, {0, 0}, {0, 0}});
  for (const vec4 tangent : load(degenerate).geometry.tangent) {
    EXPECT_NEAR(glm::length(vec3(tangent)), 1, 1e-5);
    EXPECT_NEAR(tangent.z, 0, 1e-5);
    EXPECT_EQ(std::abs(tangent.w), 1);
  }
}

TEST(Gltf, ReadsTangents) {
  Gltf file = mapped_quad(test::quad_uvs);
  json& attributes = test::quad_primitive(file)["attributes"];
  attributes["NORMAL"] = file.attribute(std::vector<vec3>(4, vec3(0, 0, 1)), f32, "VEC3", 4);
  attributes["TANGENT"] = file.attribute(std::vector<vec4>(4, vec4(0, 2, 0, -1)), f32, "VEC4", 4);
  for (const vec4 tangent : load(file).geometry.tangent) EXPECT_NEAR_VEC(tangent, vec4(0, 1, 0, -1));
}

TEST(Gltf, ReadsMaterials) {
  Gltf file = test::make_quad();
  test::quad_primitive(file)["material"] = 1;
  const std::string picture = test::data_uri(test::make_png(3, 2, {10, 20, 30, 40}), "image/png");
  file.add("images", {{"uri", picture}, {"name", "both"}});
  file.add("images",
           {{"bufferView", file.view(test::make_jpeg(8, 8, {200, 100, 50, 255}))}, {"mimeType", "image/jpeg"}});
  file.add("samplers", {{"magFilter", 9728}, {"minFilter", 9985}, {"wrapS", 33071}, {"wrapT", 33648}});
  file.add("textures", {{"source", 0}});
  file.add("textures", {{"source", 0}});
  file.add("textures", {{"source", 1}, {"sampler", 0}});
  file.add("materials", {{"name", "plain"}});
  file.add("materials", {{"name", "rich"},
                         {"pbrMetallicRoughness",
                          {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                           {"metallicFactor", 0.25},
                           {"roughnessFactor", 0.75},
                           {"baseColorTexture", {{"index", 0}}},
                           {"metallicRoughnessTexture", {{"index", 1}, {"texCoord", 1}}}}},
                         {"emissiveTexture", {{"index", 2}}},
                         {"emissiveFactor", {1, 0.5, 0}},
                         {"alphaMode", "MASK"},
                         {"alphaCutoff", 0.3},
                         {"doubleSided", true},
                         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
  file.doc["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_materials_clearcoat"};
  const Scene scene = load(file);

  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].metallic, 1);
  EXPECT_EQ(scene.materials[0].alpha, AlphaMode::Opaque);
  EXPECT_EQ(scene.materials[0].base_color_texture, none);
  const Material& rich = scene.materials[1];
  EXPECT_EQ(scene.primitives[0].material, 1u);
  EXPECT_NEAR_VEC(rich.base_color, vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_FLOAT_EQ(rich.metallic, 0.25f);
  EXPECT_FLOAT_EQ(rich.roughness, 0.75f);
  EXPECT_NEAR_VEC(rich.emissive, vec3(4, 2, 0));
  EXPECT_EQ(rich.alpha, AlphaMode::Mask);
  EXPECT_FLOAT_EQ(rich.alpha_cutoff, 0.3f);
  EXPECT_TRUE(rich.double_sided);

  // Two textures of one picture: sRGB and linear rows, same pixels.
  ASSERT_EQ(scene.pictures.size(), 3u);
  const Picture& base = scene.pictures[scene.textures[rich.base_color_texture].picture];
  const Picture& metal = scene.pictures[scene.textures[rich.metallic_roughness_texture].picture];
  EXPECT_TRUE(base.srgb);
  EXPECT_FALSE(metal.srgb);
  EXPECT_EQ(base.rgba, metal.rgba);
  EXPECT_EQ(base.width, 3u);
  EXPECT_EQ(base.height, 2u);
  EXPECT_EQ((std::vector<uint8_t>(base.rgba.begin(), base.rgba.begin() + 4)), (std::vector<uint8_t>{10, 20, 30, 40}));

  const Texture& emissive = scene.textures[rich.emissive_texture];
  EXPECT_TRUE(scene.pictures[emissive.picture].srgb);
  EXPECT_NEAR(scene.pictures[emissive.picture].rgba[0], 200, 3);
  EXPECT_EQ(scene.pictures[emissive.picture].rgba[3], 255);
  EXPECT_EQ(emissive.sampler,
            (Sampler{Filter::Nearest, Filter::Linear, Filter::Nearest, true, Wrap::Clamp, Wrap::Mirror}));
}

TEST(Gltf, SharesTexturesAndPictures) {
  Gltf file = test::make_quad();
  const int view = file.view(test::make_png(1, 1, {1, 2, 3, 4}));
  for (int i = 0; i < 2; ++i) {
    file.add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
    file.add("textures", {{"source", i}});
    file.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
  }
  const Scene scene = load(file);
  EXPECT_EQ(scene.pictures.size(), 1u);
  EXPECT_EQ(scene.textures.size(), 1u);
}

TEST(Gltf, ReadsExternalFiles) {
  Gltf file = mapped_quad(test::quad_uvs);
  file.doc["images"][0] = {{"uri", "sub/my%20c+lor%C3%A9.png"}};
  file.doc["buffers"] = json::array({{{"byteLength", file.bin.size()}, {"uri", "./data.bin"}}});
  test::Bytes longer = file.bin;
  longer.resize(longer.size() + 100);  // a file may be longer than its buffer
  const Folder folder;
  folder.write("data.bin", longer);
  folder.write("sub/my c+lor\u00e9.png", test::make_png(4, 4, {9, 9, 9, 255}));
  const Scene scene = load_gltf(folder.write("scene.gltf", file.text()));
  EXPECT_EQ(scene.triangles(), 2u);
  EXPECT_EQ(scene.pictures.at(0).width, 4u);
}

TEST(Gltf, IgnoresWhatItDoesNotRead) {
  Gltf file = test::make_quad();
  file.doc["extras"] = {{"deep", {{"er", {1, 2, 3}}}}};
  file.doc["extensionsUsed"] = {"EXT_unheard_of"};
  EXPECT_EQ(load(file).triangles(), 2u);
}

}  // namespace
