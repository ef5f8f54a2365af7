// The random numbers and the densities that the path tracer is made of.
#include <gtest/gtest.h>
#include <numbers>
#include <set>

#include "reference/sampler.h"
#include "reference/scatter.h"

namespace nf::reference {
namespace {

constexpr double pi_ = std::numbers::pi;

// Any 2^k consecutive points from a multiple of 2^k on have one point in every elementary interval of area 2^-k, in
// every pair of dimensions, after scrambling and shuffling.
TEST(Sampler, SobolPointsAreStratified) {
  for (const uint64_t key : {1u, 77u}) {
    for (const uint32_t first : {0u, 256u, 4096u}) {
      for (int pair = 0; pair < 3; ++pair) {
        for (int a = 0; a <= 8; ++a) {
          std::set<std::pair<int, int>> cells;
          for (uint32_t i = first; i < first + 256; ++i) {
            Stream stream(SamplerKind::Sobol, key, i);
            glm::vec2 u(0);
            for (int p = 0; p <= pair; ++p) u = stream.next2();
            cells.insert({int(u.x * float(1 << a)), int(u.y * float(1 << (8 - a)))});
          }
          EXPECT_EQ(cells.size(), 256u) << key << " " << first << " " << pair << " " << a;
        }
      }
    }
  }
}

// Pairs of dimensions, and keys, must not know of each other: correlations of n numbers are within 4 / sqrt(n).
TEST(Sampler, DimensionsAreUnrelated) {
  constexpr uint32_t n = 4096;
  for (const SamplerKind kind : {SamplerKind::Sobol, SamplerKind::Independent}) {
    double sum = 0, square = 0, across = 0, keys = 0;
    for (uint32_t i = 0; i < n; ++i) {
      Stream s(kind, 5, i), t(kind, 6, i);
      const glm::dvec2 a = s.next2(), b = s.next2(), c = t.next2();
      for (const double v : {a.x, a.y, b.x, b.y}) EXPECT_TRUE(v >= 0 && v < 1);
      sum += a.x;
      square += a.x * a.x;
      across += 12 * (a.x - 0.5) * (b.x - 0.5);
      keys += 12 * (a.x - 0.5) * (c.x - 0.5);
    }
    EXPECT_NEAR(sum / n, 0.5, 0.02);
    EXPECT_NEAR(square / n, 1.0 / 3, 0.02);
    EXPECT_LT(std::abs(across / n), 4 / std::sqrt(double(n)));
    EXPECT_LT(std::abs(keys / n), 4 / std::sqrt(double(n)));
  }
}

TEST(Scatter, FramesAreOrthonormal) {
  for (const vec3 n : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(1, 0, 0), glm::normalize(vec3(1, -2, 3)),
                       glm::normalize(vec3(1e-5f, 0, -1))}) {
    const mat3 f = frame_about(n);
    const mat3 product = glm::transpose(f) * f;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j ? 1 : 0, 1e-5f);
    EXPECT_NEAR(glm::determinant(f), 1, 1e-5f);
    EXPECT_NEAR(glm::length(f[2] - n), 0, 1e-6f);
  }
}

// E[z^m] under cos / pi is 2 / (m + 2).
TEST(Scatter, CosineDirections) {
  double z1 = 0, z3 = 0, x = 0, xx = 0;
  constexpr uint32_t n = 1 << 16;
  for (uint32_t i = 0; i < n; ++i) {
    const vec3 d = cosine_direction(Stream(SamplerKind::Sobol, 3, i).next2());
    EXPECT_NEAR(glm::length(d), 1, 1e-5f);
    z1 += double(d.z) / n, z3 += std::pow(double(d.z), 3) / n, x += double(d.x) / n, xx += double(d.x * d.x) / n;
  }
  EXPECT_NEAR(z1, 2.0 / 3, 1e-4);
  EXPECT_NEAR(z3, 2.0 / 5, 1e-4);
  EXPECT_NEAR(x, 0, 1e-4);
  EXPECT_NEAR(xx, 0.25, 1e-4);
}

// Sampling by specular_direction with weight f / density gives what quadrature gives; and the density is one: its own
// integral is the share of directions above the horizon.
TEST(Scatter, SpecularDensityFitsItsDirections) {
  for (const float roughness : {0.25f, 0.5f, 1.0f}) {
    for (const float cosine : {0.15f, 0.6f, 1.0f}) {
      const float alpha = alpha_of(roughness);
      const vec3 v(std::sqrt(1 - cosine * cosine), 0, cosine), f0(0.8f, 0.3f, 0.04f);
      glm::dvec3 sampled(0), summed(0);
      double above = 0, density = 0, moment = 0, moment_summed = 0;
      constexpr uint32_t n = 1 << 16;
      for (uint32_t i = 0; i < n; ++i) {
        const vec3 l = specular_direction(alpha, v, Stream(SamplerKind::Sobol, 9, i).next2());
        if (l.z <= 0) continue;
        above += 1.0 / n;
        moment += double(l.x) / n;
        sampled += glm::dvec3(specular(f0, alpha, v, l) / specular_density(alpha, v, l)) / double(n);
      }
      constexpr int steps = 1500;
      for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
          const double z = (i + 0.5) / steps, phi = 2 * pi_ * (j + 0.5) / steps, r = std::sqrt(1 - z * z);
          const vec3 l(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z));
          const double area = 2 * pi_ / (double(steps) * steps), d = double(specular_density(alpha, v, l)) * area;
          summed += glm::dvec3(specular(f0, alpha, v, l)) * area;
          density += d;
          moment_summed += d * double(l.x);
        }
      }
      EXPECT_NEAR(density, above, 3e-3) << roughness << " " << cosine;
      EXPECT_NEAR(moment_summed, moment, 3e-3) << roughness << " " << cosine;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(sampled[c], summed[c], 3e-3) << roughness << " " << cosine;
    }
  }
}

}  // namespace
}  // namespace nf::reference
