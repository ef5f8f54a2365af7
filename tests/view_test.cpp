// Views, cameras and culling.
#include "scene/view.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "core/error.h"
#include "scene/camera.h"
#include "scene/culling.h"
#include "scene/path.h"
#include "scene_files.h"

namespace {

using namespace nf;
using namespace nf::scene;
using nf::test::Folder;

constexpr float pi = 3.14159265f;

#define EXPECT_NEAR_VEC(a, b) EXPECT_LT(glm::distance((a), (b)), 1e-5f) << (a).x << " " << (a).y << " " << (a).z

TEST(Camera, ClipSpaceIsReverseZWithYDown) {
  Camera camera;
  camera.position = vec3(0);
  camera.vfov = pi / 2;
  camera.near = 0.1f;
  const mat4 clip = clip_from_view(camera, {200, 100}) * view_from_world(camera);
  const auto project = [&](vec3 p) {
    const vec4 c = clip * vec4(p, 1);
    return vec3(c) / c.w;
  };
  EXPECT_NEAR_VEC(project({0, 0, -0.1f}), vec3(0, 0, 1));
  EXPECT_NEAR_VEC(project({0, 0, -10}), vec3(0, 0, 0.01f));
  EXPECT_NEAR(project({0, 0, -1e6f}).z, 0, 1e-6);
  EXPECT_NEAR(project({0, 10, -10}).y, -1, 1e-5);  // up in the world is up the picture
  EXPECT_NEAR(project({20, 0, -10}).x, 1, 1e-5);
  EXPECT_FLOAT_EQ((clip * vec4(0, 0, -7, 1)).w, 7);
}

TEST(Camera, JitterShiftsThePictureByPixels) {
  const Camera camera;
  const glm::uvec2 size(320, 200);
  const vec4 point(0.3f, -0.2f, -4, 1);
  const auto pixel = [&](vec2 jitter) {
    const vec4 clip = clip_from_view(camera, size, jitter) * point;
    return (vec2(clip) / clip.w * 0.5f + 0.5f) * vec2(size);
  };
  EXPECT_LT(glm::distance(pixel({0.25f, -0.5f}) - pixel({0, 0}), vec2(0.25f, -0.5f)), 1e-3f);
}

// Through every key, at rest outside, even in between: keys on a line at a steady pace stay on it at that pace.
TEST(CameraPath, GoesThroughItsKeys) {
  CameraPath path;
  for (const int i : {0, 1, 3, 4}) {
    Camera camera;
    camera.position = vec3(float(i) * 2, 1, 0);
    camera.forward = vec3(std::sin(float(i)), 0, -std::cos(float(i)));
    path.push_back({i * 10.0, camera});
  }
  for (const double frame : {-5.0, 0.0, 4.0, 10.0, 17.5, 30.0, 40.0, 90.0})
    EXPECT_NEAR_VEC(camera_at(path, frame).position, vec3(std::clamp(frame, 0.0, 40.0) / 5, 1, 0));
  for (const PathKey& key : path) EXPECT_NEAR_VEC(camera_at(path, key.frame).forward, key.camera.forward);
  const Camera before = camera_at(path, 9.99), after = camera_at(path, 10.01);  // no corner at a key
  EXPECT_NEAR_VEC(after.forward - path[1].camera.forward, path[1].camera.forward - before.forward);
  EXPECT_NEAR(glm::length(camera_at(path, 20).forward), 1, 1e-6);
}

TEST(CameraPath, FilesAreReadStrictly) {
  const Folder folder;
  const auto read = [&](const std::string& text) {
    try {
      return fmt::format("{} keys", load_path(folder.write("path.json", text)).size());
    } catch (const Error& e) {
      EXPECT_EQ(e.exit(), Exit::Input);
      return std::string(e.what());
    }
  };
  const std::string a = R"({"frame": 0, "camera": {"position": [0,0,0], "target": [0,0,-1]}})",
                    b = R"({"frame": 8, "camera": {"position": [1,0,0], "target": [0,0,-1]}})",
                    head = R"({"schema": "nearfield.path/1", "keys": [)";
  EXPECT_EQ(read(head + a + "," + b + "]}"), "2 keys");
  const auto has = [&](const std::string& text, const char* part) {
    return read(text).find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(head + b + "," + a + "]}", "'keys[1].frame' must be above"));
  EXPECT_TRUE(has(head + a + "]}", "two keys"));
  EXPECT_TRUE(has(head + R"({"frame": 1}, )" + b + "]}", "'keys[0]' needs"));
  EXPECT_TRUE(has("{\"keys\": []}", "'schema' must be"));
}

TEST(Culling, AgreesWithACornerTest) {
  Camera camera;
  camera.position = vec3(1, 2, 3);
  camera.forward = glm::normalize(vec3(1, -0.2f, -2));
  const mat4 perspective = clip_from_view(camera, {160, 90}) * view_from_world(camera);
  EXPECT_EQ(frustum_from_clip(perspective).count, 5u);
  const mat4 orthographic = glm::ortho(-5.f, 5.f, -4.f, 4.f, 0.1f, 20.f) * view_from_world(camera);
  EXPECT_EQ(frustum_from_clip(orthographic).count, 6u);

  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-30, 30), half(0.01f, 4);
  std::vector<vec3> center, extent;
  for (int i = 0; i < 5000; ++i) {
    center.emplace_back(place(random), place(random), place(random));
    extent.emplace_back(half(random), half(random), half(random));
  }
  for (const mat4& clip : {perspective, orthographic}) {
    std::vector<uint32_t> visible;
    cull(frustum_from_clip(clip), center, extent, visible);
    EXPECT_TRUE(std::is_sorted(visible.begin(), visible.end()));
    EXPECT_GT(visible.size(), 50u);
    EXPECT_LT(visible.size(), 4000u);
    std::vector<bool> kept(center.size());
    for (const uint32_t row : visible) kept[row] = true;
    for (size_t i = 0; i < center.size(); ++i) {
      // Exact: culled when all eight corners are outside one plane of clip space.
      int outside[6] = {};
      for (int corner = 0; corner < 8; ++corner) {
        const vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const vec4 c = clip * vec4(center[i] + sign * extent[i], 1);
        const float distance[6] = {c.w + c.x, c.w - c.x, c.w + c.y, c.w - c.y, c.z, c.w - c.z};
        for (int plane = 0; plane < 6; ++plane) outside[plane] += distance[plane] < 0;
      }
      const bool expected = std::none_of(outside, outside + 6, [](int n) { return n == 8; });
      if (expected) {
        EXPECT_TRUE(kept[i]) << i;
      } else {
        EXPECT_FALSE(kept[i]) << i;
      }
    }
  }
}

TEST(Culling, KeepsBoxesThatOnlyTouch) {
  Camera camera;
  camera.position = vec3(0);
  camera.vfov = pi / 2;
  const Frustum frustum = frustum_from_clip(clip_from_view(camera, {100, 100}) * view_from_world(camera));
  const std::vector<vec3> center = {{11, 0, -10}, {12.1f, 0, -10}, {0, 0, 1}, {0, 0, 1.2f}};
  const std::vector<vec3> extent = {vec3(1, 1, 0), vec3(1, 1, 0), vec3(1.05f), vec3(1.05f)};
  std::vector<uint32_t> visible;
  cull(frustum, center, extent, visible);
  EXPECT_EQ(visible, (std::vector<uint32_t>{0, 2}));
}

TEST(View, FramingSeesTheWholeBox) {
  for (const Bounds& bounds :
       {Bounds{vec3(-1), vec3(1)}, Bounds{vec3(5, 0, 0), vec3(6, 30, 2)}, Bounds{vec3(3), vec3(3)}}) {
    const Camera camera = frame_bounds(bounds);
    EXPECT_GT(camera.position.y, bounds.max.y * 0.5f);
    const mat4 clip = clip_from_view(camera, {100, 100}) * view_from_world(camera);
    for (int corner = 0; corner < 8; ++corner) {
      const vec3 side(corner & 1, corner >> 1 & 1, corner >> 2);
      const vec4 c = clip * vec4(glm::mix(bounds.min, bounds.max, side), 1);
      EXPECT_LE(std::abs(c.x), c.w);
      EXPECT_LE(std::abs(c.y), c.w);
      EXPECT_GT(c.w, camera.near);
    }
  }
}

const char* const full_view = R"({
  "camera": {"position": [0,1,3], "target": [0,1,0], "up": [0,2,0], "vfov_deg": 90, "near": 0.1, "far": 50},
  "directional": [{"direction": [0,-2,0], "color": [1,0.5,0], "irradiance": 3.5, "angle_deg": 0.5}],
  "point": [{"position": [0,2,0], "color": [1,1,0], "intensity": 10, "radius": 0.1}],
  "environment": {"color": [0.1,0.2,0.3], "intensity": 2}})";

TEST(View, ReadsEverything) {
  const Folder folder;
  const View view = load_view(folder.write("view.json", full_view));
  ASSERT_TRUE(view.camera && view.directional && view.point && view.environment);
  EXPECT_EQ(view.camera->position, vec3(0, 1, 3));
  EXPECT_NEAR_VEC(view.camera->forward, vec3(0, 0, -1));
  EXPECT_NEAR_VEC(view.camera->up, vec3(0, 1, 0));
  EXPECT_FLOAT_EQ(view.camera->vfov, pi / 2);
  EXPECT_FLOAT_EQ(view.camera->near, 0.1f);
  EXPECT_FLOAT_EQ(view.camera->far, 50);
  EXPECT_NEAR_VEC(view.directional->at(0).direction, vec3(0, -1, 0));
  EXPECT_FLOAT_EQ(view.directional->at(0).irradiance, 3.5f);
  EXPECT_FLOAT_EQ(view.directional->at(0).angle_deg, 0.5f);
  EXPECT_FLOAT_EQ(view.point->at(0).intensity, 10);
  EXPECT_FLOAT_EQ(view.point->at(0).radius, 0.1f);
  EXPECT_NEAR_VEC(view.environment->color, vec3(0.2f, 0.4f, 0.6f));
}

Scene lit_scene() {
  Scene scene;
  scene.bounds = {vec3(-1), vec3(1)};
  scene.directional.emplace_back();
  scene.punctual.resize(2);
  scene.environment.color = vec3(7);
  return scene;
}

TEST(View, ReplacesOnlyWhatItNames) {
  const Folder folder;
  Scene scene = lit_scene();
  const Camera camera = select_view(folder.write("a.json", R"({"point": []})").string(), scene);
  EXPECT_EQ(camera.name, "framing");
  EXPECT_TRUE(scene.punctual.empty());
  EXPECT_EQ(scene.directional.size(), 1u);
  EXPECT_EQ(scene.environment.color, vec3(7));
  EXPECT_EQ(select_view(folder.write("b.json", full_view).string(), scene).position, vec3(0, 1, 3));
  EXPECT_EQ(scene.punctual.size(), 1u);
  EXPECT_NEAR_VEC(scene.environment.color, vec3(0.2f, 0.4f, 0.6f));
}

TEST(View, SelectsCamerasByNameAndNumber) {
  Scene scene = lit_scene();
  EXPECT_EQ(select_view("", scene).name, "framing");
  for (const char* name : {"first", "second", "0"}) scene.cameras.emplace_back().name = name;
  EXPECT_EQ(select_view("", scene).name, "first");
  EXPECT_EQ(select_view("second", scene).name, "second");
  EXPECT_EQ(select_view("1", scene).name, "second");
  EXPECT_EQ(select_view("0", scene).name, "0");  // a name wins over a number
  for (const char* wrong : {"third", "3", "-1", "99999999999999999999"}) {
    try {
      select_view(wrong, scene);
      ADD_FAILURE() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::Input);
      EXPECT_NE(std::string(error.what()).find("1 'second'"), std::string::npos) << error.what();
    }
  }
}

TEST(View, ErrorsNameThePathOfTheProblem) {
  const std::string camera = R"("position": [0,1,3], "target": [0,1,0])";
  const std::vector<std::pair<std::string, const char*>> table = {
      {"", "not valid JSON at byte 1"},
      {"{", "not valid JSON"},
      {"[]", "must be an object"},
      {R"({"camera": {)" + camera + R"(, "fov": 60}})", "unknown key 'camera.fov'"},
      {R"({"lights": []})", "unknown key 'lights'"},
      {R"({"point": [{"position": [0,0,0]}, {"position": [0,0,0], "colour": [1,1,1]}]})",
       "unknown key 'point[1].colour'"},
      {R"({"camera": 3})", "'camera' must be an object"},
      {R"({"point": {}})", "'point' must be a list"},
      {R"({"camera": {"position": [0,1,3]}})", "'camera.target' is missing"},
      {R"({"camera": {"position": [0,1], "target": [0,1,0]}})", "'camera.position' must be a list of three"},
      {R"({"camera": {"position": [0,1,"x"], "target": [0,1,0]}})", "'camera.position[2]' must be a number"},
      {R"({"camera": {"position": [0,1,1e60], "target": [0,1,0]}})", "not a finite number"},
      {R"({"camera": {"position": [0,1,1e999], "target": [0,1,0]}})", "out of range"},
      {R"({"camera": {"position": [0,1,0], "target": [0,1,0]}})", "'camera.target' is where"},
      {R"({"camera": {)" + camera + R"(, "up": [0,0,1]}})", "'camera.up' is parallel"},
      {R"({"camera": {)" + camera + R"(, "up": [0,0,0]}})", "'camera.up' must not be zero"},
      {R"({"camera": {)" + camera + R"(, "vfov_deg": 180}})", "'camera.vfov_deg'"},
      {R"({"camera": {)" + camera + R"(, "vfov_deg": 0}})", "'camera.vfov_deg'"},
      {R"({"camera": {)" + camera + R"(, "near": 0}})", "'camera.near'"},
      {R"({"camera": {)" + camera + R"(, "near": 2, "far": 1}})", "'camera.far'"},
      {R"({"directional": [{"direction": [0,0,0]}]})", "'directional[0].direction' must not be zero"},
      {R"({"directional": [{"irradiance": 1}]})", "'directional[0].direction' is missing"},
      {R"({"directional": [{"direction": [0,-1,0], "irradiance": -1}]})", "'directional[0].irradiance'"},
      {R"({"point": [{"position": [0,0,0], "color": [1,-1,1]}]})", "'point[0].color' must not be negative"},
      {R"({"environment": {"color": [1,1,1], "hdr": "sky.hdr"}})", "both color and hdr"},
      {R"({"environment": {"hdr": "absent.hdr", "rotation_deg": 3}})", "absent.hdr"},
      {R"({"environment": {"hdr": "sky.png"}})", "must end in .hdr or .exr"},
      {R"({"environment": {"hdr": 3}})", "'environment.hdr' must be a text"},
      {R"({"environment": {"hdr": "sky.hdr", "rotation_deg": "east"}})", "'environment.rotation_deg' must be a number"},
      {R"({"environment": {"hdr": "sky.hdr", "zenith": [1,1,1]}})", "gradient (zenith, horizon, ground) beside hdr"},
      {R"({"environment": {"color": [1,1,1], "ground": [1,1,1]}})", "gradient (zenith, horizon, ground) beside color"},
      {R"({"environment": {"zenith": [1,1,1], "horizon": [1,1,1]}})", "'environment.ground' is missing"},
      {R"({"environment": {"zenith": [1,1,1], "horizon": [1,-1,1], "ground": [0,0,0]}})",
       "'environment.horizon' must not be negative"},
      {R"({"environment": {"intensity": 3}})", "'environment.color' is missing"},
      {R"({"environment": {"color": [1,1,1], "rotation_deg": 3}})", "'environment.rotation_deg'"},
      {std::string(10000, '['), "nested too deeply"},
  };
  const Folder folder;
  for (const auto& [text, message] : table) {
    SCOPED_TRACE(text.substr(0, 200));
    const std::filesystem::path file = folder.write("bad.json", text);
    try {
      load_view(file);
      ADD_FAILURE() << "loaded";
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_EQ(error.exit(), Exit::Input);
      EXPECT_NE(what.find(file.string()), std::string::npos) << what;
      EXPECT_NE(what.find(message), std::string::npos) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
  }
  EXPECT_THROW(load_view(folder.path() / "absent.json"), Error);
  EXPECT_THROW(load_view(folder.path()), Error);
}

TEST(SharedScenes, ViewsLoad) {
  for (const auto& file : test::shared_files(".json")) {
    SCOPED_TRACE(file.string());
    EXPECT_TRUE(load_view(file).camera.has_value());
  }
}

}  // namespace
