// Lifetimes, sizes and places of resources.
#include <algorithm>

#include "graph/phases.h"
#include "graph/place.h"

namespace nf::graph {
namespace {

uint64_t content_bytes(const ResourceRow& row) {
  if (row.is_buffer) return row.bytes;
  uint64_t texels = 0;
  for (uint32_t mip = 0; mip < row.desc.mips; ++mip) {
    const Size size = size_of(row.desc, mip);
    texels += uint64_t(size.width) * size.height;
  }
  return texels * row.desc.layers * gpu::texel_bytes(row.desc.format);
}

void find_lifetimes(const Graph& graph, Plan& plan) {
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    const PassRow& pass = graph.passes[plan.passes[position].pass];
    for (const UseRow& use : graph.uses_of(pass)) {
      PlannedResource& planned = plan.resources[use.resource];
      if (!planned.live) planned.first = position;
      planned.live = true;
      planned.last = position;
      planned.usage |= access_of(use.use, pass.kind).usage;
    }
  }
}

struct HeapGroup {
  PlannedHeap heap;
  std::vector<uint16_t> resources;
  std::vector<PlaceItem> lives;   // as they are used
  std::vector<PlaceItem> items;   // as they are placed: without aliasing all live for the whole frame
  std::vector<uint64_t> content;  // bytes of the texels
};

// Who had the bytes before. The driver may use every byte it asked for; the validation layer on the other hand tracks
// an image by its texels, so that whoever took over only the padding behind them has not relieved the image's last use.
// The owners of both views are waited for; without padding they are the same.
void find_owners_before(const HeapGroup& group, const Placement& placement, Plan& plan) {
  const auto by_bytes = alias_predecessors(group.items, placement.offset);
  std::vector<PlaceItem> unpadded = group.items;
  bool padded = false;
  for (size_t i = 0; i < unpadded.size(); ++i) {
    padded |= group.content[i] < unpadded[i].size;
    unpadded[i].size = std::min(group.content[i], unpadded[i].size);
  }
  const auto by_texels = padded ? alias_predecessors(unpadded, placement.offset) : by_bytes;
  for (size_t i = 0; i < group.resources.size(); ++i) {
    std::vector<uint16_t>& owners = plan.resources[group.resources[i]].alias_of;
    for (const auto* before : {&by_bytes[i], &by_texels[i]})
      for (const uint32_t other : *before) owners.push_back(group.resources[other]);
    std::sort(owners.begin(), owners.end());
    owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
  }
}

}  // namespace

void place_resources(const Graph& graph, const CompileOptions& options, Plan& plan) {
  plan.resources.resize(graph.resources.size());
  find_lifetimes(graph, plan);
  std::vector<HeapGroup> groups;
  for (uint16_t r = 0; r < plan.resources.size(); ++r) {
    PlannedResource& planned = plan.resources[r];
    const ResourceRow& row = graph.resources[r];
    if (!planned.live) continue;
    const uint64_t content = content_bytes(row);
    gpu::MemoryNeeds needs{.size = content};
    if (options.needs && row.lifetime != Lifetime::Imported) needs = options.needs(row, planned.usage);
    planned.bytes = needs.size;
    if (row.lifetime != Lifetime::Transient) continue;
    plan.unaliased_bytes += needs.size;
    PlaceItem item{needs.size, needs.alignment, planned.first, planned.last};
    if (needs.dedicated) {
      planned.dedicated = true;
      planned.alias_of = {r};
      plan.placed_bytes += needs.size;
      plan.max_live_bytes += needs.size;
      continue;
    }
    auto group = std::find_if(groups.begin(), groups.end(), [&](const HeapGroup& g) {
      return g.heap.buffers == row.is_buffer && g.heap.type_bits == needs.type_bits;
    });
    if (group == groups.end())
      group = groups.insert(groups.end(), HeapGroup{{row.is_buffer, needs.type_bits, 0}, {}, {}, {}, {}});
    group->resources.push_back(r);
    group->lives.push_back(item);
    if (!options.alias) item.first = 0, item.last = uint32_t(plan.passes.size());
    group->items.push_back(item);
    group->content.push_back(content);
  }
  for (HeapGroup& group : groups) {
    plan.max_live_bytes += max_live(group.lives);
    const Placement placement = place(group.items);
    for (size_t i = 0; i < group.resources.size(); ++i) {
      plan.resources[group.resources[i]].heap = int32_t(plan.heaps.size());
      plan.resources[group.resources[i]].offset = placement.offset[i];
    }
    find_owners_before(group, placement, plan);
    group.heap.size = placement.top;
    plan.heaps.push_back(group.heap);
    plan.placed_bytes += placement.top;
  }
}

}  // namespace nf::graph
