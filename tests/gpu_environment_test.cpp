// Environments through the device: background, diffuse and specular light of maps and gradients against the maps
// themselves, the white furnace, rotation, bent normals, and the frame graph's switches.
#include "gpu_fixture.h"
#include "scene/environment_light.h"
#include "sky.h"

namespace nf::test {
namespace {

using content::Builder;
using glm::ivec2;
using glm::vec3;

constexpr float pi = 3.14159265358979f;

scene::Environment sky(const content::Sky& of, uint32_t width = 256, float rotation_deg = 0) {
  return scene::make_environment_map(content::sky_map(of, width), "test", 1, rotation_deg);
}

passes::FrameSettings settings_for(const char* technique, bool lambert) {
  passes::FrameSettings settings;
  settings.technique = &passes::find_technique(technique);
  settings.material.lambert = lambert;
  return settings;
}

void add_floor(Builder& b, float half_size, content::MaterialId material) {
  b.quad({-half_size, 0, half_size}, {half_size, 0, half_size}, {half_size, 0, -half_size}, {-half_size, 0, -half_size},
         material);
}

vec3 value3(const Shot& shot, const std::string& layer, ivec2 pixel) {
  return {shot.value(layer, pixel, 0), shot.value(layer, pixel, 1), shot.value(layer, pixel, 2)};
}

// World direction through a pixel's centre, from the camera's definition.
vec3 ray(const scene::Camera& camera, glm::uvec2 size, ivec2 pixel) {
  const vec3 right = glm::normalize(glm::cross(camera.forward, camera.up)), up = glm::cross(right, camera.forward);
  const float half = std::tan(camera.vfov / 2);
  const float x = ((float(pixel.x) + 0.5f) / float(size.x) * 2 - 1) * half * float(size.x) / float(size.y);
  const float y = (1 - (float(pixel.y) + 0.5f) / float(size.y) * 2) * half;
  return glm::normalize(camera.forward + right * x + up * y);
}

void expect_close(vec3 got, vec3 expected, float relative, const std::string& where) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(got[c], expected[c], relative * std::max(expected[c], 1e-2f)) << where << ", channel " << c;
}

class Environments : public GpuTest {
 protected:
  // A floor tile far below, so that there is a scene.
  scene::Scene empty() {
    Builder b;
    b.quad({-1, -90, 1}, {1, -90, 1}, {1, -90, -1}, {-1, -90, -1}, b.material({}));
    return load(b);
  }
};

TEST_F(Environments, BackgroundIsTheMap) {
  scene::Scene scene = empty();
  const glm::uvec2 size(64, 48);
  scene::Environment gradient{.kind = scene::EnvironmentKind::Gradient,
                              .zenith = vec3(0.1f, 0.2f, 0.9f),
                              .horizon = vec3(2, 1.5f, 1),
                              .ground = vec3(0.3f, 0.2f, 0.1f)};
  for (const scene::Environment& environment :
       {sky(content::hazy()), sky(content::afternoon(), 512, 37), sky(content::hazy(), 64, -120), gradient}) {
    scene.environment = environment;
    // Along -X, where the map's ends meet, and over both poles.
    for (const vec3 towards : {vec3(-1, 0.1f, 0), vec3(0.3f, 0.2f, 1), vec3(0.1f, 1, 0.1f), vec3(0, -1, 0.2f)}) {
      const scene::Camera camera = look(vec3(0), towards, 80);
      const Shot shot = shoot(scene, {.size = size, .camera = camera, .settings = settings_for("none", false)});
      int seen = 0;
      for (int y = 0; y < int(size.y); ++y)
        for (int x = 0; x < int(size.x); ++x) {
          if (shot.value("depth", {x, y}) > 0) continue;
          // Samplers place a direction to a few hundredths of a texel, which at the sun's edge is worth everything:
          // what lies that far to the sides bounds the pixel.
          const vec3 d = ray(camera, size, {x, y}), got = value3(shot, "", {x, y});
          const float blur = 0.03f * 2 * pi / float(std::max(scene.environment.width, 64u));
          vec3 least(1e9f), most(0);
          for (int side = 0; side < 7; ++side) {
            vec3 moved = d;
            if (side > 0) moved[(side - 1) / 2] += side % 2 ? blur : -blur;
            const vec3 value = radiance(scene.environment, glm::normalize(moved));
            least = glm::min(least, value), most = glm::max(most, value);
          }
          for (int c = 0; c < 3; ++c) {
            EXPECT_GE(got[c], least[c] * (1 - 3e-3f)) << x << "," << y;
            EXPECT_LE(got[c], most[c] * (1 + 3e-3f)) << x << "," << y;
          }
          EXPECT_EQ(value3(shot, "ambient", {x, y}), vec3(0));
          ++seen;
        }
      EXPECT_GT(seen, 3000);
      if (testing::Test::HasFailure()) return;
    }
  }
}

// Turned together, camera and map show the same picture. The scene is square and looks the same from each side.
TEST_F(Environments, RotationMovesThePicture) {
  Builder b;
  add_floor(b, 2, b.material({.base_color = vec3(0.8f), .metallic = 0.5f, .roughness = 0.3f}));
  scene::Scene scene = load(b);
  const vec3 eye(1, 1, 3), eye_turned(3, 1, -1);  // +Z goes to +X, +X to -Z
  Request still{.size = {64, 36}, .camera = look(eye, vec3(0), 70), .settings = settings_for("none", false)};
  Request turned = still;
  turned.camera = look(eye_turned, vec3(0), 70);
  scene.environment = sky(content::hazy());
  const Shot a = shoot(scene, still), other = shoot(scene, turned);
  scene.environment = sky(content::hazy(), 256, 90);
  const Shot c = shoot(scene, turned);
  double moved = 0;
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 64; ++x) {
      for (const char* layer : {"", "ambient"})
        expect_close(value3(c, layer, {x, y}), value3(a, layer, {x, y}), 6e-3f, fmt::format("'{}' {},{}", layer, x, y));
      moved = std::max(moved, double(std::abs(other.value("", {x, y}) - a.value("", {x, y}))));
    }
  EXPECT_GT(moved, 0.1) << "control: without turning the map the picture differs";
}

// A map of one colour is that colour: every layer as with the constant environment.
TEST_F(Environments, WhiteFurnace) {
  Builder b;
  add_floor(b, 2, b.material({.base_color = vec3(0.8f, 0.6f, 0.4f), .metallic = 0.3f, .roughness = 0.5f}));
  b.box({0, 0.5f, 0}, vec3(0.5f), 0.4f, b.material({.base_color = vec3(0.9f), .metallic = 1, .roughness = 0.2f}));
  scene::Scene scene = load(b);
  const vec3 color(0.5f, 0.75f, 0.9f);
  const Request request{.size = {80, 45}, .camera = look({1.5f, 1.5f, 2}, {0, 0.3f, 0}, 60)};
  scene.environment.color = color;
  const Shot constant = shoot(scene, request);
  image::Image one{32, 16, 3, {}};
  for (int i = 0; i < 32 * 16; ++i) one.pixels.insert(one.pixels.end(), {color.x, color.y, color.z});
  const scene::Environment gradient{
      .kind = scene::EnvironmentKind::Gradient, .zenith = color, .horizon = color, .ground = color};
  for (const scene::Environment& environment : {scene::make_environment_map(one, "one", 1, 20), gradient}) {
    scene.environment = environment;
    const Shot shot = shoot(scene, request);
    for (const auto& [name, image] : constant.layers) {
      double worst = 0;
      for (size_t i = 0; i < image.pixels.size(); ++i)
        worst = std::max(worst, double(std::abs(shot.layer(name).pixels[i] - image.pixels[i])));
      EXPECT_LT(worst, 1e-3) << "layer '" << name << "'";
    }
  }
}

// Diffuse light on open faces of known normals, against the sum over the map's texels.
TEST_F(Environments, DiffuseIsIrradiance) {
  Builder b;
  b.box(vec3(0), vec3(0.5f), 0.3f, b.material({.base_color = vec3(0.6f, 0.7f, 0.8f)}));
  scene::Scene scene = load(b);
  scene.environment = sky(content::hazy());
  double worst = 0;
  for (const vec3 eye : {vec3(1, 2, 2), vec3(-2, -1, -1.5f)}) {
    const Shot shot =
        shoot(scene, {.size = {48, 48}, .camera = look(eye, vec3(0), 40), .settings = settings_for("none", true)});
    for (const ivec2 pixel : {ivec2(24, 24), ivec2(18, 30), ivec2(30, 30), ivec2(24, 16)}) {
      if (shot.value("depth", pixel) <= 0) continue;
      const vec3 n = value3(shot, "normal", pixel);
      vec3 sum(0);
      const scene::Environment& map = scene.environment;
      for (uint32_t y = 0; y < map.height; ++y)
        for (uint32_t x = 0; x < map.width; ++x) {
          const float latitude = pi * (0.5f - (float(y) + 0.5f) / float(map.height)),
                      longitude = 2 * pi * ((float(x) + 0.5f) / float(map.width) - 0.5f), c = std::cos(latitude);
          const vec3 d(c * std::cos(longitude), std::sin(latitude), c * std::sin(longitude));
          const float solid_angle = c * pi / float(map.height) * 2 * pi / float(map.width);
          sum += map.texels[y * map.width + x] * std::max(glm::dot(d, n), 0.0f) * solid_angle;
        }
      const vec3 expected = sum / pi * value3(shot, "albedo", pixel), got = value3(shot, "ambient", pixel);
      expect_close(got, expected, 0.03f, fmt::format("normal {} {} {}", n.x, n.y, n.z));
      expect_close(value3(shot, "", pixel), got, 2e-3f, "composed");
      for (int c = 0; c < 3; ++c) worst = std::max(worst, double(std::abs(got[c] / expected[c] - 1)));
    }
  }
  std::printf("diffuse light off by %.2f %% at most\n", 100 * worst);
}

// The map averaged by D(h) n.l with v = n, over all texels; the map itself for a mirror.
vec3 lobe(const scene::Environment& map, vec3 n, float roughness) {
  if (roughness == 0) return radiance(map, n);
  const float a2 = std::pow(roughness, 4.0f);
  glm::dvec3 sum(0);
  double weight = 0;
  for (uint32_t i = 0; i < map.texels.size(); ++i) {
    const float latitude = pi * (0.5f - (float(i / map.width) + 0.5f) / float(map.height)), c = std::cos(latitude),
                longitude = 2 * pi * ((float(i % map.width) + 0.5f) / float(map.width) - 0.5f);
    const float n_l = glm::dot(n, vec3(c * std::cos(longitude), std::sin(latitude), c * std::sin(longitude)));
    if (n_l <= 0) continue;
    const double d = (1 + double(n_l)) / 2 * (double(a2) - 1) + 1, w = n_l / (d * d) * c;
    sum += glm::dvec3(map.texels[i]) * w;
    weight += w;
  }
  return vec3(sum / weight);
}

glm::vec2 interpolate(const std::vector<glm::vec2>& table, float n_v, float roughness) {
  constexpr int side = passes::reflectance_side;
  const glm::vec2 at = glm::clamp(glm::vec2(n_v, roughness) * float(side) - 0.5f, 0.0f, float(side - 1));
  const ivec2 low = glm::min(ivec2(at), side - 2);
  const auto cell = [&](int x, int y) { return table[size_t((low.y + y) * side + low.x + x)]; };
  const glm::vec2 t = at - glm::vec2(low);
  return glm::mix(glm::mix(cell(0, 0), cell(1, 0), t.x), glm::mix(cell(0, 1), cell(1, 1), t.x), t.y);
}

// A metal reflects the map: sharp when polished, averaged by the lobe when rough.
TEST_F(Environments, SpecularIsThePrefilteredMap) {
  const glm::uvec2 size(64, 36);
  for (const float roughness : {0.0f, 0.35f, 0.8f}) {
    Builder b;
    add_floor(b, 20, b.material({.base_color = vec3(1), .metallic = 1, .roughness = roughness}));
    scene::Scene scene = load(b);
    scene.environment = sky(content::hazy());
    const uint32_t mips = uint32_t(scene::prefilter(scene.environment).mips.size());
    const scene::Camera camera = look({0, 1, 0}, {0.6f, 0.5f, -0.8f}, 60);
    const Shot shot = shoot(scene, {.size = size, .camera = camera, .settings = settings_for("none", false)});
    const std::vector<glm::vec2> table = passes::reflectance_table();
    for (const ivec2 pixel : {ivec2(5, 34), ivec2(32, 30), ivec2(60, 33), ivec2(20, 20), ivec2(45, 25)}) {
      ASSERT_GT(shot.value("depth", pixel), 0);
      const vec3 d = ray(camera, size, pixel), mirrored(d.x, -d.y, d.z);
      // The lobes of the two mips next to the roughness.
      const float mip = scene::prefilter_mip(roughness, mips), fine = std::floor(mip);
      const vec3 light = glm::mix(
          lobe(scene.environment, mirrored, scene::prefilter_roughness(uint32_t(fine), mips)),
          lobe(scene.environment, mirrored, scene::prefilter_roughness(std::min(uint32_t(fine) + 1, mips - 1), mips)),
          mip - fine);
      const glm::vec2 albedo = interpolate(table, -d.y, roughness);
      expect_close(value3(shot, "ambient", pixel), light * (albedo.x + albedo.y), 0.03f,
                   fmt::format("roughness {} at {},{}", roughness, pixel.x, pixel.y));
      if (roughness == 0)
        expect_close(value3(shot, "ambient", pixel), radiance(scene.environment, mirrored), 0.03f, "mirror");
    }
  }
}

// No technique gives bent normals yet, so one is made up: the direct light of a red sun reads as a direction along view
// x. Diffuse light then comes from there, whatever the normal.
TEST_F(Environments, BentNormalsTurnTheIrradiance) {
  Builder b;
  add_floor(b, 50, b.material({.base_color = vec3(1)}));
  b.directional_light({0, -1, 0}, 1, {1, 0, 0});
  scene::Scene scene = load(b);
  scene.environment = sky(content::hazy());
  passes::Renderer renderer(device(), scene);
  const passes::LightingPass lighting = passes::create_lighting(renderer.pipelines(), true);
  passes::EnvironmentMaps maps = passes::create_environment(device(), scene.environment);
  const passes::SceneTables tables(device(), scene);
  passes::FrameView view;
  view.camera = view.previous_camera = look({0, 2, 0}, {0.2f, 0, -1}, 50);
  view.size = {16, 16};
  vec3 lit[2];
  for (const bool bent : {false, true}) {
    graph::Graph graph;
    const passes::FrameOutputs out = renderer.build(graph, view, settings_for("vbgi", true));
    passes::GiResult gi = out.gi;
    gi.gi = gi.bent = gi.ambient = {};
    if (bent) gi.bent = out.direct.diffuse;
    const graph::Tex composed = add_composite(graph, lighting, out.gbuffer, out.direct, gi, tables, maps);
    graph.readback("lit", composed);
    graph.readback("direct", out.direct.diffuse);
    graph.readback("visibility", out.gi.visibility);
    renderer.executor().run(graph);
    const std::vector<graph::Readback> back = renderer.executor().take_readbacks();
    uint32_t channels = 0;
    const size_t pixel = 8 * 16 + 8;
    const auto rgb = [&](size_t i) {
      const std::vector<float> f = graph::to_floats(back[i], channels);
      return vec3(f[pixel * 4], f[pixel * 4 + 1], f[pixel * 4 + 2]);
    };
    const float open = graph::to_floats(back[2], channels)[pixel];
    lit[bent] = (rgb(0) - rgb(1)) / open;
  }
  const scene::Harmonics sh = scene::irradiance_over_pi(scene::project(scene.environment));
  const vec3 right = glm::normalize(glm::cross(view.camera.forward, vec3(0, 1, 0)));
  expect_close(lit[0], scene::evaluate(sh, {0, 1, 0}), 5e-3f, "straight");
  expect_close(lit[1], scene::evaluate(sh, right), 5e-3f, "bent");
  EXPECT_GT(glm::length(lit[0] - lit[1]), 0.05f);
  device().wait_idle();
  destroy(device(), maps);
}

// The sun in a mirror and in the background exceeds half's range: it is clamped, never infinite (shoot() looks).
TEST_F(Environments, VeryBrightSunStaysFinite) {
  Builder b;
  add_floor(b, 20, b.material({.base_color = vec3(1), .metallic = 1, .roughness = 0}));
  scene::Scene scene = load(b);
  content::Sky bright = content::afternoon();
  bright.to_sun = glm::normalize(vec3(0, 0.3f, -1));
  bright.sun = vec3(1e7f);
  bright.sun_radius_deg = 5;
  scene.environment = sky(bright, 128);
  const Shot shot = shoot(scene, {.size = {64, 64}, .camera = look({0, 1, 0}, {0, 1, -1}, 60)});
  float largest = 0;
  for (const float x : shot.layer("").pixels) largest = std::max(largest, x);
  EXPECT_EQ(largest, 65504);
}

TEST_F(Environments, AmbientWithoutATechnique) {
  scene::Scene scene = load(small_room());
  scene.environment = sky(content::hazy(), 64);
  const Shot shot =
      shoot(scene, {.size = {64, 36}, .camera = inside_small_room(), .settings = settings_for("none", false)});
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 64; ++x)
      expect_close(value3(shot, "", {x, y}),
                   value3(shot, "direct", {x, y}) + value3(shot, "ambient", {x, y}) + value3(shot, "emissive", {x, y}),
                   4e-3f, fmt::format("{},{}", x, y));
}

TEST_F(Environments, SwitchesChangeNothing) {
  using graph::LayoutPolicy;
  using graph::Poison;
  scene::Scene scene = load(small_room());
  scene.environment = sky(content::afternoon(), 64, 15);
  Request request{.size = {61, 35}, .camera = inside_small_room(), .frames = 2, .scan = false};
  request.camera.position.z = 3;  // outside, the background in view
  const Shot expected = shoot(scene, request);
  for (const graph::ExecutorOptions& options :
       {graph::ExecutorOptions{},
        {.alias = false},
        {.layouts = LayoutPolicy::General},
        {.merge_barriers = false},
        {.poison = Poison::Frame},
        {.poison = Poison::Handover},
        {.order_seed = 5},
        {.layouts = LayoutPolicy::General, .order_seed = 6, .poison = Poison::Handover}}) {
    request.graph = options;
    const Shot shot = shoot(scene, request);
    EXPECT_EQ(shot.picture, expected.picture);
    for (const auto& [name, image] : expected.layers) EXPECT_EQ(shot.layer(name).pixels, image.pixels) << name;
  }
}

}  // namespace
}  // namespace nf::test
