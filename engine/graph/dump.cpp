// Printing of graphs and plans.
#include "graph/dump.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

namespace nf::graph {
namespace {

using nlohmann::json;

const char* layout_name(VkImageLayout layout) {
  switch (layout) {
    case VK_IMAGE_LAYOUT_UNDEFINED:
      return "undefined";
    case VK_IMAGE_LAYOUT_GENERAL:
      return "general";
    case VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL:
      return "shader_read";
    case VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL:
      return "color_attachment";
    case VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL:
      return "depth_attachment";
    case VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL:
      return "transfer_source";
    case VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL:
      return "transfer_destination";
    default:
      return "other";
  }
}

std::string stages_text(VkPipelineStageFlags2 stages) {
  static const std::pair<VkPipelineStageFlags2, const char*> names[] = {
      {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, "compute"},
      {VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT, "vertex"},
      {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, "fragment"},
      {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, "color"},
      {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT, "early_depth"},
      {VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT, "late_depth"},
      {VK_PIPELINE_STAGE_2_COPY_BIT, "copy"},
      {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, "indirect"},
      {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, "indices"}};
  std::string text;
  for (const auto& [bit, name] : names)
    if (stages & bit) text += (text.empty() ? "" : "|") + std::string(name);
  return text.empty() ? "none" : text;
}

// " mip 2, layers 0-5" of what is not the whole image.
std::string part_text(const ResourceRow& row, const Part& part) {
  if (row.is_buffer) return "";
  const auto range = [](const char* what, uint32_t first, uint32_t count, uint32_t all) {
    if (count == all) return std::string();
    return count == 1 ? fmt::format(" {} {}", what, first) : fmt::format(" {}s {}-{}", what, first, first + count - 1);
  };
  return range("mip", part.mip, part.mips, row.desc.mips) + range("layer", part.layer, part.layers, row.desc.layers);
}
std::string use_text(const Graph& graph, const UseRow& use) {
  return resource_name(graph, use.resource) + part_text(graph.resources[use.resource], use.part);
}

std::string size_text(const ResourceRow& row) {
  if (row.is_buffer) return fmt::format("{} B", row.bytes);
  std::string text = fmt::format("{}x{}", row.desc.size.width, row.desc.size.height);
  if (row.desc.layers > 1) text += fmt::format("x{}", row.desc.layers);
  if (row.desc.mips > 1) text += fmt::format(" m{}", row.desc.mips);
  return text;
}
const char* format_text(const ResourceRow& row) {
  return row.is_buffer ? "buffer" : gpu::format_name(row.desc.format);
}

constexpr double mib = 1048576.0;

}  // namespace

std::string resource_name(const Graph& graph, uint16_t resource) {
  const ResourceRow& row = graph.resources[resource];
  const bool previous = row.lifetime == Lifetime::HistoryPrev;
  const auto same = [&](const ResourceRow& other) {
    return !std::strcmp(other.name, row.name) && (other.lifetime == Lifetime::HistoryPrev) == previous;
  };
  const auto before = std::count_if(graph.resources.begin(), graph.resources.begin() + resource, same);
  return fmt::format("{}{}{}", row.name, previous ? ".prev" : "", before ? fmt::format(" #{}", before + 1) : "");
}

std::string pass_label(const Graph& graph, uint32_t pass) {
  const char* name = graph.passes[pass].name;
  const auto before = std::count_if(graph.passes.begin(), graph.passes.begin() + pass,
                                    [&](const PassRow& other) { return !std::strcmp(other.name, name); });
  return before ? fmt::format("{} #{}", name, before + 1) : name;
}

nlohmann::json to_json(const Graph& graph, const Plan& plan) {
  json passes = json::array(), resources = json::array(), histories = json::array(), heaps = json::array();
  std::vector<const PlannedPass*> planned(graph.passes.size(), nullptr);
  for (const PlannedPass& p : plan.passes) planned[p.pass] = &p;
  for (size_t i = 0; i < graph.passes.size(); ++i) {
    const PassRow& pass = graph.passes[i];
    json uses = json::array(), barriers = json::array();
    for (const UseRow& use : graph.uses_of(pass))
      uses.push_back({{"resource", resource_name(graph, use.resource)},
                      {"use", access_of(use.use, pass.kind).name},
                      {"reads", reads(use.use)},
                      {"writes", writes(use.use)},
                      {"slot", use.slot ? json(use.slot) : json(nullptr)},
                      {"mip", use.part.mip},
                      {"mips", use.part.mips},
                      {"layer", use.part.layer},
                      {"layers", use.part.layers}});
    if (planned[i])
      for (uint32_t b = planned[i]->first_barrier; b < planned[i]->first_barrier + planned[i]->barrier_count; ++b) {
        const Barrier& barrier = plan.barriers[b];
        barriers.push_back({{"resource", resource_name(graph, barrier.resource)},
                            {"mip", barrier.part.mip},
                            {"mips", barrier.part.mips},
                            {"layer", barrier.part.layer},
                            {"layers", barrier.part.layers},
                            {"src", stages_text(barrier.src_stages)},
                            {"dst", stages_text(barrier.dst_stages)},
                            {"from", layout_name(barrier.old_layout)},
                            {"to", layout_name(barrier.new_layout)}});
      }
    passes.push_back({{"name", pass.name},
                      {"label", pass_label(graph, uint32_t(i))},
                      {"kind", kind_name(pass.kind)},
                      {"description", pass.description},
                      {"culled", bool(plan.culled[i])},
                      {"uses", uses},
                      {"barriers", barriers}});
  }
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    const PlannedResource& p = plan.resources[r];
    json alias_of = json::array();
    for (const uint16_t other : p.alias_of)
      if (other != r) alias_of.push_back(resource_name(graph, other));
    resources.push_back({{"name", resource_name(graph, r)},
                         {"kind", row.is_buffer ? "buffer" : "image"},
                         {"format", row.is_buffer ? json(nullptr) : json(gpu::format_name(row.desc.format))},
                         {"size", row.is_buffer ? json(row.bytes) : json({row.desc.size.width, row.desc.size.height})},
                         {"mips", row.desc.mips},
                         {"layers", row.desc.layers},
                         {"bytes", p.bytes},
                         {"first", p.live ? json(p.first) : json(nullptr)},
                         {"last", p.live ? json(p.last) : json(nullptr)},
                         {"heap", p.heap >= 0 ? json(p.heap) : json(nullptr)},
                         {"offset", p.heap >= 0 ? json(p.offset) : json(nullptr)},
                         {"transient", row.lifetime == Lifetime::Transient},
                         {"imported", row.lifetime == Lifetime::Imported},
                         {"kept", row.lifetime == Lifetime::Kept},
                         {"dedicated", p.dedicated},
                         {"alias_of", alias_of}});
    if (row.lifetime == Lifetime::HistoryNext) histories.push_back({{"name", row.name}, {"live", p.live}});
  }
  for (const PlannedHeap& heap : plan.heaps) heaps.push_back(heap.size);
  return {{"schema", "nearfield.graph/1"},
          {"passes", passes},
          {"resources", resources},
          {"histories", histories},
          {"memory",
           {{"placed_bytes", plan.placed_bytes},
            {"max_live_bytes", plan.max_live_bytes},
            {"unaliased_bytes", plan.unaliased_bytes},
            {"heaps", heaps}}}};
}

std::string to_text(const Graph& graph, const Plan& plan) {
  std::string text = fmt::format("{:3} {:22} {:10}  {}\n", "#", "pass", "kind", "reads -> writes   [barriers]");
  std::vector<const PlannedPass*> planned(graph.passes.size(), nullptr);
  std::vector<size_t> position(graph.passes.size(), 0);
  for (size_t i = 0; i < plan.passes.size(); ++i) {
    planned[plan.passes[i].pass] = &plan.passes[i];
    position[plan.passes[i].pass] = i;
  }
  for (size_t i = 0; i < graph.passes.size(); ++i) {
    const PassRow& pass = graph.passes[i];
    std::string in, out;
    for (const UseRow& use : graph.uses_of(pass)) {
      std::string& side = writes(use.use) ? out : in;
      side += (side.empty() ? "" : ", ") + use_text(graph, use);
    }
    const std::string number = planned[i] ? fmt::format("{}", position[i]) : "-";
    text += fmt::format("{:3} {:22} {:10}  {} -> {}   [{}]\n", number, pass.name,
                        planned[i] ? kind_name(pass.kind) : "culled", in, out.empty() ? "host" : out,
                        planned[i] ? planned[i]->barrier_count : 0);
  }
  text += fmt::format("\n{:26} {:20} {:>11} {:>10}  {}\n", "resource", "format", "size", "KiB", "lifetime (positions)");
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    const PlannedResource& p = plan.resources[r];
    const char* kind = row.lifetime == Lifetime::Imported    ? " (imported)"
                       : row.lifetime == Lifetime::Kept      ? " (kept)"
                       : row.lifetime != Lifetime::Transient ? " (history)"
                       : p.dedicated                         ? " (memory of its own: the device asks for it)"
                                                             : "";
    std::string where;
    if (p.heap >= 0) where = fmt::format(", heap {} at {} KiB", p.heap, p.offset / 1024);
    text += fmt::format("{:26} {:20} {:>11} {:>10}  {}\n", resource_name(graph, r), format_text(row), size_text(row),
                        p.bytes / 1024,
                        p.live ? fmt::format("{}-{}{}{}", p.first, p.last, kind, where) : std::string("unused"));
  }
  text += fmt::format(
      "\nmemory: placed {:.2f} MiB, max live {:.2f} MiB (no placement needs less), unaliased {:.2f} MiB; {} barriers\n",
      double(plan.placed_bytes) / mib, double(plan.max_live_bytes) / mib, double(plan.unaliased_bytes) / mib,
      plan.barriers.size());
  return text;
}

std::string to_dot(const Graph& graph, const Plan& plan) {
  std::string text = "digraph frame {\n  rankdir=LR;\n  node [fontname=\"sans-serif\"];\n";
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    if (graph.resources[r].lifetime == Lifetime::Imported) continue;  // tables that are only read: no order, no edge
    text += fmt::format("  r{} [label=\"{}\\n{} {}\", shape={}{}];\n", r, resource_name(graph, r),
                        format_text(graph.resources[r]), size_text(graph.resources[r]),
                        graph.resources[r].is_buffer ? "cylinder" : "ellipse",
                        plan.resources[r].live ? "" : ", color=grey, fontcolor=grey");
  }
  for (size_t i = 0; i < graph.passes.size(); ++i) {
    const PassRow& pass = graph.passes[i];
    text += fmt::format("  p{} [label=\"{}\", shape=box{}];\n", i, pass.name,
                        plan.culled[i] ? ", color=grey, fontcolor=grey" : ", style=filled, fillcolor=lightblue");
    for (const UseRow& use : graph.uses_of(pass)) {
      const ResourceRow& row = graph.resources[use.resource];
      if (row.lifetime == Lifetime::Imported) continue;
      const std::string label = part_text(row, use.part);
      const std::string part = label.empty() ? "" : fmt::format(" [label=\"{}\"]", label.substr(1));
      text += writes(use.use) ? fmt::format("  p{} -> r{}{};\n", i, use.resource, part)
                              : fmt::format("  r{} -> p{}{};\n", use.resource, i, part);
    }
  }
  return text + "}\n";
}

std::string diff_text(const Graph& a, const Plan& plan_a, const Graph& b, const Plan& plan_b) {
  std::string text;
  const auto has = [](const Graph& graph, const Plan& plan, std::string_view name) {
    return std::any_of(plan.passes.begin(), plan.passes.end(),
                       [&](const PlannedPass& p) { return graph.passes[p.pass].name == name; });
  };
  const auto list = [&](const char* sign, const Graph& graph, const Plan& plan, const Graph& other,
                        const Plan& other_plan) {
    for (const PlannedPass& p : plan.passes)
      if (const char* name = graph.passes[p.pass].name; !has(other, other_plan, name))
        text += fmt::format("{} pass {} ({} barriers)\n", sign, name, p.barrier_count);
  };
  list("-", a, plan_a, b, plan_b);
  list("+", b, plan_b, a, plan_a);
  for (const PlannedPass& p : plan_a.passes)
    for (const PlannedPass& q : plan_b.passes)
      if (std::string_view(a.passes[p.pass].name) == b.passes[q.pass].name && p.barrier_count != q.barrier_count)
        text += fmt::format("  pass {}: {} -> {} barriers\n", a.passes[p.pass].name, p.barrier_count, q.barrier_count);
  const auto row = [&](const char* what, uint64_t before, uint64_t after, double unit) {
    text += fmt::format("  {:12} {:.2f} -> {:.2f}\n", what, double(before) / unit, double(after) / unit);
  };
  row("passes", plan_a.passes.size(), plan_b.passes.size(), 1);
  row("barriers", plan_a.barriers.size(), plan_b.barriers.size(), 1);
  row("placed MiB", plan_a.placed_bytes, plan_b.placed_bytes, 1048576);
  row("max live MiB", plan_a.max_live_bytes, plan_b.max_live_bytes, 1048576);
  row("unaliased MiB", plan_a.unaliased_bytes, plan_b.unaliased_bytes, 1048576);
  return text;
}

}  // namespace nf::graph
