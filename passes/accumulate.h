// The linear mean of an image over all frames so far, in a history.
#pragma once

#include "graph/graph.h"

namespace nf::passes {

#define NF_ACCUMULATE_FIELDS(F) F(Float, weight) F(Uint, previous_mean_valid)
NF_DECLARE_BLOCK(AccumulateBlock, "accumulate", NF_ACCUMULATE_FIELDS)

struct AccumulatePass {
  gpu::Pipeline pipeline;
};
AccumulatePass create_accumulate(gpu::Pipelines& pipelines);

// `frame` counts from 0; the mean starts anew at 0 or when the history is not valid. `format` is the mean's (32-bit
// float). `name` must outlive the graph.
graph::Tex add_accumulate(graph::Graph& graph, const AccumulatePass& pass, const char* name, graph::Tex value,
                          VkFormat format, uint32_t frame);

}  // namespace nf::passes
