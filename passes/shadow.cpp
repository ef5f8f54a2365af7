// Fitting and drawing of the shadow map.
#include "shadow.h"

#include <glm/gtc/matrix_transform.hpp>

namespace nf::passes {

glm::mat4 fit_shadow(const scene::Bounds& bounds, glm::vec3 direction, float& extent) {
  const glm::vec3 center = (bounds.min + bounds.max) * 0.5f;
  const float radius = std::max(glm::length(bounds.max - bounds.min) * 0.5f, 1e-3f) * 1.01f;
  extent = 2 * radius;
  const glm::vec3 up = std::abs(direction.y) > 0.99f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::mat4 light_from_world = glm::lookAt(center - direction * radius, center, up);
  // x, y in [-r, r] to [-1, 1]; distance 0 to depth 1, distance 2r to depth 0 (light space looks down -z).
  glm::mat4 clip(1);
  clip[0][0] = 1 / radius;
  clip[1][1] = -1 / radius;
  clip[2][2] = 0.5f / radius;
  clip[3][2] = 1;
  return clip * light_from_world;
}

ShadowPass create_shadow(gpu::Pipelines& pipelines, const SceneTables& scene) {
  const auto streams = SceneTables::streams();
  gpu::RasterState opaque{.streams = {streams[0]}, .depth_test = true, .depth_write = true};
  gpu::RasterState masked{.streams = {streams.begin(), streams.end()},
                          .depth_test = true,
                          .depth_write = true,
                          .set1 = scene.material_set_layout()};
  return {pipelines.raster("shadow.vert", "", {}, opaque),
          pipelines.raster("shadow.vert", "shadow.frag", {{"MASKED", "1"}}, masked),
          pipelines.raster("shadow.vert", "shadow.frag", {{"MASKED", "1"}, {"MAPPED", "1"}}, masked)};
}

graph::Tex add_shadow(graph::Graph& graph, const ShadowPass& pass, const ShadowParams& params, const SceneTables& scene,
                      const DrawList& draws, graph::Buf deformed) {
  const uint32_t side = uint32_t(params.resolution);
  const graph::Tex map = graph.image("shadow.map", {{side, side}, VK_FORMAT_D32_SFLOAT});
  const graph::Buf instances = graph.import("scene.instances", scene.instances());
  graph.raster("shadow.opaque", pass.opaque, "Depth of opaque surfaces from the sun")
      .in("instances", instances)
      .in("deformed", deformed)
      .depth(map, 0.0f)
      .draw([&scene, &draws](const graph::Recorder& r) { scene.draw(draws, DrawClass::Opaque, false, r); });
  for (const auto& [name, pipeline, draw_class] : {std::tuple("shadow.masked", pass.masked, DrawClass::Masked),
                                                   std::tuple("shadow.mapped", pass.mapped, DrawClass::Mapped)})
    if (draws.has(draw_class))
      graph.raster(name, pipeline, "Depth of cut-out surfaces from the sun")
          .in("instances", instances)
          .in("materials", graph.import("scene.materials", scene.materials()))
          .in("deformed", deformed)
          .depth(map)
          .draw([&scene, &draws, which = draw_class](const graph::Recorder& r) { scene.draw(draws, which, true, r); });
  return map;
}

}  // namespace nf::passes
