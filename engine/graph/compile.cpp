// Barriers, load and store operations.
//
// The uses of a cell (a mip of a layer, or a buffer), in order, form groups: every write is a group of its own,
// consecutive reads in the same layout are one group. One barrier stands between neighbouring groups, at the first pass
// of the later one, and makes the earlier group's writes visible to *all* passes of the later one; so no read group is
// synchronised twice. The list of groups is closed to a ring over the frame's end: the first group of frame N+1 follows
// the last of frame N. For a history the ring goes through both of its rows: what is `next` in one frame is `prev` in
// the following one; for a kept image it is the image's own. For a transient the first group follows the last groups of
// whoever had its bytes before.
//
// Every barrier is needed for its own bytes. That the barrier of another resource may happen to give the same order is
// not made use of: the validation layer would not see it, and a plan whose barriers can be read one by one is worth
// more.
#include <algorithm>
#include <tuple>

#include "graph/phases.h"

namespace nf::graph {
namespace {

constexpr uint32_t none = ~0u;

struct Group {
  uint32_t position;  // in Plan::passes: where its barrier goes
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 reads = 0, writes = 0;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  uint32_t next = none;  // the cell's following group
};

struct Cell {
  uint32_t first = none, last = none;  // groups
  uint32_t pass = none;                // position of the last use
  bool written = false;                // in this frame, or by the frame before
};

class Compiler {
 public:
  Compiler(const Graph& graph, Plan& plan) : graph_(graph), plan_(plan) {
    uint32_t total = 0;
    const std::vector<uint32_t> first = first_cells(graph, total);
    cells_.resize(total);
    plan.cells.resize(total);
    for (size_t r = 0; r < first.size(); ++r) {
      plan.resources[r].first_cell = first[r];
      const Lifetime lifetime = graph.resources[r].lifetime;
      if (lifetime == Lifetime::HistoryPrev || lifetime == Lifetime::Kept)
        for (uint32_t c = 0; c < cell_count(graph.resources[r]); ++c) cells_[first[r] + c].written = true;
    }
  }

  void run() {
    plan_.uses.resize(graph_.uses.size());
    plan_stores();
    for (uint32_t position = 0; position < plan_.passes.size(); ++position) add_pass(position);
    for (uint16_t r = 0; r < graph_.resources.size(); ++r)
      if (rings_on(r)) join_frames(r);
    std::vector<PlacedBarrier> placed;
    for (uint16_t r = 0; r < graph_.resources.size(); ++r)
      if (plan_.resources[r].live && graph_.resources[r].lifetime != Lifetime::Imported) add_barriers(r, placed);
    sort_barriers(placed);
  }

 private:
  struct PlacedBarrier {
    uint32_t position;
    Barrier barrier;
  };

  // Backwards: an attachment is stored when a later use needs its content.
  void plan_stores() {
    std::vector<bool> wanted(cells_.size(), false);
    for (size_t r = 0; r < graph_.resources.size(); ++r)
      if (const Lifetime lifetime = graph_.resources[r].lifetime;
          lifetime == Lifetime::HistoryNext || lifetime == Lifetime::Kept)
        for (uint32_t c = 0; c < cell_count(graph_.resources[r]); ++c) wanted[plan_.resources[r].first_cell + c] = true;
    for (size_t p = plan_.passes.size(); p-- > 0;) {
      const PassRow& pass = graph_.passes[plan_.passes[p].pass];
      for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u) {
        const UseRow& use = graph_.uses[u];
        const uint32_t first = plan_.resources[use.resource].first_cell;
        for_each_cell(graph_.resources[use.resource], use.part, [&](uint32_t c) {
          const bool wanted_after = wanted[first + c];
          if (is_attachment(use.use) && wanted_after) plan_.uses[u].store = VK_ATTACHMENT_STORE_OP_STORE;
          // What was drawn before shows through where this pass does not draw, and decides its depth tests.
          const bool shows = use.use == Use::ColorAttachment && wanted_after && !use.clear.clear;
          wanted[first + c] = shows || depends_on_content(use);
        });
      }
    }
  }

  // Load operations, and the pass's uses as groups. Uses of one cell by several slots are one group.
  void add_pass(uint32_t position) {
    const PassRow& pass = graph_.passes[plan_.passes[position].pass];
    for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u) {
      const UseRow& use = graph_.uses[u];
      const ResourceRow& row = graph_.resources[use.resource];
      if (row.lifetime == Lifetime::Imported) continue;
      const Access access = access_of(use.use, pass.kind, plan_.layouts);
      for_each_cell(row, use.part, [&](uint32_t index) {
        Cell& cell = cells_[plan_.resources[use.resource].first_cell + index];
        if (is_attachment(use.use)) {
          const bool keeps =
              cell.written && (use.use == Use::DepthAttachment || plan_.uses[u].store == VK_ATTACHMENT_STORE_OP_STORE);
          plan_.uses[u].load = use.clear.clear ? VK_ATTACHMENT_LOAD_OP_CLEAR
                               : keeps         ? VK_ATTACHMENT_LOAD_OP_LOAD
                                               : VK_ATTACHMENT_LOAD_OP_DONT_CARE;
        }
        Group here{.position = position, .stages = access.stages, .writes = access.write};
        // Attachments that keep their content read it; depth is read by its test.
        if (reads(use.use) || use.use == Use::DepthAttachment || plan_.uses[u].load == VK_ATTACHMENT_LOAD_OP_LOAD)
          here.reads = access.read;
        if (!row.is_buffer) here.layout = access.layout;
        add_group(cell, here);
        cell.written |= writes(use.use);
      });
    }
  }

  void add_group(Cell& cell, const Group& here) {
    if (cell.last != none) {
      Group& last = groups_[cell.last];
      const bool same_read = !here.writes && !last.writes && last.layout == here.layout;
      if (same_read || cell.pass == here.position) {
        last.stages |= here.stages;
        last.reads |= here.reads;
        last.writes |= here.writes;
        cell.pass = here.position;
        return;
      }
    }
    groups_.push_back(here);
    const uint32_t index = uint32_t(groups_.size() - 1);
    (cell.last == none ? cell.first : groups_[cell.last].next) = index;
    cell.last = index;
    cell.pass = here.position;
  }

  Cell& cell_of(uint16_t resource, uint32_t index) { return cells_[plan_.resources[resource].first_cell + index]; }

  // Whether a frame finds the content that the frame before has left, in `left_by`.
  bool rings_on(uint16_t resource) const {
    const Lifetime lifetime = graph_.resources[resource].lifetime;
    return lifetime == Lifetime::HistoryPrev || lifetime == Lifetime::Kept;
  }
  uint16_t left_by(uint16_t resource) const {
    return graph_.resources[resource].lifetime == Lifetime::Kept ? resource : graph_.resources[resource].pair;
  }
  // Reads of next at a frame's end and of prev at the beginning of the following one are one group in two halves.
  bool joined(uint16_t prev, uint32_t index) {
    const Cell &before = cell_of(left_by(prev), index), &after = cell_of(prev, index);
    if (before.last == none || after.first == none) return false;
    const Group &last = groups_[before.last], &front = groups_[after.first];
    return !last.writes && !front.writes && last.layout == front.layout;
  }
  void join_frames(uint16_t prev) {
    for (uint32_t c = 0; c < cell_count(graph_.resources[prev]); ++c) {
      if (!joined(prev, c)) continue;
      Group &last = groups_[cell_of(left_by(prev), c).last], &front = groups_[cell_of(prev, c).first];
      front.stages = last.stages |= front.stages;
      front.reads = last.reads |= front.reads;
    }
  }

  // What the cell's first group of a frame follows.
  Group group_before(uint16_t resource, uint32_t index) {
    const ResourceRow& row = graph_.resources[resource];
    const Cell& own = cell_of(resource, index);
    if (row.lifetime == Lifetime::Kept) return groups_[own.last];
    if (row.lifetime != Lifetime::Transient) {
      const Cell& other = cell_of(row.pair, index);
      return groups_[other.last != none ? other.last : own.last];
    }
    Group before{.position = 0};
    // Where in its memory an image keeps a cell is the driver's business: all cells of another owner count.
    for (const uint16_t owner : plan_.resources[resource].alias_of)
      for (uint32_t c = 0; c < cell_count(graph_.resources[owner]); ++c) {
        const Cell& cell = cell_of(owner, c);
        if (cell.last == none || (owner == resource && c != index)) continue;
        before.stages |= groups_[cell.last].stages;
        before.writes |= groups_[cell.last].writes;
      }
    return before;
  }

  void add_barriers(uint16_t resource, std::vector<PlacedBarrier>& out) {
    const ResourceRow& row = graph_.resources[resource];
    const bool prev = rings_on(resource);
    for (uint32_t index = 0; index < cell_count(row); ++index) {
      const Cell& cell = cell_of(resource, index);
      if (cell.first == none) continue;
      Group before = group_before(resource, index);
      if (!prev) before.layout = VK_IMAGE_LAYOUT_UNDEFINED;  // the content is gone, and must be: see frame-graph.md 2.3
      PlannedCell& planned = plan_.cells[plan_.resources[resource].first_cell + index];
      planned = {before.layout, groups_[cell.last].layout};
      uint32_t g = cell.first;
      if (prev && joined(resource, index)) before = groups_[g], g = groups_[g].next;
      for (; g != none; before = groups_[g], g = groups_[g].next) {
        const Group& group = groups_[g];
        VkAccessFlags2 needed = group.reads | group.writes;
        // What the reads before made visible to these stages is visible still.
        if (!before.writes && before.layout == group.layout && !(group.stages & ~before.stages))
          needed &= ~before.reads;
        out.push_back(
            {group.position, Barrier{.resource = resource,
                                     .part = {uint8_t(index % row.desc.mips), 1, uint8_t(index / row.desc.mips), 1},
                                     .src_stages = before.stages,
                                     .dst_stages = group.stages,
                                     .src_access = before.writes,
                                     .dst_access = needed,
                                     .old_layout = before.layout,
                                     .new_layout = group.layout}});
      }
    }
  }

  // Into the plan by position; equal ones of neighbouring layers, then of neighbouring mips, become one.
  void sort_barriers(std::vector<PlacedBarrier>& placed) {
    const auto key = [](const PlacedBarrier& p) {
      const Barrier& b = p.barrier;
      return std::tuple(p.position, b.resource, b.src_stages, b.dst_stages, b.src_access, b.dst_access, b.old_layout,
                        b.new_layout);
    };
    const auto merge = [&](auto place, auto fits) {
      std::stable_sort(placed.begin(), placed.end(), [&](const PlacedBarrier& a, const PlacedBarrier& b) {
        return std::pair(key(a), place(a.barrier.part)) < std::pair(key(b), place(b.barrier.part));
      });
      size_t kept = 0;
      for (size_t i = 1; i < placed.size(); ++i)
        if (key(placed[kept]) != key(placed[i]) || !fits(placed[kept].barrier.part, placed[i].barrier.part))
          placed[++kept] = placed[i];
      placed.resize(std::min(placed.size(), kept + 1));
    };
    merge([](const Part& p) { return std::tuple(p.mip, p.layer); },
          [](Part& a, const Part& b) {
            if (a.mip != b.mip || a.layer + a.layers != b.layer) return false;
            a.layers = uint8_t(a.layers + b.layers);
            return true;
          });
    merge([](const Part& p) { return std::tuple(p.layer, p.layers, p.mip); },
          [](Part& a, const Part& b) {
            if (a.layer != b.layer || a.layers != b.layers || a.mip + a.mips != b.mip) return false;
            a.mips = uint8_t(a.mips + b.mips);
            return true;
          });
    for (const PlacedBarrier& p : placed) {
      PlannedPass& pass = plan_.passes[p.position];
      if (pass.barrier_count++ == 0) pass.first_barrier = uint32_t(plan_.barriers.size());
      plan_.barriers.push_back(p.barrier);
    }
  }

  const Graph& graph_;
  Plan& plan_;
  std::vector<Cell> cells_;
  std::vector<Group> groups_;
};

}  // namespace

Plan compile(const Graph& graph, const CompileOptions& options) {
  Plan plan;
  plan.layouts = options.layouts;
  find_live_passes(graph, plan);
  if (options.order_seed) shuffle_passes(graph, options.order_seed, plan);
  place_resources(graph, options, plan);
  Compiler(graph, plan).run();
  return plan;
}

}  // namespace nf::graph
