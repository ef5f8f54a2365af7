// glTF import of the materials' extensions: texture transforms, UV sets, specular, variants, and what is refused.
#include <gtest/gtest.h>

#include "scene/gltf.h"
#include "scene/scene.h"
#include "scene_files.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::test::f32;
using nf::test::Folder;
using nf::test::Gltf;
using nf::test::json;
using nf::test::load;

#define EXPECT_NEAR_VEC(a, b) EXPECT_LT(glm::distance((a), (b)), 1e-5f) << (a).x << " " << (a).y

// A quad with one texture and one material, which `material` describes.
Gltf textured_quad(json material) {
  Gltf file = test::make_quad();
  test::quad_primitive(file)["material"] = 0;
  file.add("images", {{"uri", test::data_uri(test::make_png(2, 2, {9, 9, 9, 255}), "image/png")}});
  file.add("textures", {{"source", 0}});
  file.add("materials", std::move(material));
  return file;
}

json transformed(json transform) {
  return {{"index", 0}, {"extensions", {{"KHR_texture_transform", std::move(transform)}}}};
}

vec2 map(const UvMapping& mapping, vec2 uv) {
  return mapping.linear * uv + mapping.offset;
}

TEST(Surface, TextureTransforms) {
  // The extension's own example: "only the lower left quadrant of the source image, rotated clockwise 90 degrees".
  json quadrant = {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}};
  Gltf file = textured_quad({{"pbrMetallicRoughness", {{"baseColorTexture", transformed(quadrant)}}},
                             {"emissiveTexture", transformed({{"offset", {0.25, 0}}, {"scale", {2, -3}}})},
                             {"occlusionTexture", {{"index", 0}, {"texCoord", 1}, {"strength", 0.25}}},
                             {"normalTexture", transformed({{"texCoord", 1}})}});
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {"KHR_texture_transform"};
  const Scene scene = load(file);
  const Material& m = scene.materials[0];
  const UvMapping& base = m.mapping_of(Slot::BaseColor);
  EXPECT_NEAR_VEC(map(base, {0, 0}), vec2(0, 1));
  EXPECT_NEAR_VEC(map(base, {1, 0}), vec2(0, 0.5f));
  EXPECT_NEAR_VEC(map(base, {0, 1}), vec2(0.5f, 1));
  EXPECT_NEAR_VEC(map(base, {1, 1}), vec2(0.5f, 0.5f));
  EXPECT_NEAR_VEC(map(m.mapping_of(Slot::Emissive), {0.5f, 1}), vec2(1.25f, -3));
  EXPECT_EQ(m.mapping_of(Slot::Occlusion).set, 1u);
  EXPECT_EQ(m.mapping_of(Slot::Normal).set, 1u);
  EXPECT_EQ(m.mapping_of(Slot::MetallicRoughness), UvMapping());
  EXPECT_FLOAT_EQ(m.occlusion_strength, 0.25f);
  EXPECT_NE(m.occlusion_texture, none);
  EXPECT_FALSE(scene.pictures[scene.textures[m.occlusion_texture].picture].srgb);
}

TEST(Surface, GeneratedTangentsFollowTheNormalMapsUvs) {
  // Set 1 is turned by a quarter: its u runs along -y.
  Gltf file = textured_quad({{"normalTexture", {{"index", 0}, {"texCoord", 1}}}});
  json& attributes = test::quad_primitive(file)["attributes"];
  attributes["TEXCOORD_0"] = file.attribute(test::quad_uvs, f32, "VEC2", 4);
  attributes["TEXCOORD_1"] = file.attribute(std::vector<vec2>{{1, 1}, {1, 0}, {0, 0}, {0, 1}}, f32, "VEC2", 4);
  const Scene plain = load(file);
  EXPECT_EQ(plain.geometry.uv1[0], vec2(1, 1));
  for (const vec4 tangent : plain.geometry.tangent) EXPECT_NEAR_VEC(tangent, vec4(0, -1, 0, 1));
  // A half turn of the lookup turns the tangents with it.
  file.doc["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"]["rotation"] = 3.14159265;
  for (const vec4 tangent : load(file).geometry.tangent) EXPECT_NEAR_VEC(tangent, vec4(0, 1, 0, 1));
}

TEST(Surface, Extensions) {
  Gltf file = textured_quad({{"extensions",
                              {{"KHR_materials_unlit", json::object()},
                               {"KHR_materials_ior", {{"ior", 1.33}}},
                               {"KHR_materials_specular",
                                {{"specularFactor", 0.5},
                                 {"specularColorFactor", {1, 0.5, 2}},
                                 {"specularTexture", {{"index", 0}}},
                                 {"specularColorTexture", {{"index", 0}}}}},
                               {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}}}}});
  file.add("materials", json::object());
  file.doc["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_materials_unlit"};
  const Scene scene = load(file);
  const Material& m = scene.materials[0];
  EXPECT_TRUE(m.unlit);
  EXPECT_FLOAT_EQ(m.ior, 1.33f);
  EXPECT_FLOAT_EQ(m.specular, 0.5f);
  EXPECT_EQ(m.specular_color, vec3(1, 0.5f, 2));
  EXPECT_FALSE(scene.pictures[scene.textures[m.specular_texture].picture].srgb);
  EXPECT_TRUE(scene.pictures[scene.textures[m.specular_color_texture].picture].srgb);
  const Material& plain = scene.materials[1];
  EXPECT_FALSE(plain.unlit);
  EXPECT_EQ(plain.ior, 1.5f);
  EXPECT_EQ(plain.specular, 1);
  EXPECT_EQ(plain.specular_texture, none);
}

TEST(Surface, Variants) {
  Gltf file = textured_quad({{"name", "plain"}});
  file.add("materials", {{"name", "night"}, {"normalTexture", {{"index", 0}}}});
  file.add("materials", {{"name", "day"}});
  file.doc["extensionsUsed"] = {"KHR_materials_variants"};
  file.doc["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "Night"}}, {{"name", "Day"}}, {{"name", "?"}}};
  json mappings = json::array({{{"material", 1}, {"variants", {0}}}, {{"material", 2}, {"variants", {1, 2}}}});
  test::quad_primitive(file)["extensions"]["KHR_materials_variants"]["mappings"] = mappings;
  Scene scene = load(file);
  EXPECT_EQ(scene.variants, (std::vector<std::string>{"Night", "Day", "?"}));
  const auto name = [&] { return scene.materials[scene.primitives[0].material].name; };
  EXPECT_EQ(name(), "plain");
  // One of its materials has a normal map, so the primitive has tangents.
  EXPECT_EQ(glm::length(vec3(scene.geometry.tangent[0])), 1);
  select_variant(scene, 0);
  EXPECT_EQ(name(), "night");
  select_variant(scene, 2);
  EXPECT_EQ(name(), "day");
  select_variant(scene, none);
  EXPECT_EQ(name(), "plain");
}

TEST(Surface, RequiredExtensionsAreRefusedByName) {
  const Folder folder;
  for (const char* name : {"KHR_materials_clearcoat", "KHR_texture_basisu", "EXT_mesh_gpu_instancing", "ACME_secret"}) {
    Gltf file = test::make_quad();
    file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {name};
    const std::string error = test::load_error(folder.write("a.gltf", file.text()));
    EXPECT_NE(error.find(std::string("requires the extension ") + name), std::string::npos) << error;
  }
}

}  // namespace
