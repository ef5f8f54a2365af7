// Direct light, composition of all light, and the tone curve.
#pragma once

#include "environment.h"
#include "gbuffer.h"
#include "gi/gi_result.h"
#include "light_grid.h"

namespace nf::passes {

// diffuse, specular: RGBA16F outgoing radiance. radiance: R32UI RGB9E5, what the GI gathers (direct diffuse +
// emission).
struct Radiance {
  graph::Tex diffuse, specular, radiance;
};

#define NF_TONEMAP_PARAMS(P)                                                                        \
  P(Float, exposure_ev, 0.0f, -16.0f, 16.0f, "EV", "Exposure in stops; 0 leaves radiance as it is") \
  P(Choice, curve, 0, 0, 1, "aces|clamp", "Tone curve: a fit of ACES, or plain clamping")
NF_DECLARE_PARAMS(TonemapParams, "tonemap", NF_TONEMAP_PARAMS)

// What a shader with common/ambient.glsl has of the technique: nothing (0), visibility (1), and bent normals (2) or the
// environment's light (3) too.
constexpr int ambient_variants = 4;
gpu::Defines ambient_defines(int variant, bool environment_map);
int ambient_variant(const GiResult& gi);

struct LightingPass {
  gpu::Pipeline direct[2][2][2]
                      [2];  // [shadows from the depth buffer: made when first used][sun is shadowed][tiles][grid]
  gpu::Pipelines* pipelines = nullptr;
  gpu::Pipeline composite[2][ambient_variants];  // [has gi]
  gpu::Pipeline tonemap;
};
// `environment_map`: the environment is not constant.
LightingPass create_lighting(gpu::Pipelines& pipelines, bool environment_map);

// What shaders with common/direct_light.glsl are given. `lights` must live until the graph has run.
struct DirectLights {
  const ShadowPlan& shadows;
  const ShadowMaps& maps;
  const Lights& lights;
  const ShadowParams& shadow_params;
  const LightParams& light_params;
};
// The defines of their variant, and its inputs.
gpu::Defines light_defines(bool sun_map, bool tile_maps, bool grid, bool screen = false);
void feed_lights(graph::Graph& graph, graph::PassBuilder& pass, const DirectLights& lights);

Radiance add_direct(graph::Graph& graph, LightingPass& pass, const GBuffer& gbuffer, const DirectLights& lights);
// What is gathered, with the direct specular light as the eye sees it.
graph::Tex add_specular_source(graph::Graph& graph, const LightingPass& pass, const Radiance& direct);
// RGBA16F, linear radiance before tone mapping.
graph::Tex add_composite(graph::Graph& graph, const LightingPass& pass, const GBuffer& gbuffer, const Radiance& direct,
                         const GiResult& gi, const SceneTables& scene, const EnvironmentMaps& environment);
// RGBA8, sRGB-encoded.
graph::Tex add_tonemap(graph::Graph& graph, const LightingPass& pass, graph::Tex lit, const TonemapParams& params);

}  // namespace nf::passes
