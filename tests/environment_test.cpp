// Environments off the device: maps and gradients against their definitions, spherical harmonics against Monte Carlo
// integration, prefiltered mips against quadrature of the lobe. None of the reference code is the engine's.
#include <chrono>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "core/error.h"
#include "scene/environment_light.h"
#include "sky.h"

namespace nf::scene {
namespace {

using glm::dvec3;
using glm::vec3;
constexpr double pi = 3.14159265358979323846;

Environment sky_environment(const content::Sky& sky, uint32_t width, float rotation_deg = 0) {
  return make_environment_map(content::sky_map(sky, width), "test", 1, rotation_deg);
}

// The texel that shows a direction, by the definition of the map.
vec3 nearest(const Environment& map, dvec3 d) {
  const double u = 0.5 + std::atan2(d.z, d.x) / (2 * pi), v = 0.5 + std::asin(std::clamp(d.y, -1.0, 1.0)) / pi;
  const uint32_t x = std::min(uint32_t(u * map.width), map.width - 1);
  const uint32_t y = std::min(uint32_t((1 - v) * map.height), map.height - 1);
  return map.texels[size_t(y) * map.width + x];
}

// Directions uniform over a cone about `axis`, in `side` squared jittered strata; `f` gets each with its solid angle.
void cone(dvec3 axis, double cosine, int side, std::mt19937_64& random, const std::function<void(dvec3, double)>& f) {
  const dvec3 t = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 1, 0))),
              b = glm::cross(axis, t);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double z = 1 - (1 - cosine) * (i + any(random)) / side, r = std::sqrt(std::max(1 - z * z, 0.0));
      const double phi = 2 * pi * (j + any(random)) / side;
      f(axis * z + (t * std::cos(phi) + b * std::sin(phi)) * r, 2 * pi * (1 - cosine) / side / side);
    }
}

// Real spherical harmonic by its angles, z the polar axis, without the Condon-Shortley sign.
double harmonic(int l, int m, dvec3 d) {
  const double theta = std::acos(std::clamp(d.z, -1.0, 1.0)), phi = std::atan2(d.y, d.x);
  const int a = std::abs(m);
  double quotient = 1;  // (l - a)! / (l + a)!
  for (int i = l - a + 1; i <= l + a; ++i) quotient /= i;
  const double scale =
      std::sqrt((2 * l + 1) / (4 * pi) * quotient) * std::assoc_legendre(unsigned(l), unsigned(a), std::cos(theta));
  return m == 0 ? scale : std::sqrt(2.0) * scale * (m > 0 ? std::cos(a * phi) : std::sin(a * phi));
}

struct Case {
  const char* name;
  content::Sky sky;
};
std::vector<Case> cases() {
  return {{"smooth sky", content::hazy()}, {"sky with a sun disc", content::afternoon()}};
}

TEST(Environment, MapIsReadByItsDefinition) {
  image::Image picture{4, 2, 3, {}};
  for (int i = 0; i < 8; ++i) picture.pixels.insert(picture.pixels.end(), {float(i + 1), 0, 1});
  const Environment map = make_environment_map(picture, "test", 2);
  // Column c's centre lies at a longitude of 90 c - 135 degrees, row 0's at a latitude of +45.
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 2; ++row) {
      const double longitude = (90 * column - 135) * pi / 180, latitude = (row ? -45 : 45) * pi / 180;
      const vec3 d(std::cos(latitude) * std::cos(longitude), std::sin(latitude),
                   std::cos(latitude) * std::sin(longitude));
      EXPECT_NEAR(radiance(map, d).x, 2.0f * float(4 * row + column + 1), 1e-5f) << column << "," << row;
      EXPECT_EQ(radiance(map, d).z, 2);
    }
  // -X is where the map's ends meet: half of the first and of the last column, and of both rows.
  EXPECT_NEAR(radiance(map, {-1, 0, 0}).x, 2 * (1 + 4 + 5 + 8) / 4.0f, 1e-4f);
  EXPECT_NEAR(radiance(map, {1, 0, 0}).x, 2 * (2 + 3 + 6 + 7) / 4.0f, 1e-4f);
}

TEST(Environment, RotationTurnsAboutY) {
  const Environment still = sky_environment(content::hazy(), 64), turned = sky_environment(content::hazy(), 64, 90),
                    back = sky_environment(content::hazy(), 64, -270);
  std::mt19937 random(3);
  std::normal_distribution<float> any;
  const Harmonics sh = project(still), sh_turned = project(turned);
  for (int i = 0; i < 100; ++i) {
    const vec3 d = glm::normalize(vec3(any(random), any(random), any(random)));
    const vec3 d_turned(d.z, d.y, -d.x);  // right-handed: +Z goes to +X, +X to -Z
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(radiance(turned, d_turned)[c], radiance(still, d)[c], 2e-3f);
      EXPECT_NEAR(radiance(turned, d)[c], radiance(back, d)[c], 2e-3f);
      EXPECT_NEAR(evaluate(sh_turned, d_turned)[c], evaluate(sh, d)[c], 1e-4f);
    }
  }
}

TEST(Environment, BadTexelsAreClampedAndCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const image::Image picture{4, 2, 3, {nan,  1, 1, -1, 2, -3, inf, 1, 1, 1e30f, 0,  0,  //
                                       -inf, 0, 0, 1,  2, 3,  0,   0, 0, nan,   -1, inf}};
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const Environment map = make_environment_map(picture, "bad\nname.hdr", 2);
  const std::string text = testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout();
  EXPECT_NE(text.find("2 texels with NaN, 3 negative and 3 infinite or too large, of 8"), std::string::npos) << text;
  EXPECT_NE(text.find("bad?name.hdr"), std::string::npos) << text;
  EXPECT_EQ(map.texels[0], vec3(0, 2, 2));
  EXPECT_EQ(map.texels[1], vec3(0, 4, 0));
  EXPECT_EQ(map.texels[2], vec3(131008, 2, 2));
  EXPECT_EQ(map.texels[3], vec3(1e9f, 0, 0));
  EXPECT_EQ(map.texels[4], vec3(0));
  EXPECT_EQ(map.texels[5], vec3(2, 4, 6));
  EXPECT_EQ(map.texels[7], vec3(0, 0, 131008));
  for (const vec3& c : project(map)) EXPECT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z));
}

TEST(Environment, OddShapesWarnAndWrongOnesFail) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const Environment square = make_environment_map({3, 3, 4, std::vector<float>(36, 1.0f)}, "square.hdr");
  const std::string text = testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout();
  EXPECT_NE(text.find("'square.hdr' is 3x3, not 2:1"), std::string::npos) << text;
  EXPECT_EQ(square.texels.size(), 9u);
  EXPECT_THROW(make_environment_map({2, 1, 1, {1, 1}}, "grey.exr"), Error);
  EXPECT_THROW(make_environment_map({16385, 1, 3, std::vector<float>(16385 * 3)}, "wide.exr"), Error);
}

// The gradient's moments over the sphere have a closed form: with w = (1 - |y|)^4, the integrals over 0..1 of w, w y
// and w y^2 are 1/5, 1/30 and 1/105.
TEST(Environment, GradientHasItsClosedForm) {
  Environment e{.kind = EnvironmentKind::Gradient,
                .zenith = vec3(0.2f, 0.4f, 1),
                .horizon = vec3(1, 0.9f, 0.8f),
                .ground = vec3(0.3f, 0.2f, 0.1f)};
  EXPECT_EQ(radiance(e, {0, 1, 0}), e.zenith);
  EXPECT_EQ(radiance(e, {0, -1, 0}), e.ground);
  EXPECT_EQ(radiance(e, {0.6f, 0, 0.8f}), e.horizon);
  const vec3 half = radiance(e, {0, 0.5f, std::sqrt(0.75f)});
  EXPECT_NEAR(half.x, 0.2f + 0.8f / 16, 1e-6f);
  const Harmonics sh = project(e);
  for (int c = 0; c < 3; ++c) {
    const double up = e.horizon[c] - e.zenith[c], down = e.horizon[c] - e.ground[c];
    const double m0 = e.zenith[c] + up / 5 + e.ground[c] + down / 5;
    const double m1 = e.zenith[c] / 2.0 + up / 30 - e.ground[c] / 2.0 - down / 30;
    const double m2 = e.zenith[c] / 3.0 + up / 105 + e.ground[c] / 3.0 + down / 105;
    EXPECT_NEAR(sh[0][c], 2 * pi * m0 * std::sqrt(1 / (4 * pi)), 1e-5);
    EXPECT_NEAR(sh[1][c], 2 * pi * m1 * std::sqrt(3 / (4 * pi)), 1e-5);
    // Turned about y only Y20 and Y22 are left of l = 2: means of 3z^2 - 1 and x^2 - y^2 with z^2 = x^2 = (1 - y^2)
    // / 2.
    EXPECT_NEAR(sh[6][c], 2 * pi * (m0 / 2 - 1.5 * m2) * std::sqrt(5 / (16 * pi)), 1e-5);
    EXPECT_NEAR(sh[8][c], 2 * pi * (m0 / 2 - 1.5 * m2) * std::sqrt(15 / (16 * pi)), 1e-5);
    for (const size_t zero : {2u, 3u, 4u, 5u, 7u}) EXPECT_NEAR(sh[zero][c], 0, 1e-6);
  }
}

TEST(SphericalHarmonics, EqualMonteCarlo) {
  constexpr int degree[] = {0, 1, 1, 1, 2, 2, 2, 2, 2}, order[] = {0, -1, 0, 1, -2, -1, 0, 1, 2};
  for (const Case& test : cases()) {
    const Environment map = sky_environment(test.sky, 512);
    std::mt19937_64 random(7);
    std::array<dvec3, 9> expected{};
    const auto add = [&](dvec3 d, double solid_angle) {
      const dvec3 light = dvec3(nearest(map, d)) * solid_angle;
      for (size_t i = 0; i < 9; ++i) expected[i] += light * harmonic(degree[i], order[i], d);
    };
    // The sun's cone has samples of its own, and only those: the disc has little solid angle and much light.
    const dvec3 sun(test.sky.to_sun);
    const double edge = std::cos(3 * pi / 180);
    cone(sun, edge, 300, random, add);
    cone(-sun, -edge, 900, random, add);
    const Harmonics got = project(map);
    double largest = 0, worst = 0;
    for (const dvec3& c : expected) largest = std::max({largest, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    for (size_t i = 0; i < 9; ++i)
      for (int c = 0; c < 3; ++c) {
        // Of itself; of a hundredth of the largest where it is next to nothing.
        const double size = std::max(std::abs(expected[i][c]), 0.01 * largest);
        const double error = std::abs(double(got[i][c]) - expected[i][c]) / size;
        EXPECT_LT(error, 0.01) << test.name << ", coefficient " << i << ", channel " << c << ": " << got[i][c]
                               << " for " << expected[i][c];
        worst = std::max(worst, error);
      }
    std::printf("%s: coefficients off by %.3f %% at most\n", test.name, 100 * worst);
  }
}

// Irradiance by the sum over all texels, 500 normals along a spiral.
struct IrradianceError {
  double rms = 0, largest = 0, least = 1e30;  // rms and largest over the rms irradiance
};
IrradianceError irradiance_error(const Environment& map) {
  const Harmonics sh = irradiance_over_pi(project(map));
  std::vector<std::pair<vec3, float>> texels;
  for (uint32_t i = 0; i < map.texels.size(); ++i) {
    const double top = pi * (i / map.width) / map.height, bottom = pi * (i / map.width + 1.0) / map.height;
    const double latitude = pi / 2 - (top + bottom) / 2, longitude = 2 * pi * ((i % map.width + 0.5) / map.width - 0.5);
    texels.emplace_back(
        vec3(std::cos(latitude) * std::cos(longitude), std::sin(latitude), std::cos(latitude) * std::sin(longitude)),
        float((std::cos(top) - std::cos(bottom)) * 2 * pi / map.width));
  }
  IrradianceError out;
  double squares = 0, errors = 0;
  constexpr int normals = 500;
  for (int n = 0; n < normals; ++n) {
    const float y = 1 - (2 * float(n) + 1) / normals, phi = 2.39996323f * float(n), r = std::sqrt(1 - y * y);
    const vec3 normal(r * std::cos(phi), y, r * std::sin(phi));
    dvec3 sum(0);
    for (size_t i = 0; i < texels.size(); ++i)
      if (const float cosine = glm::dot(texels[i].first, normal); cosine > 0)
        sum += dvec3(map.texels[i] * (cosine * texels[i].second));
    const vec3 got = evaluate(sh, normal);
    for (int c = 0; c < 3; ++c) {
      const double error = double(got[c]) * pi - sum[c];
      squares += sum[c] * sum[c], errors += error * error;
      out.largest = std::max(out.largest, std::abs(error));
      out.least = std::min(out.least, double(got[c]));
    }
  }
  const double scale = std::sqrt(squares / (3 * normals));
  out.rms = std::sqrt(errors / (3 * normals)) / scale;
  out.largest /= scale;
  return out;
}

TEST(SphericalHarmonics, IrradianceOverNormals) {
  for (const Case& test : cases()) {
    const IrradianceError error = irradiance_error(sky_environment(test.sky, 256));
    EXPECT_LT(error.rms, 0.02) << test.name;
    EXPECT_GT(error.least, 0) << test.name;
    std::printf("%s: irradiance over 500 normals off by %.2f %% (rms), %.2f %% at most, of its rms\n", test.name,
                100 * error.rms, 100 * error.largest);
  }
  // What second order cannot do, on record: a sun in black space is a clamped cosine, of which 8.8 % (rms) lie beyond.
  content::Sky space = content::afternoon();
  space.zenith = space.horizon = space.ground = space.glow = vec3(0);
  const IrradianceError error = irradiance_error(sky_environment(space, 256));
  EXPECT_NEAR(error.rms, 0.088, 0.004);
  EXPECT_LT(error.least, 0) << "rings below zero: why evaluate_positive() is there";
  EXPECT_EQ(evaluate_positive(irradiance_over_pi(project(sky_environment(space, 64))),
                              -space.to_sun * 0.6f + glm::normalize(glm::cross(space.to_sun, vec3(0, 1, 0))) * 0.8f),
            vec3(0));
}

TEST(SphericalHarmonics, PolynomialIsTheSameFunction) {
  const Harmonics sh = project(sky_environment(content::hazy(), 64)), p = to_polynomial(sh);
  for (const vec3 d : {vec3(1, 0, 0), vec3(0.6f, 0, -0.8f), vec3(0.48f, 0.6f, 0.64f), vec3(0, -1, 0)}) {
    const vec3 value = p[0] + p[1] * d.y + p[2] * d.z + p[3] * d.x + p[4] * d.x * d.y + p[5] * d.y * d.z +
                       p[6] * (3 * d.z * d.z - 1) + p[7] * d.x * d.z + p[8] * (d.x * d.x - d.y * d.y);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], evaluate(sh, d)[c], 1e-5f);
  }
}

TEST(Prefilter, FacesAreThoseOfVulkan) {
  // The specification's table "Cube map face and coordinate selection": centres, and the upper left corners.
  const vec3 centre[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const vec3 corner[] = {{1, 1, 1}, {-1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, -1}};
  for (uint32_t face = 0; face < 6; ++face) {
    EXPECT_EQ(cube_direction(face, 0.5f, 0.5f), centre[face]);
    EXPECT_EQ(cube_direction(face, 0, 0), corner[face]);
  }
}

TEST(Prefilter, RoughnessAndMipAreInverse) {
  EXPECT_EQ(prefilter_roughness(0, 6), 0);
  EXPECT_EQ(prefilter_roughness(5, 6), 1);
  for (uint32_t mip = 0; mip < 6; ++mip) EXPECT_NEAR(prefilter_mip(prefilter_roughness(mip, 6), 6), float(mip), 1e-5f);
}

TEST(Prefilter, ConstantStaysConstant) {
  const PrefilteredCube cube = prefilter(make_environment_map({8, 4, 3, std::vector<float>(96, 0.75f)}, "flat"));
  ASSERT_EQ(cube.side, 64u);
  ASSERT_EQ(cube.mips.size(), 4u);
  for (size_t mip = 0; mip < cube.mips.size(); ++mip) {
    ASSERT_EQ(cube.mips[mip].size(), 6 * (64u >> mip) * (64u >> mip));
    for (const vec3& texel : cube.mips[mip]) ASSERT_NEAR(texel.x, 0.75f, 1e-5f);
  }
}

// The lobe D(h) n.l about `n` by quadrature over all texels.
vec3 lobe_quadrature(const Environment& map, dvec3 n, double roughness) {
  const double a2 = std::pow(roughness, 4);
  dvec3 sum(0);
  double weight = 0;
  for (uint32_t y = 0; y < map.height; ++y)
    for (uint32_t x = 0; x < map.width; ++x) {
      const double latitude = pi / 2 - pi * (y + 0.5) / map.height, longitude = 2 * pi * ((x + 0.5) / map.width - 0.5);
      const dvec3 l(std::cos(latitude) * std::cos(longitude), std::sin(latitude),
                    std::cos(latitude) * std::sin(longitude));
      const double n_l = glm::dot(n, l);
      if (n_l <= 0) continue;
      const double n_h2 = (1 + n_l) / 2, d = n_h2 * (a2 - 1) + 1;
      const double w = a2 / (d * d) * n_l * std::cos(latitude);
      sum += w * dvec3(map.texels[size_t(y) * map.width + x]);
      weight += w;
    }
  return vec3(sum / weight);
}

TEST(Prefilter, MipsEqualTheLobe) {
  for (const Case& test : cases()) {
    const Environment map = sky_environment(test.sky, 512);
    const PrefilteredCube cube = prefilter(map);
    const uint32_t mips = uint32_t(cube.mips.size());
    for (uint32_t mip = 1; mip < mips; ++mip) {
      const uint32_t side = cube.side >> mip;
      std::mt19937 random(mip);
      double worst = 0, squares = 0, errors = 0;
      constexpr int tries = 60;
      for (int i = 0; i < tries; ++i) {
        uint32_t face = uint32_t(random() % 6), x = uint32_t(random() % side), y = uint32_t(random() % side);
        if (i == 0) {  // the texel that faces the sun
          double best = -1;
          for (uint32_t t = 0; t < 6 * side * side; ++t) {
            const vec3 d = glm::normalize(cube_direction(t / (side * side), (float(t % side) + 0.5f) / float(side),
                                                         (float(t / side % side) + 0.5f) / float(side)));
            if (glm::dot(d, test.sky.to_sun) > best)
              best = glm::dot(d, test.sky.to_sun), face = t / (side * side), x = t % side, y = t / side % side;
          }
        }
        const dvec3 n = glm::normalize(
            dvec3(cube_direction(face, (float(x) + 0.5f) / float(side), (float(y) + 0.5f) / float(side))));
        const vec3 expected = lobe_quadrature(map, n, double(prefilter_roughness(mip, mips)));
        const vec3 got = cube.mips[mip][(size_t(face) * side + y) * side + x];
        for (int c = 0; c < 3; ++c) {
          const double error = double(got[c]) - double(expected[c]);
          worst = std::max(worst, std::abs(error) / double(expected[c]));
          squares += double(expected[c]) * double(expected[c]), errors += error * error;
        }
      }
      // The first mip's lobe is as narrow as the cube's texels, and the disc is no wider.
      const bool disc = test.sky.sun.x > 0;
      EXPECT_LT(std::sqrt(errors / squares), disc && mip == 1 ? 0.08 : 0.02) << test.name << ", mip " << mip;
      EXPECT_LT(worst, disc && mip == 1 ? 0.08 : disc ? 0.05 : 0.02) << test.name << ", mip " << mip;
      std::printf("%s: mip %u, roughness %.3f: rms %.2f %%, at most %.1f %%\n", test.name, mip,
                  double(prefilter_roughness(mip, mips)), 100 * std::sqrt(errors / squares), 100 * worst);
    }
  }
}

TEST(Prefilter, KeepsTheLightAndRepeats) {
  const Environment map = sky_environment(content::afternoon(), 1024);
  const auto start = std::chrono::steady_clock::now();
  const Harmonics sh = project(map);
  const auto middle = std::chrono::steady_clock::now();
  const PrefilteredCube cube = prefilter(map), again = prefilter(map);
  const std::chrono::duration<double, std::milli> first = middle - start,
                                                  second = std::chrono::steady_clock::now() - middle;
  std::printf("1024 x 512: harmonics %.0f ms, mips %.0f ms\n", first.count(), second.count() / 2);
  EXPECT_EQ(cube.mips, again.mips);
  // The mean over the sphere is that of the map.
  for (const size_t mip : {0u, 1u}) {
    const uint32_t side = cube.side >> mip;
    dvec3 sum(0);
    double weight = 0;
    for (uint32_t t = 0; t < 6 * side * side; ++t) {
      const double x = 2 * (t % side + 0.5) / side - 1, y = 2 * (t / side % side + 0.5) / side - 1;
      const double w = std::pow(1 + x * x + y * y, -1.5);
      sum += w * dvec3(cube.mips[mip][t]);
      weight += w;
    }
    const dvec3 mean = sum / weight;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / (double(sh[0][c]) / std::sqrt(4 * pi)), 1, 0.01) << "mip " << mip;
  }
}

}  // namespace
}  // namespace nf::scene
