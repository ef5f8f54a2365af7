// Making plans real: images of the resources, histories, read-back buffers; and what a frame leaves behind.
#include "graph/executor.h"

#include <algorithm>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "core/log.h"

namespace nf::graph {

Executor::Executor(gpu::Device& device, gpu::Pipelines& pipelines, bool alias)
    : device_(device), pipelines_(pipelines), ring_(device), alias_(alias) {}

Executor::~Executor() {
  vkDeviceWaitIdle(device_.handle);
  release();
  for (PhysicalHistory& history : histories_)
    for (gpu::Image& image : history.images) destroy(device_, image);
}

void Executor::release() {
  for (gpu::Image& image : images_) destroy(device_, image);
  for (gpu::Buffer& buffer : poison_) destroy(device_, buffer);
  poison_.clear();
  for (gpu::Heap& heap : heaps_) destroy(device_, heap);
  heaps_.clear();
  for (gpu::Buffer& buffer : readback_buffers_) destroy(device_, buffer);
  images_.clear();
  readback_buffers_.clear();
  readback_rows_.clear();
}

void Executor::invalidate_histories() {
  for (HistoryState& state : history_states_) state.written = false;
}

namespace {

gpu::ImageInfo image_info(const ImageDesc& desc, VkImageUsageFlags usage) {
  return {.extent = {desc.size.width, desc.size.height},
          .format = desc.format,
          .mips = desc.mips,
          .layers = desc.layers,
          .usage = usage};
}

}  // namespace

Plan Executor::plan_for(const Graph& graph) const {
  return compile(graph, {.alias = alias_, .needs = [this](const ImageDesc& desc, VkImageUsageFlags usage) {
                           return gpu::image_needs(device_, image_info(desc, usage));
                         }});
}

void Executor::replan(const Graph& graph, uint64_t hash) {
  require_valid(graph);
  Plan plan = plan_for(graph);
  device_.wait_idle();
  release();
  plan_ = std::move(plan);
  for (const PlannedHeap& heap : plan_.heaps)
    heaps_.push_back(create_heap(device_, heap.size, heap.type_bits, "the transient heap"));
  images_.resize(graph.resources.size());
  history_of_.assign(graph.resources.size(), -1);
  history_is_next_.assign(graph.resources.size(), 0);
  for (PhysicalHistory& history : histories_) history.used = false;

  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    const PlannedResource& planned = plan_.resources[r];
    if (row.lifetime == Lifetime::Transient) {
      if (!planned.live) continue;
      const gpu::ImageInfo info = image_info(row.desc, planned.usage);
      images_[r] = planned.heap < 0
                       ? create_image(device_, info, row.name)
                       : place_image(device_, info, row.name, heaps_[size_t(planned.heap)], planned.offset);
      continue;
    }
    history_is_next_[r] = row.lifetime == Lifetime::HistoryNext;
    const VkImageUsageFlags usage = planned.usage | plan_.resources[row.pair].usage | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (usage == VK_IMAGE_USAGE_TRANSFER_DST_BIT) continue;  // neither side is live
    auto found = std::find_if(histories_.begin(), histories_.end(), [&](const PhysicalHistory& h) {
      return !std::strcmp(h.name, row.name) && h.desc == row.desc && (h.usage & usage) == usage;
    });
    if (found == histories_.end()) {
      PhysicalHistory history{.name = row.name, .desc = row.desc, .usage = usage, .images = {}, .layouts = {}};
      for (gpu::Image& image : history.images) image = create_image(device_, image_info(row.desc, usage), row.name);
      histories_.push_back(history);
      found = histories_.end() - 1;
    }
    found->used = true;
    history_of_[r] = int(found - histories_.begin());
  }
  // Histories that this plan does not use are gone, and with them their content.
  std::vector<int> moved(histories_.size(), -1);
  std::vector<PhysicalHistory> kept;
  for (size_t i = 0; i < histories_.size(); ++i) {
    if (histories_[i].used) {
      moved[i] = int(kept.size());
      kept.push_back(histories_[i]);
    } else {
      for (gpu::Image& image : histories_[i].images) destroy(device_, image);
    }
  }
  histories_ = std::move(kept);
  for (int& index : history_of_)
    if (index >= 0) index = moved[size_t(index)];

  for (const PlannedPass& planned : plan_.passes) {
    const PassRow& pass = graph.passes[planned.pass];
    if (pass.kind != PassKind::Readback) continue;
    const ImageDesc& desc = graph.resources[graph.uses[pass.first_use].resource].desc;
    const uint64_t bytes = uint64_t(desc.size.width) * desc.size.height * gpu::texel_bytes(desc.format);
    readback_buffers_.push_back(
        create_buffer(device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Where::Host, pass.name));
    readback_rows_.emplace_back(pass.name, desc);
  }
  hash_ = hash;
  fresh_ = true;
  ++replans_;
}

const gpu::Image& Executor::image(uint16_t resource) const {
  const int history = history_of_[resource];
  if (history < 0) return images_[resource];
  return histories_[size_t(history)].images[history_is_next_[resource] ? parity_ : 1 - parity_];
}

void Executor::run(const Graph& graph, const ExecuteOptions& options) {
  const uint64_t hash = topology_hash(graph);
  if (hash != hash_ || plan_.passes.empty()) replan(graph, hash);
  parity_ = 1 - parity_;

  VkDeviceSize uniform_bytes = 256;
  for (const ParamRow& row : graph.params) uniform_bytes += ring_.uniform_stride(row.table->size);
  for (const ParamRow& row : graph.shared) uniform_bytes += ring_.uniform_stride(row.table->size);
  gpu::Frame& frame = ring_.begin(uniform_bytes, uint32_t(plan_.passes.size() + 1) * 2);
  std::vector<gpu::UniformRange> uniforms;  // the graph's params, then its shared blocks
  for (const auto* rows : {&graph.params, &graph.shared})
    for (const ParamRow& row : *rows)
      uniforms.push_back(ring_.push_uniform(frame, std::span(graph.param_bytes).subspan(row.offset, row.table->size)));

  if (options.poison) poison(frame.commands);
  if (fresh_) settle(graph, frame.commands);
  last_passes_.clear();
  for (const PlannedPass& planned : plan_.passes) {
    const PassRow& pass = graph.passes[planned.pass];
    const Doing doing(fmt::format("recording the pass {}", pass.name));
    record_pass(graph, planned, frame, options, uniforms);
    last_passes_.emplace_back(pass.name, pass.description);
  }
  ring_.submit(frame);
  last_ = &frame;
  fresh_ = false;

  history_states_.clear();
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    if (row.lifetime != Lifetime::HistoryNext || history_of_[r] < 0 || !plan_.resources[r].live) continue;
    history_states_.push_back({row.name, row.desc, true});
    histories_[size_t(history_of_[r])].layouts[parity_] = plan_.resources[r].last_layout;
    if (plan_.resources[row.pair].live)
      histories_[size_t(history_of_[r])].layouts[1 - parity_] = plan_.resources[row.pair].last_layout;
  }
}

FrameResult Executor::finish() {
  FrameResult result;
  if (!last_) return result;
  ring_.wait(*last_);
  const std::vector<double> ns = read_timestamps(device_, *last_);
  if (ns.size() == last_passes_.size() * 2 && !ns.empty()) {
    for (size_t i = 0; i < last_passes_.size(); ++i)
      result.passes.push_back({last_passes_[i].first, last_passes_[i].second, (ns[2 * i + 1] - ns[2 * i]) * 1e-6});
    result.frame_ms = (ns.back() - ns.front()) * 1e-6;
  }
  return result;
}

std::vector<Readback> Executor::take_readbacks() {
  if (last_) ring_.wait(*last_);
  std::vector<Readback> result;
  for (size_t i = 0; i < readback_buffers_.size(); ++i) {
    const gpu::Buffer& buffer = readback_buffers_[i];
    result.push_back({readback_rows_[i].first, readback_rows_[i].second, {buffer.mapped, buffer.mapped + buffer.size}});
  }
  return result;
}

std::vector<float> to_floats(const Readback& readback, uint32_t& channels) {
  const size_t texels = size_t(readback.desc.size.width) * readback.desc.size.height;
  const auto floats = [&](uint32_t count) {
    channels = count;
    std::vector<float> out(texels * count);
    std::memcpy(out.data(), readback.texels.data(), out.size() * sizeof(float));
    return out;
  };
  const auto halves = [&](uint32_t count) {
    channels = count;
    std::vector<float> out(texels * count);
    for (size_t i = 0; i < out.size(); ++i) {
      uint16_t bits;
      std::memcpy(&bits, readback.texels.data() + i * 2, 2);
      out[i] = glm::unpackHalf1x16(bits);
    }
    return out;
  };
  switch (readback.desc.format) {
    case VK_FORMAT_R32_SFLOAT:
      return floats(1);
    case VK_FORMAT_R32G32_SFLOAT:
      return floats(2);
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return floats(4);
    case VK_FORMAT_D32_SFLOAT:
      return floats(1);
    case VK_FORMAT_R16_SFLOAT:
      return halves(1);
    case VK_FORMAT_R16G16_SFLOAT:
      return halves(2);
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return halves(4);
    default:
      fail(Exit::Internal, "cannot turn the read-back '{}' of format {} into floats", readback.name,
           gpu::format_name(readback.desc.format));
  }
}

}  // namespace nf::graph
