// Probes are rows like any others: compile() finds barriers and lifetimes as if they had been declared there.
#include "graph/probe.h"

#include <algorithm>

#include "graph/phases.h"

namespace nf::graph {
namespace {

// Whether what runs before row `end` writes the cell; `culled` names a pass that would and does not run.
bool written_before(const Graph& graph, const Plan& plan, const Probe& probe, uint32_t end, const char*& culled) {
  const ResourceRow& row = graph.resources[probe.resource];
  const uint32_t cell = row.is_buffer ? 0 : uint32_t(probe.layer) * row.desc.mips + probe.mip;
  bool written = false;
  for (uint32_t p = 0; p < end; ++p)
    for (const UseRow& use : graph.uses_of(graph.passes[p])) {
      if (use.resource != probe.resource || !writes(use.use)) continue;
      for_each_cell(row, use.part, [&](uint32_t c) {
        if (c != cell) return;
        written |= !plan.culled[p];
        if (plan.culled[p]) culled = graph.passes[p].name;
      });
    }
  return written;
}

}  // namespace

std::string probe_fault(const Graph& graph, const Probe& probe) {
  if (probe.pass >= graph.passes.size())
    return fmt::format("there is no pass {}: the frame has {}", probe.pass, graph.passes.size());
  if (probe.resource >= graph.resources.size())
    return fmt::format("there is no resource {}: the frame has {}", probe.resource, graph.resources.size());
  const PassRow& pass = graph.passes[probe.pass];
  const ResourceRow& row = graph.resources[probe.resource];
  if (row.lifetime == Lifetime::Imported)
    return fmt::format("'{}' belongs to the scene and lies outside the frame: it is only read here", row.name);
  if (!row.is_buffer && (probe.mip >= row.desc.mips || probe.layer >= row.desc.layers))
    return fmt::format("'{}' has {} mips and {} layers: there is no mip {} of layer {}", row.name, row.desc.mips,
                       row.desc.layers, probe.mip, probe.layer);
  if (!row.is_buffer && gpu::texel_bytes(row.desc.format) == 0)
    return fmt::format("'{}' has a format that cannot be read back", row.name);
  if (probe.texel) {
    if (row.is_buffer) return fmt::format("'{}' is a buffer: it has no texels", row.name);
    const Size size = size_of(row.desc, probe.mip);
    if (probe.texel->x >= size.width || probe.texel->y >= size.height)
      return fmt::format("'{}' is {}x{} there: it has no texel {}, {}", row.name, size.width, size.height,
                         probe.texel->x, probe.texel->y);
  }
  Plan plan;
  find_live_passes(graph, plan);
  if (plan.culled[probe.pass]) return fmt::format("'{}' is culled: nothing in the frame needs it", pass.name);
  // What the last frame left, or zeros.
  if (row.lifetime == Lifetime::HistoryPrev || row.lifetime == Lifetime::Kept) return {};
  const char* culled = nullptr;
  if (written_before(graph, plan, probe, probe.pass + !probe.before, culled)) return {};
  if (culled)
    return fmt::format("'{}' has no content {} '{}': '{}', which would write it, is culled", row.name,
                       probe.before ? "before" : "after", pass.name, culled);
  const std::string part = !row.is_buffer && cell_count(row) > 1
                               ? fmt::format(" in mip {} of layer {}", probe.mip, probe.layer)
                               : std::string();
  return fmt::format("'{}' has no content{} {} '{}': nothing has written it yet", row.name, part,
                     probe.before ? "before" : "after", pass.name);
}

std::string add_probe(Graph& graph, const Probe& probe) {
  if (std::string fault = probe_fault(graph, probe); !fault.empty()) return fault;
  const uint32_t at = probe.pass + !probe.before;
  const Location here = Location::current();
  PassRow row{.name = probe.name,
              .description = "Copy to the host, to be looked at",
              .kind = PassKind::Readback,
              .pipeline = {},
              .first_use = at < graph.passes.size() ? graph.passes[at].first_use : uint32_t(graph.uses.size()),
              .use_count = 1,
              .first_param = at < graph.passes.size() ? graph.passes[at].first_param : uint32_t(graph.params.size()),
              .over_part = {},
              .one_texel = probe.texel.has_value(),
              .texel = probe.texel.value_or(Texel{}),
              .draw = {},
              .at = here};
  for (uint32_t p = at; p < graph.passes.size(); ++p) ++graph.passes[p].first_use;
  const UseRow use{nullptr, probe.resource, Use::CopySource, {probe.mip, 1, probe.layer, 1}, {}, here};
  graph.uses.insert(graph.uses.begin() + row.first_use, use);
  graph.passes.insert(graph.passes.begin() + at, row);
  ++graph.readbacks;
  return {};
}

std::vector<Probe> last_states(const Graph& graph, size_t resources) {
  Plan plan;
  find_live_passes(graph, plan);
  constexpr uint32_t never = ~0u;
  std::vector<Probe> out;
  for (uint16_t r = 0; r < std::min(resources, graph.resources.size()); ++r) {
    const ResourceRow& row = graph.resources[r];
    if (row.is_buffer || row.lifetime == Lifetime::Imported || gpu::texel_bytes(row.desc.format) == 0) continue;
    uint32_t used = never;
    std::vector<uint32_t> written(cell_count(row), never);
    for (uint32_t p = 0; p < graph.passes.size(); ++p)
      for (const UseRow& use : graph.uses_of(graph.passes[p])) {
        if (use.resource != r || plan.culled[p]) continue;
        used = p;
        if (writes(use.use)) for_each_cell(row, use.part, [&](uint32_t c) { written[c] = p; });
      }
    const bool kept = row.lifetime == Lifetime::HistoryPrev || row.lifetime == Lifetime::Kept;
    for (uint32_t c = 0; c < written.size(); ++c) {
      const uint32_t pass = written[c] == never && kept ? used : written[c];
      if (pass == never) continue;
      out.push_back(
          {.pass = pass, .resource = r, .mip = uint8_t(c % row.desc.mips), .layer = uint8_t(c / row.desc.mips)});
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const Probe& a, const Probe& b) { return a.pass < b.pass; });
  return out;
}

const Readback* find_readback(std::span<const Readback> readbacks, std::string_view name) {
  for (const Readback& readback : readbacks)
    if (name == readback.name) return &readback;
  return nullptr;
}

}  // namespace nf::graph
