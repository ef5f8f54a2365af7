// One run of a graph, and what a frame leaves behind.
#include "graph/executor.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <glm/gtc/color_space.hpp>
#include <glm/gtc/packing.hpp>

namespace nf::graph {
namespace {

// steady_clock is CLOCK_MONOTONIC.
double now_ns() {
  return double(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count());
}

}  // namespace

void Executor::run(const Graph& graph, const ExecuteOptions& execute) {
  const double start_ns = now_ns();
  collect(ring_.finished());
  switched_ = false;
  select_plan(graph);
  RealPlan& real = plans_[current_];
  const Plan& plan = real.plan;
  // Behind a run that held, the sides are not where the plan expects them.
  if (held_)
    switched_ = true;
  else
    parity_ = 1 - parity_;
  held_ = execute.hold_histories;
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    if (row.lifetime == Lifetime::HistoryPrev && plan.resources[r].live) held_ &= row.valid;
  }
  real.last_run = ++runs_;
  graph_ = &graph;

  VkDeviceSize uniform_bytes = 256;
  for (const ParamRow& row : graph.params) uniform_bytes += ring_.uniform_stride(row.table->size);
  for (const ParamRow& row : graph.shared) uniform_bytes += ring_.uniform_stride(row.table->size);
  gpu::Frame& frame = ring_.begin(uniform_bytes, uint32_t(plan.passes.size() + 1) * 2,
                                  execute.counts ? uint32_t(plan.passes.size()) : 0);
  std::vector<gpu::UniformRange> uniforms;  // the graph's params, then its shared blocks
  for (const auto* rows : {&graph.params, &graph.shared})
    for (const ParamRow& row : *rows)
      uniforms.push_back(ring_.push_uniform(frame, std::span(graph.param_bytes).subspan(row.offset, row.table->size)));

  settle(graph, frame.commands);
  last_passes_.clear();
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    const PassRow& pass = graph.passes[plan.passes[position].pass];
    const Doing doing(fmt::format("recording the pass {}", pass.name));
    const double pass_ns = now_ns();
    record_pass(graph, position, frame, execute, uniforms);
    last_passes_.push_back({pass.name, pass.description, pass.kind, 0, 0, (now_ns() - pass_ns) * 1e-6, {}});
  }
  last_counted_ = execute.counts && device_.facts.pipeline_statistics;
  last_submit_ns_ = now_ns();
  last_record_ms_ = (last_submit_ns_ - start_ns) * 1e-6;
  const Doing doing("submitting the frame");
  ring_.submit(frame, execute.after, execute.then);
  last_ = &frame;
  graph_ = nullptr;

  last_readbacks_.clear();
  for (const PassRow& pass : graph.passes)
    if (pass.kind == PassKind::Readback) last_readbacks_.push_back(pass.name);
  history_states_.clear();
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    const bool kept = row.lifetime == Lifetime::Kept;
    if ((row.lifetime != Lifetime::HistoryNext && !kept) || !real.histories[r]) continue;
    PhysicalHistory& history = *real.histories[r];
    const auto leave_in_layouts = [&](uint16_t resource, uint32_t side) {
      for (uint32_t c = 0; c < cell_count(row); ++c)
        if (const PlannedCell& cell = plan.cells[plan.resources[resource].first_cell + c];
            cell.after != VK_IMAGE_LAYOUT_UNDEFINED)
          history.layouts[side][c] = cell.after;
    };
    leave_in_layouts(r, kept ? 0 : parity_);
    if (!kept) leave_in_layouts(row.pair, 1 - parity_);
    if (!plan.resources[r].live) continue;
    history.written = runs_;
    history_states_.push_back({history.name, history.desc, history.bytes});
    if (kept)
      history_states_.back().marks.assign(graph.marks.begin() + row.first_mark,
                                          graph.marks.begin() + row.first_mark + row.desc.layers);
  }
}

FrameResult Executor::finish() {
  FrameResult result;
  if (!last_) return result;
  ring_.wait(*last_);
  result.record_ms = last_record_ms_;
  result.submit_ns = last_submit_ns_;
  result.wall_ms = (now_ns() - last_submit_ns_) * 1e-6;
  const std::vector<double> ns = read_timestamps(device_, *last_, &result.gpu_begin_ns);
  if (ns.size() != last_passes_.size() * 2 || ns.empty()) return result;
  result.passes = last_passes_;
  for (uint32_t i = 0; i < result.passes.size(); ++i) {
    PassTime& pass = result.passes[i];
    pass.begin_ms = ns[2 * i] * 1e-6;
    pass.ms = std::max(ns[2 * i + 1] - ns[2 * i], 0.0) * 1e-6;
    if (last_counted_ && has_shader(pass.kind)) pass.counts = read_counts(device_, *last_, counted_work(pass.kind), i);
  }
  result.frame_ms = (*std::max_element(ns.begin(), ns.end()) - *std::min_element(ns.begin(), ns.end())) * 1e-6;
  return result;
}

std::vector<Readback> Executor::take_readbacks() {
  if (last_) ring_.wait(*last_);
  std::vector<Readback> result;
  for (size_t i = 0; i < last_readbacks_.size(); ++i) {
    const ReadbackRow& row = plans_[current_].readbacks[i];
    result.push_back({last_readbacks_[i], row.desc, {row.buffer.mapped, row.buffer.mapped + row.buffer.size}});
  }
  return result;
}

std::vector<float> to_floats(const Readback& readback, uint32_t& channels) {
  const size_t texels = size_t(readback.desc.size.width) * readback.desc.size.height;
  const VkFormat format = readback.desc.format;
  // Texels of `count` channels out of texels of one T.
  const auto convert = [&]<class T>(uint32_t count, T, const auto& texel) {
    channels = count;
    std::vector<float> out(texels * count);
    for (size_t i = 0; i < texels; ++i) {
      T bits;
      std::memcpy(&bits, readback.texels.data() + i * sizeof bits, sizeof bits);
      const auto value = texel(bits);
      std::memcpy(out.data() + i * count, &value, count * sizeof(float));
    }
    return out;
  };
  // Channels one by one.
  const auto each = [&]<class T>(uint32_t count, T, const auto& channel) {
    channels = count;
    std::vector<float> out(texels * count);
    for (size_t i = 0; i < out.size(); ++i) {
      T bits;
      std::memcpy(&bits, readback.texels.data() + i * sizeof bits, sizeof bits);
      out[i] = channel(bits);
    }
    return out;
  };
  const auto same = [](float value) { return value; };
  const auto half = [](uint16_t bits) { return glm::unpackHalf1x16(bits); };
  const auto unorm8 = [](uint8_t bits) { return float(bits) / 255; };
  const auto unorm16 = [](uint16_t bits) { return float(bits) / 65535; };
  switch (format) {
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_D32_SFLOAT:
      return each(1, 0.0f, same);
    case VK_FORMAT_R32G32_SFLOAT:
      return each(2, 0.0f, same);
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return each(4, 0.0f, same);
    case VK_FORMAT_R16_SFLOAT:
      return each(1, uint16_t(), half);
    case VK_FORMAT_R16G16_SFLOAT:
      return each(2, uint16_t(), half);
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return each(4, uint16_t(), half);
    case VK_FORMAT_R8_UNORM:
      return each(1, uint8_t(), unorm8);
    case VK_FORMAT_R8G8_UNORM:
      return each(2, uint8_t(), unorm8);
    case VK_FORMAT_R8G8B8A8_UNORM:
      return each(4, uint8_t(), unorm8);
    case VK_FORMAT_D16_UNORM:
      return each(1, uint16_t(), unorm16);
    case VK_FORMAT_R16G16B16A16_UNORM:
      return each(4, uint16_t(), unorm16);
    case VK_FORMAT_R32_UINT:
      return each(1, uint32_t(), [](uint32_t bits) { return float(bits); });
    case VK_FORMAT_R8G8B8A8_SRGB:
      return convert(4, uint32_t(), [](uint32_t bits) {
        const glm::vec4 encoded = glm::unpackUnorm4x8(bits);
        return glm::vec4(glm::convertSRGBToLinear(glm::vec3(encoded)), encoded.w);
      });
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
      return convert(4, uint32_t(), [](uint32_t bits) { return glm::unpackUnorm3x10_1x2(bits); });
    case VK_FORMAT_B10G11R11_UFLOAT_PACK32:
      // A half's exponent over fewer bits of mantissa. (GLM's own function does not know subnormal numbers.)
      return convert(3, uint32_t(), [half](uint32_t bits) {
        return glm::vec3(half(uint16_t((bits & 0x7ff) << 4)), half(uint16_t((bits >> 11 & 0x7ff) << 4)),
                         half(uint16_t((bits >> 22) << 5)));
      });
    default:
      fail(Exit::Internal, "cannot turn the read-back '{}' of format {} into floats", readback.name,
           gpu::format_name(format));
  }
}

}  // namespace nf::graph
