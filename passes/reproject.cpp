// Last frame's surfaces and cameras.
#include "reproject.h"

#include "scene/camera.h"

namespace nf::passes {

ReprojectBlock make_reproject_block(const FrameView& view) {
  const glm::vec2 size(view.size);
  const float ty = std::tan(view.previous_camera.vfov * 0.5f), tx = ty * size.x / size.y;
  ReprojectBlock block;
  block.view_from_previous_view =
      scene::view_from_world(view.camera) * glm::inverse(scene::view_from_world(view.previous_camera));
  block.previous_ray_scale = {2 * tx / size.x, -2 * ty / size.y};
  block.previous_ray_offset = glm::vec2(-tx, ty) - view.previous_jitter * block.previous_ray_scale;
  block.jitter = view.jitter;
  return block;
}

glm::vec2 halton_jitter(uint32_t frame) {
  const auto radical_inverse = [](uint32_t i, uint32_t base) {
    float value = 0, digit = 1;
    for (; i > 0; i /= base) {
      digit /= float(base);
      value += digit * float(i % base);
    }
    return value;
  };
  const uint32_t i = frame % 16 + 1;
  return {radical_inverse(i, 2) - 0.5f, radical_inverse(i, 3) - 0.5f};
}

PreviousSurface keep_surface(graph::Graph& graph, const GBuffer& g) {
  const PreviousSurface kept{graph.history("previous.depth", graph.desc(g.depth)),
                             graph.history("previous.normal", graph.desc(g.normal))};
  graph.copy("previous.depth", g.depth, kept.depth.next);
  graph.copy("previous.normal", g.normal, kept.normal.next);
  return kept;
}

}  // namespace nf::passes
