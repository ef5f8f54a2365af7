// Generated skies.
#include "sky.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

namespace nf::content {

using glm::vec3;

Sky afternoon() {
  Sky sky;
  sky.to_sun = glm::normalize(vec3(0.55f, 0.62f, 0.56f));
  sky.glow = vec3(1.2f, 1.0f, 0.7f);
  sky.sun = vec3(480, 420, 315);
  sky.sun_radius_deg = 1.5f;
  return sky;
}

Sky hazy() {
  Sky sky;
  sky.to_sun = glm::normalize(vec3(-0.7f, 0.35f, 0.6f));
  sky.glow = vec3(2.5f, 1.8f, 1.0f);
  return sky;
}

vec3 sky_radiance(const Sky& sky, vec3 direction) {
  const float away = 1 - std::min(std::abs(direction.y), 1.0f);
  // Over the ground the horizon fades at once, but not in a step.
  const vec3 base = direction.y >= 0 ? glm::mix(sky.zenith, sky.horizon, away * away * away)
                                     : glm::mix(sky.ground, sky.horizon, std::pow(away, 24.0f));
  const float towards = glm::dot(direction, sky.to_sun), half_way = 0.5f + 0.5f * towards;
  const bool disc = towards > std::cos(glm::radians(sky.sun_radius_deg));
  return base + sky.glow * std::pow(half_way, 8.0f) + (disc ? sky.sun : vec3(0));
}

image::Image sky_map(const Sky& sky, uint32_t width) {
  constexpr uint32_t samples = 4;
  constexpr float pi = glm::pi<float>();
  const uint32_t height = width / 2;
  image::Image map{width, height, 3, {}};
  map.pixels.reserve(size_t(width) * height * 3);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      vec3 sum(0);
      for (uint32_t i = 0; i < samples * samples; ++i) {
        const float u = (float(x) + (float(i % samples) + 0.5f) / samples) / float(width);
        const float v = 1 - (float(y) + (float(i / samples) + 0.5f) / samples) / float(height);
        const float longitude = (u - 0.5f) * 2 * pi, latitude = (v - 0.5f) * pi;
        sum += sky_radiance(sky, vec3(std::cos(latitude) * std::cos(longitude), std::sin(latitude),
                                      std::cos(latitude) * std::sin(longitude)));
      }
      for (int c = 0; c < 3; ++c) map.pixels.push_back(sum[c] / (samples * samples));
    }
  return map;
}

}  // namespace nf::content
