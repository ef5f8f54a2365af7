// Culling, lifetimes, barriers, load and store operations.
//
// Barriers: the uses of a resource, in order, form groups: every write is a group of its own, consecutive reads in the
// same layout are one group. One barrier stands between neighbouring groups, at the first pass of the later one, and
// makes the earlier group's writes visible to *all* passes of the later one; so no read group is synchronised twice.
// The list of groups is closed to a ring over the frame's end: the first group of frame N+1 follows the last of frame
// N. For a history the ring goes through both of its rows: what is `next` in one frame is `prev` in the following one.
#include <algorithm>

#include "graph/place.h"
#include "graph/plan.h"

namespace nf::graph {
namespace {

struct Group {
  uint32_t position;  // in Plan::passes: where its barrier goes
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 reads = 0, writes = 0;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  bool needs_content = false;  // something reads what was there before
};

std::span<const UseRow> uses_of(const Graph& graph, const PassRow& pass) {
  return std::span(graph.uses).subspan(pass.first_use, pass.use_count);
}

// Whether the pass's results depend on what was there before: a depth test's do, although no slot reads the image.
bool depends_on_content(const UseRow& use) {
  return reads(use.use) || (use.use == Use::DepthAttachment && !use.clear.clear);
}

bool needs_content(const UseRow& use, bool written_before) {
  if (use.clear.clear) return false;
  if (use.use == Use::ColorAttachment || use.use == Use::DepthAttachment) return written_before;  // load what is there
  return reads(use.use);
}

// A pass lives when a read-back needs it, directly or through other passes or through a history into a later frame.
std::vector<bool> find_culled(const Graph& graph) {
  std::vector<bool> live(graph.passes.size(), false), needed(graph.resources.size(), false);
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t i = graph.passes.size(); i-- > 0;) {
      const PassRow& pass = graph.passes[i];
      bool wanted = live[i] || pass.kind == PassKind::Readback;
      for (const UseRow& use : uses_of(graph, pass))
        wanted |= !use.is_buffer && writes(use.use) && needed[use.resource];
      if (!wanted) continue;
      if (!live[i]) live[i] = changed = true;
      for (const UseRow& use : uses_of(graph, pass)) {
        if (use.is_buffer || needed[use.resource]) continue;
        if (!depends_on_content(use)) continue;
        needed[use.resource] = changed = true;
        const ResourceRow& row = graph.resources[use.resource];
        if (row.lifetime == Lifetime::HistoryPrev && !needed[row.pair]) needed[row.pair] = true;
      }
    }
  }
  for (size_t i = 0; i < live.size(); ++i) live[i] = !live[i];
  return live;
}

std::vector<Group> find_groups(const Graph& graph, const Plan& plan, uint16_t resource) {
  std::vector<Group> groups;
  bool written = graph.resources[resource].lifetime == Lifetime::HistoryPrev;
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    const PassRow& pass = graph.passes[plan.passes[position].pass];
    Group here{.position = position};
    bool used = false;
    for (const UseRow& use : uses_of(graph, pass)) {
      if (use.is_buffer || use.resource != resource) continue;
      const Access access = access_of(use.use, pass.kind);
      used = true;
      here.stages |= access.stages;
      here.writes |= access.write;
      const bool content = needs_content(use, written);
      // Attachments that keep their content read it; depth is read by its test.
      if (reads(use.use) || content || use.use == Use::DepthAttachment) here.reads |= access.read;
      here.needs_content |= content;
      here.layout = access.layout;
    }
    if (!used) continue;
    written |= here.writes != 0;
    if (!groups.empty() && !here.writes && !groups.back().writes && groups.back().layout == here.layout) {
      groups.back().stages |= here.stages;
      groups.back().reads |= here.reads;
      continue;
    }
    groups.push_back(here);
  }
  return groups;
}

struct PlacedBarrier {
  uint32_t position;
  Barrier barrier;
};

// `joined`: the first group continues the one before it and needs no barrier.
void add_barriers(uint16_t resource, const std::vector<Group>& groups, const Group& before, bool keeps_content,
                  bool joined, std::vector<PlacedBarrier>& out) {
  const Group* previous = &before;
  bool first = true;
  for (const Group& group : groups) {
    const bool keep = first ? keeps_content : true;
    if (!(first && joined))
      out.push_back({group.position, Barrier{.resource = resource,
                                             .src_stages = previous->stages,
                                             .dst_stages = group.stages,
                                             .src_access = previous->writes,
                                             .dst_access = group.reads | group.writes,
                                             .old_layout = keep ? previous->layout : VK_IMAGE_LAYOUT_UNDEFINED,
                                             .new_layout = group.layout}});
    previous = &group;
    first = false;
  }
}

// The attachments' load and store operations.
void plan_attachments(const Graph& graph, Plan& plan) {
  plan.uses.resize(graph.uses.size());
  std::vector<bool> written(graph.resources.size(), false);
  for (const PlannedPass& planned : plan.passes) {
    const PassRow& pass = graph.passes[planned.pass];
    for (uint32_t i = pass.first_use; i < pass.first_use + pass.use_count; ++i) {
      const UseRow& use = graph.uses[i];
      if (use.is_buffer) continue;
      plan.uses[i].load = use.clear.clear         ? VK_ATTACHMENT_LOAD_OP_CLEAR
                          : written[use.resource] ? VK_ATTACHMENT_LOAD_OP_LOAD
                                                  : VK_ATTACHMENT_LOAD_OP_DONT_CARE;
      if (writes(use.use)) written[use.resource] = true;
    }
  }
  // Backwards: an attachment is stored when a later use needs its content.
  std::vector<bool> wanted(graph.resources.size(), false);
  for (size_t r = 0; r < graph.resources.size(); ++r) wanted[r] = graph.resources[r].lifetime == Lifetime::HistoryNext;
  for (size_t p = plan.passes.size(); p-- > 0;) {
    const PassRow& pass = graph.passes[plan.passes[p].pass];
    for (uint32_t i = pass.first_use; i < pass.first_use + pass.use_count; ++i) {
      const UseRow& use = graph.uses[i];
      if (use.is_buffer) continue;
      plan.uses[i].store = wanted[use.resource] ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE;
    }
    for (const UseRow& use : uses_of(graph, pass))
      if (!use.is_buffer) wanted[use.resource] = needs_content(use, true);
  }
}

// Sizes, heaps, offsets and alias predecessors of the live transients.
void place_transients(const Graph& graph, const CompileOptions& options, Plan& plan) {
  struct HeapGroup {
    uint32_t type_bits;
    std::vector<uint16_t> resources;
    std::vector<PlaceItem> items;
  };
  std::vector<HeapGroup> groups;
  std::vector<PlaceItem> everything;
  for (uint16_t r = 0; r < plan.resources.size(); ++r) {
    PlannedResource& planned = plan.resources[r];
    const ImageDesc& desc = graph.resources[r].desc;
    if (!planned.live) continue;
    gpu::MemoryNeeds needs;
    for (uint32_t mip = 0; mip < desc.mips; ++mip)
      needs.size += uint64_t(std::max(desc.size.width >> mip, 1u)) * std::max(desc.size.height >> mip, 1u) *
                    desc.layers * gpu::texel_bytes(desc.format);
    if (options.needs) needs = options.needs(desc, planned.usage);
    planned.bytes = needs.size;
    planned.alias_of = {r};
    if (graph.resources[r].lifetime != Lifetime::Transient) continue;
    plan.unaliased_bytes += needs.size;
    PlaceItem item{needs.size, needs.alignment, planned.first, planned.last};
    everything.push_back(item);
    if (needs.dedicated) {
      plan.placed_bytes += needs.size;
      continue;
    }
    // Without aliasing everything lives for the whole frame.
    if (!options.alias) item.first = 0, item.last = uint32_t(plan.passes.size());
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const HeapGroup& g) { return g.type_bits == needs.type_bits; });
    if (group == groups.end()) group = groups.insert(groups.end(), HeapGroup{needs.type_bits, {}, {}});
    group->resources.push_back(r);
    group->items.push_back(item);
  }
  plan.max_live_bytes = max_live(everything);
  for (const HeapGroup& group : groups) {
    // Swaps cost the square of the count each; a large frame gets fewer.
    const uint64_t square = uint64_t(group.items.size()) * group.items.size();
    const Placement placement = place(group.items, uint32_t(std::min<uint64_t>(500, 20'000'000 / square)));
    const auto before = alias_predecessors(group.items, placement.offset);
    for (size_t i = 0; i < group.resources.size(); ++i) {
      PlannedResource& planned = plan.resources[group.resources[i]];
      planned.heap = int32_t(plan.heaps.size());
      planned.offset = placement.offset[i];
      planned.alias_of.clear();
      for (const uint32_t other : before[i]) planned.alias_of.push_back(group.resources[other]);
    }
    plan.heaps.push_back({group.type_bits, placement.top});
    plan.placed_bytes += placement.top;
  }
}

}  // namespace

Plan compile(const Graph& graph, const CompileOptions& options) {
  Plan plan;
  plan.culled = find_culled(graph);
  for (uint32_t i = 0; i < graph.passes.size(); ++i)
    if (!plan.culled[i]) plan.passes.push_back({.pass = i});

  const uint16_t count = uint16_t(graph.resources.size());
  plan.resources.resize(count);
  std::vector<std::vector<Group>> groups(count);
  for (uint16_t r = 0; r < count; ++r) {
    groups[r] = find_groups(graph, plan, r);
    if (groups[r].empty()) continue;
    plan.resources[r].live = true;
    plan.resources[r].first_layout = groups[r].front().layout;
    plan.resources[r].last_layout = groups[r].back().layout;
  }
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    const PassRow& pass = graph.passes[plan.passes[position].pass];
    for (const UseRow& use : uses_of(graph, pass)) {
      if (use.is_buffer) continue;
      PlannedResource& planned = plan.resources[use.resource];
      if (!planned.usage) planned.first = position;
      planned.last = position;
      planned.usage |= access_of(use.use, pass.kind).usage;
    }
  }
  place_transients(graph, options, plan);

  // Reads of next at a frame's end and of prev at the beginning of the following one are one group in two halves.
  std::vector<bool> joined(count, false);
  for (uint16_t r = 0; r < count; ++r) {
    const ResourceRow& row = graph.resources[r];
    if (row.lifetime != Lifetime::HistoryPrev || groups[r].empty() || groups[row.pair].empty()) continue;
    Group &last = groups[row.pair].back(), &front = groups[r].front();
    if (last.writes || front.writes || last.layout != front.layout) continue;
    front.stages = last.stages |= front.stages;
    front.reads = last.reads |= front.reads;
    joined[r] = true;
  }

  std::vector<PlacedBarrier> placed;
  for (uint16_t r = 0; r < count; ++r) {
    if (groups[r].empty()) continue;
    const ResourceRow& row = graph.resources[r];
    Group before{};
    if (row.lifetime != Lifetime::Transient) {
      before = groups[groups[row.pair].empty() ? r : row.pair].back();
    } else {
      // Its own last use of the frame before is waited for too. That follows already, through the owners in between;
      // but the validation layer tracks a barrier by its image's texels, which end before its padded memory does.
      before.stages = groups[r].back().stages;
      for (const uint16_t other : plan.resources[r].alias_of) {
        before.stages |= groups[other].back().stages;
        before.writes |= groups[other].back().writes;
      }
    }
    add_barriers(r, groups[r], before, row.lifetime == Lifetime::HistoryPrev, joined[r], placed);
  }
  std::stable_sort(placed.begin(), placed.end(),
                   [](const PlacedBarrier& a, const PlacedBarrier& b) { return a.position < b.position; });
  for (const PlacedBarrier& p : placed) {
    PlannedPass& pass = plan.passes[p.position];
    if (pass.barrier_count++ == 0) pass.first_barrier = uint32_t(plan.barriers.size());
    plan.barriers.push_back(p.barrier);
  }
  plan_attachments(graph, plan);
  return plan;
}

}  // namespace nf::graph
