// Direct light, composition, tone curve.
#include "lighting.h"

namespace nf::passes {

gpu::Defines ambient_defines(int variant, bool environment_map) {
  gpu::Defines defines;
  if (variant > 0) defines.emplace_back("HAS_VISIBILITY", "1");
  if (environment_map) defines.emplace_back("ENVIRONMENT_MAP", "1");
  // From all sides the same light: which side is open does not matter.
  if (environment_map && variant == 2) defines.emplace_back("HAS_BENT", "1");
  if (environment_map && variant == 3) defines.emplace_back("HAS_AMBIENT", "1");
  return defines;
}

int ambient_variant(const GiResult& gi) {
  return !gi.visibility ? 0 : gi.ambient ? 3 : gi.bent ? 2 : 1;
}

LightingPass create_lighting(gpu::Pipelines& pipelines, bool environment_map) {
  LightingPass pass;
  pass.pipelines = &pipelines;
  for (int sun = 0; sun < 2; ++sun)
    for (int tiles = 0; tiles < 2; ++tiles)
      for (int grid = 0; grid < 2; ++grid)
        pass.direct[false][sun][tiles][grid] = pipelines.fullscreen("direct.frag", light_defines(sun, tiles, grid));
  for (int gi = 0; gi < 2; ++gi)
    for (int open = 0; open < ambient_variants; ++open) {
      gpu::Defines defines = ambient_defines(open, environment_map);
      if (gi) defines.emplace_back("HAS_GI", "1");
      pass.composite[gi][open] = pipelines.fullscreen("composite.frag", defines);
    }
  pass.tonemap = pipelines.fullscreen("tonemap.frag");
  return pass;
}

gpu::Defines light_defines(bool sun_map, bool tile_maps, bool grid, bool screen) {
  gpu::Defines defines;
  if (sun_map) defines.emplace_back("SUN_SHADOW", "1");
  if (tile_maps) defines.emplace_back("TILE_SHADOWS", "1");
  if (grid) defines.emplace_back("LIGHT_GRID", "1");
  if (screen) defines.emplace_back("SCREEN_SHADOWS", "1");
  return defines;
}

void feed_lights(graph::Graph& graph, graph::PassBuilder& pass, const DirectLights& l) {
  pass.in("light_rows", graph.import("lights.rows", *l.lights.rows))
      .params(l.lights.view)
      .params(l.light_params)
      .params(l.shadows.sun);
  if (l.maps.sun) pass.in("sun_map", l.maps.sun);
  if (l.maps.tiles) pass.in("tile_maps", l.maps.tiles);
  if (l.maps.sun || l.maps.tiles) pass.params(l.shadow_params);
  if (l.lights.has_grid)
    pass.in("cluster_first", graph.import("lights.cluster_first", *l.lights.cluster_first))
        .in("cluster_lights", graph.import("lights.cluster_lights", *l.lights.cluster_lights));
}

Radiance add_direct(graph::Graph& graph, LightingPass& pass, const GBuffer& g, const DirectLights& lights) {
  const Radiance out{graph.image("direct.diffuse", {g.size, VK_FORMAT_R16G16B16A16_SFLOAT}),
                     graph.image("direct.specular", {g.size, VK_FORMAT_R16G16B16A16_SFLOAT}),
                     graph.image("direct.radiance", {g.size, VK_FORMAT_R32_UINT})};
  const bool sun = lights.maps.sun.valid(), tiles = lights.maps.tiles.valid(), grid = lights.lights.has_grid,
             screen = lights.shadow_params.enabled && lights.shadow_params.screen_samples > 0;
  gpu::Pipeline& pipeline = pass.direct[screen][sun][tiles][grid];
  if (!pipeline.interface)
    pipeline = pass.pipelines->fullscreen("direct.frag", light_defines(sun, tiles, grid, screen));
  auto builder = graph.fullscreen("direct.light", pipeline,
                                  "Sun, point and spot lights: diffuse and specular, and the GI's source");
  builder.in("depth", g.depth)
      .in("normal", g.normal)
      .in("albedo", g.albedo)
      .in("material", g.material)
      .in("emissive", g.emissive)
      .out("direct_diffuse", out.diffuse)
      .out("direct_specular", out.specular)
      .out("radiance", out.radiance);
  if (screen && !sun && !tiles) builder.params(lights.shadow_params);  // else feed_lights gives them
  feed_lights(graph, builder, lights);
  return out;
}

graph::Tex add_specular_source(graph::Graph& graph, const LightingPass& pass, const Radiance& direct) {
  graph::ImageDesc desc = graph.desc(direct.radiance);
  const graph::Tex all = graph.image("direct.all", desc);
  graph
      .fullscreen("direct.add_specular", pass.pipelines->fullscreen("direct_all.frag"), "The GI's source with specular")
      .in("radiance", direct.radiance)
      .in("direct_specular", direct.specular)
      .out("all", all);
  return all;
}

graph::Tex add_composite(graph::Graph& graph, const LightingPass& pass, const GBuffer& g, const Radiance& direct,
                         const GiResult& gi, const SceneTables& scene, const EnvironmentMaps& environment) {
  const graph::Tex lit = graph.image("composite.lit", {g.size, VK_FORMAT_R16G16B16A16_SFLOAT});
  const gpu::Pipeline pipeline = pass.composite[gi.gi.valid()][ambient_variant(gi)];
  auto builder = graph.fullscreen("composite", pipeline, "Direct + ambient + indirect + emission");
  builder.in("depth", g.depth)
      .in("normal", g.normal)
      .in("albedo", g.albedo)
      .in("material", g.material)
      .in("emissive", g.emissive)
      .in("reflectance", graph.import("lighting.reflectance", scene.reflectance()))
      .in("direct_diffuse", direct.diffuse)
      .in("direct_specular", direct.specular)
      .out("lit", lit);
  if (gi.gi) builder.in("gi", gi.gi);
  if (gi.visibility) builder.in("visibility", gi.visibility);
  if (pipeline.interface->find("bent")) builder.in("bent", gi.bent);
  if (pipeline.interface->find("ambient")) builder.in("ambient", gi.ambient);
  feed_environment(graph, builder, *pipeline.interface, environment);
  return lit;
}

graph::Tex add_tonemap(graph::Graph& graph, const LightingPass& pass, graph::Tex lit, const TonemapParams& params) {
  const graph::Tex ldr = graph.image("tonemap.ldr", {graph.desc(lit).size, VK_FORMAT_R8G8B8A8_UNORM});
  graph.fullscreen("tonemap", pass.tonemap, "Exposure, tone curve, sRGB").in("lit", lit).out("ldr", ldr).params(params);
  return ldr;
}

}  // namespace nf::passes
