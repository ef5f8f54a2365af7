// G-buffer: what the camera sees, before light.
#pragma once

#include "graph/graph.h"
#include "scene_tables.h"
#include "view.h"

namespace nf::passes {

// depth: R32F, metres along the view axis, 0 = background. normal: R32UI, view space, octahedral 2x16. albedo:
// A2B10G10R10, gamma 2. material: RGBA8, (metallic, roughness, dielectric F0). emissive: RGBA16F radiance. velocity:
// RG16F, pixels.
struct GBuffer {
  graph::Tex depth, normal, albedo, material, emissive, velocity;
  graph::Tex z;  // D32F, reverse-Z: what is drawn later is tested against it
  graph::Size size;
};

struct GBufferPass {
  gpu::Pipeline opaque, masked, mapped, linear_depth;
};
GBufferPass create_gbuffer(gpu::Pipelines& pipelines, const SceneTables& scene);

// `draws` and `scene` must live until the graph has run. `deformed` is add_deform's.
GBuffer add_gbuffer(graph::Graph& graph, const GBufferPass& pass, graph::Size size, const SceneTables& scene,
                    const DrawList& draws, graph::Buf deformed);

}  // namespace nf::passes
