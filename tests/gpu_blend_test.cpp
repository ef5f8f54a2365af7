// Blended surfaces over the frame: their order, their light, their shadows, and that they are in nothing else; and the
// textures of KHR_materials_specular.
#include "gpu_fixture.h"

namespace nf::test {
namespace {

using content::Builder;
using glm::ivec2;
using glm::vec3;
using glm::vec4;

constexpr float pi = 3.14159265358979f;

class Blend : public GpuTest {
 protected:
  void SetUp() override {
    request.size = {96, 54};
    request.settings.technique = &passes::find_technique("none");
  }
  vec3 color(const Shot& shot, ivec2 pixel) {
    return {shot.value("", pixel, 0), shot.value("", pixel, 1), shot.value("", pixel, 2)};
  }
  // Makes a material blended, shown as it is.
  static void glass(scene::Scene& scene, uint32_t material, vec4 color) {
    scene::Material& m = scene.materials[material];
    m.alpha = scene::AlphaMode::Blend;
    m.base_color = color;
    m.unlit = m.double_sided = true;
  }
  Request request;
};

void expect_near(vec3 a, vec3 b, float tolerance, const char* what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << what << ", channel " << c;
}

// An upright square of side 2 * half that looks to +z.
void add_pane(Builder& b, float z, float half, content::MaterialId material) {
  b.quad({-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}, material);
}

TEST_F(Blend, PanesAreMixedBackToFrontFromEitherSide) {
  Builder b;
  const auto first = b.material({}), second = b.material({}), wall = b.material({});
  // Declared in neither order of depth, one object each.
  b.object("near");
  add_pane(b, 1, 1, first);
  b.object("far");
  add_pane(b, -1, 1, second);
  b.object("middle");
  add_pane(b, 0, 1, wall);
  scene::Scene scene = load(b);
  const vec4 c0(0.9f, 0.1f, 0.2f, 0.25f), c1(0.1f, 0.8f, 0.3f, 0.5f), c2(0.2f, 0.3f, 0.9f, 0.75f);
  glass(scene, 0, c0), glass(scene, 1, c1), glass(scene, 2, c2);
  const vec3 behind(0.5f, 0.6f, 0.7f);
  scene.environment.color = behind;
  const auto over = [](vec4 front, vec3 back) { return vec3(front) * front.w + back * (1 - front.w); };
  const vec3 from_front = over(c0, over(c2, over(c1, behind))), from_back = over(c1, over(c2, over(c0, behind)));
  ASSERT_GT(glm::length(from_front - from_back), 0.1f) << "control: the order matters";
  for (const float side : {1.0f, -1.0f}) {
    request.camera = look({0, 0, 4 * side}, {0, 0, 0}, 30);
    const Shot shot = shoot(scene, request);
    expect_near(color(shot, {48, 27}), side > 0 ? from_front : from_back, 2e-3f, side > 0 ? "front" : "back");
    expect_near(color(shot, {2, 27}), behind, 1e-3f, "beside");
  }
}

TEST_F(Blend, IsHiddenByWhatIsOpaqueAndInNoOtherLayer) {
  Builder b;
  const auto white = b.material({.base_color = vec3(0.7f)}), pane = b.material({});
  b.object("room");
  b.quad({-3, -1, 3}, {3, -1, 3}, {3, -1, -3}, {-3, -1, -3}, white);
  b.box({-0.5f, 0, 1}, vec3(0.4f), 0, white);
  b.object("pane");
  add_pane(b, 0, 1, pane);
  b.directional_light({0.2f, -1, -0.3f}, 2);
  scene::Scene scene = load(b);
  scene.environment.color = vec3(0.3f);
  request.camera = look({0, 0, 4}, {0, 0, 0}, 40);
  request.settings.technique = &passes::find_technique("vbgi");
  request.settings.shadow.enabled = 0;
  glass(scene, 1, {0, 1, 0, 0});
  const Shot without = shoot(scene, request);
  scene.materials[1].base_color.w = 0.5f;
  const Shot with = shoot(scene, request);
  for (const auto& [name, layer] : without.layers) {
    if (name.empty()) continue;
    EXPECT_EQ(layer.pixels, with.layer(name).pixels) << name;
  }
  // Half of what is behind it; the box stands before it.
  const vec3 open = color(without, {56, 22}), covered = color(with, {56, 22});
  expect_near(covered, open * 0.5f + vec3(0, 0.5f, 0), 2e-3f, "pane");
  expect_near(color(with, {38, 27}), color(without, {38, 27}), 0, "box");
  // As a cut-out it is a surface like any other: here below alpha 0.5, and there above.
  request.settings.material.blend = 1;
  scene.materials[1].base_color.w = 0.45f;
  EXPECT_EQ(shoot(scene, request).layer("").pixels, without.layer("").pixels);
  scene.materials[1].base_color.w = 0.55f;
  EXPECT_NEAR(shoot(scene, request).value("depth", {56, 22}), 4, 1e-3f);
}

// Opaque by its alpha, a blended box must look as an opaque one: one set of lighting functions, with every kind of
// light.
TEST_F(Blend, IsLitAsAnOpaqueSurface) {
  Builder b;
  const auto white = b.material({.base_color = vec3(0.7f)});
  const auto metal = b.material({.base_color = vec3(0.8f, 0.5f, 0.3f), .metallic = 0.6f, .roughness = 0.35f});
  b.object("floor");
  b.quad({-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, white);
  b.box({-0.9f, 1.2f, 0.8f}, vec3(0.25f), 0.3f, white);
  b.object("box");
  b.box({0, 0.5f, 0}, vec3(0.5f), 0.6f, metal);
  b.directional_light({0.8f, -1, -0.6f}, 2);
  b.point_light({0.8f, 1.4f, 1}, 1.5f);
  b.spot_light({-1.5f, 2, 1.5f}, {1, -1, -1}, 6, 15, 30);
  scene::Scene scene = load(b);
  scene.environment.kind = scene::EnvironmentKind::Gradient;
  scene.environment.zenith = {0.2f, 0.3f, 0.6f}, scene.environment.horizon = vec3(0.7f),
  scene.environment.ground = vec3(0.1f);
  for (scene::PunctualLight& l : scene.punctual) l.range = 20;
  request.camera = look({0.3f, 1.3f, 2.6f}, {0, 0.5f, 0}, 50);
  for (const int grid : {1, 2}) {
    request.settings.lights.grid = grid;
    scene.materials[1].alpha = scene::AlphaMode::Opaque;
    const Shot opaque = shoot(scene, request);
    scene.materials[1].alpha = scene::AlphaMode::Blend;
    const Shot blended = shoot(scene, request);
    double worst = 0, sum = 0;
    int count = 0;
    for (int y = 0; y < 54; ++y)
      for (int x = 0; x < 96; ++x) {
        // The box and not its edges, where the shadow's plane comes from neighbours.
        if (blended.value("depth", {x, y}) == opaque.value("depth", {x, y})) continue;
        const vec3 a = color(opaque, {x, y}), c = color(blended, {x, y});
        const double off = double(glm::length(a - c)) / (double(glm::length(a)) + 0.02);
        worst = std::max(worst, off), sum += off, ++count;
      }
    std::printf("blended at alpha 1 against opaque, grid %d: %d pixels, mean difference %.4f, greatest %.3f\n",
                grid - 1, count, sum / count, worst);
    ASSERT_GT(count, 400);
    EXPECT_LT(sum / count, 0.01);
  }
}

TEST_F(Blend, CastsAShadowAsDenseAsItIs) {
  Builder b;
  const auto white = b.material({.base_color = vec3(1)});
  const auto pane = b.material({});
  b.object("floor");
  b.quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, white);
  for (const float y : {1.0f, 1.5f}) {
    b.object("pane");
    b.quad({-1, y, 1}, {1, y, 1}, {1, y, -1}, {-1, y, -1}, pane);
  }
  b.directional_light({0, -1, 0}, pi);
  scene::Scene scene = load(b);
  request.camera = look({0, 0.8f, 0}, {0, 0, 0}, 60, {0, 0, -1});  // below both
  request.settings.material.lambert = 1;
  request.settings.shadow.resolution = 512;
  request.frames = 16, request.accumulate = true, request.scan = false;
  for (const float alpha : {0.25f, 0.7f}) {
    glass(scene, 1, {1, 1, 1, alpha});
    const Shot shot = shoot(scene, request);
    double sum = 0, squares = 0;
    const image::Image& light = shot.layer("direct_diffuse");
    const double n = double(light.pixels.size()) / light.channels;
    for (uint32_t y = 0; y < light.height; ++y)
      for (uint32_t x = 0; x < light.width; ++x)
        sum += double(light.at(x, y, 0)), squares += std::pow(double(light.at(x, y, 0)), 2);
    const double mean = sum / n, expected = std::pow(1.0 - double(alpha), 2);
    std::printf("two panes of alpha %.1f: %.3f of the light (%.3f), deviation %.3f\n", double(alpha), mean, expected,
                std::sqrt(std::max(squares / n - mean * mean, 0.0)));
    EXPECT_NEAR(mean, expected, 0.02) << alpha;
  }
}

TEST_F(Blend, SwitchesOfTheGraphChangeNothing) {
  Builder b = small_room();
  const auto pane = b.material({});
  for (int i = 0; i < 6; ++i) {
    b.object("pane");
    add_pane(b, 0.1f * float(i), 0.6f, pane);
  }
  scene::Scene scene = load(b);
  glass(scene, uint32_t(scene.materials.size() - 1), {0.3f, 0.6f, 0.9f, 0.4f});
  scene.materials.back().unlit = false;
  request.camera = inside_small_room();
  request.scan = false;
  const auto with = [&](const graph::ExecutorOptions& options) {
    request.graph = options;
    return shoot(scene, request).picture;
  };
  const auto expected = with({});
  EXPECT_EQ(with({.alias = false}), expected);
  EXPECT_EQ(with({.layouts = graph::LayoutPolicy::General}), expected);
  EXPECT_EQ(with({.poison = graph::Poison::Handover}), expected);
  for (uint64_t seed = 1; seed <= 3; ++seed) EXPECT_EQ(with({.order_seed = seed}), expected) << "order " << seed;
  request.settings.material.blend = 1;
  EXPECT_NE(with({}), expected) << "control: the panes are seen";
}

// diffuse = albedo (1 - F0) E / pi tells F0: min(((ior - 1) / (ior + 1))^2 colour, 1) * strength, both with textures.
TEST_F(Blend, SpecularTexturesScaleTheDielectricReflectance) {
  Builder b;
  b.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, b.material({.base_color = vec3(1)}));
  b.directional_light({0, 0, -1}, pi);
  scene::Scene scene = load(b);
  const auto texture = [&](bool srgb, std::vector<uint8_t> texel) {
    scene.pictures.push_back({.name = "", .width = 1, .height = 1, .srgb = srgb, .rgba = std::move(texel)});
    scene.textures.push_back({.picture = uint32_t(scene.pictures.size() - 1), .sampler = {}});
    return uint32_t(scene.textures.size() - 1);
  };
  scene::Material& m = scene.materials[0];
  m.ior = 3;  // F0 0.25
  request.camera = look({0, 0, 1}, {0, 0, 0}, 40);
  request.settings.shadow.enabled = 0;
  const auto expect_f0 = [&](float f0, const char* what) {
    EXPECT_NEAR(shoot(scene, request).value("direct_diffuse", {48, 27}), 1 - f0, 0.003f) << what;
  };
  expect_f0(0.25f, "no texture");
  m.specular = 0.8f;
  m.specular_texture = texture(false, {0, 0, 0, 128});
  expect_f0(0.25f * 0.8f * 128 / 255, "strength");
  m.specular_color = vec3(0.5f, 2, 1);
  m.specular_color_texture = texture(true, {255, 188, 0, 255});  // sRGB 188 is 0.503: the strongest channel is green
  expect_f0(0.25f * 2 * 0.503f * 0.8f * 128 / 255, "and colour");
}

}  // namespace
}  // namespace nf::test
