// The sun's shadow map: one orthographic map over the scene's bounds.
#pragma once

#include "graph/graph.h"
#include "scene_tables.h"

namespace nf::passes {

#define NF_SHADOW_PARAMS(P)                                                         \
  P(Bool, enabled, 1, 0, 1, "", "Shadows of the sun (the first directional light)") \
  P(Int, resolution, 2048, 16, 8192, "px", "Side of the shadow map")                \
  P(Float, normal_bias, 2.0f, 0.0f, 16.0f, "texels",                                \
    "How far the receiver is moved along its normal, times the slope")              \
  P(Float, bias, 1.0f, 0.0f, 16.0f, "texels", "How far the receiver is moved towards the light")
NF_DECLARE_PARAMS(ShadowParams, "shadow", NF_SHADOW_PARAMS)

// Clip from world of a directional light whose map covers the bounds, reverse-Z: 1 at the light. The map is a square of
// the bounding sphere's size, so it does not depend on the camera. `extent` gets the square's side in metres.
glm::mat4 fit_shadow(const scene::Bounds& bounds, glm::vec3 direction, float& extent);

struct ShadowPass {
  gpu::Pipeline opaque, masked, mapped;
};
ShadowPass create_shadow(gpu::Pipelines& pipelines, const SceneTables& scene);

// Invalid handle when there is no sun or shadows are off.
graph::Tex add_shadow(graph::Graph& graph, const ShadowPass& pass, const ShadowParams& params, const SceneTables& scene,
                      const DrawList& draws, graph::Buf deformed);

}  // namespace nf::passes
