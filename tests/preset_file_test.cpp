// Presets and views as files: what is written is what is read, and what is wrong is named.
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "preset.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using glm::vec3;
using nlohmann::json;

class PresetFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() /
        fmt::format("nearfield-preset-{}-{}", testing::UnitTest::GetInstance()->current_test_info()->name(), getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  // What reading a preset with these further keys says.
  std::string complaint(const std::string& rest) const {
    try {
      read_preset(write("p.json", R"({"schema": "nearfield.preset/1")" + rest + "}"));
    } catch (const Error& e) {
      EXPECT_EQ(e.exit(), Exit::Input);
      return e.what();
    }
    return "";
  }
  fs::path folder_;
};

scene::View full_view() {
  scene::View view;
  view.camera = scene::Camera{.name = "view",
                              .position = {103.7f, -2.1f, 0.3f},
                              .forward = glm::normalize(vec3(0.3f, -0.4f, 0.7f)),
                              .up = glm::normalize(vec3(0.1f, 1, 0)),
                              .vfov = 0.9f,
                              .near = 0.07f,
                              .far = 321};
  view.directional = {{.direction = glm::normalize(vec3(0.3f, -1, 0.2f)),
                       .color = {1, 0.9f, 0.8f},
                       .irradiance = 3.3f,
                       .angle_deg = 0.53f}};
  view.point = {{.position = {0.1f, 2, -0.3f}, .color = {0.1f, 0.2f, 0.3f}, .intensity = 17.3f, .radius = 0.05f},
                {.position = {1, 2, 3},
                 .direction = glm::normalize(vec3(0.2f, -1, 0.1f)),
                 .intensity = 40,
                 .range = 12.5f,
                 .inner_cone = 0.31f,
                 .outer_cone = 0.62f}};
  view.environment = scene::Environment{.color = {0.1f, 0.12f, 0.15f}};
  return view;
}

void expect_near(vec3 a, vec3 b) {
  EXPECT_LT(glm::distance(a, b), 2e-6f) << a.x << " " << a.y << " " << a.z << " and " << b.x << " " << b.y << " "
                                        << b.z;
}

void expect_same(const scene::View& a, const scene::View& b) {
  ASSERT_TRUE(a.camera && b.camera && a.directional && b.directional && a.point && b.point && b.environment);
  EXPECT_EQ(a.camera->position, b.camera->position);
  expect_near(a.camera->forward, b.camera->forward);
  expect_near(a.camera->up, b.camera->up);
  EXPECT_NEAR(a.camera->vfov, b.camera->vfov, 1e-6f);
  EXPECT_EQ(a.camera->near, b.camera->near);
  EXPECT_EQ(a.camera->far, b.camera->far);
  ASSERT_EQ(a.directional->size(), b.directional->size());
  for (size_t i = 0; i < a.directional->size(); ++i) {
    const scene::DirectionalLight &x = (*a.directional)[i], &y = (*b.directional)[i];
    expect_near(x.direction, y.direction);
    EXPECT_EQ(std::tuple(x.color, x.irradiance, x.angle_deg), std::tuple(y.color, y.irradiance, y.angle_deg));
  }
  ASSERT_EQ(a.point->size(), b.point->size());
  for (size_t i = 0; i < a.point->size(); ++i) {
    const scene::PunctualLight &x = (*a.point)[i], &y = (*b.point)[i];
    EXPECT_EQ(std::tuple(x.position, x.color, x.intensity, x.radius, x.range),
              std::tuple(y.position, y.color, y.intensity, y.radius, y.range));
    expect_near(x.direction, y.direction);
    EXPECT_NEAR(x.inner_cone, y.inner_cone, 1e-6f);
    EXPECT_NEAR(x.outer_cone, y.outer_cone, 1e-6f);
  }
  EXPECT_EQ(a.environment->kind, b.environment->kind);
  EXPECT_EQ(a.environment->color, b.environment->color);
}

TEST_F(PresetFile, WhatIsWrittenIsRead) {
  const fs::path file = folder_ / "own.json";
  Preset preset;
  preset.scene = "a folder/room.glb";
  preset.technique = "gtao";
  preset.mode = "paper";
  preset.size = "640x360";
  preset.seed = 4294967295u;
  preset.view = full_view();
  preset.params = {{"gi.radius", 0.3}, {"gtao.sectors", "4"}};
  write_preset(file, preset);
  const Preset read = read_preset(file);
  EXPECT_EQ(std::tuple(read.scene, read.technique, read.mode, read.size, read.seed),
            std::tuple(preset.scene, preset.technique, preset.mode, preset.size, preset.seed));
  EXPECT_EQ(read.params, preset.params);
  ASSERT_TRUE(read.view && std::holds_alternative<scene::View>(*read.view));
  expect_same(std::get<scene::View>(*preset.view), std::get<scene::View>(*read.view));
  // A second time nothing moves: editing a preset again and again does not wander.
  write_preset(folder_ / "again.json", read);
  const Preset again = read_preset(folder_ / "again.json");
  expect_same(std::get<scene::View>(*read.view), std::get<scene::View>(*again.view));

  for (const Preset& small : {Preset{}, Preset{.view = "corner"}}) {
    write_preset(file, small);
    const Preset back = read_preset(file);
    EXPECT_FALSE(back.scene || back.technique || back.mode || back.size || back.seed);
    EXPECT_EQ(back.view.has_value(), small.view.has_value());
    if (back.view) {
      EXPECT_EQ(std::get<std::string>(*back.view), "corner");
    }
    EXPECT_TRUE(back.params.empty());
  }
}

TEST_F(PresetFile, EnvironmentsOfEveryKind) {
  fs::create_directories(folder_ / "maps");
  image::Image picture{4, 2, 3, {}};
  for (int i = 0; i < 24; ++i) picture.pixels.push_back(float(i) / 8);
  image::write_exr(folder_ / "maps" / "sky.exr", std::vector<image::Layer>{{"", "RGB", picture}}, {},
                   image::Precision::Float);
  Preset preset;
  const auto back = [&](const scene::Environment& environment) {
    preset.view = scene::View{.environment = environment};
    write_preset(folder_ / "p.json", preset);
    const Preset read = read_preset(folder_ / "p.json");
    EXPECT_FALSE(std::get<scene::View>(*read.view).camera);
    EXPECT_FALSE(std::get<scene::View>(*read.view).point) << "what is not there replaces nothing";
    return std::get<scene::View>(*read.view).environment.value();
  };
  const scene::Environment map = scene::load_environment_map(folder_ / "maps" / "sky.exr", 0.7f, 30);
  const scene::Environment same = back(map);
  EXPECT_EQ(same.texels, map.texels);
  EXPECT_EQ(same.intensity, 0.7f);
  EXPECT_NEAR(same.rotation, map.rotation, 1e-6f);
  // Beside the preset: its path moves with the folder. Elsewhere: absolute.
  EXPECT_EQ(json::parse(std::ifstream(folder_ / "p.json"))["view"]["environment"]["hdr"], "maps/sky.exr");
  preset.view = scene::View{.environment = map};
  write_preset(folder_ / "maps" / "p.json", preset);
  EXPECT_EQ(json::parse(std::ifstream(folder_ / "maps" / "p.json"))["view"]["environment"]["hdr"], "sky.exr");
  fs::create_directories(folder_ / "other");
  write_preset(folder_ / "other" / "p.json", preset);
  EXPECT_EQ(json::parse(std::ifstream(folder_ / "other" / "p.json"))["view"]["environment"]["hdr"],
            (folder_ / "maps" / "sky.exr").string());
  EXPECT_EQ(std::get<scene::View>(*read_preset(folder_ / "other" / "p.json").view).environment->texels, map.texels);

  const scene::Environment gradient = back({.kind = scene::EnvironmentKind::Gradient,
                                            .zenith = {0.1f, 0.2f, 0.9f},
                                            .horizon = {0.7f, 0.8f, 0.9f},
                                            .ground = {0.1f, 0.1f, 0.05f}});
  EXPECT_EQ(gradient.kind, scene::EnvironmentKind::Gradient);
  EXPECT_EQ(gradient.zenith, vec3(0.1f, 0.2f, 0.9f));
  EXPECT_EQ(gradient.ground, vec3(0.1f, 0.1f, 0.05f));
  scene::Environment nameless = map;
  nameless.file.clear();
  preset.view = scene::View{.environment = nameless};
  EXPECT_THROW(write_preset(folder_ / "q.json", preset), Error);
  EXPECT_FALSE(fs::exists(folder_ / "q.json"));
}

TEST_F(PresetFile, FaultsAreNamedByTheirPath) {
  EXPECT_EQ(complaint(""), "");
  EXPECT_EQ(complaint(R"(, "scene": "x.glb", "view": {}, "params": {})"), "");
  const auto names = [&](const std::string& rest, const char* word) {
    const std::string text = complaint(rest);
    EXPECT_NE(text.find(word), std::string::npos) << rest << " says: " << text;
    EXPECT_NE(text.find("p.json"), std::string::npos) << text;
  };
  names(R"(, "colour": "red")", "unknown key 'colour'");
  names(R"(, "scene": 7)", "'scene'");
  names(R"(, "mode": "fast")", "'mode'");
  names(R"(, "view": 7)", "'view'");
  names(R"(, "view": {"cam": {}})", "unknown key 'view.cam'");
  names(R"(, "view": {"camera": {"position": [0, 0, 0], "target": [0, 0, 1], "fov": 3}})", "'view.camera.fov'");
  names(R"(, "view": {"point": [{"position": [0, 0]}]})", "'view.point[0].position'");
  names(R"(, "view": {"point": [{"position": [0, 0, 0], "direction": [0, 1, 0]}]})", "'view.point[0].direction'");
  names(R"(, "view": {"point": [{"position": [0, 0, 0], "outer_cone_deg": 20}]})",
        "'view.point[0].direction' is missing");
  names(
      R"(, "view": {"point": [{"position": [0, 0, 0], "direction": [0, 1, 0], "outer_cone_deg": 20, "inner_cone_deg": 20}]})",
      "'view.point[0].inner_cone_deg'");
  names(R"(, "view": {"point": [{"position": [0, 0, 0], "direction": [0, 1, 0], "outer_cone_deg": 100}]})",
        "'view.point[0].outer_cone_deg'");
  names(R"(, "view": {"environment": {"hdr": "nowhere.hdr"}})", "'view.environment.hdr'");
  names(R"(, "bookmarks": [])", "'bookmarks'");
  names(R"(, "bookmarks": {"0": {}})", "unknown key 'bookmarks.0'");
  names(R"(, "bookmarks": {"10": {}})", "unknown key 'bookmarks.10'");
  names(R"(, "bookmarks": {"3": {"position": [0, 0, 0]}})", "'bookmarks.3.target'");
  names(R"(, "bookmarks": {"3": {"position": [0, 0, 0], "target": [0, 0, 1], "fov": 3}})", "'bookmarks.3.fov'");
  EXPECT_THROW(read_preset(folder_ / "nowhere.json"), Error);
}

// Those that are there, under their numbers; none is not the same as no word of them.
TEST_F(PresetFile, BookmarksAreKept) {
  const scene::Camera camera = *full_view().camera;
  Preset preset;
  EXPECT_FALSE(read_preset(write("p.json", R"({"schema": "nearfield.preset/1"})")).bookmarks);
  preset.bookmarks.emplace();
  write_preset(folder_ / "p.json", preset);
  ASSERT_TRUE(read_preset(folder_ / "p.json").bookmarks);
  (*preset.bookmarks)[0] = camera;
  (*preset.bookmarks)[8] = camera;
  (*preset.bookmarks)[8]->position.x += 1;
  write_preset(folder_ / "p.json", preset);
  const Bookmarks read = read_preset(folder_ / "p.json").bookmarks.value();
  for (size_t i = 0; i < read.size(); ++i) EXPECT_EQ(read[i].has_value(), i == 0 || i == 8) << i;
  EXPECT_EQ(read[0]->position, camera.position);
  EXPECT_EQ(read[8]->position.x, camera.position.x + 1);
  expect_near(read[8]->forward, camera.forward);
  expect_near(read[8]->up, camera.up);
  EXPECT_NEAR(read[8]->vfov, camera.vfov, 1e-6f);
  EXPECT_EQ(read[8]->far, camera.far);
}

// The old file stays where the new one cannot be written.
TEST_F(PresetFile, WrittenWholeOrNotAtAll) {
  const std::string file = write("p.json", "old");
  EXPECT_THROW(write_preset(folder_ / "nowhere" / "p.json", Preset{}), Error);
  write_preset(file, Preset{.technique = "ssao"});
  EXPECT_EQ(read_preset(file).technique, "ssao");
  size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_)) ++files;
  EXPECT_EQ(files, 1u) << "no temporary file is left";
}

}  // namespace
}  // namespace nf::editor
