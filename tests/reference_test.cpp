// What the path tracer sees: holes, backs and radii; and its bookkeeping: halves, threads, checkpoints, noise.
#include <fstream>
#include <numbers>

#include "core/error.h"
#include "reference/world.h"
#include "reference_bed.h"
#include "scene/animation.h"
#include "scene/deform.h"
#include "scenes.h"

namespace nf {
namespace {

using namespace test;
using reference::RadiusMode;
using reference::SamplerKind;
using reference::Settings;

void square(Builder& b, MaterialId m, float half, float y, bool up) {
  if (up)
    b.quad({-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}, m);
  else
    b.quad({-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}, m);
}

// A floor below an endless ceiling at height 1 whose back the camera looks through.
double visibility_below_ceiling(float radius, RadiusMode mode, uint32_t samples = 4096, float falloff = 0.615f) {
  Builder b;
  const MaterialId m = b.material({});
  square(b, m, 2, 0, true);
  square(b, m, 3000, 1, false);
  Settings s = lambert_settings(camera({0, 4, 0}, {0, 0, 0}, 0.01f, {0, 0, -1}), 2, 2);
  s.radius = radius;
  s.radius_mode = mode;
  s.falloff = falloff;
  return trace(scene_of(b.glb()), s, "visibility", samples).mean("visibility");
}

// Ball: a ray at the angle a to the normal meets the ceiling at 1 / cos a, so the open share is 1 / r^2.
TEST(ReferenceRadius, Ball) {
  EXPECT_EQ(visibility_below_ceiling(1 / 1.01f, RadiusMode::Ball), 1);
  EXPECT_NEAR(visibility_below_ceiling(1 / 0.99f, RadiusMode::Ball), 0.99 * 0.99, 2e-3);
  EXPECT_NEAR(visibility_below_ceiling(2, RadiusMode::Ball), 0.25, 2e-3);
  EXPECT_NEAR(visibility_below_ceiling(std::numeric_limits<float>::infinity(), RadiusMode::Ball), 0, 1e-4);
}

TEST(ReferenceRadius, BallWithFalloff) {
  // Without a fading edge it is the ball.
  EXPECT_NEAR(visibility_below_ceiling(2, RadiusMode::BallFalloff, 4096, 1e-6f), 0.25, 2e-3);
  // Quadrature over t = 1 / cos a of the density 2 / t^3, with the weight (2 - t) / 0.8 beyond 1.2.
  double occluded = 0;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double t = 1 + (i + 0.5) / steps;
    occluded += std::min((2 - t) / 0.8, 1.0) * 2 / (t * t * t) / steps;
  }
  EXPECT_NEAR(visibility_below_ceiling(2, RadiusMode::BallFalloff, 4096, 0.4f), 1 - occluded, 1.5e-3);
}

// Disc, seen from above at height 4: a point of the ceiling at the distance d from the axis is seen at d 4 / 3, in
// metres at the floor's depth. So it counts up to d = 3/4 r, which is the angle atan d.
TEST(ReferenceRadius, Disc) {
  for (const double r : {0.1, 0.5, 2.0}) {
    const double d = 0.75 * r;
    EXPECT_NEAR(visibility_below_ceiling(float(r), RadiusMode::Disc), 1 - d * d / (1 + d * d), 2e-3) << r;
  }
}

// With bound_gi a lamp lights what its distance lets it: the parts of a large plate at height 1 within the ball or the
// disc.
TEST(ReferenceRadius, BoundsGi) {
  Builder b;
  square(b, b.material({}), 2, 0, true);
  square(b, b.material({.base_color = vec3(0), .emissive = vec3(1)}), 300, 1, false);
  const scene::Scene scene = scene_of(b.glb());
  Settings s = lambert_settings(camera({0, 4, 0}, {0, 0, 0}, 0.01f, {0, 0, -1}), 2, 2);
  s.bound_gi = true;
  s.emitters = reference::EmitterSampling::Directions;
  const auto light = [&](RadiusMode mode, float radius) {
    s.radius = radius;
    s.radius_mode = mode;
    return trace(scene, s, "gi_1", 4096).mean("gi_1");
  };
  EXPECT_EQ(light(RadiusMode::Ball, 0.99f), 0);
  EXPECT_NEAR(light(RadiusMode::Ball, 2), 0.75, 2e-3);
  EXPECT_NEAR(light(RadiusMode::Disc, 2), 1.5 * 1.5 / (1 + 1.5 * 1.5), 2e-3);
  EXPECT_NEAR(light(RadiusMode::Ball, 1e9f), 1, 2e-3);
  // And found by choosing points of it: a small one, straight above, so that there is a choice.
  Builder small;
  square(small, small.material({}), 2, 0, true);
  square(small, small.material({.base_color = vec3(0), .emissive = vec3(1)}), 0.5f, 1, false);
  const scene::Scene lamp = scene_of(small.glb());
  for (const float radius : {1.1f, 5.0f}) {
    s.radius = radius;
    s.radius_mode = RadiusMode::Ball;
    s.emitters = reference::EmitterSampling::Directions;
    const double by_directions = trace(lamp, s, "gi_1", 16384).mean("gi_1");
    s.emitters = reference::EmitterSampling::Surfaces;
    EXPECT_NEAR(trace(lamp, s, "gi_1", 16384).mean("gi_1"), by_directions, 2e-3) << radius;
    EXPECT_GT(by_directions, 0.1);
  }
}

// Each bounce has the bound: a lamp that reaches the floor only over a ceiling, 1 m from it, is 3 m from that.
TEST(ReferenceRadius, BoundsEachBounce) {
  Builder b;
  square(b, b.material({}), 0.2f, 0, true);
  square(b, b.material({.base_color = vec3(1)}), 300, 1, false);
  square(b, b.material({.base_color = vec3(0), .emissive = vec3(1)}), 300, -2, true);
  const scene::Scene scene = scene_of(b.glb());
  Settings s = lambert_settings(camera({0, 0.5f, 0}, {0, 0, 0}, 0.01f, {0, 0, -1}), 2, 2);
  s.bounces = 2;
  s.bound_gi = true;
  for (const RadiusMode mode : {RadiusMode::Ball, RadiusMode::BallFalloff}) {
    s.radius_mode = mode;
    s.radius = 2;
    const reference::EmitterSampling ways[] = {reference::EmitterSampling::Directions,
                                               reference::EmitterSampling::Both};
    for (const auto way : ways) {
      s.emitters = way;
      EXPECT_EQ(trace(scene, s, "gi_2", 1024).mean("gi_2"), 0);
    }
    s.radius = 1e9f;
    EXPECT_NEAR(trace(scene, s, "gi_2", 1024).mean("gi_2"), 1, 0.03);
  }
}

// The camera sees through the backs of single-sided surfaces, light does not pass them.
TEST(ReferenceGeometry, BacksAndMirrors) {
  for (const float mirror : {1.0f, -1.0f}) {
    Builder b;
    const MaterialId m = b.material({.base_color = vec3(0.5f)}),
                     both = b.material({.base_color = vec3(0.25f), .double_sided = true});
    b.object("floor", {.scale = {mirror, 1, 1}});
    square(b, m, 1, 0, true);
    b.object("roof", {.scale = {mirror, 1, 1}});
    square(b, m, 0.2f, 1, false);
    b.object("card", {.translation = {0.4f, 0.5f, 0}, .scale = {mirror, 1, 1}});
    square(b, both, 0.05f, 0, false);
    b.directional_light({0, -1, 0}, 3.14159265f);
    const Traced t =
        trace(scene_of(b.glb()), lambert_settings(down_on_unit_square(), 33, 33), "depth,direct,albedo,normal", 2);
    EXPECT_NEAR(t["depth"].at(16, 16, 0), 4, 1e-4f);  // the floor, through the roof
    EXPECT_EQ(t["direct"].at(16, 16, 0), 0);          // in the roof's shadow
    EXPECT_NEAR(t["direct"].at(2, 2, 0), 0.5f, 1e-5f);
    EXPECT_NEAR(t["normal"].at(16, 16, 1), 1, 1e-6f);
    // The card shows its back, which is lit from above as the front would be. Half way up: at 0.4 / 3.5 of the tangent.
    const uint32_t x = uint32_t((0.4f * 4 / 3.5f + 0.5f) * 33);
    EXPECT_NEAR(t["depth"].at(x, 16, 0), 3.5f, 1e-4f);
    EXPECT_NEAR(t["normal"].at(x, 16, 1), 1, 1e-6f);
    EXPECT_NEAR(t["direct"].at(x, 16, 0), 0.25f, 1e-5f);
  }
}

// Left half a hole: seen through, lit through, and shone through by what is behind.
TEST(ReferenceGeometry, Holes) {
  Builder b;
  image::Image8 picture{64, 1, 4, {}};
  for (int i = 0; i < 64; ++i) picture.pixels.insert(picture.pixels.end(), {255, 255, 255, uint8_t(i < 32 ? 0 : 255)});
  square(b, b.material({.base_color = vec3(0.5f)}), 1, 0, true);
  square(b,
         b.material({.base_color = vec3(0.75f),
                     .alpha_cutoff = 0.5f,
                     .double_sided = true,
                     .base_color_picture = b.picture("half", picture)}),
         0.5f, 0.01f, true);
  b.directional_light({0, -1, 0}, 3.14159265f);
  Settings s = lambert_settings(down_on_unit_square(), 16, 16);
  s.radius = 0.5f;
  const Traced t = trace(scene_of(b.glb()), s, "albedo,direct,depth,visibility", 64);
  EXPECT_NEAR(t["depth"].at(3, 8, 0), 4, 1e-4f);
  EXPECT_NEAR(t["albedo"].at(3, 8, 0), 0.5f, 1e-4f);
  EXPECT_NEAR(t["direct"].at(3, 8, 0), 0.5f, 1e-4f);
  EXPECT_GT(t["visibility"].at(1, 8, 0), 0.99f);
  EXPECT_NEAR(t["depth"].at(12, 8, 0), 3.99f, 1e-4f);
  EXPECT_NEAR(t["direct"].at(12, 8, 0), 0.75f, 1e-4f);
}

// Beside an endless wall half the directions are open; with the density cos / pi over that half, the mean of x is 2 /
// (3 pi) and that of y, the normal's direction, 1 / 3.
TEST(ReferenceGeometry, BentNormalBesideAWall) {
  Builder b;
  const MaterialId m = b.material({});
  square(b, m, 2, 0, true);
  b.quad({-0.001f, 0, 2000}, {-0.001f, 0, -2000}, {-0.001f, 2000, -2000}, {-0.001f, 2000, 2000}, m);
  Settings s = lambert_settings(camera({0.3f, 4, 0}, {0, 0, 0}, 0.001f), 1, 1);
  const Traced t = trace(scene_of(b.glb()), s, "bent,visibility", 16384);
  EXPECT_NEAR(t.mean("visibility"), 0.5, 2e-3);
  EXPECT_NEAR(t.mean("bent", 0) / t.mean("bent", 1), 2 / 3.14159265, 1e-2);
  EXPECT_NEAR(t.mean("bent", 2), 0, 2e-3);
}

TEST(ReferenceGeometry, BackgroundIsTheSky) {
  Builder b;
  square(b, b.material({}), 0.1f, 0, true);
  scene::Scene scene = scene_of(b.glb());
  scene.environment.color = {0.5f, 1, 2};
  const Traced t = trace(scene, lambert_settings(down_on_unit_square()), "all", 2);
  EXPECT_EQ(t[""].at(0, 0, 2), 2);
  EXPECT_EQ(t["depth"].at(0, 0, 0), 0);
  EXPECT_EQ(t["visibility"].at(0, 0, 0), 1);
  EXPECT_EQ(t["ambient"].at(0, 0, 0), 0);
}

// --- bookkeeping

Settings cornell_settings(const scene::Scene& scene, uint32_t width = 24, uint32_t height = 16) {
  Settings s = lambert_settings(scene.cameras[0], width, height);
  s.lambert = false;
  s.bounces = 3;
  return s;
}

// Layers add up as the README says.
TEST(ReferenceFilm, FinalRadianceIsTheSumOfLayers) {
  const scene::Scene scene = scene_of(content::fence());
  scene::Scene sunny = scene;
  sunny.environment.color = {0.2f, 0.3f, 0.4f};
  const Traced t = trace(sunny, cornell_settings(sunny), "all", 16);
  for (size_t i = 0; i < t[""].pixels.size(); ++i) {
    if (t["depth"].pixels[i / 3] == 0) continue;
    const float sum =
        t["direct"].pixels[i] + t["ambient"].pixels[i] + t["indirect"].pixels[i] + t["emissive"].pixels[i];
    EXPECT_NEAR(t[""].pixels[i], sum, 1e-5f);
    EXPECT_NEAR(t["direct"].pixels[i], t["direct_diffuse"].pixels[i] + t["direct_specular"].pixels[i], 1e-6f);
    EXPECT_LE(t["gi_1"].pixels[i], t["gi_2"].pixels[i]);
    EXPECT_LE(t["gi_2"].pixels[i], t["gi"].pixels[i]);
  }
  EXPECT_GT(t.mean("specular"), 0);
}

// Same bytes whatever the threads, and whether taken in one go, in parts, or over a checkpoint.
TEST(ReferenceFilm, BytesDoNotDependOnHowTheyWereMade) {
  const scene::Scene scene = scene_of(content::cornell());
  Settings s = cornell_settings(scene);
  const std::vector<std::string> layers = reference::parse_layers("all", s.bounces);
  const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("nf_checkpoint_{}", getpid());
  const auto pixels = [](const reference::Tracer& t) {
    std::vector<float> all;
    for (const image::Layer& l : t.layers()) all.insert(all.end(), l.image.pixels.begin(), l.image.pixels.end());
    for (const image::Layer& l : t.half(0)) all.insert(all.end(), l.image.pixels.begin(), l.image.pixels.end());
    return all;
  };
  s.threads = 1;
  reference::Tracer one(scene, s, layers);
  one.sample(12);
  s.threads = 5;
  reference::Tracer many(scene, s, layers);
  many.sample(4);
  many.sample(7);  // of an odd number one more
  EXPECT_EQ(many.samples(), 12u);
  EXPECT_EQ(pixels(one), pixels(many));

  reference::Tracer first(scene, s, layers), second(scene, s, layers);
  first.sample(6);
  first.save(file);
  second.load(file);
  second.sample(6);
  EXPECT_EQ(pixels(one), pixels(second));

  s.seed = 2;
  reference::Tracer other(scene, s, layers);
  EXPECT_THROW(other.load(file), Error);
  std::filesystem::resize_file(file, 1000);
  EXPECT_THROW(first.load(file), Error);
  std::ofstream(file) << "something else";
  EXPECT_THROW(first.load(file), Error);
  std::filesystem::remove(file);
}

// Another seed, another sampler and another way to find the lamp give other noise and the same light.
TEST(ReferenceNoise, EverythingAgreesWithinThreeSigma) {
  const scene::Scene scene = scene_of(content::cornell());
  const Settings base = cornell_settings(scene);
  const Traced a = trace(scene, base, "gi", 256);
  const auto compare = [&](const Settings& s, const char* what) {
    const Traced b = trace(scene, s, "gi", 256);
    EXPECT_NE(a["gi"].pixels, b["gi"].pixels) << what;
    const double sigma = std::hypot(a.sigma("gi"), b.sigma("gi"));
    for (uint32_t c = 0; c < 3; ++c) EXPECT_LT(std::abs(a.mean("gi", c) - b.mean("gi", c)), 3 * sigma) << what;
    // The noise that the halves tell is the one there is.
    double squares = 0;
    for (size_t i = 0; i < a["gi"].pixels.size(); ++i) {
      const double difference = double(a["gi"].pixels[i]) - double(b["gi"].pixels[i]);
      squares += difference * difference;
    }
    const double told = std::hypot(a.rmse("gi"), b.rmse("gi"));
    EXPECT_NEAR(std::sqrt(squares / double(a["gi"].pixels.size())) / told, 1, 0.25) << what;
  };
  Settings s = base;
  s.seed = 77;
  compare(s, "seed");
  s = base;
  s.sampler = SamplerKind::Independent;
  compare(s, "sampler");
  for (const reference::EmitterSampling way :
       {reference::EmitterSampling::Surfaces, reference::EmitterSampling::Directions}) {
    s = base;
    s.seed = 5;  // else the same random numbers make the same noise
    s.emitters = way;
    compare(s, way == reference::EmitterSampling::Surfaces ? "surfaces" : "directions");
  }
}

// Slope of log noise over log samples, by least squares.
double noise_slope(SamplerKind kind, const std::string& layer, uint32_t most) {
  const scene::Scene scene = scene_of(content::cornell());
  Settings s = cornell_settings(scene);
  s.sampler = kind;
  s.bounces = 1;
  reference::Tracer tracer(scene, s, reference::parse_layers(layer, 1));
  double x = 0, y = 0, xx = 0, xy = 0, n = 0;
  for (uint32_t samples = 16; samples <= most; samples *= 4) {
    tracer.sample(samples - tracer.samples());
    for (const reference::Noise& noise : tracer.noise()) {
      if (noise.layer != layer) continue;
      const double lx = std::log(double(samples)), ly = std::log(noise.rmse);
      x += lx, y += ly, xx += lx * lx, xy += lx * ly, ++n;
    }
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

TEST(ReferenceNoise, FallsAsTheRootOfTheSamples) {
  for (const char* layer : {"gi", "visibility"}) {
    EXPECT_NEAR(noise_slope(SamplerKind::Independent, layer, 1024), -0.5, 0.05) << layer;
    EXPECT_LT(noise_slope(SamplerKind::Sobol, layer, 1024), -0.5) << layer;
  }
}

TEST(ReferenceLayers, NamesAreChecked) {
  EXPECT_EQ(reference::parse_layers("gi,depth,gi", 2), (std::vector<std::string>{"", "gi", "depth"}));
  EXPECT_EQ(reference::parse_layers("gi_2,indirect_1", 2).size(), 3u);
  for (const char* bad : {"shine", "gi_0", "gi_3", "gi_", "gi_x", "depth_1", "direct_1"})
    EXPECT_THROW(reference::parse_layers(bad, 2), Error) << bad;
}

// Skinned and morphed instances are where scene::deform has them; others where their node has them.
TEST(ReferenceWorld, WhatMoves) {
  scene::Scene scene = scene::load_gltf(NF_BINARY_DIR "/content/atrium.glb");
  scene::animate(scene, 1.3);
  const reference::World world(scene, {.lambert = true});
  size_t skinned = 0, off = 0;
  for (uint32_t i = 0; i < world.instances().size(); ++i) {
    const reference::WorldInstance& instance = world.instances()[i];
    ASSERT_EQ(instance.position.size(), instance.primitive->vertex_count + 1);
    for (uint32_t v = 0; v < instance.primitive->vertex_count; ++v)
      off += glm::distance(instance.position[v], scene::deformed_position(scene, i, v, scene::Moment::Now)) > 1e-4f;
    skinned += scene.instances.skin[i] != scene::none;
  }
  EXPECT_GT(skinned, 0u);
  EXPECT_EQ(off, 0u);
}

// The same texture transform, index of refraction and unlit surfaces as the shaders have.
TEST(ReferenceWorld, MaterialsOfExtensions) {
  Builder b;
  const auto picture = b.picture("two", {2, 1, 3, {255, 0, 0, 0, 255, 0}});
  b.quad({-0.5f, 0, 0.5f}, {0.5f, 0, 0.5f}, {0.5f, 0, -0.5f}, {-0.5f, 0, -0.5f},
         b.material({.base_color_picture = picture}));
  b.directional_light({0, -1, 0}, 2);
  scene::Scene scene = scene_of(b.glb());
  reference::Settings s = lambert_settings(down_on_unit_square(), 8, 8);
  scene.textures[0].sampler.mag = scene::Filter::Nearest;
  const Traced plain = trace(scene, s, "albedo", 1);
  EXPECT_EQ(plain["albedo"].at(1, 4, 0), 1);
  EXPECT_EQ(plain["albedo"].at(6, 4, 0), 0);
  scene.materials[0].mapping[size_t(scene::Slot::BaseColor)].offset = {0.5f, 0};
  const Traced moved = trace(scene, s, "albedo", 1);
  EXPECT_EQ(moved["albedo"].at(1, 4, 0), 0);
  EXPECT_EQ(moved["albedo"].at(6, 4, 0), 1);
  s.lambert = false;
  const Traced lit = trace(scene, s, "direct_diffuse,direct_specular", 1);
  EXPECT_GT(lit.mean("direct_specular"), 0);
  scene.materials[0].ior = 1;
  scene.materials[0].metallic = 0;
  const Traced matt = trace(scene, s, "direct_diffuse,direct_specular", 1);
  EXPECT_EQ(matt.mean("direct_specular"), 0);
  EXPECT_NEAR(matt.mean("direct_diffuse"), 0.5 * 2 / std::numbers::pi, 1e-5);
  scene.materials[0].unlit = true;
  const Traced unlit = trace(scene, s, "direct_diffuse,emissive", 1);
  EXPECT_EQ(unlit.mean("direct_diffuse"), 0);
  EXPECT_NEAR(unlit.mean("emissive"), 0.5, 1e-5);
}

}  // namespace
}  // namespace nf
