// Lighting mathematics off the device: the reflectance table, the BRDF, shadow maps' fit and choice, the grid of
// lights.
#include <gtest/gtest.h>
#include <random>

#include "environment.h"
#include "glsl_twin.h"
#include "light_grid.h"
#include "mips.h"
#include "scene/camera.h"

NF_GLSL_BEGIN
#include "common/brdf.glsl"
#include "common/lights.glsl"
#include "common/shadow.glsl"
NF_GLSL_END

namespace nf::passes {
namespace {

// Uniform hemisphere quadrature of the specular lobe (glTF 2.0, Appendix B), written independently of the table's
// importance sampling.
glm::vec2 brute_force(float n_v, float roughness) {
  constexpr int n = 1200;
  constexpr double pi = 3.14159265358979;
  const double alpha = double(roughness) * roughness, a2 = alpha * alpha, vx = std::sqrt(1 - double(n_v) * n_v);
  double x = 0, y = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double n_l = (i + 0.5) / n, phi = 2 * pi * (j + 0.5) / n, s = std::sqrt(1 - n_l * n_l);
      const double lx = s * std::cos(phi), ly = s * std::sin(phi);
      double hx = lx + vx, hy = ly, hz = n_l + double(n_v);
      const double length = std::sqrt(hx * hx + hy * hy + hz * hz);
      hx /= length, hy /= length, hz /= length;
      const double d = hz * hz * (a2 - 1) + 1, distribution = a2 / (pi * d * d);
      const double smith = 0.5 / (double(n_v) * std::sqrt(n_l * n_l * (1 - a2) + a2) +
                                  n_l * std::sqrt(double(n_v) * n_v * (1 - a2) + a2));
      const double v_h = vx * hx + double(n_v) * hz, fresnel = std::pow(1 - v_h, 5);
      const double weight = distribution * smith * n_l * 2 * pi / n / n;
      x += weight * (1 - fresnel);
      y += weight * fresnel;
    }
  return {float(x), float(y)};
}

TEST(Reflectance, TableEqualsQuadrature) {
  const std::vector<glm::vec2> table = reflectance_table();
  ASSERT_EQ(table.size(), size_t(reflectance_side) * reflectance_side);
  for (const uint32_t row : {5u, 9u, 15u})
    for (const uint32_t column : {2u, 8u, 15u}) {
      const glm::vec2 expected =
          brute_force((float(column) + 0.5f) / reflectance_side, (float(row) + 0.5f) / reflectance_side);
      const glm::vec2 got = table[row * reflectance_side + column];
      EXPECT_NEAR(got.x, expected.x, 6e-3f) << row << "," << column;
      EXPECT_NEAR(got.y, expected.y, 6e-3f) << row << "," << column;
    }
  // A mirror reflects everything: F0 = 1 gives 1 for smooth surfaces, less for rough ones (single scattering).
  EXPECT_NEAR(table[15].x + table[15].y, 1, 0.01f);
  EXPECT_LT(table[255].x + table[255].y, 1);
}

// The specular lobe that the shaders use, integrated, against the independent quadrature.
TEST(Brdf, ShaderTextEqualsQuadrature) {
  constexpr int n = 600;
  for (const float roughness : {0.3f, 0.6f, 1.0f})
    for (const float n_v : {0.2f, 0.7f, 1.0f}) {
      const float alpha = roughness * roughness, vx = std::sqrt(1 - n_v * n_v);
      double x = 0, y = 0, normalised = 0;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const float n_l = (float(i) + 0.5f) / n, phi = 2 * 3.14159265f * (float(j) + 0.5f) / n;
          const float s = std::sqrt(1 - n_l * n_l);
          const glm::vec3 l(s * std::cos(phi), s * std::sin(phi), n_l), v(vx, 0, n_v), h = glm::normalize(l + v);
          const float fresnel = twin::fresnel_schlick(glm::vec3(0), glm::dot(v, h)).x;
          const double weight =
              double(twin::ggx_distribution(h.z, alpha) * twin::smith_visibility(n_l, n_v, alpha) * n_l) * 2 *
              3.14159265358979 / n / n;
          x += weight * (1 - double(fresnel)), y += weight * double(fresnel);
        }
      for (int i = 0; i < 100000; ++i) {
        const float n_h = (float(i) + 0.5f) / 100000;
        normalised += double(twin::ggx_distribution(n_h, alpha) * n_h) * 2 * 3.14159265358979 / 100000;
      }
      const glm::vec2 expected = brute_force(n_v, roughness);
      EXPECT_NEAR(x, double(expected.x), 2e-3) << roughness << " " << n_v;
      EXPECT_NEAR(y, double(expected.y), 2e-3) << roughness << " " << n_v;
      EXPECT_NEAR(normalised, 1, 2e-3) << "the projected area of the microfacets is the surface's";
    }
  // Fresnel: F0 at normal incidence, 1 at grazing; 0.04 + 0.96 / 32 half way.
  EXPECT_NEAR(twin::fresnel_schlick(glm::vec3(0.04f), 0.5f).x, 0.07f, 1e-6f);
  EXPECT_EQ(twin::fresnel_schlick(glm::vec3(0.04f), 0.0f).x, 1.0f);
}

TEST(Lights, FalloffAndWidenedHighlights) {
  // Inside the inner cone, half way (in cosine), outside; cos 0.9 to 0.7.
  const float scale = 1 / 0.2f, offset = -0.7f * scale;
  EXPECT_EQ(twin::light_falloff(0.95f, scale, offset, 4, 0), 1.0f);
  EXPECT_NEAR(twin::light_falloff(0.8f, scale, offset, 4, 0), 0.25f, 1e-5f);
  EXPECT_EQ(twin::light_falloff(0.69f, scale, offset, 4, 0), 0.0f);
  // The window at half and all of the range: 1 - 1/16, 0.
  EXPECT_NEAR(twin::light_falloff(1, 0, 1, 1, 2), 0.9375f, 1e-6f);
  EXPECT_EQ(twin::light_falloff(1, 0, 1, 4, 2), 0.0f);
  // sqrt(0.1^2 + (0.2^2 + 0.1^2) / pi); the bound sqrt(0.1^2 + 0.18); never beyond 1.
  EXPECT_NEAR(twin::widened_alpha(0.1f, {0.2f, 0, 0}, {0, 0.1f, 0}), 0.160983f, 1e-5f);
  EXPECT_NEAR(twin::widened_alpha(0.1f, {1, 1, 0}, {0, 1, 0}), 0.435890f, 1e-5f);
  EXPECT_EQ(twin::widened_alpha(0.3f, {}, {}), 0.3f);
  EXPECT_EQ(twin::widened_alpha(1, {1, 0, 0}, {}), 1.0f);
}

glm::vec3 any_direction(std::mt19937& engine) {
  std::uniform_real_distribution<float> any(-1, 1);
  return glm::normalize(glm::vec3(any(engine), any(engine), any(engine)));
}

TEST(Shadow, AxesOfMapsAreThoseOfTheShader) {
  std::mt19937 engine(3);
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 axis =
        i < 6 ? glm::vec3(i / 2 == 0, i / 2 == 1, i / 2 == 2) * (i % 2 ? -1.0f : 1.0f) : any_direction(engine);
    glm::vec3 right, down, twin_right, twin_down;
    map_axes(axis, right, down);
    twin::map_axes(axis, twin_right, twin_down);
    EXPECT_EQ(right, twin_right);
    EXPECT_EQ(down, twin_down);
    EXPECT_NEAR(glm::length(right), 1, 1e-5f);
    EXPECT_NEAR(glm::length(glm::cross(right, down) - axis), 0, 1e-5f);
  }
}

scene::Camera camera_at(glm::vec3 position, glm::vec3 forward) {
  return {.name = "", .position = position, .forward = glm::normalize(forward), .vfov = 1.0f, .far = 100};
}

// Every point of the scene that the camera sees lies in a cascade; nearer to the light is greater.
TEST(Shadow, CascadesCoverWhatTheCameraSees) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> unit(0, 1);
  const scene::Bounds bounds{{-30, 0, -10}, {50, 12, 70}};
  const glm::uvec2 size(320, 180);
  for (int i = 0; i < 200; ++i) {
    ShadowParams params;
    params.cascades = 1 + i % 4;
    const scene::DirectionalLight light{.direction = i == 0 ? glm::vec3(0, -1, 0) : any_direction(engine)};
    const scene::Camera camera =
        camera_at(glm::mix(bounds.min, bounds.max, glm::vec3(unit(engine), unit(engine), unit(engine))),
                  any_direction(engine) + glm::vec3(0.01f));
    const SunBlock sun = fit_sun(camera, size, bounds, light, params);
    ASSERT_GE(sun.cascade_count, 1u);
    ASSERT_LE(sun.cascade_count, uint32_t(params.cascades));
    const glm::mat4 clip_from_world = scene::clip_from_view(camera, size) * scene::view_from_world(camera);
    for (int k = 0; k < 300; ++k) {
      const glm::vec3 at = glm::mix(bounds.min, bounds.max, glm::vec3(unit(engine), unit(engine), unit(engine)));
      const glm::vec4 seen = clip_from_world * glm::vec4(at, 1);
      if (seen.w < camera.near || std::abs(seen.x) > seen.w || std::abs(seen.y) > seen.w) continue;
      float least = 10;
      for (uint32_t c = 0; c < sun.cascade_count; ++c) {
        const glm::vec4 p = clip_from_cascade(sun, c) * glm::vec4(at, 1);
        least = std::min(least, std::max(std::abs(p.x), std::abs(p.y)));
        EXPECT_GE(p.z, 0);
        EXPECT_LE(p.z, 1);
        EXPECT_GT(p.z, (clip_from_cascade(sun, c) * glm::vec4(at + sun.direction * 0.1f, 1)).z);
      }
      EXPECT_LE(least, 1) << "camera " << i;
    }
  }
}

// Turning the camera keeps every cascade's size; moving it shifts the maps by whole texels.
TEST(Shadow, CascadesStandStill) {
  const scene::Bounds bounds{{-100, 0, -100}, {100, 20, 100}};
  ShadowParams params;
  params.distance = 60;
  const scene::DirectionalLight light{.direction = glm::normalize(glm::vec3(0.3f, -1, 0.2f))};
  const SunBlock first = fit_sun(camera_at({0, 2, 0}, {0, 0, -1}), {320, 180}, bounds, light, params);
  ASSERT_EQ(first.cascade_count, 3u);
  for (int i = 1; i < 100; ++i) {
    const float angle = 0.1f * float(i);
    const SunBlock sun =
        fit_sun(camera_at({0.37f * float(i) - 15, 2, 0.11f * float(i)}, {std::sin(angle), -0.1f, std::cos(angle)}),
                {320, 180}, bounds, light, params);
    ASSERT_EQ(sun.cascade_count, first.cascade_count);
    for (uint32_t c = 0; c < sun.cascade_count; ++c) {
      const glm::vec3 a = cascade_of(first, c), b = cascade_of(sun, c);
      EXPECT_EQ(a.z, b.z);
      const float texel = 2 / (a.z * float(params.resolution));
      const glm::vec2 moved = (glm::vec2(b) - glm::vec2(a)) / texel;
      EXPECT_NEAR(moved.x, std::round(moved.x), 0.02f);
      EXPECT_NEAR(moved.y, std::round(moved.y), 0.02f);
    }
  }
}

// What the shader takes for the face of a direction, its tile has in sight.
TEST(Shadow, SixTilesSeeEverything) {
  scene::Scene scene;
  scene.punctual.push_back({.position = {1, 2, 3}, .intensity = 1});
  const ShadowPlan plan = plan_shadows(camera_at({}, {0, 0, -1}), {16, 16}, scene, {});
  ASSERT_EQ(plan.tiles.size(), 6u);
  std::mt19937 engine(5);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 d = any_direction(engine) * 3.0f;
    glm::vec3 axis;
    const int face = twin::face_of(d, axis);
    EXPECT_EQ(axis, plan.tiles[size_t(face)].axis);
    const glm::vec4 p = clip_from_tile(plan.tiles[size_t(face)]) * glm::vec4(scene.punctual[0].position + d, 1);
    EXPECT_GE(p.w, 3 / std::sqrt(3.0f) - 1e-4f);
    EXPECT_LE(std::abs(p.x), p.w);
    EXPECT_LE(std::abs(p.y), p.w);
    EXPECT_NEAR(p.z / p.w, plan.tiles[0].near / glm::dot(axis, d), 1e-6f);
  }
}

TEST(Shadow, TilesGoToTheLightsThatMatter) {
  scene::Scene scene;
  const auto add = [&](glm::vec3 at, float intensity, bool spot) {
    scene::PunctualLight l{.position = at, .intensity = intensity};
    if (spot) l.inner_cone = 0.2f, l.outer_cone = 0.5f;
    scene.punctual.push_back(l);
  };
  add({50, 0, 0}, 10, false);  // far away
  add({2, 0, 0}, 10, false);
  add({1, 0, 0}, 10, true);
  add({1, 0, 0}, 0.01f, true);
  ShadowParams params;
  params.tiles = 8;
  const scene::Camera camera = camera_at({}, {1, 0, 0});
  EXPECT_EQ(plan_shadows(camera, {16, 16}, scene, params).first_tile, (std::vector<int32_t>{-1, 0, 6, 7}));
  params.tiles = 1;
  EXPECT_EQ(plan_shadows(camera, {16, 16}, scene, params).first_tile, (std::vector<int32_t>{-1, -1, 0, -1}));
  params.tiles = 14;
  EXPECT_EQ(plan_shadows(camera, {16, 16}, scene, params).first_tile, (std::vector<int32_t>{0, 6, 12, 13}));
  params.enabled = 0;
  EXPECT_TRUE(plan_shadows(camera, {16, 16}, scene, params).tiles.empty());
}

// No light that reaches a point is missing from the point's cluster; most others are.
TEST(LightGrid, HoldsEveryLightThatReaches) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> unit(0, 1);
  scene::Scene scene;
  for (int i = 0; i < 300; ++i) {
    scene::PunctualLight l{.position = {unit(engine) * 40 - 20, unit(engine) * 4, unit(engine) * 40 - 20},
                           .direction = any_direction(engine),
                           .intensity = 1,
                           .range = i % 7 ? 1 + 3 * unit(engine) : 0};
    if (i % 2) l.inner_cone = 0.1f, l.outer_cone = 0.2f + 1.5f * unit(engine);
    scene.punctual.push_back(l);
  }
  const LightTable table = make_light_table(scene, {});
  EXPECT_EQ(table.global, 43u);
  size_t listed = 0, reached = 0, looked = 0;
  for (int view = 0; view < 20; ++view) {
    const scene::Camera camera =
        camera_at({unit(engine) * 20 - 10, 2, unit(engine) * 20 - 10}, any_direction(engine) + glm::vec3(0.01f));
    const glm::uvec2 size(333, 177);
    const glm::vec2 jitter(0.4f, -0.3f);
    const LightGrid grid = make_light_grid(table, camera, size, jitter, 80);
    const glm::mat4 world_from_view = glm::inverse(scene::view_from_world(camera));
    const float focal = 0.5f * float(size.y) / std::tan(camera.vfov / 2);
    for (int k = 0; k < 400; ++k) {
      const glm::uvec2 pixel(unit(engine) * float(size.x), unit(engine) * float(size.y));
      const float z = std::exp2(unit(engine) * 11 - 5);
      const glm::vec2 from_middle = glm::vec2(pixel) + 0.5f - glm::vec2(size) * 0.5f - jitter;
      const glm::vec3 at = world_from_view * glm::vec4(from_middle.x / focal * z, -from_middle.y / focal * z, -z, 1);
      const float slice =
          std::clamp(std::floor(std::log2(z) * grid.slice_scale + grid.slice_offset), 0.0f, float(cluster_slices - 1));
      const size_t cluster =
          (size_t(slice) * grid.height + pixel.y / cluster_pixels) * grid.width + pixel.x / cluster_pixels;
      const auto begin = grid.indices.begin() + grid.first[cluster],
                 end = grid.indices.begin() + grid.first[cluster + 1];
      EXPECT_TRUE(std::is_sorted(begin, end));
      listed += size_t(end - begin), ++looked;
      for (uint32_t i = table.global; i < table.rows.size(); ++i) {
        const LightRow& l = table.rows[i];
        const glm::vec3 to = l.position - at;
        if (twin::light_falloff(-glm::dot(l.direction, glm::normalize(to)), l.cone_scale, l.cone_offset,
                                glm::dot(to, to), l.range) <= 0)
          continue;
        ++reached;
        EXPECT_TRUE(std::binary_search(begin, end, i)) << "view " << view << ", light " << i;
      }
    }
  }
  EXPECT_GT(reached, 500u);
  std::printf("a cluster lists %.1f lights, a point is reached by %.1f of %zu\n", double(listed) / double(looked),
              double(reached) / double(looked), table.rows.size() - table.global);
  EXPECT_LT(double(listed), 0.1 * double(looked) * double(table.rows.size()));
}

TEST(Mips, AverageInLinearLight) {
  scene::Picture picture{.name = "checker", .width = 4, .height = 2, .srgb = true, .rgba = {}};
  for (int i = 0; i < 8; ++i) {
    const uint8_t v = (i + i / 4) % 2 ? 255 : 0;
    picture.rgba.insert(picture.rgba.end(), {v, v, v, v});
  }
  auto levels = make_mips(picture);
  ASSERT_EQ(levels.size(), 3u);
  EXPECT_EQ(levels[0], picture.rgba);
  EXPECT_EQ(levels[1].size(), 8u);
  EXPECT_EQ(levels[2].size(), 4u);
  EXPECT_NEAR(levels[2][0], 188, 1) << "half the light is 188 in sRGB";
  EXPECT_NEAR(levels[2][3], 128, 1) << "alpha is linear";
  picture.srgb = false;
  EXPECT_NEAR(make_mips(picture)[2][0], 128, 1);
}

}  // namespace
}  // namespace nf::passes
