// Running means.
#include "accumulate.h"

namespace nf::passes {

AccumulatePass create_accumulate(gpu::Pipelines& pipelines) {
  return {pipelines.fullscreen("accumulate.frag")};
}

graph::Tex add_accumulate(graph::Graph& graph, const AccumulatePass& pass, const char* name, graph::Tex value,
                          VkFormat format, uint32_t frame) {
  const graph::History history = graph.history(name, {graph.desc(value).size, format});
  const AccumulateBlock block{.weight = 1.0f / float(frame + 1)};
  graph.fullscreen(name, pass.pipeline, "Mean over the frames so far")
      .in("value", value)
      .in("previous_mean", history.prev)
      .out("mean", history.next)
      .params(block);
  return history.next;
}

}  // namespace nf::passes
