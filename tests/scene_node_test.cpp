// glTF import of what hangs on nodes: transforms, instances, cameras, lights.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "scene/gltf.h"
#include "scene/scene.h"
#include "scene_files.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::test::f32;
using nf::test::Gltf;
using nf::test::json;
using nf::test::load;
using nf::test::u16;
using nf::test::u32;
using nf::test::u8;

constexpr float pi = 3.14159265f;

#define EXPECT_NEAR_VEC(a, b) EXPECT_LT(glm::distance((a), (b)), 1e-5f) << (a).x << " " << (a).y << " " << (a).z

TEST(Gltf, ReadsLights) {
  Gltf file = test::make_quad();
  json lights = json::array();
  lights.push_back({{"type", "directional"}, {"intensity", 3}, {"color", {1, 0.5, 0.25}}});
  lights.push_back({{"type", "point"}, {"intensity", 40}, {"range", 5}});
  lights.push_back({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}});
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = {"KHR_lights_punctual"};
  file.doc["extensions"]["KHR_lights_punctual"]["lights"] = lights;
  const float half = std::sqrt(0.5f);  // a quarter turn about x takes -Z to +Y; its inverse to -Y
  for (int i = 0; i < 3; ++i) {
    file.add_root({{"rotation", {-half, 0, 0, half}},
                   {"translation", {0, 3, 1}},
                   {"scale", {2, 2, 2}},
                   {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  }
  const Scene scene = load(file);
  ASSERT_EQ(scene.directional.size(), 1u);
  EXPECT_NEAR_VEC(scene.directional[0].direction, vec3(0, -1, 0));
  EXPECT_NEAR_VEC(scene.directional[0].color, vec3(1, 0.5f, 0.25f));
  EXPECT_FLOAT_EQ(scene.directional[0].irradiance, 3);
  ASSERT_EQ(scene.punctual.size(), 2u);
  EXPECT_NEAR_VEC(scene.punctual[0].position, vec3(0, 3, 1));
  EXPECT_FLOAT_EQ(scene.punctual[0].intensity, 40);
  EXPECT_FLOAT_EQ(scene.punctual[0].range, 5);
  EXPECT_FLOAT_EQ(scene.punctual[0].outer_cone, pi);
  EXPECT_NEAR_VEC(scene.punctual[1].direction, vec3(0, -1, 0));
  EXPECT_FLOAT_EQ(scene.punctual[1].inner_cone, 0.2f);
  EXPECT_FLOAT_EQ(scene.punctual[1].outer_cone, 0.4f);
}

TEST(Gltf, ReadsCameras) {
  Gltf file = test::make_quad();
  file.add("cameras",
           {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 2}, {"znear", 1}}}});
  file.add("cameras", {{"type", "perspective"}, {"name", "main"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.2}, {"zfar", 30}}}});
  const float half = std::sqrt(0.5f);
  file.add_root({{"camera", 0}});
  file.add_root({{"camera", 1}, {"name", "node"}, {"translation", {1, 2, 3}}});
  file.add_root({{"camera", 2}, {"name", "turned"}, {"rotation", {0, half, 0, half}}, {"scale", {1, 3, 0.5}}});
  const Scene scene = load(file);
  ASSERT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.cameras[0].name, "main");
  EXPECT_EQ(scene.cameras[0].position, vec3(1, 2, 3));
  EXPECT_EQ(scene.cameras[0].forward, vec3(0, 0, -1));
  EXPECT_FLOAT_EQ(scene.cameras[0].vfov, 0.8f);
  EXPECT_FLOAT_EQ(scene.cameras[0].near, 0.1f);
  EXPECT_EQ(scene.cameras[1].name, "turned");
  EXPECT_NEAR_VEC(scene.cameras[1].forward, vec3(-1, 0, 0));
  EXPECT_NEAR_VEC(scene.cameras[1].up, vec3(0, 1, 0));
  EXPECT_FLOAT_EQ(scene.cameras[1].far, 30);
}

TEST(Gltf, SortsNodesAndComposesTransforms) {
  Gltf file = test::make_quad();
  // Listed child first; the quad's node 0 hangs below 2, which hangs below 1.
  file.add("nodes", {{"name", "top"}, {"children", {2}}, {"translation", {10, 0, 0}}});
  file.add("nodes", {{"children", {0}}, {"matrix", {-2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 5, 0, 1}}});
  file.doc["nodes"][0]["scale"] = {3, 1, 1};
  file.doc["scenes"][0]["nodes"] = {1};
  const Scene scene = load(file);
  ASSERT_EQ(scene.nodes.size(), 3u);
  for (size_t i = 0; i < 3; ++i) EXPECT_TRUE(scene.nodes.parent[i] == none || scene.nodes.parent[i] < i);
  EXPECT_EQ(scene.nodes.name[0], "top");
  ASSERT_EQ(scene.instances.size(), 1u);
  const vec3 corner(scene.nodes.world[scene.instances.node[0]] * vec4(1, 1, 0, 1));
  EXPECT_NEAR_VEC(corner, vec3(10 - 6, 5 + 2, 0));
  EXPECT_EQ(scene.instances.mirrored[0], 1);
  EXPECT_NEAR_VEC(scene.bounds.min, vec3(4, 5, 0));
  EXPECT_NEAR_VEC(scene.bounds.max, vec3(10, 7, 0));
  EXPECT_NEAR_VEC(scene.nodes.scale[1], vec3(-2, 2, 2));
  EXPECT_EQ(scene.nodes.world, scene.nodes.previous_world);
}

TEST(Gltf, InstancesShareAMesh) {
  Gltf file = test::make_quad();
  file.add_root({{"mesh", 0}, {"translation", {0, 0, -5}}});
  const Scene scene = load(file);
  EXPECT_EQ(scene.primitives.size(), 1u);
  EXPECT_EQ(scene.triangles(), 2u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_NEAR_VEC(scene.instances.center[1], vec3(0.5f, 0.5f, -5));
  EXPECT_EQ(scene.instances.mirrored[1], 0);
}

TEST(Gltf, LoadsTheDefaultScene) {
  Gltf file = test::make_quad();
  const int other = file.add("nodes", {{"mesh", 0}, {"name", "other"}});
  file.add("scenes", {{"nodes", {other}}});
  file.doc["scene"] = 1;
  const Scene scene = load(file);
  ASSERT_EQ(scene.nodes.size(), 1u);
  EXPECT_EQ(scene.nodes.name[0], "other");
}

TEST(Transforms, KeepThePreviousWorld) {
  Gltf file = test::make_quad();
  Scene scene = load(file);
  scene.nodes.local_matrix[0] = glm::translate(mat4(1), vec3(0, 0, 2));
  update_transforms(scene);
  EXPECT_EQ(scene.nodes.previous_world[0], mat4(1));
  EXPECT_EQ(vec3(scene.nodes.world[0][3]), vec3(0, 0, 2));
  EXPECT_NEAR_VEC(scene.bounds.max, vec3(1, 1, 2));
}

}  // namespace
