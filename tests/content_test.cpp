// The generated GLB files are valid, their faces look the right way, and the same calls give the same bytes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <unistd.h>

#include "builder.h"
#include "core/error.h"
#include "image/file.h"
#include "scenes.h"
#include "textures.h"

namespace nf::content {
namespace {

using Json = nlohmann::json;

struct Glb {
  Json json;
  std::vector<uint8_t> binary;
};

uint32_t word(const std::vector<uint8_t>& bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

// Fails the test and returns an empty Glb where the container is broken.
Glb parse(const std::vector<uint8_t>& bytes) {
  Glb glb;
  EXPECT_GE(bytes.size(), 20u);
  EXPECT_EQ(bytes.size() % 4, 0u);
  EXPECT_EQ(word(bytes, 0), 0x46546c67u);  // "glTF"
  EXPECT_EQ(word(bytes, 4), 2u);
  EXPECT_EQ(word(bytes, 8), bytes.size());
  std::vector<uint32_t> types;
  for (size_t at = 12; at < bytes.size();) {
    const uint32_t size = word(bytes, at);
    types.push_back(word(bytes, at + 4));
    EXPECT_EQ(size % 4, 0u);
    if (at + 8 + size > bytes.size()) {
      ADD_FAILURE() << "a chunk that ends behind the file";
      return {};
    }
    const auto begin = bytes.begin() + std::ptrdiff_t(at) + 8, end = begin + std::ptrdiff_t(size);
    if (types.size() == 1) glb.json = Json::parse(begin, end, nullptr, false);
    if (types.size() == 2) glb.binary.assign(begin, end);
    at += 8 + size;
  }
  EXPECT_EQ(types.at(0), 0x4e4f534au);                                // "JSON"
  EXPECT_EQ(types.size() > 1 ? types[1] : 0x004e4942u, 0x004e4942u);  // "BIN"
  EXPECT_LE(types.size(), 2u);
  EXPECT_FALSE(glb.json.is_discarded());
  return glb;
}

template <class T>
std::vector<T> values(const Glb& glb, size_t accessor) {
  const Json& row = glb.json.at("accessors").at(accessor);
  const Json& view = glb.json.at("bufferViews").at(row.at("bufferView").get<size_t>());
  std::vector<T> result(row.at("count").get<size_t>());
  const size_t offset = view.at("byteOffset"), size = view.at("byteLength");
  EXPECT_EQ(offset % 4, 0u);
  EXPECT_EQ(size, result.size() * sizeof(T));
  if (offset + size > glb.binary.size()) {
    ADD_FAILURE() << "a buffer view that ends behind the buffer";
    return {};
  }
  std::memcpy(result.data(), glb.binary.data() + offset, size);
  return result;
}

struct Face {
  std::string object;
  vec3 center, normal;
};

// Checks every primitive of a file and returns its triangles in the space of their nodes.
std::vector<Face> check_geometry(const Glb& glb) {
  std::vector<Face> faces;
  for (const Json& mesh : glb.json.at("meshes")) {
    for (const Json& primitive : mesh.at("primitives")) {
      const Json& attributes = primitive.at("attributes");
      const auto position = values<vec3>(glb, attributes.at("POSITION"));
      const auto normal = values<vec3>(glb, attributes.at("NORMAL"));
      const auto uv = values<vec2>(glb, attributes.at("TEXCOORD_0"));
      const auto index = values<uint32_t>(glb, primitive.at("indices"));
      EXPECT_EQ(normal.size(), position.size());
      EXPECT_EQ(uv.size(), position.size());
      EXPECT_EQ(index.size() % 3, 0u);
      const Json& material = glb.json.at("materials").at(primitive.at("material").get<size_t>());
      EXPECT_EQ(material.contains("normalTexture"), attributes.contains("TANGENT"));
      if (attributes.contains("TANGENT")) {
        const auto tangent = values<vec4>(glb, attributes.at("TANGENT"));
        EXPECT_EQ(tangent.size(), position.size());
        for (size_t i = 0; i < tangent.size(); ++i) {
          EXPECT_NEAR(glm::length(vec3(tangent[i])), 1, 1e-5f);
          EXPECT_NEAR(glm::dot(vec3(tangent[i]), normal[i]), 0, 1e-5f);
          EXPECT_EQ(tangent[i].w, 1);
        }
      }

      vec3 low = position[0], high = low;
      for (const vec3& p : position) low = glm::min(low, p), high = glm::max(high, p);
      const Json& accessor = glb.json.at("accessors").at(attributes.at("POSITION").get<size_t>());
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(accessor.at("min").at(size_t(c)).get<float>(), low[c]);
        EXPECT_EQ(accessor.at("max").at(size_t(c)).get<float>(), high[c]);
      }
      for (const vec3& n : normal) EXPECT_NEAR(glm::length(n), 1, 1e-5f);
      for (size_t i = 0; i + 2 < index.size(); i += 3) {
        const uint32_t a = index[i], b = index[i + 1], c = index[i + 2];
        if (std::max({a, b, c}) >= position.size()) {
          ADD_FAILURE() << "an index out of range";
          return faces;
        }
        const vec3 cross = glm::cross(position[b] - position[a], position[c] - position[a]);
        EXPECT_GT(glm::length(cross), 0);
        for (uint32_t corner : {a, b, c}) EXPECT_GT(glm::dot(glm::normalize(cross), normal[corner]), 0.999f);
        faces.push_back({mesh.at("name"), (position[a] + position[b] + position[c]) / 3.0f, normal[a]});
      }
    }
  }
  return faces;
}

std::set<std::string> camera_names(const Glb& glb) {
  std::set<std::string> names;
  for (const Json& camera : glb.json.at("cameras")) names.insert(camera.at("name").get<std::string>());
  return names;
}

const Json& node_named(const Glb& glb, const std::string& name) {
  for (const Json& node : glb.json.at("nodes"))
    if (node.at("name") == name) return node;
  throw std::runtime_error("no node " + name);
}

quat rotation_of(const Json& node) {
  if (!node.contains("rotation")) return {1, 0, 0, 0};
  const auto q = node.at("rotation").get<std::array<float, 4>>();
  return {q[3], q[0], q[1], q[2]};
}

void expect_outwards(const std::vector<Face>& faces, vec3 center, float sign = 1) {
  for (const Face& face : faces) EXPECT_GT(sign * glm::dot(face.normal, face.center - center), 0);
}

void expect_near(vec3 a, vec3 b, float tolerance = 1e-5f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "component " << c;
}

TEST(Content, same_bytes_twice) {
  EXPECT_EQ(cornell(), cornell());
  EXPECT_EQ(fence(), fence());
  EXPECT_EQ(furnace(), furnace());
  EXPECT_EQ(atrium(), atrium());
}

TEST(Content, the_build_wrote_the_scenes) {
  const std::filesystem::path folder = std::filesystem::path(NF_BINARY_DIR) / "content";
  if (!std::filesystem::exists(folder / "furnace.glb")) GTEST_SKIP() << "nearfield_scenes was not built";
  EXPECT_EQ(image::read_file(folder / "cornell.glb"), cornell());
  EXPECT_EQ(image::read_file(folder / "fence.glb"), fence());
  EXPECT_EQ(image::read_file(folder / "furnace.glb"), furnace());
  EXPECT_EQ(image::read_file(folder / "atrium.glb"), atrium());
}

TEST(Content, cornell_box) {
  const Glb glb = parse(cornell());
  const std::vector<Face> faces = check_geometry(glb);
  EXPECT_EQ(faces.size(), 6 * 2 + 2 * 12u);
  EXPECT_EQ(camera_names(glb), (std::set<std::string>{"front", "corner"}));
  for (const Face& face : faces) {
    EXPECT_LE(std::abs(face.center.x), 1);
    EXPECT_LE(std::abs(face.center.z), 1);
    if (face.object == "tall") expect_outwards({face}, {-0.326f, 0.595f, -0.265f});
    if (face.object == "short") expect_outwards({face}, {0.333f, 0.297f, 0.391f});
    if (face.object == "lamp") expect_near(face.normal, {0, -1, 0});
    if (face.object == "floor" || face.object == "ceiling" || face.object == "back" || face.object == "left" ||
        face.object == "right")
      expect_outwards({face}, {0, 1, 0}, -1);
  }
  const Json& lamp = glb.json.at("materials").at(3);
  EXPECT_EQ(lamp.at("emissiveFactor"), Json::parse("[1,1,1]"));
  EXPECT_EQ(lamp.at("extensions").at("KHR_materials_emissive_strength").at("emissiveStrength"), 15);
  EXPECT_EQ(glb.json.at("extensionsUsed"), Json::parse(R"(["KHR_materials_emissive_strength"])"));
  for (const Json& material : glb.json.at("materials")) {
    EXPECT_EQ(material.at("pbrMetallicRoughness").at("metallicFactor"), 0);
    EXPECT_EQ(material.at("pbrMetallicRoughness").at("roughnessFactor"), 1);
  }
  EXPECT_EQ(glb.json.at("materials").at(1).at("pbrMetallicRoughness").at("baseColorFactor"),
            Json::parse("[0.65,0.05,0.05,1]"));
  const Json& front = node_named(glb, "front");
  EXPECT_EQ(front.at("translation"), Json::parse("[0,1,3.3]"));
  EXPECT_NEAR(glb.json.at("cameras").at(0).at("perspective").at("yfov").get<float>(), glm::radians(48.0f), 1e-6f);
}

TEST(Content, fence_before_a_wall) {
  const Glb glb = parse(fence());
  size_t bar_faces = 0;
  for (const Face& face : check_geometry(glb)) {
    bar_faces += face.object == "bars";
    if (face.object == "wall") expect_near(face.normal, {0, 0, 1});
    if (face.object == "ground") expect_near(face.normal, {0, 1, 0});
  }
  EXPECT_EQ(bar_faces, 24u * (8 * 2 + 2 * 6));
  EXPECT_EQ(camera_names(glb), (std::set<std::string>{"front", "side"}));

  const Json& light = glb.json.at("extensions").at("KHR_lights_punctual").at("lights").at(0);
  EXPECT_EQ(light.at("type"), "directional");
  EXPECT_EQ(light.at("intensity"), 3);
  const Json& node = node_named(glb, "directional0");
  EXPECT_EQ(node.at("extensions").at("KHR_lights_punctual").at("light"), 0);
  expect_near(rotation_of(node) * vec3(0, 0, -1), glm::normalize(vec3(0.45f, -0.8f, -0.65f)));

  size_t masked = 0, normal_mapped = 0;
  for (const Json& material : glb.json.at("materials")) {
    masked += material.value("alphaMode", "OPAQUE") == "MASK";
    normal_mapped += material.contains("normalTexture");
  }
  EXPECT_EQ(masked, 1u);
  EXPECT_EQ(normal_mapped, 1u);
  const uint8_t png_signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  ASSERT_EQ(glb.json.at("images").size(), 3u);
  for (const Json& picture : glb.json.at("images")) {
    const Json& view = glb.json.at("bufferViews").at(picture.at("bufferView").get<size_t>());
    EXPECT_EQ(std::memcmp(glb.binary.data() + view.at("byteOffset").get<size_t>(), png_signature, 8), 0);
  }
}

TEST(Content, furnace_faces_inwards) {
  const Glb glb = parse(furnace());
  const std::vector<Face> faces = check_geometry(glb);
  EXPECT_EQ(faces.size(), 12u);
  expect_outwards(faces, {0, 1, 0}, -1);
  const Json& material = glb.json.at("materials").at(0);
  EXPECT_EQ(material.at("emissiveFactor"), Json::parse("[1,1,1]"));
  EXPECT_EQ(material.at("pbrMetallicRoughness").at("baseColorFactor"), Json::parse("[0.8,0.8,0.8,1]"));
  EXPECT_EQ(camera_names(glb), (std::set<std::string>{"centre", "corner"}));
}

TEST(Builder, shapes_face_outwards) {
  const std::vector<std::function<void(Builder&, MaterialId)>> shapes{
      [](Builder& b, MaterialId m) {
        b.box({1, 2, 3}, {0.5f, 1, 2}, 0.7f, m);
      },
      [](Builder& b, MaterialId m) {
        b.cylinder({1, 1, 3}, {1, 3, 3}, 0.2f, 9, m);
      },
      [](Builder& b, MaterialId m) {
        b.cylinder({0, 2, 3}, {2, 2, 3}, 0.2f, 8, m);
      },
      [](Builder& b, MaterialId m) {
        b.cylinder({2, 3, 2}, {0, 1, 4}, 0.2f, 3, m);
      },
  };
  for (const auto& shape : shapes) {
    Builder b;
    shape(b, b.material({}));
    expect_outwards(check_geometry(parse(b.glb())), {1, 2, 3});
  }
}

TEST(Builder, grid_covers_the_quad) {
  Builder b;
  b.grid({-1, 0, 2}, {1, 0, 2}, {1, 0, -2}, {-1, 0, -2}, 3, 5, b.material({}), {2, 4});
  const Glb glb = parse(b.glb());
  EXPECT_EQ(check_geometry(glb).size(), 30u);
  const auto position = values<vec3>(glb, 0);
  const auto uv = values<vec2>(glb, 2);
  ASSERT_EQ(position.size(), uv.size());
  for (size_t i = 0; i < position.size(); ++i) {
    EXPECT_NEAR(uv[i].x, position[i].x + 1, 1e-5f);
    EXPECT_NEAR(uv[i].y, position[i].z + 2, 1e-5f);  // v grows downwards, from p3's row to p0's
  }
}

TEST(Builder, cameras_and_lights_look_where_they_are_told) {
  Builder b;
  b.camera("level", {1, 2, 3}, {4, 2, 3}, 40);
  b.camera("down", {0, 5, 0}, {0, 0, 0}, 40);
  b.directional_light({0, -1, 0}, 2);
  b.point_light({1, 1, 1}, 10, {1, 0.5f, 0});
  b.spot_light({0, 2, 0}, {0, -1, 1}, 5, 20, 30);
  const Glb glb = parse(b.glb());
  expect_near(rotation_of(node_named(glb, "level")) * vec3(0, 0, -1), {1, 0, 0});
  expect_near(rotation_of(node_named(glb, "level")) * vec3(0, 1, 0), {0, 1, 0});
  expect_near(rotation_of(node_named(glb, "down")) * vec3(0, 0, -1), {0, -1, 0});
  expect_near(rotation_of(node_named(glb, "directional0")) * vec3(0, 0, -1), {0, -1, 0});
  expect_near(rotation_of(node_named(glb, "spot2")) * vec3(0, 0, -1), glm::normalize(vec3(0, -1, 1)));
  const Json& lights = glb.json.at("extensions").at("KHR_lights_punctual").at("lights");
  EXPECT_EQ(lights.at(1).at("color"), Json::parse("[1,0.5,0]"));
  EXPECT_NEAR(lights.at(2).at("spot").at("outerConeAngle").get<double>(), std::numbers::pi / 6, 1e-6);
  EXPECT_FALSE(glb.json.contains("meshes"));
  EXPECT_FALSE(glb.json.contains("buffers"));
}

TEST(Builder, objects_materials_and_saving) {
  Builder b;
  const MaterialId red = b.material({.base_color = {1, 0, 0}, .emissive = {0.5f, 0, 4}, .double_sided = true});
  const MaterialId dim = b.material({.name = "dim", .emissive = vec3(0.25f)});
  b.object("moved", {.translation = {1, 2, 3}, .scale = vec3(2)});
  b.quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, red);
  b.quad({0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, dim);
  b.quad({0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}, red);
  const auto path = std::filesystem::temp_directory_path() / fmt::format("nf_content_test_{}.glb", getpid());
  b.save(path);
  const Glb glb = parse(image::read_file(path));
  std::filesystem::remove(path);
  EXPECT_EQ(check_geometry(glb).size(), 6u);
  ASSERT_EQ(glb.json.at("meshes").size(), 1u);
  EXPECT_EQ(glb.json.at("meshes").at(0).at("primitives").size(), 2u);
  EXPECT_EQ(node_named(glb, "moved").at("translation"), Json::parse("[1,2,3]"));
  const Json& material = glb.json.at("materials").at(0);
  EXPECT_EQ(material.at("doubleSided"), true);
  EXPECT_EQ(material.at("emissiveFactor"), Json::parse("[0.125,0,1]"));
  EXPECT_EQ(material.at("extensions").at("KHR_materials_emissive_strength").at("emissiveStrength"), 4);
  EXPECT_FALSE(glb.json.at("materials").at(1).contains("extensions"));

  try {
    b.save(path / "no_such_folder" / "a.glb");
    FAIL() << "nothing was thrown";
  } catch (const Error& e) {
    EXPECT_EQ(e.exit(), Exit::Output);
  }
}

TEST(Textures, normals_are_unit_and_leaves_are_cut_out) {
  const Bricks bricks = brick_pictures(64);
  size_t tilted = 0;
  for (size_t i = 0; i < bricks.normal.pixels.size(); i += 3) {
    const auto* p = &bricks.normal.pixels[i];
    const vec3 normal = vec3(p[0], p[1], p[2]) / 255.0f * 2.0f - 1.0f;
    EXPECT_NEAR(glm::length(normal), 1, 0.02f);
    EXPECT_GT(normal.z, 0);
    tilted += normal.z < 0.95f;
  }
  EXPECT_GT(tilted, 100u);

  const image::Image8 leaves = leaf_picture(64);
  size_t solid = 0;
  for (size_t i = 3; i < leaves.pixels.size(); i += 4) {
    EXPECT_TRUE(leaves.pixels[i] == 0 || leaves.pixels[i] == 255);
    solid += leaves.pixels[i] == 255;
  }
  EXPECT_GT(solid, 64u * 64 / 5);
  EXPECT_LT(solid, 64u * 64 * 4 / 5);
}

}  // namespace
}  // namespace nf::content
