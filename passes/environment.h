// What surfaces reflect of a constant environment.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace nf::passes {

// Directional albedo of the GGX lobe with height-correlated Smith and Schlick's Fresnel, as F0 * x + y; n.v runs along
// a row, roughness from row to row, both at cell centres. By quadrature (glTF 2.0, Appendix B; split as in Karis 2013).
constexpr uint32_t reflectance_side = 16;
std::vector<glm::vec2> reflectance_table();

}  // namespace nf::passes
