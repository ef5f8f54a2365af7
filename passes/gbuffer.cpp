// G-buffer passes: opaque surfaces, cut-outs, linear depth.
#include "gbuffer.h"

namespace nf::passes {

GBufferPass create_gbuffer(gpu::Pipelines& pipelines, const SceneTables& scene) {
  const gpu::RasterState state{.streams = {SceneTables::streams().begin(), SceneTables::streams().end()},
                               .depth_test = true,
                               .depth_write = true,
                               .set1 = scene.material_set_layout()};
  return {pipelines.raster("gbuffer.vert", "gbuffer.frag", {}, state),
          pipelines.raster("gbuffer.vert", "gbuffer.frag", {{"MASKED", "1"}}, state),
          pipelines.raster("gbuffer.vert", "gbuffer.frag", {{"MASKED", "1"}, {"MAPPED", "1"}}, state),
          pipelines.fullscreen("depth.frag")};
}

GBuffer add_gbuffer(graph::Graph& graph, const GBufferPass& pass, graph::Size size, const SceneTables& scene,
                    const DrawList& draws, graph::Buf deformed) {
  GBuffer g{.depth = graph.image("gbuffer.depth", {size, VK_FORMAT_R32_SFLOAT}),
            .normal = graph.image("gbuffer.normal", {size, VK_FORMAT_R32_UINT}),
            .albedo = graph.image("gbuffer.albedo", {size, VK_FORMAT_A2B10G10R10_UNORM_PACK32}),
            .material = graph.image("gbuffer.material", {size, VK_FORMAT_R8G8B8A8_UNORM}),
            .emissive = graph.image("gbuffer.emissive", {size, VK_FORMAT_R16G16B16A16_SFLOAT}),
            .velocity = graph.image("gbuffer.velocity", {size, VK_FORMAT_R16G16_SFLOAT}),
            .z = graph.image("gbuffer.z", {size, VK_FORMAT_D32_SFLOAT}),
            .size = size};
  const graph::Buf instances = graph.import("scene.instances", scene.instances());
  const graph::Buf materials = graph.import("scene.materials", scene.materials());

  const std::array<float, 4> black{};
  graph.raster("gbuffer.opaque", pass.opaque, "Base colour, material, normal, emission, velocity of opaque surfaces")
      .in("instances", instances)
      .in("materials", materials)
      .in("deformed", deformed)
      .out("albedo", g.albedo, black)
      .out("material", g.material, black)
      .out("normal", g.normal, black)
      .out("emissive", g.emissive, black)
      .out("velocity", g.velocity, black)
      .depth(g.z, 0.0f)
      .draw([&scene, &draws](const graph::Recorder& r) { scene.draw(draws, DrawClass::Opaque, true, r); });
  const auto add_behind = [&](const char* name, gpu::Pipeline pipeline, const char* description, DrawClass draw_class) {
    if (!draws.has(draw_class)) return;
    graph.raster(name, pipeline, description)
        .in("instances", instances)
        .in("materials", materials)
        .in("deformed", deformed)
        .out("albedo", g.albedo)
        .out("material", g.material)
        .out("normal", g.normal)
        .out("emissive", g.emissive)
        .out("velocity", g.velocity)
        .depth(g.z)
        .draw([&scene, &draws, draw_class](const graph::Recorder& r) { scene.draw(draws, draw_class, true, r); });
  };
  add_behind("gbuffer.masked", pass.masked, "The same for surfaces cut out by alpha", DrawClass::Masked);
  add_behind("gbuffer.mapped", pass.mapped, "The same for textures with transforms or other coordinates",
             DrawClass::Mapped);
  graph.fullscreen("gbuffer.linear_depth", pass.linear_depth, "Depth in metres, for everything that reads neighbours")
      .in("depth", g.z)
      .out("linear_depth", g.depth);
  return g;
}

}  // namespace nf::passes
