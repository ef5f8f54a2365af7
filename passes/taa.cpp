// Temporal antialiasing: resolve and sharpen.
#include "taa.h"

namespace nf::passes {

graph::Tex add_taa(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const ReprojectBlock& reproject,
                   graph::Tex lit, const TaaParams& params) {
  const graph::ImageDesc desc{g.size, VK_FORMAT_R16G16B16A16_SFLOAT};
  const graph::History history = graph.history("taa.history", desc);
  graph.fullscreen("taa.resolve", pipelines.fullscreen("taa.frag"), "Mean of jittered frames along the motion")
      .in("lit", lit)
      .in("depth", g.depth)
      .in("velocity", g.velocity)
      .in("previous", history.prev)
      .out("resolved", history.next)
      .params(reproject)
      .params(params)
      .params(TaaBlock{});
  if (params.sharpness <= 0) return history.next;
  const graph::Tex sharp = graph.image("taa.sharp", desc);
  graph.fullscreen("taa.sharpen", pipelines.fullscreen("taa_sharpen.frag"), "Sharpening")
      .in("resolved", history.next)
      .out("sharp", sharp)
      .params(params);
  return sharp;
}

}  // namespace nf::passes
