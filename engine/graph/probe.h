// Looking at a resource at any point of a frame: a read-back put in between two passes of a graph that is built.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph/executor.h"

namespace nf::graph {

struct Probe {
  uint32_t pass = 0;                // row of Graph::passes
  bool before = false;              // just before it; else just after
  uint16_t resource = 0;            // row of Graph::resources
  uint8_t mip = 0, layer = 0;       // of images
  const char* name = "probe";       // of the read-back; lives as long as the graph
  std::optional<Texel> texel = {};  // of images: only this one of the mip
};

// Why the resource cannot be read back there; empty when it can. It needs content: a pass that runs and writes it,
// earlier in the frame. What is imported lies outside the frame.
std::string probe_fault(const Graph& graph, const Probe& probe);

// Puts the read-back in, or returns the fault. Rows of later passes move on by one, and so do the numbers of later
// read-backs: with several probes begin with the last, and find results by name. The graph runs with a plan of its own.
std::string add_probe(Graph& graph, const Probe& probe);

// A mip of a layer of every live image of the first `resources` rows, after the pass that writes it last; what the
// frame only reads, after the pass that reads it last. In the order of the passes: put in from the last to the first,
// the read-backs come in this order.
std::vector<Probe> last_states(const Graph& graph, size_t resources);

// By name, of what Executor::take_readbacks() gave; nullptr: there is none.
const Readback* find_readback(std::span<const Readback> readbacks, std::string_view name);

}  // namespace nf::graph
