// The environment on the GPU: the map for the background, spherical harmonics for diffuse light, prefiltered mips for
// specular light; and how much of it a surface reflects. A constant environment needs none of the maps: it is
// frame.environment.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/params.h"
#include "graph/graph.h"
#include "scene/environment.h"

namespace nf::passes {

// Directional albedo of the GGX lobe with height-correlated Smith and Schlick's Fresnel, as F0 * x + y; n.v runs along
// a row, roughness from row to row, both at cell centres. By quadrature (glTF 2.0, Appendix B; split as in Karis 2013).
constexpr uint32_t reflectance_side = 16;
std::vector<glm::vec2> reflectance_table();

// irradiance_0...: irradiance / pi as scene::to_polynomial() has it. map_turn: the map's rotation, in turns.
// clang-format off
#define NF_ENVIRONMENT_FIELDS(F)                                                                            \
  F(Vec3, irradiance_0) F(Vec3, irradiance_1) F(Vec3, irradiance_2) F(Vec3, irradiance_3) F(Vec3, irradiance_4) \
  F(Vec3, irradiance_5) F(Vec3, irradiance_6) F(Vec3, irradiance_7) F(Vec3, irradiance_8) F(Float, map_turn)  \
  F(Float, last_mip)
// clang-format on
NF_DECLARE_BLOCK(EnvironmentBlock, "environment", NF_ENVIRONMENT_FIELDS)

struct EnvironmentMaps {
  gpu::Image map;   // RGBA16F, equirectangular, as in the file; a gradient is one texel wide
  gpu::Image cube;  // RGBA16F, scene::prefilter()'s mips
  EnvironmentBlock block;
  bool any() const { return map.handle != VK_NULL_HANDLE; }
};
// Nothing for a constant environment. Values beyond half's 65504 are clamped in the pictures, not in the irradiance.
EnvironmentMaps create_environment(gpu::Device& device, const scene::Environment& environment);
void destroy(gpu::Device& device, EnvironmentMaps& maps);

// Feeds those of the slots `environment_map`, `environment_cube` and `environment` that the pass's shader has.
void feed_environment(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface,
                      const EnvironmentMaps& maps);

}  // namespace nf::passes
