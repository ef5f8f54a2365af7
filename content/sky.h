// Generated skies: a clear gradient, a glow about the sun, and the sun's disc, as an equirectangular HDR map.
#pragma once

#include <glm/glm.hpp>

#include "image/image.h"

namespace nf::content {

// Radiance. The disc is in the map: a directional light beside it would light the scene twice.
struct Sky {
  glm::vec3 zenith{0.25f, 0.45f, 0.9f}, horizon{0.8f, 0.85f, 0.9f}, ground{0.18f, 0.16f, 0.13f};
  glm::vec3 to_sun{0, 1, 0};  // unit
  glm::vec3 glow{0};          // added in the sun's direction, falls off with the 8th power of the half-way cosine
  glm::vec3 sun{0};           // inside the disc
  float sun_radius_deg = 0.5f;
};
Sky afternoon();  // the bundled sky.exr: its sun gives an eighth of all light
Sky hazy();       // no disc, bright on one side: everything about it is smooth

glm::vec3 sky_radiance(const Sky& sky, glm::vec3 direction);

// width x width / 2 texels, row 0 at the zenith, u = 0.5 + atan2(z, x) / 2 pi; each the mean of 16 samples.
image::Image sky_map(const Sky& sky, uint32_t width);

}  // namespace nf::content
