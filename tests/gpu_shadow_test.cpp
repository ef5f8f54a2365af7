// Direct light and shadows on the device against values known in advance: cones, shadow edges, planes that must stay
// lit, walls that must stay dark, penumbrae, many lights.
#include "gpu_fixture.h"

namespace nf::test {
namespace {

using content::Builder;
using glm::ivec2;
using glm::vec3;

constexpr float pi = 3.14159265358979f;

// Frames of one scene whose lights and settings change in between.
class Shadow : public GpuTest {
 protected:
  void SetUp() override {
    settings.technique = &passes::find_technique("none");
    settings.material.lambert = 1;
  }
  void open(const Builder& builder, const scene::Camera& camera, glm::uvec2 size) {
    scene = load(builder);
    view = {.camera = camera, .previous_camera = camera, .size = size};
    renderer = std::make_unique<passes::Renderer>(device(), scene);
  }
  void TearDown() override {
    renderer.reset();
    GpuTest::TearDown();
  }
  std::map<std::string, image::Image> render(uint32_t frames = 1) {
    std::map<std::string, image::Image> layers;
    for (view.frame_index = 0; view.frame_index < frames; ++view.frame_index) {
      graph::Graph graph(renderer->executor().histories());
      const passes::FrameOutputs outputs = renderer->build(graph, view, settings);
      std::vector<std::string> names;
      for (const passes::Aov& aov : passes::aovs()) {
        const std::string name = aov.name;
        if (name != "direct" && name != "direct_diffuse" && name != "position" && name != "depth") continue;
        graph.readback("layer", renderer->add_layer(graph, outputs, aov, frames > 1 ? int64_t(view.frame_index) : -1));
        names.push_back(name);
      }
      renderer->executor().run(graph);
      for (const graph::PassTime& pass : renderer->executor().finish().passes)
        if (std::string(pass.name) == "direct.light") direct_ms = pass.ms;
      const auto readbacks = renderer->executor().take_readbacks();
      for (size_t i = 0; i < names.size(); ++i) {
        image::Image image{view.size.x, view.size.y, 0, {}};
        image.pixels = graph::to_floats(readbacks[i], image.channels);
        layers[names[i]] = std::move(image);
      }
    }
    return layers;
  }
  // Calls visit(pixel, world position, outgoing diffuse light, red) for every pixel that shows something.
  template <class Visit>
  void each_pixel(std::map<std::string, image::Image>& layers, const Visit& visit) {
    for (uint32_t y = 0; y < view.size.y; ++y)
      for (uint32_t x = 0; x < view.size.x; ++x) {
        if (layers["depth"].at(x, y, 0) <= 0) continue;
        const image::Image& p = layers["position"];
        visit(ivec2(x, y), vec3(p.at(x, y, 0), p.at(x, y, 1), p.at(x, y, 2)), layers["direct_diffuse"].at(x, y, 0));
      }
  }

  scene::Scene scene;
  passes::FrameView view;
  passes::FrameSettings settings;
  std::unique_ptr<passes::Renderer> renderer;
  double direct_ms = 0;  // of the last frame
};

void add_floor(Builder& b, float half_size, content::MaterialId material) {
  b.quad({-half_size, 0, half_size}, {half_size, 0, half_size}, {half_size, 0, -half_size}, {-half_size, 0, -half_size},
         material);
}

vec3 sun_from(float elevation_deg, float azimuth_deg) {
  const float e = glm::radians(elevation_deg), a = glm::radians(azimuth_deg);
  return -vec3(std::cos(e) * std::cos(a), std::sin(e), std::cos(e) * std::sin(a));
}

// Side of a texel of the only cascade, in metres.
float sun_texel(const scene::Scene& scene, const passes::FrameView& view, const passes::ShadowParams& params) {
  const passes::SunBlock sun = passes::fit_sun(view.camera, view.size, scene.bounds, scene.directional[0], params);
  EXPECT_EQ(sun.cascade_count, 1u);
  return 2 / (sun.cascade0.z * float(params.resolution));
}

// A plane, and boxes beside it that only stretch the map's depth. It must be lit wholly and evenly, from any side.
TEST_F(Shadow, ALitPlaneHasNoAcneFrom1To89Degrees) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  add_floor(b, 20, white);
  b.box({0, -30, 0}, vec3(2), 0.3f, white);
  b.directional_light({0, -1, 0}, pi);
  open(b, look({1, 3, 4}, {0, 0, 0}, 70), {96, 54});
  settings.shadow.resolution = 512;
  int shadowed = 0;
  for (int elevation = 1; elevation <= 89; ++elevation) {
    scene.directional[0].direction = sun_from(float(elevation), float(elevation * 37));
    auto layers = render();
    const float expected = std::sin(glm::radians(float(elevation)));
    each_pixel(layers, [&](ivec2 pixel, vec3 at, float light) {
      if (std::abs(at.x) > 19 || std::abs(at.z) > 19 || at.y < -0.1f) return;
      EXPECT_NEAR(light, expected, 1e-3f) << elevation << " degrees, pixel " << pixel.x << "," << pixel.y;
      shadowed += light < expected - 1e-3f;
    });
  }
  EXPECT_EQ(shadowed, 0);
}

// The shadow of a box's top edge, looked down on: where the light comes back to a half.
TEST_F(Shadow, ABoxShadowEndsWhereItShould) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  add_floor(b, 4, white);
  b.box({0, 0.5f, 0}, vec3(0.5f), 0, white);
  b.directional_light({1, -1, 0}, pi);
  open(b, look({1.5f, 6, 0}, {1.5f, 0, 0}, 50, {0, 0, -1}), {320, 180});
  settings.shadow.cascades = 1;
  for (const int resolution : {256, 1024})
    for (const float elevation : {30.0f, 45.0f, 60.0f}) {
      settings.shadow.resolution = resolution;
      scene.directional[0].direction = sun_from(elevation, 180);
      auto layers = render(16);
      const float texel = sun_texel(scene, view, settings.shadow), e = glm::radians(elevation);
      const float tip = 0.5f + 1 / std::tan(e), full = std::sin(e);
      // Shares of light summed over a strip about the edge give its place.
      double lit = 0, length = 0, footprint = 0;
      float beyond = 1, within = 0;
      each_pixel(layers, [&](ivec2, vec3 at, float light) {
        if (at.y > 0.01f || std::abs(at.z) > 0.3f || at.x < 0.55f || std::abs(at.x - tip) > 0.4f) return;
        const float share = light / full;
        lit += share, length += 1;
        footprint = std::max(footprint, double(std::abs(at.x - tip)));
        // In the map, across the light.
        const float distance = (at.x - tip) * std::sin(e);
        if (distance > 3 * texel) beyond = std::min(beyond, share);
        if (distance < -3 * texel) within = std::max(within, share);
      });
      ASSERT_GT(length, 100);
      const float low = std::max(tip - 0.4f, 0.55f), high = tip + 0.4f;
      const double edge = high - lit / length * (high - low);
      std::printf("resolution %d, %g degrees: edge off by %+.2f texels of %.4f m\n", resolution, double(elevation),
                  (edge - double(tip)) * std::sin(double(e)) / double(texel), double(texel));
      EXPECT_NEAR((edge - double(tip)) * std::sin(double(e)), 0, double(texel) + 0.004)
          << "half a pixel is 0.013 m wide";
      EXPECT_NEAR(beyond, 1, 2e-3f);
      EXPECT_EQ(within, 0);
    }
}

// Behind a thin wall the floor is dark from two texels on, counted in the map, across the light.
TEST_F(Shadow, NoLightLeaksAtAWallsFoot) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  add_floor(b, 4, white);
  b.quad({-3, 0, 0}, {3, 0, 0}, {3, 3, 0}, {-3, 3, 0}, white);
  b.directional_light({0, -1, 1}, pi);
  open(b, look({0, 1.2f, 1.5f}, {0, 0, 0}, 40), {160, 90});
  settings.shadow.cascades = 1;
  int dark = 0;
  for (const int resolution : {128, 512})
    for (int elevation = 20; elevation <= 80; elevation += 5)
      for (const float azimuth : {-90.0f, -60.0f}) {
        settings.shadow.resolution = resolution;
        scene.directional[0].direction = sun_from(float(elevation), azimuth);
        auto layers = render();
        const float texel = sun_texel(scene, view, settings.shadow), e = glm::radians(float(elevation));
        const float reach = 3 / std::tan(e) * std::abs(std::sin(glm::radians(azimuth)));
        each_pixel(layers, [&](ivec2, vec3 at, float light) {
          if (at.y > 1e-3f || at.z < 2 * texel / std::sin(e) || at.z > reach - 4 * texel / std::sin(e) ||
              std::abs(at.x) > 0.8f)
            return;
          EXPECT_EQ(light, 0) << resolution << " px, " << elevation << " degrees, " << at.z / texel << " texels";
          ++dark;
        });
      }
  EXPECT_GT(dark, 10000);
  // The control: the wall is seen from behind, so that it casts no shadow unless both sides do.
  settings.shadow.two_sided = 0;
  auto layers = render();
  each_pixel(layers, [&](ivec2, vec3 at, float light) {
    if (at.y > 1e-3f || std::abs(at.x) > 0.8f || at.z < 0.1f) return;
    EXPECT_GT(light, 0.5f);
  });
}

// A sun of 2 degrees and an edge 2 m above the floor: the light grows over 2 m x the sun's width as the share of a disk
// that a straight line has uncovered does.
TEST_F(Shadow, ASunWithSizeHasAPenumbra) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  add_floor(b, 3, white);
  b.quad({-2, 2, 2}, {0, 2, 2}, {0, 2, -2}, {-2, 2, -2}, white);
  b.directional_light({0, -1, 0}, pi);
  open(b, look({0, 1.6f, 0}, {0.001f, 0, 0}, 40, {0, 0, -1}), {128, 96});
  scene.directional[0].angle_deg = 4;
  settings.shadow.cascades = 1;
  settings.shadow.most_filter = 64;
  settings.shadow.samples = settings.shadow.search_samples = 16;
  auto layers = render(16);
  const float radius = 2 * std::tan(glm::radians(2.0f));
  double error = 0, worst = 0, count = 0;
  each_pixel(layers, [&](ivec2, vec3 at, float light) {
    if (std::abs(at.x) > 0.2f || std::abs(at.z) > 0.2f) return;
    const double t = std::clamp(double(at.x / radius), -1.0, 1.0);
    const double expected = 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / double(pi);
    error += double(light) - expected;
    worst = std::max(worst, std::abs(double(light) - expected));
    count += 1;
  });
  ASSERT_GT(count, 1000);
  std::printf("penumbra of %.3f m: mean error %+.4f, greatest %.3f\n", 2 * double(radius), error / count, worst);
  EXPECT_NEAR(error / count, 0, 0.01);
  EXPECT_LT(worst, 0.12);
}

// The same of a lamp: a ball of 0.1 m at 3 m, over an edge at 1 m, from behind which a floor point at x sees the part
// of the lamp that lies beyond -2x.
TEST_F(Shadow, ALampWithSizeHasAPenumbra) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  add_floor(b, 3, white);
  b.quad({-1, 1, 1}, {0, 1, 1}, {0, 1, -1}, {-1, 1, -1}, white);
  b.spot_light({0, 3, 0}, {0, -1, 0}, 9 * pi, 20, 25);
  open(b, look({0, 0.9f, 0}, {0.001f, 0, 0}, 40, {0, 0, -1}), {128, 96});
  scene.punctual[0].radius = 0.1f;
  settings.shadow.samples = settings.shadow.search_samples = 16;
  auto layers = render(16);
  double error = 0, worst = 0, count = 0;
  each_pixel(layers, [&](ivec2, vec3 at, float light) {
    if (std::abs(at.x) > 0.15f || std::abs(at.z) > 0.15f) return;
    const double t = std::clamp(double(2 * at.x / 0.1f), -1.0, 1.0);
    const double full = 81 / std::pow(9 + double(at.x * at.x + at.z * at.z), 2);
    const double off = double(light) / full - 0.5 - (t * std::sqrt(1 - t * t) + std::asin(t)) / double(pi);
    error += off, count += 1;
    worst = std::max(worst, std::abs(off));
  });
  ASSERT_GT(count, 1000);
  std::printf("penumbra of 0.100 m: mean error %+.4f, greatest %.3f\n", error / count, worst);
  EXPECT_NEAR(error / count, 0, 0.01);
  EXPECT_LT(worst, 0.12);
}

TEST_F(Shadow, ASpotLightsItsConeAndCastsShadows) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  add_floor(b, 4, white);
  b.box({0, 1, 0}, {0.2f, 0.02f, 0.2f}, 0, white);
  b.spot_light({0, 3, 0}, {0, -1, 0}, 9, 15, 30);
  open(b, look({0, 0.9f, 3.2f}, {0, 0, 0}, 60), {160, 90});
  auto layers = render();
  const float inner = std::cos(glm::radians(15.0f)), outer = std::cos(glm::radians(30.0f));
  int lit = 0, dark = 0, outside = 0;
  each_pixel(layers, [&](ivec2, vec3 at, float light) {
    if (at.y > 0.01f) return;
    const float d2 = 9 + at.x * at.x + at.z * at.z, cosine = 3 / std::sqrt(d2);
    const float cone = std::clamp((cosine - outer) / (inner - outer), 0.0f, 1.0f);
    const float expected = 9 / pi * cone * cone * cosine / d2;
    // The plate's shadow: its upper side's edges at 1.02 m are seen at 3 / 1.98 of their size, the lower side's at
    // less.
    const float side = std::max(std::abs(at.x), std::abs(at.z)), edge = 0.2f * 3 / 1.98f;
    if (side < edge - 0.03f) {
      EXPECT_EQ(light, 0) << at.x << "," << at.z;
      ++dark;
    } else if (side > edge + 0.03f) {
      EXPECT_NEAR(light, expected, 1e-3f * expected + 2e-4f) << at.x << "," << at.z;
      ++(expected > 0 ? lit : outside);
    }
  });
  EXPECT_GT(dark, 50);
  EXPECT_GT(lit, 500);
  EXPECT_GT(outside, 500);
}

// All six tiles, their seams, and their corners: a point light in a closed room lights every wall by the inverse
// square.
TEST_F(Shadow, APointLightFillsARoomWithoutSeams) {
  Builder b;
  b.room({0, 1, 0}, {1.5f, 1, 1.2f}, b.material({.base_color = vec3(1)}));
  const vec3 lamp(0.3f, 1.1f, -0.2f);
  b.point_light(lamp, 5);
  open(b, look({0, 1, 0}, {1, 1, 0}, 100), {96, 96});
  int checked = 0;
  for (const vec3 forward :
       {vec3(1, 0, 0), vec3(-1, 0.2f, 0), vec3(0, 0, 1), vec3(0.2f, 0, -1), vec3(0, 1, 0), vec3(0, -1, 0)}) {
    view.camera = view.previous_camera =
        look({0, 1, 0}, vec3(0, 1, 0) + forward, 100, std::abs(forward.y) > 0.9f ? vec3(0, 0, 1) : vec3(0, 1, 0));
    auto layers = render();
    each_pixel(layers, [&](ivec2 pixel, vec3 at, float light) {
      const vec3 inside = glm::abs((at - vec3(0, 1, 0)) / vec3(1.5f, 1, 1.2f));
      const int axis = inside.x > inside.y && inside.x > inside.z ? 0 : inside.y > inside.z ? 1 : 2;
      // Along the room's own edges the filter reaches around the corner.
      if (inside[(axis + 1) % 3] > 0.97f || inside[(axis + 2) % 3] > 0.97f) return;
      const vec3 to = lamp - at;
      const float expected = 5 / pi * std::abs(to[axis]) / std::pow(glm::dot(to, to), 1.5f);
      EXPECT_NEAR(light / expected, 1, 1.5e-3f)
          << pixel.x << "," << pixel.y << " at " << at.x << " " << at.y << " " << at.z;
      ++checked;
    });
  }
  EXPECT_GT(checked, 30000);
}

// Lights without a map are shadowed by the depth buffer: a second sun, and a lamp when there are no tiles. The wall's
// height and distance say where its shadow ends; without samples there is none.
TEST_F(Shadow, LightsWithoutAMapAreShadowedByTheScreen) {
  for (const bool sun : {true, false}) {
    Builder b;
    const auto white = b.material({.base_color = vec3(1)});
    add_floor(b, 8, white);
    b.box({0, 0.25f, 0}, {0.1f, 0.25f, 3}, 0, white);  // half a metre high, its far side at x = 0.1
    const vec3 lamp(-2, 2, 0);
    if (sun) {
      b.directional_light({0, -1, 0}, 1e-6f);  // the first has cascades
      b.directional_light({1, -1, 0}, 1);
    } else {
      b.point_light(lamp, 5);
      settings.shadow.tiles = 0;
    }
    settings.shadow.screen_length = 1.5f, settings.shadow.screen_thickness = 0.3f;
    open(b, look({0.3f, 3, 0.4f}, {0.3f, 0, 0}, 60), {160, 90});
    for (const int samples : {0, 48}) {
      settings.shadow.screen_samples = samples;
      auto layers = render();
      int dark = 0, lit = 0, wrong = 0;
      each_pixel(layers, [&](ivec2, vec3 at, float light) {
        if (at.y > 0.01f || std::abs(at.z) > 0.7f || at.x < -1 || at.x > 1.2f) return;
        // The top edge that ends the shadow is at (-0.1 or 0.1, 0.5): the far one.
        const float end = sun ? 0.6f : 0.1f + 2.1f / 1.5f * 0.5f;
        if (std::abs(at.x - end) < 0.05f || std::abs(at.x - 0.1f) < 0.05f || std::abs(at.x + 0.1f) < 0.05f) return;
        const bool shadowed = samples > 0 && at.x > 0.1f && at.x < end;
        (shadowed ? dark : lit) += 1;
        if (shadowed != (light < 1e-4f)) ++wrong;
      });
      EXPECT_GT(lit, 1000) << sun;
      EXPECT_GE(dark, samples > 0 ? 300 : 0) << sun;
      EXPECT_LE(wrong, (dark + lit) / 200) << (sun ? "second sun" : "lamp") << ", " << samples << " samples";
    }
  }
}

// 500 lights with a range, cones among them: the grid gives the bytes of the loop over all.
Builder many_lights() {
  Builder b;
  const auto white = b.material({.base_color = vec3(0.8f), .roughness = 0.4f});
  add_floor(b, 20, white);
  for (int i = 0; i < 12; ++i) b.box({float(i % 4) * 8 - 12, 1, float(i / 4) * 8 - 12}, vec3(1), float(i), white);
  b.directional_light({0.3f, -1, 0.2f}, 0.2f);
  b.point_light({0, 6, 0}, 4);
  return b;
}

void scatter_lights(scene::Scene& scene, uint32_t count) {
  const auto at = [](uint32_t i, uint32_t salt) {
    return float((i * 2654435761u + salt * 40503u) >> 8 & 0xffff) / 65536;
  };
  for (uint32_t i = 0; i < count; ++i) {
    scene::PunctualLight l;
    l.position = {at(i, 1) * 40 - 20, 0.3f + at(i, 2) * 2, at(i, 3) * 40 - 20};
    l.direction = glm::normalize(vec3(at(i, 4) - 0.5f, -1, at(i, 5) - 0.5f));
    l.color = {at(i, 6), at(i, 7), at(i, 8)};
    l.intensity = 2;
    l.range = 1 + 2 * at(i, 9);
    if (i % 3 == 0) l.inner_cone = 0.3f, l.outer_cone = 0.4f + at(i, 10);
    scene.punctual.push_back(l);
  }
}

TEST_F(Shadow, TheGridOfLightsChangesNoByte) {
  open(many_lights(), look({0, 4, 14}, {0, 0, 0}, 65), {160, 90});
  scatter_lights(scene, 500);
  settings.material.lambert = 0;
  settings.shadow.tile_resolution = 128;
  // The second time, so that no shader is compiled in it.
  const auto timed = [&](int grid, double& ms) {
    settings.lights.grid = grid;
    render();
    auto layers = render();
    ms = direct_ms;
    return layers;
  };
  double all_ms = 0, grid_ms = 0;
  const auto all = timed(1, all_ms), grid = timed(2, grid_ms);
  std::printf("%zu lights, %ux%u: direct.light %.2f ms in a loop over all, %.2f ms with the grid\n",
              scene.punctual.size(), view.size.x, view.size.y, all_ms, grid_ms);
  EXPECT_EQ(all.at("direct").pixels, grid.at("direct").pixels);
  EXPECT_EQ(all.at("direct_diffuse").pixels, grid.at("direct_diffuse").pixels);
  scene.punctual.resize(scene.punctual.size() - 100);
  EXPECT_NE(all.at("direct").pixels, render().at("direct").pixels) << "control: the lights count";
}

TEST_F(Shadow, SwitchesOfTheGraphChangeNothing) {
  open(many_lights(), look({0, 4, 14}, {0, 0, 0}, 65), {96, 54});
  scatter_lights(scene, 40);
  settings.shadow.resolution = 256;
  settings.shadow.tile_resolution = 128;
  const auto with = [&](const graph::ExecutorOptions& options) {
    renderer->executor().options = options;
    renderer->executor().invalidate_histories();
    return render().at("direct").pixels;
  };
  const auto expected = with({});
  EXPECT_EQ(with({.alias = false}), expected);
  EXPECT_EQ(with({.layouts = graph::LayoutPolicy::General}), expected);
  EXPECT_EQ(with({.merge_barriers = false}), expected);
  EXPECT_EQ(with({.poison = graph::Poison::Frame}), expected);
  EXPECT_EQ(with({.poison = graph::Poison::Handover}), expected);
  for (uint64_t seed = 1; seed <= 8; ++seed) EXPECT_EQ(with({.order_seed = seed}), expected) << "order " << seed;
  settings.shadow.enabled = 0;
  EXPECT_NE(with({}), expected) << "control: shadows are seen";
}

}  // namespace
}  // namespace nf::test
