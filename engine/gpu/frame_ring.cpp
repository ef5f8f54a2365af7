// Frames in flight.
#include "gpu/frame_ring.h"

#include <cstring>

namespace nf::gpu {
namespace {

// In the order of PassCounts' members: that of the bits.
constexpr VkQueryPipelineStatisticFlags graphics_counts =
    VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_VERTICES_BIT |
    VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_PRIMITIVES_BIT |
    VK_QUERY_PIPELINE_STATISTIC_VERTEX_SHADER_INVOCATIONS_BIT | VK_QUERY_PIPELINE_STATISTIC_CLIPPING_INVOCATIONS_BIT |
    VK_QUERY_PIPELINE_STATISTIC_CLIPPING_PRIMITIVES_BIT | VK_QUERY_PIPELINE_STATISTIC_FRAGMENT_SHADER_INVOCATIONS_BIT;

}  // namespace

FrameRing::FrameRing(Device& device) : device_(device) {
  VkSemaphoreTypeCreateInfo type{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                 .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
  VkSemaphoreCreateInfo create{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
  NF_VK(vkCreateSemaphore(device.handle, &create, nullptr, &timeline_));
  for (Frame& frame : frames_) {
    VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                 .queueFamilyIndex = device.queue_family};
    NF_VK(vkCreateCommandPool(device.handle, &pool, nullptr, &frame.pool));
    VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = frame.pool,
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
    NF_VK(vkAllocateCommandBuffers(device.handle, &allocate, &frame.commands));
  }
}

FrameRing::~FrameRing() {
  device_.wait_idle();
  for (Frame& frame : frames_) {
    vkDestroyCommandPool(device_.handle, frame.pool, nullptr);
    for (const VkQueryPool pool : {frame.timestamps.pool, frame.statistics.graphics, frame.statistics.compute})
      vkDestroyQueryPool(device_.handle, pool, nullptr);
    destroy(device_, frame.uniforms);
  }
  vkDestroySemaphore(device_.handle, timeline_, nullptr);
}

// Makes room for `count` passes, and forgets what was counted.
void FrameRing::prepare(StatisticsPools& pools, uint32_t count) {
  if (!count || !device_.facts.pipeline_statistics) return;
  if (pools.capacity < count) {
    for (const VkQueryPool pool : {pools.graphics, pools.compute}) vkDestroyQueryPool(device_.handle, pool, nullptr);
    pools.capacity = count * 2;
    VkQueryPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                 .queryType = VK_QUERY_TYPE_PIPELINE_STATISTICS,
                                 .queryCount = pools.capacity,
                                 .pipelineStatistics = graphics_counts};
    NF_VK(vkCreateQueryPool(device_.handle, &create, nullptr, &pools.graphics));
    create.pipelineStatistics = VK_QUERY_PIPELINE_STATISTIC_COMPUTE_SHADER_INVOCATIONS_BIT;
    NF_VK(vkCreateQueryPool(device_.handle, &create, nullptr, &pools.compute));
  }
  for (const VkQueryPool pool : {pools.graphics, pools.compute})
    vkResetQueryPool(device_.handle, pool, 0, pools.capacity);
}

Frame& FrameRing::begin(VkDeviceSize uniform_bytes, uint32_t timestamps, uint32_t statistics) {
  Frame& frame = frames_[next_];
  next_ = (next_ + 1) % size;
  wait(frame);
  if (frame.uniforms.size < uniform_bytes) {
    destroy(device_, frame.uniforms);
    frame.uniforms =
        create_buffer(device_, uniform_bytes * 2, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, Where::Host, "uniforms");
  }
  if (frame.timestamps.capacity < timestamps && device_.facts.timestamp_mask) {
    vkDestroyQueryPool(device_.handle, frame.timestamps.pool, nullptr);
    VkQueryPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                 .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                 .queryCount = timestamps * 2};
    NF_VK(vkCreateQueryPool(device_.handle, &create, nullptr, &frame.timestamps.pool));
    frame.timestamps.capacity = timestamps * 2;
  }
  prepare(frame.statistics, statistics);
  frame.uniforms_used = 0;
  frame.timestamps.used = 0;
  if (frame.timestamps.pool) vkResetQueryPool(device_.handle, frame.timestamps.pool, 0, frame.timestamps.capacity);
  NF_VK(vkResetCommandPool(device_.handle, frame.pool, 0));
  VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                 .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  NF_VK(vkBeginCommandBuffer(frame.commands, &begin));
  return frame;
}

void FrameRing::submit(Frame& frame, TimelinePoint after, TimelinePoint then) {
  NF_VK(vkEndCommandBuffer(frame.commands));
  const auto info = [](TimelinePoint point) {
    return VkSemaphoreSubmitInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                 .semaphore = point.semaphore,
                                 .value = point.value,
                                 .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
  };
  VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                     .commandBuffer = frame.commands};
  const VkSemaphoreSubmitInfo wait = info(after), signals[] = {info({timeline_, submitted_ + 1}), info(then)};
  VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                       .waitSemaphoreInfoCount = after.semaphore ? 1u : 0u,
                       .pWaitSemaphoreInfos = &wait,
                       .commandBufferInfoCount = 1,
                       .pCommandBufferInfos = &commands,
                       .signalSemaphoreInfoCount = then.semaphore ? 2u : 1u,
                       .pSignalSemaphoreInfos = signals};
  NF_VK(device_.submit(submit));
  frame.value = ++submitted_;
}

void FrameRing::wait(const Frame& frame) {
  if (!frame.value) return;
  VkSemaphoreWaitInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                           .semaphoreCount = 1,
                           .pSemaphores = &timeline_,
                           .pValues = &frame.value};
  NF_VK(vkWaitSemaphores(device_.handle, &info, UINT64_MAX));
}

uint64_t FrameRing::finished() const {
  uint64_t value = 0;
  NF_VK(vkGetSemaphoreCounterValue(device_.handle, timeline_, &value));
  return value;
}

VkDeviceSize FrameRing::uniform_stride(VkDeviceSize bytes) const {
  const VkDeviceSize alignment = device_.properties.limits.minUniformBufferOffsetAlignment;
  return (bytes + alignment - 1) / alignment * alignment;
}

UniformRange FrameRing::push_uniform(Frame& frame, std::span<const std::byte> data) {
  const VkDeviceSize offset = frame.uniforms_used;
  NF_CHECK(offset + data.size() <= frame.uniforms.size, "{} + {} > {}", offset, data.size(), frame.uniforms.size);
  std::memcpy(frame.uniforms.mapped + offset, data.data(), data.size());
  frame.uniforms_used = offset + uniform_stride(data.size());
  return {frame.uniforms.handle, offset, data.size()};
}

void write_timestamp(Device& device, Frame& frame, Timing timing) {
  if (!device.facts.timestamp_mask) return;
  vkCmdWriteTimestamp2(frame.commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, frame.timestamps.pool,
                       frame.timestamps.used++);
  if (timing == Timing::Serialize) {
    VkDependencyInfo nothing{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    vkCmdPipelineBarrier2(frame.commands, &nothing);
  }
}

std::vector<double> read_timestamps(Device& device, Frame& frame, double* first) {
  std::vector<uint64_t> ticks(frame.timestamps.used);
  if (ticks.empty()) return {};
  NF_VK(vkGetQueryPoolResults(device.handle, frame.timestamps.pool, 0, frame.timestamps.used, ticks.size() * 8,
                              ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
  const uint64_t mask = device.facts.timestamp_mask;
  std::vector<double> result;
  for (const uint64_t tick : ticks) {
    const uint64_t after = (tick - ticks[0]) & mask, before = (ticks[0] - tick) & mask;
    result.push_back((after <= before ? double(after) : -double(before)) * double(device.facts.timestamp_period));
  }
  if (first) *first = double(ticks[0] & mask) * double(device.facts.timestamp_period);
  return result;
}

void begin_counts(Frame& frame, CountedWork work, uint32_t pass) {
  const VkQueryPool pool = work == CountedWork::Compute ? frame.statistics.compute : frame.statistics.graphics;
  vkCmdBeginQuery(frame.commands, pool, pass, 0);
}

void end_counts(Frame& frame, CountedWork work, uint32_t pass) {
  const VkQueryPool pool = work == CountedWork::Compute ? frame.statistics.compute : frame.statistics.graphics;
  vkCmdEndQuery(frame.commands, pool, pass);
}

PassCounts read_counts(Device& device, const Frame& frame, CountedWork work, uint32_t pass) {
  const bool compute = work == CountedWork::Compute;
  uint64_t values[6] = {};
  NF_VK(vkGetQueryPoolResults(device.handle, compute ? frame.statistics.compute : frame.statistics.graphics, pass, 1,
                              sizeof(values), values, sizeof(values),
                              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
  if (compute) return {.compute_invocations = values[0]};
  return {values[0], values[1], values[2], values[3], values[4], values[5], 0};
}

}  // namespace nf::gpu
