// The path tracer against closed forms: what plates, boxes, lamps and skies do to each other.
#include <numbers>

#include "reference/scatter.h"
#include "reference_bed.h"
#include "scenes.h"
#include "sky.h"

namespace nf {
namespace {

using namespace test;
using reference::EmitterSampling;
using reference::Settings;

constexpr double pi = std::numbers::pi;

void floor_square(Builder& b, MaterialId m, float half = 0.5f, float y = 0) {
  b.quad({-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}, m);
}
// Facing down.
void ceiling_square(Builder& b, MaterialId m, float half, float y) {
  b.quad({-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}, m);
}

// Every face has albedo 0.8 and emits 1: K bounces give 1 + 0.8 + ... + 0.8^(K-1).
TEST(ReferenceLight, Furnace) {
  const scene::Scene scene = scene_of(content::furnace());
  for (const scene::Camera& eye : scene.cameras) {
    Settings s = lambert_settings(eye, 12, 8);
    s.bounces = 16;
    s.emitters = EmitterSampling::Directions;
    const Traced t = trace(scene, s, "gi,gi_1,gi_2,gi_5,indirect_5,visibility", 4);
    for (const uint32_t k : {1u, 2u, 5u, 16u}) {
      const double expected = (1 - std::pow(0.8, k)) / 0.2;
      for (const float value : t[k == 16 ? "gi" : fmt::format("gi_{}", k)].pixels)
        EXPECT_NEAR(double(value), expected, 1e-3 * expected) << eye.name << " " << k;
    }
    for (const float value : t[""].pixels) EXPECT_NEAR(double(value), (1 - std::pow(0.8, 17)) / 0.2, 5e-3);
    for (const float value : t["indirect_5"].pixels)
      EXPECT_NEAR(double(value), 0.8 * (1 - std::pow(0.8, 5)) / 0.2, 3e-3);
    for (const float value : t["visibility"].pixels) EXPECT_EQ(value, 0);  // not a ray finds a gap
  }
}

// Albedo 0.8 under a sun of irradiance pi reads 0.8, and falls with the cosine.
TEST(ReferenceLight, LambertPlaneInTheSun) {
  for (const float degrees : {0.0f, 40.0f, 75.0f}) {
    Builder b;
    floor_square(b, b.material({.base_color = vec3(0.8f)}));
    const float angle = glm::radians(degrees);
    b.directional_light({std::sin(angle), -std::cos(angle), 0}, float(pi), {1, 0.5f, 0.25f});
    const Traced t = trace(scene_of(b.glb()), lambert_settings(down_on_unit_square()), "direct,direct_diffuse", 2);
    for (size_t i = 0; i < t["direct"].pixels.size(); i += 3) {
      EXPECT_NEAR(t["direct"].pixels[i], 0.8f * std::cos(angle), 2e-6f);
      EXPECT_NEAR(t["direct"].pixels[i + 1], 0.4f * std::cos(angle), 2e-6f);
      EXPECT_NEAR(t["direct_diffuse"].pixels[i + 2], 0.2f * std::cos(angle), 2e-6f);
    }
  }
}

// A sun of some size gives a facing plane the same, all the way to the limb of the cone.
TEST(ReferenceLight, SizesOfLightsKeepTheirPower) {
  Builder b;
  floor_square(b, b.material({.base_color = vec3(1)}));
  scene::Scene scene = scene_of(b.glb());
  scene.directional.push_back({.direction = {0, -1, 0}, .irradiance = float(pi), .angle_deg = 60});
  Traced t = trace(scene, lambert_settings(down_on_unit_square()), "direct", 64);
  for (const float value : t["direct"].pixels) EXPECT_NEAR(value, 1, 1e-5f);
  // A sphere's irradiance is that of a point in its centre, where all of it is above the horizon.
  scene.directional.clear();
  scene.punctual.push_back({.position = {0, 2, 0}, .intensity = 3, .radius = 0.7f});
  t = trace(scene, lambert_settings(camera({0, 4, 0}, {0, 0, 0}, 0.1f, {0, 0, -1}), 2, 2), "direct", 4096);
  EXPECT_NEAR(t.mean("direct"), 3 / (4 * pi), 2e-4);
}

// E = I cos / d^2, and the spot's cone as KHR_lights_punctual has it.
TEST(ReferenceLight, PointAndSpot) {
  Builder b;
  floor_square(b, b.material({.base_color = vec3(0.5f)}), 2);
  b.point_light({0.3f, 1.5f, -0.2f}, 7);
  scene::Scene scene = scene_of(b.glb());
  const Traced t = trace(scene, lambert_settings(down_on_unit_square(), 16, 16), "direct,position", 2);
  for (uint32_t y = 0; y < 16; ++y) {
    for (uint32_t x = 0; x < 16; ++x) {
      const vec3 p((float(x) + 0.5f) / 16 - 0.5f, 0, (float(y) + 0.5f) / 16 - 0.5f);
      EXPECT_NEAR(t["position"].at(x, y, 0), p.x, 1e-5f);
      EXPECT_NEAR(t["position"].at(x, y, 2), p.z, 1e-5f);
      const vec3 to = vec3(0.3f, 1.5f, -0.2f) - p;
      const double d = double(glm::length(to));
      EXPECT_NEAR(double(t["direct"].at(x, y, 0)), 0.5 / pi * 7 * 1.5 / (d * d * d), 1e-5);
    }
  }
  scene.punctual[0] = {.position = {0, 1, 0},
                       .direction = {0, -1, 0},
                       .intensity = 2,
                       .range = 3,
                       .inner_cone = glm::radians(10.0f),
                       .outer_cone = glm::radians(20.0f)};
  const Traced spot = trace(scene, lambert_settings(down_on_unit_square(), 15, 15), "direct", 2);
  const double window = 1 - std::pow(1 / 9.0, 2);
  EXPECT_NEAR(double(spot["direct"].at(7, 7, 0)), 0.5 / pi * 2 * window, 1e-5);
  EXPECT_EQ(spot["direct"].at(0, 7, 0), 0);  // 0.467 m to the side: 25 degrees
}

// Hottel's factor between unit squares, parallel at distance 1 (Howell C-11) and at right angles with a common edge
// (C-14).
double parallel_squares() {
  return 2 / pi *
         (std::log(std::sqrt(4.0 / 3)) + 2 * std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) - 2 * std::atan(1.0));
}
double perpendicular_squares() {
  return 1 / pi * (2 * std::atan(1.0) - std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) + 0.25 * std::log(0.75));
}

TEST(ReferenceLight, FormFactorOfParallelSquares) {
  Builder b;
  floor_square(b, b.material({}));
  ceiling_square(b, b.material({.base_color = vec3(0), .emissive = vec3(1)}), 0.5f, 1);
  const scene::Scene scene = scene_of(b.glb());
  EXPECT_NEAR(parallel_squares(), 0.1998, 5e-5);
  for (const EmitterSampling way : {EmitterSampling::Both, EmitterSampling::Directions, EmitterSampling::Surfaces}) {
    Settings s = lambert_settings(down_on_unit_square(), 16, 16);
    s.pixel_box = true;
    s.emitters = way;
    const Traced t = trace(scene, s, "gi_1,visibility", 1024);
    EXPECT_NEAR(t.mean("gi_1"), parallel_squares(), 4e-4) << int(way);
    EXPECT_NEAR(t.mean("visibility"), 1 - parallel_squares(), 1.5e-3);  // the lamp is all there is
  }
}

TEST(ReferenceLight, FormFactorOfPerpendicularSquares) {
  Builder b;
  floor_square(b, b.material({}));
  const MaterialId lamp = b.material({.base_color = vec3(0), .emissive = vec3(1)});
  b.quad({-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 1, -0.5f}, {-0.5f, 1, -0.5f}, lamp);
  const scene::Scene scene = scene_of(b.glb());
  EXPECT_NEAR(perpendicular_squares(), 0.2000, 5e-5);
  // Choosing points alone has no finite variance along the common edge.
  for (const EmitterSampling way : {EmitterSampling::Both, EmitterSampling::Directions}) {
    Settings s = lambert_settings(down_on_unit_square(8), 16, 16);
    s.pixel_box = true;
    s.emitters = way;
    const Traced t = trace(scene, s, "gi_1", 512);
    EXPECT_NEAR(t.mean("gi_1"), perpendicular_squares(), 5e-4) << int(way);
  }
}

// A light in the middle of a closed cube: each face gets a sixth of it, and of every bounce. What leaves one face lands
// on the others, so the mean over a face falls by the albedo each time.
TEST(ReferenceLight, PointLightInABox) {
  Builder b;
  b.room({0, 0.5f, 0}, vec3(0.5f), b.material({.base_color = vec3(0.6f)}));
  b.point_light({0, 0.5f, 0}, 2);
  Settings s = lambert_settings(down_on_unit_square(), 16, 16);
  s.pixel_box = true;
  s.bounces = 3;
  const Traced t = trace(scene_of(b.glb()), s, "direct_diffuse,gi_1,gi_2,gi_3", 256);
  const double face = 4 * pi * 2 / 6;  // flux through a face, of area 1
  EXPECT_NEAR(t.mean("direct_diffuse"), 0.6 / pi * face, 2e-3);
  double expected = 0, power = face / pi;
  for (const char* layer : {"gi_1", "gi_2", "gi_3"}) {
    power *= 0.6;
    expected += power;
    EXPECT_NEAR(t.mean(layer), expected, 5e-3 * expected) << layer;
  }
}

// Emission leaves the front only, unless the material is double-sided.
TEST(ReferenceLight, LampsHaveAFront) {
  for (const bool double_sided : {false, true}) {
    Builder b;
    floor_square(b, b.material({}));
    // Its front looks up, away from the floor; the camera is between the two.
    floor_square(b, b.material({.base_color = vec3(0), .emissive = vec3(1), .double_sided = double_sided}), 0.5f, 1);
    const scene::Scene scene = scene_of(b.glb());
    for (const EmitterSampling way : {EmitterSampling::Both, EmitterSampling::Directions, EmitterSampling::Surfaces}) {
      Settings s = lambert_settings(down_on_unit_square(0.9f), 16, 16);
      s.emitters = way;
      s.pixel_box = true;
      EXPECT_NEAR(trace(scene, s, "gi_1", 512).mean("gi_1"), double_sided ? parallel_squares() : 0, 3e-3) << int(way);
    }
  }
}

// Under an open sky of radiance L a plane gets L; a plate that hides the share F of it leaves 1 - F. With
// include_ambient the plate's underside, which sees the plane and past it, lights the plane.
TEST(ReferenceLight, Sky) {
  Builder b;
  floor_square(b, b.material({.base_color = vec3(0.5f)}));
  ceiling_square(b, b.material({.base_color = vec3(0.4f)}), 0.5f, 1);
  scene::Scene scene = scene_of(b.glb());
  scene.environment.color = {3, 2, 1};
  Settings s = lambert_settings(down_on_unit_square(), 16, 16);
  s.pixel_box = true;
  const Traced without = trace(scene, s, "ambient,gi_1,visibility", 256);
  const double f = parallel_squares();
  EXPECT_NEAR(without.mean("ambient"), 0.5 * 3 * (1 - f), 4e-3);
  EXPECT_NEAR(without.mean("ambient", 2), 0.5 * 1 * (1 - f), 2e-3);
  EXPECT_EQ(without.mean("gi_1"), 0);
  s.include_ambient = true;
  s.bounces = 1;
  EXPECT_EQ(trace(scene, s, "ambient", 256)["ambient"].pixels, without["ambient"].pixels);
  s.bounces = 2;
  const Traced t = trace(scene, s, "gi_1", 1024);
  EXPECT_NEAR(t.mean("gi_1"), 3 * 0.4 * (1 - f) * f, 0.02);  // nearly: the underside's light varies a little
}

// Under a turned HDR map a plane gets the sum over the map's texels, and sees the map behind itself.
TEST(ReferenceLight, MapOfTheSky) {
  Builder b;
  floor_square(b, b.material({.base_color = vec3(0.5f)}));
  scene::Scene scene = scene_of(b.glb());
  const image::Image texels = content::sky_map(content::hazy(), 128);
  scene.environment = scene::make_environment_map(texels, "sky", 2, 70);
  glm::dvec3 sum(0);
  for (uint32_t y = 0; y < texels.height / 2; ++y) {
    const double latitude = pi / 2 - pi * (y + 0.5) / texels.height;
    const double weight = std::sin(latitude) * std::cos(latitude) * (pi / texels.height) * (2 * pi / texels.width);
    for (uint32_t x = 0; x < texels.width; ++x) {
      for (uint32_t c = 0; c < 3; ++c) sum[int(c)] += 2.0 * double(texels.at(x, y, c)) * weight;
    }
  }
  Settings s = lambert_settings(down_on_unit_square(), 16, 16);
  const Traced t = trace(scene, s, "ambient", 256);
  for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(t.mean("ambient", c) / (0.5 * sum[int(c)] / pi), 1, 5e-3) << c;
  // 30 degrees up and towards -X: turned by 70 degrees, the map's column of 180 + 70.
  s.camera = camera({0, 1, 0}, {-1, 1 + std::tan(float(pi) / 6), 0}, 1);
  const Traced sky = trace(scene, s, "ambient", 1);
  const uint32_t column = uint32_t((0.5 + (180 + 70) / 360.0 - 1) * texels.width);
  const uint32_t row = uint32_t((0.5 - 30 / 180.0) * texels.height);
  for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(sky.mean("", c) / (2 * double(texels.at(column, row, c))), 1, 0.02) << c;
}

// Bright texels chosen or not, the light is the same, and with a sun in the map there is less noise; on diffuse and
// glossy surfaces, straight from the sky and over bounces.
TEST(ReferenceLight, BrightTexels) {
  Builder b;
  floor_square(b, b.material({.base_color = vec3(0.5f), .roughness = 0.5f}));
  b.box({0, 0.1f, 0}, vec3(0.1f), 0.3f, b.material({.base_color = vec3(0.7f, 0.4f, 0.2f)}));
  scene::Scene scene = scene_of(b.glb());
  scene.environment = scene::make_environment_map(content::sky_map(content::afternoon(), 256), "sky", 1, 40);
  for (const bool lambert : {true, false}) {
    Settings s = lambert_settings(down_on_unit_square(), 24, 24);
    s.lambert = lambert;
    s.include_ambient = true;
    s.bounces = 2;
    const Traced chosen = trace(scene, s, "ambient,gi_1,gi_2,specular", 256);
    s.sky = reference::SkySampling::Directions;
    s.seed = 2;
    const Traced blind = trace(scene, s, "ambient,gi_1,gi_2,specular", 1024);
    for (const char* layer : {"ambient", "gi_1", "gi_2", "specular"}) {
      if (lambert && std::string(layer) == "specular") continue;
      const double sigma = std::hypot(chosen.sigma(layer), blind.sigma(layer));
      EXPECT_GT(blind.mean(layer), 10 * sigma) << layer;
      for (uint32_t c = 0; c < 3; ++c)
        EXPECT_NEAR(chosen.mean(layer, c), blind.mean(layer, c), 3 * std::sqrt(3) * sigma) << layer << lambert;
    }
    // At a quarter of the samples.
    EXPECT_LT(chosen.rmse("ambient"), blind.rmse("ambient"));
  }
}

// A white mirror-like room that glows: whatever the lobe, a bounce returns its directional albedo.
TEST(ReferenceLight, GlossyFurnace) {
  for (const float roughness : {0.2f, 0.6f, 1.0f}) {
    Builder b;
    b.room({0, 0, 0}, vec3(1),
           b.material({.base_color = {0.9f, 0.5f, 0.2f}, .metallic = 1, .roughness = roughness, .emissive = vec3(1)}));
    Settings s = lambert_settings(camera({0, 0, 0}, {0.3f, -1, 0.1f}, 1), 2, 2);
    s.lambert = false;
    s.bounces = 1;
    s.emitters = EmitterSampling::Directions;
    const Traced t = trace(scene_of(b.glb()), s, "specular,gi,ambient", 4096);
    // Quadrature of the lobe over the hemisphere, in the frame of the floor.
    const double cosine = double(-glm::normalize(vec3(0.3f, -1, 0.1f)).y);
    const vec3 v(float(std::sqrt(1 - cosine * cosine)), 0, float(cosine));
    glm::dvec3 sum(0);
    constexpr int steps = 700;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        const double z = (i + 0.5) / steps, phi = 2 * pi * (j + 0.5) / steps, r = std::sqrt(1 - z * z);
        const vec3 l(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z));
        sum += glm::dvec3(reference::specular({0.9f, 0.5f, 0.2f}, reference::alpha_of(roughness), v, l));
      }
    }
    sum *= 2 * pi / (double(steps) * steps);
    for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(t.mean("specular", c), sum[int(c)], 4e-3) << roughness << " " << c;
  }
}

// The same albedo is what a metal plane shows of a white sky, and direct_specular is the lobe itself.
TEST(ReferenceLight, MetalUnderSkyAndSun) {
  Builder b;
  floor_square(b, b.material({.base_color = vec3(0.7f), .metallic = 1, .roughness = 0.5f}), 2);
  scene::Scene scene = scene_of(b.glb());
  scene.environment.color = vec3(1);
  const vec3 to_eye = glm::normalize(vec3(1, 1.2f, 0));
  Settings s = lambert_settings(camera(to_eye * 3.0f, {0, 0, 0}, 0.05f), 2, 2);
  s.lambert = false;
  const double ambient = trace(scene, s, "ambient", 8192).mean("ambient");
  scene.environment.color = vec3(0);
  const vec3 to_sun = glm::normalize(vec3(-0.5f, 1, 0.2f));
  scene.directional.push_back({.direction = -to_sun, .irradiance = 2});
  const double direct = trace(scene, s, "direct_specular", 2).mean("direct_specular");
  const auto local = [](vec3 w) { return vec3(w.x, w.z, w.y); };
  EXPECT_NEAR(direct, double(2.0f * reference::specular(vec3(0.7f), 0.25f, local(to_eye), local(to_sun)).x), 1e-4);
  double sum = 0;
  constexpr int steps = 700;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const double z = (i + 0.5) / steps, phi = 2 * pi * (j + 0.5) / steps, r = std::sqrt(1 - z * z);
      const vec3 l(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z));
      sum += double(reference::specular(vec3(0.7f), 0.25f, local(to_eye), l).x);
    }
  }
  EXPECT_NEAR(ambient, sum * 2 * pi / (double(steps) * steps), 2e-3);
}

}  // namespace
}  // namespace nf
