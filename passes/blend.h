// Blended surfaces (alphaMode BLEND): drawn over the composed picture, back to front by instance, before the tone
// curve. They are in no other image: not in the G-buffer, so GI neither sees nor lights them; direct light and the
// environment do, unoccluded. In shadow maps they dim the light by their alpha (shadow.frag).
#pragma once

#include "lighting.h"

namespace nf::passes {

struct BlendPass {
  gpu::Pipeline pipelines[2][2][2];  // as LightingPass::direct
};
// Empty where the scene has no such surface.
BlendPass create_blend(gpu::Pipelines& pipelines, const SceneTables& scene, bool environment_map);

// Draws into `lit`. `draws` are the camera's, and with `scene` and `lights` must live until the graph has run.
void add_blend(graph::Graph& graph, const BlendPass& pass, graph::Tex lit, const GBuffer& gbuffer,
               const DirectLights& lights, const SceneTables& scene, const DrawList& draws, graph::Buf deformed,
               const EnvironmentMaps& environment);

}  // namespace nf::passes
