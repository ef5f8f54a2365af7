// The phases of compile(), in their order. Each fills its part of the plan from the graph and from the parts before.
#pragma once

#include "graph/plan.h"

namespace nf::graph {

// Plan::culled and Plan::passes, in declared order. A pass lives when a read-back needs it, directly, through other
// passes, or through a history into a later frame.
void find_live_passes(const Graph& graph, Plan& plan);
// Another order of Plan::passes in which every pass still follows all it depends on.
void shuffle_passes(const Graph& graph, uint64_t seed, Plan& plan);
// Plan::resources (lifetimes, usage, bytes, heaps, offsets, owners before), Plan::heaps and the sums of bytes.
void place_resources(const Graph& graph, const CompileOptions& options, Plan& plan);

// Whether the pass's results depend on what was there before: a depth test's do, although no slot reads the image.
inline bool depends_on_content(const UseRow& use) {
  return reads(use.use) || (use.use == Use::DepthAttachment && !use.clear.clear);
}

// The cells of a part, in order.
template <class F>
void for_each_cell(const ResourceRow& row, const Part& part, F&& f) {
  for (uint32_t layer = part.layer; layer < uint32_t(part.layer + part.layers); ++layer)
    for (uint32_t mip = part.mip; mip < uint32_t(part.mip + part.mips); ++mip) f(layer * row.desc.mips + mip);
}

// Numbers the cells of all resources one after the other.
std::vector<uint32_t> first_cells(const Graph& graph, uint32_t& total);

}  // namespace nf::graph
