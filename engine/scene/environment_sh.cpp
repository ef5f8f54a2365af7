// Spherical harmonics of an environment.
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/environment_light.h"

namespace nf::scene {
namespace {

constexpr double pi = glm::pi<double>();

// Factors of the orthonormal basis before its polynomials, in the order of Harmonics.
const std::array<double, 9>& factors() {
  static const double one = std::sqrt(1 / (4 * pi)), linear = std::sqrt(3 / (4 * pi)), cross = std::sqrt(15 / (4 * pi));
  static const std::array<double, 9> all = {one,   linear,   linear, linear, cross, cross, std::sqrt(5 / (16 * pi)),
                                            cross, cross / 2};
  return all;
}

std::array<double, 9> polynomials(glm::dvec3 d) {
  return {1, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3 * d.z * d.z - 1, d.x * d.z, d.x * d.x - d.y * d.y};
}

// Integrals over a range of longitude of 1, cos, sin, cos 2, sin 2.
using Fourier = std::array<double, 5>;
Fourier longitude_integrals(double from, double to) {
  return {to - from, std::sin(to) - std::sin(from), std::cos(from) - std::cos(to),
          (std::sin(2 * to) - std::sin(2 * from)) / 2, (std::cos(2 * from) - std::cos(2 * to)) / 2};
}

// Antiderivatives over the sphere's measure cos(a) da, a the latitude: of 1, sin, cos, sin cos, cos^2, sin^2.
std::array<double, 6> latitude_integrals(double a) {
  const double s = std::sin(a), c = std::cos(a);
  return {s, s * s / 2, a / 2 + s * c / 2, -c * c * c / 3, s - s * s * s / 3, s * s * s / 3};
}

}  // namespace

Harmonics project(const Environment& environment) {
  const bool is_map = environment.kind == EnvironmentKind::Map;
  const Environment made = is_map ? Environment{} : as_map(environment);
  const Environment& map = is_map ? environment : made;
  std::vector<Fourier> columns;
  for (uint32_t x = 0; x < map.width; ++x) {
    const auto longitude = [&](uint32_t column) {
      return (double(column) / map.width - 0.5) * 2 * pi - double(map.rotation);
    };
    columns.push_back(longitude_integrals(longitude(x), longitude(x + 1)));
  }
  std::array<glm::dvec3, 9> sum{};
  for (uint32_t y = 0; y < map.height; ++y) {
    std::array<glm::dvec3, 5> row{};
    for (uint32_t x = 0; x < map.width; ++x) {
      const glm::dvec3 texel(map.texels[size_t(y) * map.width + x]);
      for (size_t i = 0; i < 5; ++i) row[i] += texel * columns[x][i];
    }
    const auto upper = latitude_integrals((0.5 - double(y) / map.height) * pi),
               lower = latitude_integrals((0.5 - double(y + 1) / map.height) * pi);
    const auto band = [&](size_t i) { return upper[i] - lower[i]; };
    // x = cos a cos b, y = sin a, z = cos a sin b; squares and products of cos b, sin b through the double angle.
    const glm::dvec3 xx = band(4) * (row[0] + row[3]) / 2.0, zz = band(4) * (row[0] - row[3]) / 2.0;
    sum[0] += band(0) * row[0];
    sum[1] += band(1) * row[0];
    sum[2] += band(2) * row[2];
    sum[3] += band(2) * row[1];
    sum[4] += band(3) * row[1];
    sum[5] += band(3) * row[2];
    sum[6] += 3.0 * zz - band(0) * row[0];
    sum[7] += band(4) * row[4] / 2.0;
    sum[8] += xx - band(5) * row[0];
  }
  Harmonics out;
  for (size_t i = 0; i < 9; ++i) out[i] = glm::vec3(sum[i] * factors()[i]);
  return out;
}

Harmonics irradiance_over_pi(const Harmonics& radiance) {
  Harmonics out = radiance;
  for (size_t i = 1; i < 9; ++i) out[i] *= i < 4 ? 2.0f / 3.0f : 0.25f;
  return out;
}

glm::vec3 evaluate(const Harmonics& harmonics, glm::vec3 direction) {
  const std::array<double, 9> basis = polynomials(glm::dvec3(direction));
  glm::dvec3 sum(0);
  for (size_t i = 0; i < 9; ++i) sum += glm::dvec3(harmonics[i]) * (basis[i] * factors()[i]);
  return glm::vec3(sum);
}

glm::vec3 evaluate_positive(const Harmonics& harmonics, glm::vec3 direction) {
  return glm::max(evaluate(harmonics, direction), glm::vec3(0));
}

Harmonics to_polynomial(const Harmonics& harmonics) {
  Harmonics out;
  for (size_t i = 0; i < 9; ++i) out[i] = harmonics[i] * float(factors()[i]);
  return out;
}

}  // namespace nf::scene
