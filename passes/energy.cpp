// Sums, 16 x 16 texels at a time.
#include "energy.h"

namespace nf::passes {

graph::Tex add_energy(graph::Graph& graph, gpu::Pipelines& pipelines, const char* name, graph::Tex image,
                      graph::Tex into) {
  graph::Size size = graph.desc(image).size;
  for (bool first = true;; first = false) {
    size = {(size.width + 15) / 16, (size.height + 15) / 16};
    const bool last = size == graph::Size{1, 1};
    const graph::Tex next =
        last && into ? into : graph.optional(graph.image(name, {size, VK_FORMAT_R32G32B32A32_SFLOAT}));
    graph
        .fullscreen(name, pipelines.fullscreen("energy.frag", first ? gpu::Defines{{"FIRST", "1"}} : gpu::Defines{}),
                    "Sums of luminance over the picture")
        .in("source", image)
        .out("energy", next);
    if (last) return next;
    image = next;
  }
}

}  // namespace nf::passes
