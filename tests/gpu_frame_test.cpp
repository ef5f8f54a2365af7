// The whole frame on the device against values known in advance: a lit plane, open planes, emissive walls; odd sizes,
// repeats, validation with its negative control.
#include "gpu_fixture.h"

namespace nf::test {
namespace {

using content::Builder;
using glm::ivec2;
using glm::vec3;

constexpr float pi = 3.14159265358979f;

passes::FrameSettings lambert_settings(const char* technique) {
  passes::FrameSettings settings;
  settings.technique = &passes::find_technique(technique);
  settings.material.lambert = 1;
  return settings;
}

// A square in the plane y = 0, seen from above.
void add_floor(Builder& b, float half_size, content::MaterialId material) {
  b.quad({-half_size, 0, half_size}, {half_size, 0, half_size}, {half_size, 0, -half_size}, {-half_size, 0, -half_size},
         material);
}

class Frame : public GpuTest {};

TEST_F(Frame, WhitePlaneReadsItsAlbedo) {
  Builder b;
  add_floor(b, 5, b.material({.base_color = vec3(0.8f)}));
  b.directional_light({0, -1, 0}, pi);
  const scene::Scene scene = load(b);
  const Shot shot =
      shoot(scene, {.size = {64, 36}, .camera = look({0, 2, 2}, {0, 0, 0}, 50), .settings = lambert_settings("none")});
  for (const char* layer : {"", "direct", "direct_diffuse", "radiance"})
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 64; ++x) {
        if (shot.value("depth", {x, y}) <= 0) continue;
        for (uint32_t c = 0; c < 3; ++c)
          ASSERT_NEAR(shot.value(layer, {x, y}, c), 0.8f, 1e-3f) << "'" << layer << "' at " << x << "," << y;
      }
  EXPECT_NEAR(shot.value("albedo", {32, 18}), 0.8f, 1e-3f);
  EXPECT_NEAR(shot.value("normal", {32, 18}, 1), 1, 1e-4f);
  EXPECT_NEAR(shot.value("depth", {32, 18}), std::sqrt(8.0f), 0.05f);
}

// Point light: inverse square and cosine.
TEST_F(Frame, PointLightFallsOffWithTheSquare) {
  Builder b;
  add_floor(b, 5, b.material({.base_color = vec3(1)}));
  b.point_light({0.3f, 1.5f, -0.2f}, 7);
  const scene::Scene scene = load(b);
  const Shot shot = shoot(
      scene, {.size = {64, 36}, .camera = look({0, 3, 0.1f}, {0, 0, 0}, 60), .settings = lambert_settings("none")});
  for (const ivec2 pixel : {ivec2(10, 5), ivec2(32, 18), ivec2(50, 30)}) {
    const vec3 at(shot.value("position", pixel, 0), shot.value("position", pixel, 1), shot.value("position", pixel, 2));
    const vec3 to = vec3(0.3f, 1.5f, -0.2f) - at;
    const float expected = 1 / pi * 7 * to.y / std::pow(glm::dot(to, to), 1.5f);
    EXPECT_NEAR(shot.value("direct_diffuse", pixel) / expected, 1, 1e-3f);
  }
}

TEST_F(Frame, BoxShadowsTheFloor) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  add_floor(b, 3, white);
  b.box({0, 0.5f, 0}, vec3(0.5f), 0, white);
  b.directional_light({1, -1, 0}, 1);
  const scene::Scene scene = load(b);
  const Shot shot = shoot(
      scene, {.size = {160, 90}, .camera = look({0, 5, 3}, {0.5f, 0, 0}, 50), .settings = lambert_settings("none")});
  int lit = 0, dark = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 160; ++x) {
      const vec3 at(shot.value("position", {x, y}, 0), shot.value("position", {x, y}, 1),
                    shot.value("position", {x, y}, 2));
      if (shot.value("depth", {x, y}) <= 0 || at.y > 0.01f) continue;
      // The shadow on the floor: z within the box, x from its far face to 1.5 (the top edge at x = 0.5, height 1).
      const float margin = 0.05f;
      const bool inside = std::abs(at.z) < 0.5f - margin && at.x > 0.5f + margin && at.x < 1.5f - margin;
      const bool outside = std::abs(at.z) > 0.5f + margin || at.x > 1.5f + margin || at.x < -0.5f - margin;
      const float value = shot.value("direct_diffuse", {x, y});
      if (inside) {
        EXPECT_EQ(value, 0) << at.x << " " << at.z;
        ++dark;
      }
      if (outside) {
        EXPECT_NEAR(value, std::sqrt(0.5f) / pi, 1e-3f) << at.x << " " << at.z;
        ++lit;
      }
    }
  EXPECT_GT(dark, 100);
  EXPECT_GT(lit, 1000);
}

// Visibility on a 9x9 grid of an open plane at 90 degrees field of view, through the device.
std::vector<std::pair<ivec2, float>> open_plane(const Shot& shot, glm::uvec2 size) {
  std::vector<std::pair<ivec2, float>> grid;
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x) {
      const ivec2 pixel((int(size.x) - 1) * x / 8, (int(size.y) - 1) * y / 8);
      if (shot.value("depth", pixel) > 0) grid.emplace_back(pixel, shot.value("visibility", pixel));
    }
  return grid;
}

passes::FrameSettings plane_settings(int slice_measure) {
  passes::FrameSettings settings = lambert_settings("vbgi");
  settings.gi.shared.slices = 64;
  settings.gi.shared.steps = 8;
  settings.gi.shared.radius = 100;
  settings.gi.shared.slice_measure = slice_measure;
  return settings;
}

TEST_F(Frame, OpenPlaneReadsOne) {
  Builder b;
  add_floor(b, 500, b.material({.base_color = vec3(0.5f)}));
  const scene::Scene scene = load(b);
  for (const float pitch : {-20.0f, -45.0f, -80.0f}) {
    const vec3 forward(0, std::sin(glm::radians(pitch)), -std::cos(glm::radians(pitch)));
    for (const int measure : {1, 2}) {
      const Shot shot = shoot(scene, {.size = {128, 128},
                                      .camera = look({0, 1.7f, 0}, vec3(0, 1.7f, 0) + forward, 90),
                                      .settings = plane_settings(measure)});
      const auto grid = open_plane(shot, {128, 128});
      EXPECT_GE(grid.size(), 45u);
      for (const auto& [pixel, visibility] : grid)
        EXPECT_NEAR(visibility, 1, 2e-3f)
            << "pitch " << pitch << " measure " << measure << " at " << pixel.x << "," << pixel.y;
    }
  }
}

// Slices uniform on the screen without the azimuth weight: .968 at 30 degrees below the axis of a level camera. The
// control of the test above.
TEST_F(Frame, OpenPlaneWithoutTheAzimuthWeightMisses) {
  Builder b;
  add_floor(b, 500, b.material({.base_color = vec3(0.5f)}));
  const scene::Scene scene = load(b);
  const Shot shot = shoot(
      scene, {.size = {129, 128}, .camera = look({0, 1.7f, 0}, {0, 1.7f, -1}, 90), .settings = plane_settings(0)});
  const ivec2 pixel(64, int(64 + 64 * std::tan(glm::radians(30.0f))));
  EXPECT_NEAR(shot.value("visibility", pixel), 0.968f, 4e-3f);
  float worst = 0;
  for (const auto& [at, visibility] : open_plane(shot, {129, 128})) worst = std::max(worst, std::abs(visibility - 1));
  EXPECT_GT(worst, 0.05f);
}

// An emissive wall in the plane x = 1, in front of a black floor; its top stands at an elevation of beta over the
// origin.
TEST_F(Frame, EmissiveWallLightsTheFloor) {
  struct View {
    float beta;
    vec3 eye, target;
  };
  for (const View& view : {View{30, {-6, 4, 0}, {0.5f, 0.3f, 0}}, View{60, {-6, 4, 0}, {0.5f, 0.8f, 0}},
                           View{80, {-12, 6, 0}, {0.5f, 2.5f, 0}}}) {
    const float height = std::tan(glm::radians(view.beta));
    Builder b;
    add_floor(b, 200, b.material({.base_color = vec3(0)}));
    b.quad({1, 0, -200}, {1, 0, 200}, {1, height, 200}, {1, height, -200},
           b.material({.base_color = vec3(0), .emissive = vec3(2, 1, 0.5f)}));
    const scene::Scene scene = load(b);
    passes::FrameSettings settings = lambert_settings("vbgi");
    settings.gi.shared.slices = 16;
    settings.gi.shared.steps = 96;
    settings.gi.shared.radius = 100;
    settings.gi.shared.thickness_mode = 3;
    const Shot shot = shoot(scene, {.size = {320, 180},
                                    .camera = look(view.eye, view.target, 70),
                                    .settings = settings,
                                    .frames = 4,
                                    .accumulate = true});
    double light = 0, visibility = 0, expected = 0;
    int count = 0;
    for (int y = 0; y < 180; ++y)
      for (int x = 0; x < 320; ++x) {
        const vec3 at(shot.value("position", {x, y}, 0), shot.value("position", {x, y}, 1),
                      shot.value("position", {x, y}, 2));
        if (shot.value("depth", {x, y}) <= 0 || at.y > 0.01f || std::abs(at.x) > 0.25f || std::abs(at.z) > 0.5f)
          continue;
        expected += 0.5 * (1 - std::cos(std::atan(height / (1 - at.x))));
        light += shot.value("gi", {x, y}, 1);
        visibility += shot.value("visibility", {x, y});
        EXPECT_NEAR(shot.value("gi", {x, y}, 0), 2 * shot.value("gi", {x, y}, 1), 2e-2f);
        ++count;
      }
    ASSERT_GT(count, 10) << "beta " << view.beta;
    EXPECT_NEAR(light / count, expected / count, 1e-2) << "beta " << view.beta;
    EXPECT_NEAR(visibility / count, 1 - expected / count, 1e-2) << "beta " << view.beta;
    std::printf("beta %g: gi %.4f, expected %.4f, visibility %.4f over %d pixels\n", double(view.beta), light / count,
                expected / count, visibility / count, count);
  }
}

TEST_F(Frame, RedAndGreenWallsLandOnTheirSides) {
  Builder b;
  add_floor(b, 100, b.material({.base_color = vec3(0)}));
  b.quad({-2, 0, 100}, {-2, 0, -100}, {-2, 2, -100}, {-2, 2, 100},
         b.material({.base_color = vec3(0), .emissive = vec3(1, 0, 0)}));
  b.quad({2, 0, -100}, {2, 0, 100}, {2, 2, 100}, {2, 2, -100},
         b.material({.base_color = vec3(0), .emissive = vec3(0, 1, 0)}));
  const scene::Scene scene = load(b);
  passes::FrameSettings settings = lambert_settings("vbgi");
  settings.gi.shared.slices = 8;
  settings.gi.shared.steps = 64;
  settings.gi.shared.radius = 100;
  settings.gi.shared.thickness_mode = 3;
  const Shot shot = shoot(scene, {.size = {320, 180},
                                  .camera = look({0, 3, 3}, {0, 0.5f, -3}, 80),
                                  .settings = settings,
                                  .frames = 4,
                                  .accumulate = true});
  int count = 0;
  double error_red = 0, error_green = 0;
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 320; ++x) {
      const vec3 at(shot.value("position", {x, y}, 0), shot.value("position", {x, y}, 1),
                    shot.value("position", {x, y}, 2));
      if (at.y > 0.01f || std::abs(at.x) > 1.5f || std::abs(at.z + 2) > 0.5f || shot.value("depth", {x, y}) <= 0)
        continue;
      const float red = 0.5f * (1 - std::cos(std::atan(2 / (2 + at.x)))),
                  green = 0.5f * (1 - std::cos(std::atan(2 / (2 - at.x))));
      error_red += shot.value("gi", {x, y}, 0) - red;
      error_green += shot.value("gi", {x, y}, 1) - green;
      EXPECT_NEAR(shot.value("gi", {x, y}, 0), red, 5e-2f);
      EXPECT_NEAR(shot.value("gi", {x, y}, 1), green, 5e-2f);
      EXPECT_EQ(shot.value("gi", {x, y}, 2), 0);
      ++count;
    }
  ASSERT_GT(count, 100);
  EXPECT_NEAR(error_red / count, 0, 1.5e-2);
  EXPECT_NEAR(error_green / count, 0, 1.5e-2);
}

}  // namespace
}  // namespace nf::test
