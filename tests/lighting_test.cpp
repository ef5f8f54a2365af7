// Lighting mathematics off the device: the reflectance table and the shadow map's fit.
#include <gtest/gtest.h>
#include <random>

#include "environment.h"
#include "mips.h"
#include "shadow.h"

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

TEST(Shadow, FitCoversTheBoundsFromEveryDirection) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> any(-1, 1);
  const scene::Bounds bounds{{-3, 0, -1}, {5, 2, 7}};
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 direction =
        i == 0 ? glm::vec3(0, -1, 0) : glm::normalize(glm::vec3(any(engine), any(engine), any(engine)));
    float extent = 0;
    const glm::mat4 clip = fit_shadow(bounds, direction, extent);
    EXPECT_GT(extent, 0);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec4 p = clip * glm::vec4(corner & 1 ? 5 : -3, corner & 2 ? 2 : 0, corner & 4 ? 7 : -1, 1);
      EXPECT_LE(std::abs(p.x), 1);
      EXPECT_LE(std::abs(p.y), 1);
      EXPECT_GE(p.z, 0);
      EXPECT_LE(p.z, 1);
    }
    // Nearer to the light is greater.
    const glm::vec4 a = clip * glm::vec4(1, 1, 1, 1), b = clip * glm::vec4(glm::vec3(1, 1, 1) + direction * 0.1f, 1);
    EXPECT_GT(a.z, b.z);
    EXPECT_NEAR(a.x, b.x, 1e-5f);
  }
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
