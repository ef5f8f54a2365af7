// What an editor changes in a scene between two frames: lights come and go, the environment is replaced, materials are
// scaled. The next picture is that of a renderer which never knew anything else.
#include "gpu_fixture.h"
#include "reference/reference.h"
#include "scene/update.h"

namespace nf::test {
namespace {

using glm::vec3;

class Edit : public GpuTest {
 protected:
  static std::vector<std::byte> picture(passes::Renderer& renderer, const passes::FrameSettings& settings = {}) {
    passes::FrameView view = view_of_small_room({64, 36});
    view.averaged = false;
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("picture", renderer.add_picture(graph, out, settings));
    renderer.executor().run(graph);
    return renderer.executor().take_readbacks().at(0).texels;
  }
  static std::vector<std::byte> fresh(const scene::Scene& scene, const passes::FrameSettings& settings = {}) {
    passes::Renderer renderer(device(), scene);
    return picture(renderer, settings);
  }
};

scene::PunctualLight lamp(int i, float range) {
  return {.position = {0.7f * std::sin(float(i)), 0.5f + 0.1f * float(i % 10), 0.7f * std::cos(float(i))},
          .color = {0.2f + 0.1f * float(i % 7), 0.5f, 0.9f},
          .intensity = 0.3f,
          .range = range};
}

TEST_F(Edit, LightsComeAndGo) {
  scene::Scene scene = load(small_room());
  passes::Renderer renderer(device(), scene);
  passes::FrameSettings settings;
  settings.shadow.resolution = 128;
  settings.shadow.tile_resolution = 64;
  const auto check = [&](const char* what, bool changes = true) {
    static std::vector<std::byte> last;
    renderer.update(scene::update(scene));
    for (int frame = 0; frame < 2; ++frame)  // both sides of what is written anew for every frame
      EXPECT_EQ(picture(renderer, settings), fresh(scene, settings)) << what << ", frame " << frame;
    const std::vector<std::byte> now = picture(renderer, settings);
    EXPECT_EQ(now != last, changes) << what;
    last = now;
  };
  check("as it was");
  scene.punctual.push_back(lamp(1, 0));
  check("a lamp more");
  for (int i = 2; i < 14; ++i) scene.punctual.push_back(lamp(i, 1.5f));
  check("so many that they are looked up in a grid");
  scene.punctual.push_back(
      {.position = {0, 1.8f, 0}, .direction = {0, -1, 0}, .intensity = 6, .inner_cone = 0.2f, .outer_cone = 0.5f});
  check("a spot light");
  scene.punctual.erase(scene.punctual.begin(), scene.punctual.begin() + 5);
  check("five fewer, and the others have moved up");
  scene.directional.push_back({.direction = {0.5f, -1, 0}, .irradiance = 1});
  check("a second sun");
  scene.directional.erase(scene.directional.begin());
  check("without the first");
  scene.directional.clear();
  check("none");
  scene.punctual.clear();
  check("no lamps");
  check("nothing done", false);
  scene.directional.push_back({.direction = {0.2f, -1, 0.1f}, .irradiance = 2});
  scene.punctual.push_back(lamp(3, 0));
  check("one of each again");
}

TEST_F(Edit, EnvironmentsAreReplaced) {
  content::Builder open;
  const auto white = open.material({.base_color = vec3(0.7f)});
  open.quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, white);
  open.box({0.2f, 0.5f, -0.2f}, vec3(0.4f), 0.4f,
           open.material({.base_color = vec3(0.8f), .metallic = 1, .roughness = 0.2f}));
  scene::Scene scene = load(open);
  image::Image sky{16, 8, 3, {}};
  for (uint32_t i = 0; i < 16 * 8; ++i)
    for (uint32_t c = 0; c < 3; ++c) sky.pixels.push_back(0.05f * float(i % 16) + 0.2f * float(c));
  const scene::Environment constant{.color = {0.3f, 0.4f, 0.5f}}, dark{},
      gradient{.kind = scene::EnvironmentKind::Gradient,
               .zenith = {0.1f, 0.2f, 0.8f},
               .horizon = vec3(0.9f),
               .ground = vec3(0.1f)},
      map = scene::make_environment_map(sky, "sky"), turned = scene::make_environment_map(sky, "sky", 0.5f, 120);
  for (const char* technique : {"vbgi", "none"}) {
    passes::FrameSettings settings;
    settings.technique = &passes::find_technique(technique);
    scene.environment = constant;
    passes::Renderer renderer(device(), scene);
    std::vector<std::byte> last;
    gpu::DeviceCounts counts[3];
    for (gpu::DeviceCounts& count : counts) {
      for (const scene::Environment* next : {&gradient, &map, &turned, &dark, &map, &constant}) {
        scene.environment = *next;
        renderer.update_environment();
        const std::vector<std::byte> now = picture(renderer, settings);
        if (&count == counts) {
          ASSERT_EQ(now, fresh(scene, settings));
        }
        EXPECT_NE(now, last);
        last = now;
      }
      count = device().counts;
    }
    EXPECT_EQ(counts[1], counts[2]) << technique << ": nothing piles up";
  }
}

// Against scenes whose materials were made so, and against the path tracer.
TEST_F(Edit, MaterialsAreScaled) {
  const auto room = [](float albedo, float emissive) {
    content::Builder b;
    b.room({0, 1, 0}, vec3(1, 1, 1), b.material({.base_color = vec3(0.4f, 0.3f, 0.2f) * albedo}));
    b.box({0.3f, 0.3f, -0.2f}, vec3(0.3f), 0.4f,
          b.material(
              {.base_color = glm::min(vec3(0.9f, 0.3f, 0.2f) * albedo, vec3(1)), .metallic = 0.5f, .roughness = 0.3f}));
    b.quad({-0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, 0.3f}, {-0.3f, 1.98f, 0.3f},
           b.material({.base_color = vec3(0), .emissive = vec3(8, 6, 4) * emissive}));
    b.point_light({-0.5f, 1.5f, 0.4f}, 1);
    return b;
  };
  const scene::Scene plain = load(room(1, 1));
  Request request{.size = {48, 27}, .camera = look({-0.7f, 0.4f, 0.8f}, {0.2f, 1.4f, -0.3f}, 80), .scan = false};
  request.settings.technique = &passes::find_technique("vbgi");
  const Shot before = shoot(plain, request);
  request.settings.material.albedo_scale = 1.5f;
  request.settings.material.emissive_scale = 0.25f;
  const Shot scaled = shoot(plain, request);
  request.settings.material = {};
  const Shot made = shoot(load(room(1.5f, 0.25f)), request);
  for (const char* name : {"albedo", "emissive", "direct", "gi", ""}) {
    const image::Difference apart = image::difference(scaled.layer(name), made.layer(name), 0);
    EXPECT_LT(apart.max_abs, 4e-3) << "layer '" << name << "' at " << apart.worst_x << "," << apart.worst_y;
    EXPECT_GT(image::difference(scaled.layer(name), before.layer(name), 0).max_abs, 0.02) << name;
  }

  reference::Settings settings{.camera = request.camera, .size = {24, 14}, .bounces = 3};
  const auto trace = [&](const scene::Scene& scene, float albedo, float emissive) {
    settings.albedo_scale = albedo;
    settings.emissive_scale = emissive;
    reference::Tracer tracer(scene, settings, {"", "albedo", "emissive", "gi"});
    tracer.sample(32);
    return tracer.layers();
  };
  const auto a = trace(plain, 1.5f, 0.25f), b = trace(load(room(1.5f, 0.25f)), 1, 1), c = trace(plain, 1, 1);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT(image::difference(a[i].image, b[i].image, 0).max_abs, 1e-4) << "traced layer '" << a[i].name << "'";
    EXPECT_GT(image::difference(a[i].image, c[i].image, 0).max_abs, 0.03) << a[i].name;
  }
}

}  // namespace
}  // namespace nf::test
