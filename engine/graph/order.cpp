// Which passes run, and in which order.
#include <random>

#include "graph/phases.h"

namespace nf::graph {

std::vector<uint32_t> first_cells(const Graph& graph, uint32_t& total) {
  std::vector<uint32_t> first;
  first.reserve(graph.resources.size());
  total = 0;
  for (const ResourceRow& row : graph.resources) {
    first.push_back(total);
    total += cell_count(row);
  }
  return first;
}

void find_live_passes(const Graph& graph, Plan& plan) {
  // By whole resources: a pyramid whose top is wanted keeps the passes of all its mips.
  std::vector<bool> live(graph.passes.size(), false), next_needed(graph.resources.size(), false);
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<bool> needed = next_needed;
    for (size_t i = graph.passes.size(); i-- > 0;) {
      const PassRow& pass = graph.passes[i];
      bool wanted = live[i] || leaves_the_frame(pass.kind);
      for (const UseRow& use : graph.uses_of(pass)) wanted |= writes(use.use) && needed[use.resource];
      if (!wanted) continue;
      live[i] = true;
      for (const UseRow& use : graph.uses_of(pass)) {
        const ResourceRow& row = graph.resources[use.resource];
        // What this frame reads of prev, any pass of the frame before has written to next, also one behind this one.
        // And what is written to next in part is written whole: another graph may read it. So is what is kept.
        const uint16_t next = row.lifetime == Lifetime::HistoryPrev                                     ? row.pair
                              : row.lifetime == Lifetime::HistoryNext || row.lifetime == Lifetime::Kept ? use.resource
                                                                                                        : no_resource;
        if (next != no_resource && !next_needed[next]) next_needed[next] = changed = true;
        if (depends_on_content(use)) needed[use.resource] = true;
      }
    }
  }
  plan.culled.resize(live.size());
  for (uint32_t i = 0; i < live.size(); ++i) {
    plan.culled[i] = !live[i];
    if (live[i]) plan.passes.push_back({.pass = i});
  }
}

void shuffle_passes(const Graph& graph, uint64_t seed, Plan& plan) {
  struct Cell {
    uint32_t writer = ~0u;
    std::vector<uint32_t> readers;  // since it was written
  };
  uint32_t total = 0;
  const std::vector<uint32_t> first = first_cells(graph, total);
  std::vector<Cell> cells(total);
  const uint32_t count = uint32_t(plan.passes.size());
  std::vector<std::vector<uint32_t>> after(count);
  std::vector<uint32_t> waits(count, 0);
  const auto depend = [&](uint32_t earlier, uint32_t later) {
    if (earlier == ~0u || earlier == later) return;
    after[earlier].push_back(later);
    ++waits[later];
  };
  for (uint32_t p = 0; p < count; ++p)
    for (const UseRow& use : graph.uses_of(graph.passes[plan.passes[p].pass]))
      for_each_cell(graph.resources[use.resource], use.part, [&](uint32_t c) {
        Cell& cell = cells[first[use.resource] + c];
        depend(cell.writer, p);
        if (!writes(use.use)) {
          cell.readers.push_back(p);
          return;
        }
        for (const uint32_t reader : cell.readers) depend(reader, p);
        cell.readers.clear();
        cell.writer = p;
      });

  std::mt19937_64 random(seed);
  std::vector<uint32_t> ready;
  for (uint32_t p = 0; p < count; ++p)
    if (!waits[p]) ready.push_back(p);
  std::vector<PlannedPass> order;
  while (!ready.empty()) {
    const size_t pick = random() % ready.size();
    const uint32_t p = ready[pick];
    ready[pick] = ready.back();
    ready.pop_back();
    order.push_back(plan.passes[p]);
    for (const uint32_t later : after[p])
      if (--waits[later] == 0) ready.push_back(later);
  }
  NF_CHECK(order.size() == count, "{} of {} passes ordered", order.size(), count);
  plan.passes = std::move(order);
}

}  // namespace nf::graph
