// The generated scenes as the engine reads them: sizes, cameras, motion; and the builder's curved, copied, skinned
// shapes.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <set>

#include "builder.h"
#include "scene/animation.h"
#include "scene/deform.h"
#include "scene/view.h"
#include "scene_files.h"
#include "scenes.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::content::Builder;
using nf::content::SurfacePoint;
using nf::test::Folder;

Scene load(const std::vector<uint8_t>& glb) {
  const Folder folder;
  return load_gltf(folder.write("scene.glb", glb));
}

uint64_t drawn_triangles(const Scene& scene) {
  uint64_t sum = 0;
  for (const uint32_t primitive : scene.instances.primitive) sum += scene.primitives[primitive].index_count / 3;
  return sum;
}

// Pictures of time 0 are the pictures of the scene at rest.
TEST(Content, RestIsTimeZero) {
  for (const auto& make : {content::cornell, content::fence, content::furnace, content::atrium}) {
    Scene scene = load(make());
    EXPECT_GE(scene.cameras.size(), 2u);
    const std::vector<mat4> rest = scene.nodes.world;
    animate(scene, 0);
    EXPECT_EQ(scene.nodes.world, rest);
  }
}

TEST(Content, WhatMoves) {
  const auto moved = [](const std::vector<uint8_t>& glb) {
    Scene scene = load(glb);
    animate(scene, 0);
    animate(scene, 0.7);
    std::set<std::string> names;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
      if (scene.nodes.moved[i]) names.insert(scene.nodes.name[i]);
    }
    return names;
  };
  EXPECT_EQ(moved(content::cornell()), (std::set<std::string>{"short"}));
  EXPECT_EQ(moved(content::fence()), (std::set<std::string>{"card"}));
  const std::set<std::string> names = moved(content::atrium());
  for (const char* name : {"lantern", "lantern 7", "banner 0 joint 0", "banner 2 joint 4", "point0"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
  EXPECT_FALSE(names.contains("column"));
}

TEST(Content, Atrium) {
  Scene scene = load(content::atrium());
  EXPECT_GE(drawn_triangles(scene), 100000u);
  EXPECT_LE(drawn_triangles(scene), 300000u);
  EXPECT_LT(scene.triangles(), drawn_triangles(scene) / 3);  // columns and arches are shared
  EXPECT_EQ(scene.directional.size(), 1u);
  EXPECT_EQ(scene.punctual.size(), 4u);
  EXPECT_EQ(scene.skins.size(), 3u);
  EXPECT_GE(scene.bounds.min.y, -0.01f);
  size_t masked = 0, cloths = 0;
  for (const Material& material : scene.materials) {
    masked += material.alpha == AlphaMode::Mask;
    cloths += material.name.ends_with("cloth");
  }
  EXPECT_EQ(masked, 1u);
  EXPECT_EQ(cloths, 3u);
  for (const vec3& normal : scene.geometry.normal) ASSERT_NEAR(glm::length(normal), 1, 1e-4f);

  // At rest the banners hang where their vertices are in the file; in the draught their lower ends move most.
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (scene.instances.skin[i] == none) continue;
    const Primitive& primitive = scene.primitives[scene.instances.primitive[i]];
    animate(scene, 0);
    for (uint32_t v = 0; v < primitive.vertex_count; ++v) {
      const vec3 file = scene.geometry.position[primitive.vertex_offset + v];
      ASSERT_LT(glm::distance(deformed_position(scene, i, v, Moment::Now), file), 1e-4f);
    }
    animate(scene, 0.5);
    const auto travel = [&](uint32_t v) {
      return glm::distance(deformed_position(scene, i, v, Moment::Now), deformed_position(scene, i, v, Moment::Before));
    };
    EXPECT_GT(travel(0), 0.05f);  // row 0 is the lower edge
    EXPECT_LT(travel(primitive.vertex_count - 1), 0.1f * travel(0));
  }
  const Folder folder;
  EXPECT_TRUE(load_view(folder.write("view.json", content::atrium_view())).environment.has_value());
}

// Triangles' sides agree with the vertices' normals, and those look away from `center`.
void expect_outwards(const Scene& scene, vec3 center) {
  const Geometry& g = scene.geometry;
  for (size_t i = 0; i < g.index.size(); i += 3) {
    const uint32_t a = g.index[i], b = g.index[i + 1], c = g.index[i + 2];
    const vec3 face = glm::cross(g.position[b] - g.position[a], g.position[c] - g.position[a]);
    EXPECT_GT(glm::length(face), 0);
    for (const uint32_t corner : {a, b, c}) {
      EXPECT_GT(glm::dot(glm::normalize(face), g.normal[corner]), 0.8f);
      EXPECT_GT(glm::dot(g.normal[corner], g.position[corner] - center), 0);
    }
  }
}

TEST(Shapes, RevolvedSphere) {
  Builder b;
  std::vector<content::vec2> line;
  for (int i = 0; i <= 12; ++i) {
    const float angle = std::numbers::pi_v<float> * (float(i) / 12 - 0.5f);
    line.emplace_back(i == 0 || i == 12 ? 0.0f : std::cos(angle), std::sin(angle));
  }
  b.revolve(line, 24, {1, 2, 3}, b.material({}));
  const Scene scene = load(b.glb());
  expect_outwards(scene, {1, 2, 3});
  for (size_t i = 0; i < scene.geometry.position.size(); ++i) {
    if (std::abs(scene.geometry.position[i].y - 2) > 0.99f) continue;
    EXPECT_GT(glm::dot(scene.geometry.normal[i], scene.geometry.position[i] - vec3(1, 2, 3)), 0.999f);
  }
}

TEST(Shapes, SurfaceTangentsFollowItsUvs) {
  Builder b;
  const auto picture = b.picture("p", {.width = 1, .height = 1, .channels = 3, .pixels = {128, 128, 255}});
  const auto material = b.material({.normal_picture = picture});
  // u runs up the patch and v to the left: a turned picture.
  b.surface(
      4, 4,
      [](float s, float t) {
        return SurfacePoint{{s, t, 0.3f * s * s}, {t, -s}};
      },
      material);
  const Scene scene = load(b.glb());
  for (size_t i = 0; i < scene.geometry.normal.size(); ++i) {
    const float slope = 0.6f * scene.geometry.position[i].x;
    EXPECT_LT(glm::distance(scene.geometry.normal[i], glm::normalize(vec3(-slope, 0, 1))), 1e-2f);
    const vec4 tangent = scene.geometry.tangent[i];
    EXPECT_LT(glm::distance(vec3(tangent), vec3(0, 1, 0)), 1e-3f);
    EXPECT_EQ(tangent.w, -1);  // the picture's up is +x, cross(normal, tangent) is -x
  }
}

TEST(Shapes, CopiesAndParents) {
  Builder b;
  const auto white = b.material({});
  const auto first = b.object("first", {.translation = {1, 0, 0}});
  b.box({0, 0, 0}, vec3(0.5f), 0, white);
  b.copy("second", first, {.translation = {0, 5, 0}}, first);
  b.point_light({0, 1, 0}, 3, vec3(1), first);
  b.animate_translation(first, {0, 2}, {{1, 0, 0}, {1, 0, 4}});
  Scene scene = load(b.glb());
  EXPECT_EQ(scene.primitives.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  animate(scene, 1);
  EXPECT_LT(glm::distance(scene.instances.center[0], vec3(1, 0, 2)), 1e-5f);
  EXPECT_LT(glm::distance(scene.instances.center[1], vec3(1, 5, 2)), 1e-5f);
  EXPECT_LT(glm::distance(scene.punctual[0].position, vec3(1, 1, 2)), 1e-5f);
}

}  // namespace
