// Sums over a picture: what a frame reports about itself.
#pragma once

#include "graph/graph.h"

namespace nf::passes {

// Of an image whose alpha is a luminance of its own: x, the sum of its colours' luminance; y, the sum of alpha. In
// `into`, 1x1 RGBA32F, or an image of its own. The order of additions is fixed.
graph::Tex add_energy(graph::Graph& graph, gpu::Pipelines& pipelines, const char* name, graph::Tex image,
                      graph::Tex into = {});

}  // namespace nf::passes
