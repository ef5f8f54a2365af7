// Printing of graphs and plans.
#include "graph/dump.h"

#include <algorithm>
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
      {VK_PIPELINE_STAGE_2_COPY_BIT, "copy"}};
  std::string text;
  for (const auto& [bit, name] : names)
    if (stages & bit) text += (text.empty() ? "" : "|") + std::string(name);
  return text.empty() ? "none" : text;
}

std::span<const UseRow> uses_of(const Graph& graph, const PassRow& pass) {
  return std::span(graph.uses).subspan(pass.first_use, pass.use_count);
}

// "name" of a resource; the two sides of a history are told apart.
std::string resource_name(const Graph& graph, uint16_t resource) {
  const ResourceRow& row = graph.resources[resource];
  return row.lifetime == Lifetime::HistoryPrev ? fmt::format("{}.prev", row.name) : row.name;
}

}  // namespace

nlohmann::json to_json(const Graph& graph, const Plan& plan) {
  json passes = json::array(), resources = json::array(), histories = json::array();
  std::vector<const PlannedPass*> planned(graph.passes.size(), nullptr);
  for (const PlannedPass& p : plan.passes) planned[p.pass] = &p;
  for (size_t i = 0; i < graph.passes.size(); ++i) {
    const PassRow& pass = graph.passes[i];
    json uses = json::array(), barriers = json::array();
    for (const UseRow& use : uses_of(graph, pass))
      uses.push_back({{"resource", use.is_buffer ? std::string(graph.buffers[use.resource].name)
                                                 : resource_name(graph, use.resource)},
                      {"use", access_of(use.use, pass.kind).name},
                      {"slot", use.slot ? json(use.slot) : json(nullptr)},
                      {"mip", 0}});
    if (planned[i])
      for (uint32_t b = planned[i]->first_barrier; b < planned[i]->first_barrier + planned[i]->barrier_count; ++b) {
        const Barrier& barrier = plan.barriers[b];
        barriers.push_back({{"resource", resource_name(graph, barrier.resource)},
                            {"src", stages_text(barrier.src_stages)},
                            {"dst", stages_text(barrier.dst_stages)},
                            {"from", layout_name(barrier.old_layout)},
                            {"to", layout_name(barrier.new_layout)}});
      }
    passes.push_back({{"name", pass.name},
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
                         {"kind", "image"},
                         {"format", gpu::format_name(row.desc.format)},
                         {"size", {row.desc.size.width, row.desc.size.height}},
                         {"bytes", p.bytes},
                         {"first", p.live ? json(p.first) : json(nullptr)},
                         {"last", p.live ? json(p.last) : json(nullptr)},
                         {"heap", p.heap >= 0 ? json(p.heap) : json(nullptr)},
                         {"offset", p.heap >= 0 ? json(p.offset) : json(nullptr)},
                         {"transient", row.lifetime == Lifetime::Transient},
                         {"alias_of", alias_of}});
    if (row.lifetime == Lifetime::HistoryNext) histories.push_back({{"name", row.name}, {"live", p.live}});
  }
  for (const BufferRow& row : graph.buffers)
    resources.push_back({{"name", row.name},
                         {"kind", "buffer"},
                         {"format", nullptr},
                         {"size", row.buffer->size},
                         {"bytes", row.buffer->size},
                         {"first", nullptr},
                         {"last", nullptr},
                         {"heap", nullptr},
                         {"offset", nullptr},
                         {"transient", false},
                         {"alias_of", json::array()}});
  return {{"schema", "nearfield.graph/1"},
          {"passes", passes},
          {"resources", resources},
          {"histories", histories},
          {"memory",
           {{"placed_bytes", plan.placed_bytes},
            {"max_live_bytes", plan.max_live_bytes},
            {"unaliased_bytes", plan.unaliased_bytes}}}};
}

std::string to_text(const Graph& graph, const Plan& plan) {
  std::string text = fmt::format("{:3} {:22} {:10}  {}\n", "#", "pass", "kind", "reads -> writes   [barriers]");
  uint32_t position = 0;
  std::vector<const PlannedPass*> planned(graph.passes.size(), nullptr);
  for (const PlannedPass& p : plan.passes) planned[p.pass] = &p;
  for (size_t i = 0; i < graph.passes.size(); ++i) {
    const PassRow& pass = graph.passes[i];
    std::string in, out;
    for (const UseRow& use : uses_of(graph, pass)) {
      const std::string name =
          use.is_buffer ? std::string(graph.buffers[use.resource].name) : resource_name(graph, use.resource);
      std::string& side = writes(use.use) && !use.is_buffer ? out : in;
      side += (side.empty() ? "" : ", ") + name;
    }
    const std::string number = planned[i] ? fmt::format("{}", position++) : "-";
    text += fmt::format("{:3} {:22} {:10}  {} -> {}   [{}]\n", number, pass.name,
                        planned[i] ? kind_name(pass.kind) : "culled", in, out.empty() ? "host" : out,
                        planned[i] ? planned[i]->barrier_count : 0);
  }
  text += fmt::format("\n{:26} {:20} {:>11} {:>10}  {}\n", "resource", "format", "size", "KiB", "lifetime (positions)");
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    const PlannedResource& p = plan.resources[r];
    text += fmt::format(
        "{:26} {:20} {:>11} {:>10}  {}\n", resource_name(graph, r), gpu::format_name(row.desc.format),
        fmt::format("{}x{}", row.desc.size.width, row.desc.size.height), p.bytes / 1024,
        !p.live ? std::string("unused")
                : fmt::format("{}-{}{}", p.first, p.last, row.lifetime == Lifetime::Transient ? "" : " (history)"));
  }
  text += fmt::format("\nmemory: placed {:.2f} MiB, max live {:.2f} MiB, unaliased {:.2f} MiB; {} barriers\n",
                      double(plan.placed_bytes) / 1048576.0, double(plan.max_live_bytes) / 1048576.0,
                      double(plan.unaliased_bytes) / 1048576.0, plan.barriers.size());
  return text;
}

std::string to_dot(const Graph& graph, const Plan& plan) {
  std::string text = "digraph frame {\n  rankdir=LR;\n  node [fontname=\"sans-serif\"];\n";
  for (uint16_t r = 0; r < graph.resources.size(); ++r)
    text +=
        fmt::format("  r{} [label=\"{}\\n{} {}x{}\", shape=ellipse{}];\n", r, resource_name(graph, r),
                    gpu::format_name(graph.resources[r].desc.format), graph.resources[r].desc.size.width,
                    graph.resources[r].desc.size.height, plan.resources[r].live ? "" : ", color=grey, fontcolor=grey");
  for (size_t i = 0; i < graph.passes.size(); ++i) {
    const PassRow& pass = graph.passes[i];
    text += fmt::format("  p{} [label=\"{}\", shape=box{}];\n", i, pass.name,
                        plan.culled[i] ? ", color=grey, fontcolor=grey" : ", style=filled, fillcolor=lightblue");
    for (const UseRow& use : uses_of(graph, pass)) {
      if (use.is_buffer) continue;
      text += writes(use.use) ? fmt::format("  p{} -> r{};\n", i, use.resource)
                              : fmt::format("  r{} -> p{};\n", use.resource, i);
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
