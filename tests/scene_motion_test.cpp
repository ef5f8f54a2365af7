// What moves: skins, morph targets, animations, and the update that touches only what moved.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "moving_files.h"
#include "scene/animation.h"
#include "scene/deform.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::test::f32;
using nf::test::Folder;
using nf::test::Gltf;
using nf::test::json;
using nf::test::load_binary;

constexpr float pi = 3.14159265f;

#define EXPECT_NEAR_VEC(a, b)               \
  EXPECT_LT(glm::distance((a), (b)), 1e-5f) \
      << (a).x << " " << (a).y << " " << (a).z << " is not " << (b).x << " " << (b).y

// Where the arm's vertex is when the elbow is turned by `angle`: by hand, without matrices.
vec3 arm_vertex(size_t i, float angle) {
  const float x = float(i % 2), y = float(i / 2);
  const vec3 bent(x * std::cos(angle) - (y - 1) * std::sin(angle), 1 + x * std::sin(angle) + (y - 1) * std::cos(angle),
                  0);
  const float elbow = y == 0 ? 0.f : y == 1 ? 0.5f : 1.f;
  return glm::mix(vec3(x, y, 0), bent, elbow);
}

TEST(Skin, MovesVerticesByTheirJoints) {
  Scene scene = load_binary(test::arm_file());
  ASSERT_EQ(scene.skins.size(), 1u);
  ASSERT_EQ(scene.instances.skin[0], 0u);
  for (const float time : {0.f, 0.25f, 0.5f, 0.99f}) {
    animate(scene, time);
    const Deformed now = deform(scene, 0, Moment::Now);
    ASSERT_EQ(now.position.size(), 6u);
    for (size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR_VEC(now.position[i], arm_vertex(i, time * pi / 2));
      EXPECT_NEAR_VEC(now.position[i], deformed_position(scene, 0, uint32_t(i), Moment::Now));
      EXPECT_NEAR_VEC(now.normal[i], vec3(0, 0, 1));
    }
  }
}

TEST(Skin, VelocityIsTheDifferenceOfTwoPoses) {
  Scene scene = load_binary(test::arm_file());
  animate(scene, 0.2);
  animate(scene, 0.6);
  for (uint32_t i = 0; i < 6; ++i) {
    const vec3 moved = deformed_position(scene, 0, i, Moment::Now) - deformed_position(scene, 0, i, Moment::Before);
    EXPECT_NEAR_VEC(moved, arm_vertex(i, 0.3f * pi) - arm_vertex(i, 0.1f * pi));
  }
}

TEST(Skin, KeepsTheFourStrongestInfluences) {
  Gltf file = test::arm_file();
  json& attributes = test::quad_primitive(file)["attributes"];
  // Six influences on the last vertex: 0.1 0.1 0.3 0.1 | 0.3 0.1, all of joint 0 but the fourth and fifth, of joint 1.
  std::vector<uint8_t> joints(24, 0), more_joints(24, 0);
  joints[23] = 1;
  more_joints[20] = 1;
  std::vector<vec4> weights(6, vec4(1, 0, 0, 0)), more(6, vec4(0));
  weights[5] = {0.1f, 0.1f, 0.3f, 0.1f};
  more[5] = {0.3f, 0.1f, 0, 0};
  attributes["JOINTS_0"] = test::plain_accessor(file, joints, test::u8, "VEC4", 6);
  attributes["WEIGHTS_0"] = file.attribute(weights, f32, "VEC4", 6);
  attributes["JOINTS_1"] = test::plain_accessor(file, more_joints, test::u8, "VEC4", 6);
  attributes["WEIGHTS_1"] = file.attribute(more, f32, "VEC4", 6);
  const Scene scene = load_binary(file);
  const uint32_t row = scene.primitives[0].first_influence + 5;
  EXPECT_NEAR_VEC(scene.influences.weight[row], vec4(0.375f, 0.375f, 0.125f, 0.125f));
  EXPECT_EQ(scene.influences.joint[row], glm::u16vec4(0, 1, 0, 0));
}

TEST(Skin, RefusesJointsBeyondTheSkin) {
  const Folder folder;
  Gltf file = test::arm_file();
  file.doc["skins"][0]["joints"] = {1};
  EXPECT_NE(test::load_error(folder.write("a.glb", file.glb())).find("joint 1, but skins[0] has only 1"),
            std::string::npos);
  Gltf outside = test::arm_file();
  outside.doc["skins"][0]["joints"] = {1, outside.add("nodes", json::object())};
  outside.doc["animations"].clear();
  const Scene scene = load_binary(outside);
  EXPECT_EQ(scene.instances.skin[0], none);
}

TEST(Morph, AddsWeightedTargets) {
  Scene scene = load_binary(test::morph_file());
  ASSERT_EQ(scene.primitives[0].target_count, 2u);
  EXPECT_EQ(scene.morph_weights.value, (std::vector<float>{0.5f, 0}));
  EXPECT_NEAR_VEC(deformed_position(scene, 0, 2, Moment::Now), vec3(1, 2, 0));
  EXPECT_NEAR_VEC(deformed_position(scene, 0, 1, Moment::Now), vec3(1, 0, 0));
  EXPECT_NEAR_VEC(scene.bounds.max, vec3(1, 2, 0));

  animate(scene, 0);
  const Changes changes = animate(scene, 1);
  EXPECT_EQ(changes.weights, (std::vector<RowRange>{{1, 1}}));
  EXPECT_EQ(changes.instances, (std::vector<RowRange>{{0, 1}}));
  EXPECT_TRUE(changes.nodes.empty());
  const Deformed now = deform(scene, 0, Moment::Now);
  EXPECT_NEAR_VEC(now.position[3], vec3(0, 2, 0.5f));
  EXPECT_NEAR_VEC(now.normal[3], glm::normalize(vec3(0.5f, 0, 0.5f)));
  EXPECT_NEAR_VEC(deform(scene, 0, Moment::Before).position[3], vec3(0, 2, 0));

  Gltf own = test::morph_file();
  own.doc["nodes"][0]["weights"] = {-1, 0};
  EXPECT_NEAR_VEC(deformed_position(load_binary(own), 0, 2, Moment::Now), vec3(1, -1, 0));
}

// Skin and morph together, in random poses: the box holds every vertex and is not absurdly large.
TEST(Deform, BoundsHoldEveryVertex) {
  Gltf file = test::arm_file();
  test::quad_primitive(file)["targets"] = json::array();
  for (int target = 0; target < 3; ++target) {
    std::vector<vec3> deltas(6);
    for (size_t i = 0; i < 6; ++i)
      deltas[i] = vec3(std::sin(float(i + size_t(target))), 0.3f * float(i), float(target) - 1);
    test::quad_primitive(file)["targets"].push_back({{"POSITION", file.positions(deltas)}});
  }
  Scene scene = load_binary(file);
  std::mt19937 random(11);
  std::uniform_real_distribution<float> value(-1.5f, 1.5f);
  for (int pose = 0; pose < 200; ++pose) {
    for (uint32_t node = 0; node < scene.nodes.size(); ++node) {
      set_local(scene.nodes, node, vec3(value(random), value(random), value(random)),
                glm::normalize(quat(value(random), value(random), value(random), value(random))),
                vec3(value(random), value(random), value(random)));
    }
    for (float& weight : scene.morph_weights.wanted) weight = value(random);
    update(scene);
    const vec3 center = scene.instances.center[0], extent = scene.instances.extent[0] + 1e-4f;
    vec3 reach(0);
    for (const vec3& p : deform(scene, 0, Moment::Now).position) {
      EXPECT_TRUE(glm::all(glm::lessThanEqual(glm::abs(p - center), extent))) << pose;
      reach = glm::max(reach, glm::abs(p - center));
    }
    EXPECT_LT(glm::length(extent), 12 * glm::length(reach) + 1);
  }
}

// A quad at a node that one clip drives.
Scene clip_scene(const char* path, const std::vector<float>& times, const std::vector<float>& values, const char* type,
                 size_t count, const char* interpolation) {
  Gltf file = test::make_quad();
  file.doc["nodes"][0]["translation"] = {7, 0, 0};
  test::add_clip(file, 0, path, times, values, type, count, interpolation);
  return load_binary(file);
}

TEST(Animation, StepHoldsAndLinearRuns) {
  const std::vector<float> values = {1, 0, 0, 3, 0, 0, 3, 8, 0};
  Scene step = clip_scene("translation", {0.5f, 1, 2}, values, "VEC3", 3, "STEP");
  Scene linear = clip_scene("translation", {0.5f, 1, 2}, values, "VEC3", 3, "LINEAR");
  EXPECT_FLOAT_EQ(step.animations.clips[0].duration, 2);
  EXPECT_EQ(step.nodes.translation[0], vec3(7, 0, 0));  // until animate() is called
  const auto at = [](Scene& scene, double time) {
    animate(scene, time);
    return vec3(scene.nodes.world[0][3]);
  };
  EXPECT_NEAR_VEC(at(step, 0.99), vec3(1, 0, 0));
  EXPECT_NEAR_VEC(at(step, 1), vec3(3, 0, 0));
  EXPECT_NEAR_VEC(at(linear, 0), vec3(1, 0, 0));  // before the first key
  EXPECT_NEAR_VEC(at(linear, 0.75), vec3(2, 0, 0));
  EXPECT_NEAR_VEC(at(linear, 1.25), vec3(3, 2, 0));
  EXPECT_NEAR_VEC(at(linear, 3.25), vec3(3, 2, 0));   // the clip repeats
  EXPECT_NEAR_VEC(at(linear, -0.75), vec3(3, 2, 0));  // both ways
  EXPECT_NEAR_VEC(at(linear, 2.5), vec3(1, 0, 0));
}

// Hermite splines reproduce cubic polynomials exactly.
TEST(Animation, CubicSplinesReproduceCubics) {
  const auto f = [](float t) { return vec3(t * t * t - 2 * t + 1, 0.5f * t * t, -t); };
  const auto slope = [](float t) { return vec3(3 * t * t - 2, t, -1); };
  const std::vector<float> times = {0, 0.75f, 2};
  std::vector<float> values;
  for (const float t : times) {
    for (const vec3 v : {slope(t), f(t), slope(t)}) values.insert(values.end(), {v.x, v.y, v.z});
  }
  Scene scene = clip_scene("translation", times, values, "VEC3", 9, "CUBICSPLINE");
  for (const float t : {0.f, 0.3f, 0.75f, 1.f, 1.6f, 1.99f}) {
    animate(scene, double(t));
    EXPECT_NEAR_VEC(scene.nodes.translation[0], f(t));
  }
}

TEST(Animation, RotationsTurnEvenlyTheShorterWay) {
  // A quarter turn about y whose second key is the negative quaternion: the same rotation.
  const float half = test::half_root;
  Scene scene = clip_scene("rotation", {0, 3}, {0, 0, 0, 1, 0, -half, 0, -half}, "VEC4", 2, "LINEAR");
  for (const float t : {0.f, 1.f, 2.f, 2.9f}) {
    animate(scene, double(t));
    const float angle = t / 3 * pi / 2;
    EXPECT_NEAR_VEC(vec3(scene.nodes.world[0] * vec4(1, 0, 0, 0)), vec3(std::cos(angle), 0, -std::sin(angle)));
  }
  Scene spline =
      clip_scene("rotation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, half, 0, 0, half, 0, 0, 0, 0},
                 "VEC4", 6, "CUBICSPLINE");
  animate(spline, 0.5);
  EXPECT_NEAR(glm::length(spline.nodes.rotation[0]), 1, 1e-6);
  EXPECT_NEAR_VEC(vec3(spline.nodes.world[0] * vec4(0, 1, 0, 0)), vec3(0, half, half));  // half way by symmetry
}

TEST(Animation, QuantizedRotations) {
  Gltf file = test::make_quad();
  const int input = file.attribute(std::vector<float>{0, 1}, f32, "SCALAR", 2);
  const int output = file.attribute(std::vector<int16_t>{0, 0, 0, 32767, 0, 23170, 0, 23170}, 5122, "VEC4", 2);
  json samplers = json::array({{{"input", input}, {"output", output}}});
  json channels = json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}}});
  file.add("animations", {{"samplers", samplers}, {"channels", channels}});
  Scene scene = load_binary(file);
  animate(scene, 0.5);
  EXPECT_LT(glm::distance(vec3(scene.nodes.world[0] * vec4(1, 0, 0, 0)), vec3(test::half_root, 0, -test::half_root)),
            1e-4f);
}

TEST(Animation, ClipsPlayTogetherUnlessStopped) {
  Gltf file = test::make_quad();
  file.doc["nodes"][0]["translation"] = {7, 0, 0};
  test::add_clip(file, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3", 2);
  test::add_clip(file, 0, "scale", {0, 2}, {1, 1, 1, 3, 3, 3}, "VEC3", 2);
  test::add_clip(file, 0, "translation", {0, 1}, {0, 0, 0, 0, 1, 0}, "VEC3", 2);
  Scene scene = load_binary(file);
  ASSERT_EQ(scene.animations.clips.size(), 3u);
  animate(scene, 0.5);
  EXPECT_NEAR_VEC(scene.nodes.translation[0], vec3(0, 0.5f, 0));
  EXPECT_NEAR_VEC(scene.nodes.scale[0], vec3(1.5f));
  scene.animations.clips[2].plays = false;
  animate(scene, 0.5);
  EXPECT_NEAR_VEC(scene.nodes.translation[0], vec3(0.5f, 0, 0));
  scene.animations.clips[0].plays = false;
  animate(scene, 0.5);
  EXPECT_NEAR_VEC(scene.nodes.translation[0], vec3(7, 0, 0));
}

TEST(Animation, BadOnesAreRefused) {
  const Folder folder;
  const auto error = [&](const std::function<void(Gltf&)>& damage) {
    Gltf file = test::make_quad();
    test::add_clip(file, 0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3", 2);
    damage(file);
    return test::load_error(folder.write("bad.glb", file.glb()));
  };
  const auto expect = [&](const char* part, const std::function<void(Gltf&)>& damage) {
    const std::string text = error(damage);
    EXPECT_NE(text.find(part), std::string::npos) << "got: " << text;
  };
  const auto clip = [](Gltf& f) -> json& { return f.doc["animations"][0]; };
  EXPECT_EQ(error([](Gltf&) {}), "");
  expect("sampler is 1", [&](Gltf& f) { clip(f)["channels"][0]["sampler"] = 1; });
  expect("node is 5", [&](Gltf& f) { clip(f)["channels"][0]["target"]["node"] = 5; });
  expect("interpolation is 'WOBBLE'", [&](Gltf& f) { clip(f)["samplers"][0]["interpolation"] = "WOBBLE"; });
  expect("2 values where 6 are expected", [&](Gltf& f) { clip(f)["samplers"][0]["interpolation"] = "CUBICSPLINE"; });
  expect("components", [&](Gltf& f) { clip(f)["channels"][0]["target"]["path"] = "rotation"; });
  expect("do not rise", [&](Gltf& f) {
    const float late = 2;
    std::memcpy(f.bin.data() + f.bin.size() - 32, &late, 4);
  });
  // What drives nothing is left out.
  EXPECT_EQ(error([&](Gltf& f) { clip(f)["channels"][0]["target"].erase("node"); }), "");
  EXPECT_EQ(error([&](Gltf& f) { clip(f)["channels"][0]["target"]["path"] = "pointer"; }), "");
}

TEST(Update, LightsAndCamerasFollowTheirNodes) {
  Gltf file = test::make_quad();
  file.doc["extensionsUsed"] = {"KHR_lights_punctual"};
  json lights = json::array();
  lights.push_back({{"type", "point"}});
  lights.push_back({{"type", "directional"}});
  lights.push_back({{"type", "spot"}, {"spot", json::object()}});
  file.doc["extensions"]["KHR_lights_punctual"]["lights"] = lights;
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
  const int carrier = file.add_root({{"children", {2, 3, 4, 5}}});
  for (int i = 0; i < 3; ++i) {
    file.add("nodes", {{"translation", {0, 1, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  }
  file.add("nodes", {{"camera", 0}, {"translation", {0, 0, 2}}});
  const float half = test::half_root;
  test::add_clip(file, carrier, "rotation", {0, 1}, {0, 0, 0, 1, half, 0, 0, half}, "VEC4", 2);
  Scene scene = load_binary(file);
  EXPECT_FLOAT_EQ(scene.punctual[1].outer_cone, pi / 4);
  animate(scene, 0);
  const Changes changes = animate(scene, 1 - 1e-9);  // a quarter turn about x: y to z, z to -y
  EXPECT_LT(glm::distance(scene.punctual[0].position, vec3(0, 0, 1)), 1e-4f);
  EXPECT_LT(glm::distance(scene.punctual[1].direction, vec3(0, 1, 0)), 1e-4f);
  EXPECT_LT(glm::distance(scene.directional[0].direction, vec3(0, 1, 0)), 1e-4f);
  EXPECT_LT(glm::distance(scene.cameras[0].position, vec3(0, -2, 0)), 1e-4f);
  EXPECT_LT(glm::distance(scene.cameras[0].forward, vec3(0, 1, 0)), 1e-4f);
  EXPECT_EQ(changes.punctual, (std::vector<RowRange>{{0, 2}}));
  EXPECT_EQ(changes.directional, (std::vector<RowRange>{{0, 1}}));
  EXPECT_EQ(changes.cameras, (std::vector<RowRange>{{0, 1}}));
  EXPECT_EQ(changes.nodes, (std::vector<RowRange>{{1, 5}}));
  EXPECT_TRUE(changes.instances.empty());
}

// Ten nodes in two chains of five, a quad at each.
Scene chain_scene() {
  Gltf file = test::make_quad();
  file.doc["scenes"][0]["nodes"] = json::array();
  file.doc["nodes"] = json::array();
  for (int chain = 0; chain < 2; ++chain) {
    for (int i = 0; i < 5; ++i) {
      json node = {{"mesh", 0}, {"translation", {1, 0, 0}}};
      const int row = file.add("nodes", node);
      if (i < 4) file.doc["nodes"][size_t(row)]["children"] = {row + 1};
      if (i == 0) file.doc["scenes"][0]["nodes"].push_back(row);
    }
  }
  return load_binary(file);
}

void move(Scene& scene, uint32_t node, vec3 translation) {
  set_local(scene.nodes, node, translation, scene.nodes.rotation[node], scene.nodes.scale[node]);
}

TEST(Update, TouchesOnlyWhatMoved) {
  // Breadth first: the chains' nodes alternate.
  Scene scene = chain_scene();
  EXPECT_EQ(update(scene), Changes());
  move(scene, 5, {1, 2, 0});  // the second chain's third node
  Changes changes = update(scene);
  const std::vector<RowRange> below = {{5, 1}, {7, 1}, {9, 1}};
  EXPECT_EQ(changes.nodes, below);
  EXPECT_EQ(changes.instances, below);
  EXPECT_EQ(vec3(scene.nodes.world[9][3]), vec3(5, 2, 0));
  EXPECT_EQ(vec3(scene.nodes.previous_world[9][3]), vec3(5, 0, 0));
  EXPECT_EQ(vec3(scene.nodes.world[8][3]), vec3(5, 0, 0));
  EXPECT_EQ(scene.bounds.max, vec3(6, 3, 0));

  // At rest again: the previous transforms catch up, once.
  changes = update(scene);
  EXPECT_EQ(changes.nodes, below);
  EXPECT_EQ(scene.nodes.previous_world, scene.nodes.world);
  EXPECT_EQ(update(scene), Changes());

  // Setting what is already there is no change.
  move(scene, 5, {1, 2, 0});
  EXPECT_EQ(update(scene), Changes());
}

TEST(Update, AgreesWithWalkingUp) {
  Scene scene = chain_scene();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(-1, 1);
  for (int round = 0; round < 300; ++round) {
    const std::vector<mat4> before = scene.nodes.world;
    for (uint32_t node = 0; node < scene.nodes.size(); ++node) {
      if (random() % 4 == 0) {
        set_local(scene.nodes, node, vec3(value(random), value(random), value(random)),
                  glm::angleAxis(value(random), vec3(0, 0, 1)), vec3(1 + 0.5f * value(random)));
      }
    }
    const Changes changes = update(scene);
    std::vector<uint8_t> listed(scene.nodes.size());
    for (const RowRange& range : changes.nodes) {
      for (uint32_t row = range.first; row < range.first + range.count; ++row) listed[row] = 1;
    }
    for (uint32_t node = 0; node < scene.nodes.size(); ++node) {
      vec4 point(0.3f, -0.7f, 0.2f, 1);
      for (uint32_t at = node; at != none; at = scene.nodes.parent[at]) {
        point = vec4(scene.nodes.translation[at] + scene.nodes.rotation[at] * (scene.nodes.scale[at] * vec3(point)), 1);
      }
      EXPECT_LT(glm::distance(vec3(scene.nodes.world[node] * vec4(0.3f, -0.7f, 0.2f, 1)), vec3(point)), 1e-4f);
      EXPECT_EQ(scene.nodes.previous_world[node], before[node]);
      if (!listed[node]) {
        EXPECT_EQ(scene.nodes.world[node], before[node]);
      }
    }
  }
}

}  // namespace
