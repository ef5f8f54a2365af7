// Blended surfaces: one raster pass.
#include "blend.h"

namespace nf::passes {

BlendPass create_blend(gpu::Pipelines& pipelines, const SceneTables& scene, bool environment_map) {
  BlendPass pass;
  if (!scene.any_blended()) return pass;
  const gpu::RasterState state{.streams = {SceneTables::streams().begin(), SceneTables::streams().end()},
                               .depth_test = true,
                               .over = true,
                               .set1 = scene.material_set_layout()};
  for (int sun = 0; sun < 2; ++sun)
    for (int tiles = 0; tiles < 2; ++tiles)
      for (int grid = 0; grid < 2; ++grid) {
        gpu::Defines defines = light_defines(sun, tiles, grid);
        defines.emplace_back("MAPPED", "1");
        if (environment_map) defines.emplace_back("ENVIRONMENT_MAP", "1");
        pass.pipelines[sun][tiles][grid] = pipelines.raster("gbuffer.vert", "blend.frag", defines, state);
      }
  return pass;
}

void add_blend(graph::Graph& graph, const BlendPass& pass, graph::Tex lit, const GBuffer& gbuffer,
               const DirectLights& lights, const SceneTables& scene, const DrawList& draws, graph::Buf deformed,
               const EnvironmentMaps& environment) {
  if (!draws.has(DrawClass::Blended)) return;
  const gpu::Pipeline pipeline =
      pass.pipelines[lights.maps.sun.valid()][lights.maps.tiles.valid()][lights.lights.has_grid];
  auto builder = graph.raster("blend", pipeline, "Blended surfaces over the picture, back to front");
  builder.in("instances", graph.import("scene.instances", scene.instances()))
      .in("materials", graph.import("scene.materials", scene.materials()))
      .in("deformed", deformed)
      .in("reflectance", graph.import("lighting.reflectance", scene.reflectance()))
      .out("lit", lit)
      .depth(gbuffer.z)
      .draw([&scene, &draws](const graph::Recorder& r) { scene.draw(draws, DrawClass::Blended, true, r); });
  feed_lights(graph, builder, lights);
  feed_environment(graph, builder, *pipeline.interface, environment);
}

}  // namespace nf::passes
