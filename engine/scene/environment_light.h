// What shading needs of an environment, made once on the CPU: spherical harmonics for diffuse light, and a cube map
// filtered by the GGX lobe for specular light. The same input gives the same bytes, whatever the number of threads.
#pragma once

#include <array>

#include "scene/environment.h"

namespace nf::scene {

// Real, orthonormal spherical harmonics up to l = 2 over world directions, RGB, in the order Y00, Y1-1 (y), Y10 (z),
// Y11 (x), Y2-2 (xy), Y2-1 (yz), Y20 (3z^2 - 1), Y21 (xz), Y22 (x^2 - y^2).
using Harmonics = std::array<glm::vec3, 9>;

// Coefficients of the radiance. Each texel counts as constant over its part of the sphere, and the basis functions are
// integrated over that part exactly.
Harmonics project(const Environment& environment);

// Coefficients of irradiance / pi over the normal: the radiance's times 1, 2/3, 1/4 for l = 0, 1, 2 (the clamped
// cosine's, Ramamoorthi and Hanrahan 2001, eq. 8, over pi). No window against ringing: the cosine itself leaves little
// beyond l = 2, a window would dim what all normals see to soften what a few see of a small sun, and irradiance below
// zero, the other sign of ringing, is clamped by evaluate_positive() and by the shader.
Harmonics irradiance_over_pi(const Harmonics& radiance);

glm::vec3 evaluate(const Harmonics& harmonics, glm::vec3 direction);           // unit, world
glm::vec3 evaluate_positive(const Harmonics& harmonics, glm::vec3 direction);  // not below 0
// The same function as a polynomial of x, y, z: 1; y, z, x; xy, yz, 3z^2 - 1, xz, x^2 - y^2, factors multiplied in.
Harmonics to_polynomial(const Harmonics& harmonics);

// Six faces (+X, -X, +Y, -Y, +Z, -Z, texels as Vulkan's cube maps have them) with mips; mips[m] holds the faces one
// after the other, rows from the top. Mip m is radiance averaged with the weight of the GGX lobe seen along its normal,
// D(h) n.l with v = n (Karis 2013), of the roughness prefilter_roughness(m, mips). Mip 0 is the environment itself.
struct PrefilteredCube {
  uint32_t side = 0;  // of mip 0
  std::vector<std::vector<glm::vec3>> mips;
};
// 64 to 256 texels a side, as fine as the environment's map asks for; the last mip has 8.
PrefilteredCube prefilter(const Environment& environment);
// Perceptual roughness of a mip, and the (fractional) mip of a roughness: last * r (2 - r), finest near mirrors.
float prefilter_roughness(uint32_t mip, uint32_t mips);
float prefilter_mip(float roughness, uint32_t mips);

// Direction through a point of a face, s and t in 0..1 from its upper left corner. Not unit: the largest component
// is 1.
glm::vec3 cube_direction(uint32_t face, float s, float t);

}  // namespace nf::scene
