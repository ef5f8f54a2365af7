// Light from infinitely far away: one colour, a gradient, or an equirectangular HDR map. Plain data; what is made of it
// for shading (spherical harmonics, prefiltered mips) is in environment_light.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "image/image.h"

namespace nf::scene {

enum class EnvironmentKind : uint8_t { Constant, Gradient, Map };

// All radiance, intensity multiplied in.
struct Environment {
  EnvironmentKind kind = EnvironmentKind::Constant;
  glm::vec3 color{0};  // Constant: the same from all sides; black for the other kinds
  // Gradient: with w = (1 - |d.y|)^4 the radiance from direction d is mix(zenith, horizon, w) above the horizon and
  // mix(ground, horizon, w) below it: continuous, and brightest near the horizon, as clear skies are.
  glm::vec3 zenith{0}, horizon{0}, ground{0};
  // Map: rows from the top. Unturned, texel column u and row v (both in 0..1, v from the bottom) show the direction
  // with u = 0.5 + atan2(z, x) / 2 pi, v = 0.5 + asin(y) / pi. Every value is finite and not negative.
  uint32_t width = 0, height = 0;
  std::vector<glm::vec3> texels;
  float intensity = 1;  // what is multiplied into `texels`, for who writes the map's name down again
  float rotation = 0;   // radians: turns the map about +Y, right-handed
  std::string file;     // the map's, for messages
};

// Radiance from `direction` (world, unit): the map bilinear between texel centres, wrapped in u, clamped in v.
glm::vec3 radiance(const Environment& environment, glm::vec3 direction);

// The environment as a map: a gradient becomes 1024 rows of one texel, a constant one texel, a map is itself.
Environment as_map(const Environment& environment);

// A map of these texels (3 channels or more, the first three count) times `intensity`. NaN and negative values become
// 0, infinite ones 65504 times the intensity (half's largest, where EXR files saturate), and none exceeds 1e9; a
// warning says how many texels there were. Another shape than 2:1 is a warning. Throws nf::Error (Exit::Input) for more
// than 16384 texels a side, or fewer than 3 channels.
Environment make_environment_map(const image::Image& picture, const std::string& file, float intensity = 1,
                                 float rotation_deg = 0);

// .hdr, or the default layer of an .exr (or its only one). Throws nf::Error (Exit::Input).
Environment load_environment_map(const std::filesystem::path& path, float intensity = 1, float rotation_deg = 0);

}  // namespace nf::scene
