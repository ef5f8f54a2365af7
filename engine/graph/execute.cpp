// Recording of a plan. The only file that emits barriers in a frame.
#include <algorithm>

#include "graph/executor.h"

namespace nf::graph {
namespace {

VkImageMemoryBarrier2 whole_image(const gpu::Image& image) {
  return {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .image = image.handle,
          .subresourceRange = {gpu::aspect_of(image.info.format), 0, VK_REMAINING_MIP_LEVELS, 0,
                               VK_REMAINING_ARRAY_LAYERS}};
}

void emit(VkCommandBuffer commands, std::span<const VkImageMemoryBarrier2> images,
          const VkMemoryBarrier2* memory = nullptr) {
  VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                              .memoryBarrierCount = memory ? 1u : 0u,
                              .pMemoryBarriers = memory,
                              .imageMemoryBarrierCount = uint32_t(images.size()),
                              .pImageMemoryBarriers = images.data()};
  vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace

void Executor::poison(VkCommandBuffer commands) {
  if (poison_.empty())
    for (const gpu::Heap& heap : heaps_) poison_.push_back(gpu::cover(device_, heap));
  VkMemoryBarrier2 before{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                          .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                          .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                          .dstStageMask = VK_PIPELINE_STAGE_2_CLEAR_BIT,
                          .dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT};
  emit(commands, {}, &before);
  for (const gpu::Buffer& buffer : poison_) vkCmdFillBuffer(commands, buffer.handle, 0, VK_WHOLE_SIZE, 0xffffffffu);
  VkMemoryBarrier2 after{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                         .srcStageMask = VK_PIPELINE_STAGE_2_CLEAR_BIT,
                         .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                         .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                         .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
  emit(commands, {}, &after);
}

// Before a plan's first frame: everything earlier is finished, and histories are where the plan expects them. A history
// that was never written is cleared, so that reading it is defined.
void Executor::settle(const Graph& graph, VkCommandBuffer commands) {
  VkMemoryBarrier2 all{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                       .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                       .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                       .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                       .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
  emit(commands, {}, &all);
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    if (row.lifetime != Lifetime::HistoryPrev || history_of_[r] < 0 || !plan_.resources[r].live) continue;
    PhysicalHistory& history = histories_[size_t(history_of_[r])];
    const uint32_t prev = 1 - parity_;
    // What the ring of compile.cpp takes as the state before the first use of prev.
    const VkImageLayout expected =
        plan_.resources[row.pair].live ? plan_.resources[row.pair].last_layout : plan_.resources[r].last_layout;
    VkImageMemoryBarrier2 barrier = whole_image(history.images[prev]);
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    if (history.layouts[prev] == VK_IMAGE_LAYOUT_UNDEFINED) {
      barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
      emit(commands, {&barrier, 1});
      const VkClearColorValue zero{};
      vkCmdClearColorImage(commands, history.images[prev].handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &zero, 1,
                           &barrier.subresourceRange);
      barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    } else {
      barrier.oldLayout = history.layouts[prev];
    }
    barrier.newLayout = expected;
    emit(commands, {&barrier, 1});
  }
}

void Executor::record_barriers(const PlannedPass& planned, VkCommandBuffer commands, const ExecuteOptions& options) {
  std::vector<VkImageMemoryBarrier2> barriers;
  for (uint32_t i = planned.first_barrier; i < planned.first_barrier + planned.barrier_count; ++i) {
    if (options.drop_barrier == int(i)) continue;
    const Barrier& b = plan_.barriers[i];
    VkImageMemoryBarrier2 barrier = whole_image(image(b.resource));
    barrier.srcStageMask = b.src_stages;
    barrier.srcAccessMask = b.src_access;
    barrier.dstStageMask = b.dst_stages;
    barrier.dstAccessMask = b.dst_access;
    barrier.oldLayout = b.old_layout;
    barrier.newLayout = b.new_layout;
    barriers.push_back(barrier);
  }
  if (!barriers.empty()) emit(commands, barriers);
}

gpu::Pipelines::Bound Executor::bind_pipeline(const Graph& graph, const PassRow& pass) {
  if (pass.kind == PassKind::Compute) return pipelines_.get(pass.pipeline.id);
  std::vector<VkFormat> colors(pass.pipeline.interface->color_outputs.size(), VK_FORMAT_UNDEFINED);
  VkFormat depth = VK_FORMAT_UNDEFINED;
  for (uint32_t i = pass.first_use; i < pass.first_use + pass.use_count; ++i) {
    const UseRow& use = graph.uses[i];
    if (use.use == Use::DepthAttachment) depth = graph.resources[use.resource].desc.format;
    if (use.use != Use::ColorAttachment) continue;
    const auto& names = pass.pipeline.interface->color_outputs;
    colors[size_t(std::find(names.begin(), names.end(), use.slot) - names.begin())] =
        graph.resources[use.resource].desc.format;
  }
  return pipelines_.get(pass.pipeline.id, colors, depth);
}

void Executor::push_descriptors(const Graph& graph, const PassRow& pass, const gpu::Pipelines::Bound& bound,
                                VkCommandBuffer commands, std::span<const gpu::UniformRange> uniforms) {
  const auto& slots = pass.pipeline.interface->slots;
  std::vector<VkDescriptorImageInfo> images;
  std::vector<VkDescriptorBufferInfo> buffers;
  std::vector<VkWriteDescriptorSet> writes;
  images.reserve(slots.size());
  buffers.reserve(slots.size());
  const auto write = [&](const gpu::Slot& slot, VkDescriptorType type, const VkDescriptorImageInfo* im,
                         const VkDescriptorBufferInfo* buf) {
    writes.push_back({.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                      .dstBinding = slot.binding,
                      .descriptorCount = 1,
                      .descriptorType = type,
                      .pImageInfo = im,
                      .pBufferInfo = buf});
  };
  for (uint32_t i = pass.first_use; i < pass.first_use + pass.use_count; ++i) {
    const UseRow& use = graph.uses[i];
    if (!use.slot || use.use == Use::ColorAttachment) continue;
    const gpu::Slot& slot = *pass.pipeline.interface->find(use.slot);
    if (use.is_buffer) {
      const gpu::Buffer& buffer = *graph.buffers[use.resource].buffer;
      write(slot, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, nullptr,
            &buffers.emplace_back(VkDescriptorBufferInfo{buffer.handle, 0, VK_WHOLE_SIZE}));
    } else {
      const Access access = access_of(use.use, pass.kind);
      const bool sampled = use.use == Use::SampledImage;
      write(slot, sampled ? VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
            &images.emplace_back(VkDescriptorImageInfo{VK_NULL_HANDLE, image(use.resource).view, access.layout}),
            nullptr);
    }
  }
  const auto write_block = [&](const ParamRow& row, const gpu::UniformRange& range) {
    if (const gpu::Slot* slot = pass.pipeline.interface->find(row.table->prefix))
      write(*slot, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, nullptr,
            &buffers.emplace_back(VkDescriptorBufferInfo{range.buffer, range.offset, range.size}));
  };
  for (uint32_t i = 0; i < pass.param_count; ++i)
    write_block(graph.params[pass.first_param + i], uniforms[pass.first_param + i]);
  for (size_t i = 0; i < graph.shared.size(); ++i) write_block(graph.shared[i], uniforms[graph.params.size() + i]);
  for (const gpu::Slot& slot : slots)
    if (slot.kind == gpu::SlotKind::Sampler) {
      const VkSampler sampler = pipelines_.sampler(slot.name);
      NF_CHECK(sampler, "no sampler is named {}", slot.name);
      write(slot, VK_DESCRIPTOR_TYPE_SAMPLER,
            &images.emplace_back(VkDescriptorImageInfo{sampler, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED}), nullptr);
    }
  if (!writes.empty())
    device_.push_descriptor_set(commands, bound.point, bound.layout, 0, uint32_t(writes.size()), writes.data());
}

void Executor::begin_rendering(const Graph& graph, const PassRow& pass, VkCommandBuffer commands) {
  const auto& names = pass.pipeline.interface->color_outputs;
  std::vector<VkRenderingAttachmentInfo> colors(names.size(), {.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO});
  VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  bool has_depth = false;
  VkExtent2D extent{1, 1};
  for (uint32_t i = pass.first_use; i < pass.first_use + pass.use_count; ++i) {
    const UseRow& use = graph.uses[i];
    if (use.use != Use::ColorAttachment && use.use != Use::DepthAttachment) continue;
    const bool is_depth = use.use == Use::DepthAttachment;
    VkRenderingAttachmentInfo& attachment =
        is_depth ? depth : colors[size_t(std::find(names.begin(), names.end(), use.slot) - names.begin())];
    has_depth |= is_depth;
    const gpu::Image& target = image(use.resource);
    attachment.imageView = target.view;
    attachment.imageLayout = access_of(use.use, pass.kind).layout;
    attachment.loadOp = plan_.uses[i].load;
    attachment.storeOp = plan_.uses[i].store;
    if (is_depth)
      attachment.clearValue.depthStencil = {use.clear.color[0], 0};
    else
      std::copy_n(use.clear.color, 4, attachment.clearValue.color.float32);
    extent = target.info.extent;
  }
  VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                            .renderArea = {{0, 0}, extent},
                            .layerCount = 1,
                            .colorAttachmentCount = uint32_t(colors.size()),
                            .pColorAttachments = colors.data(),
                            .pDepthAttachment = has_depth ? &depth : nullptr};
  vkCmdBeginRendering(commands, &rendering);
  const VkViewport viewport{0, 0, float(extent.width), float(extent.height), 0, 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetScissor(commands, 0, 1, &scissor);
}

void Executor::record_pass(const Graph& graph, const PlannedPass& planned, gpu::Frame& frame,
                           const ExecuteOptions& options, std::span<const gpu::UniformRange> uniforms) {
  const PassRow& pass = graph.passes[planned.pass];
  const VkCommandBuffer commands = frame.commands;
  VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = pass.name};
  device_.begin_label(commands, &label);
  gpu::write_timestamp(device_, frame, options.timing);
  record_barriers(planned, commands, options);

  if (pass.kind == PassKind::Readback) {
    const UseRow& use = graph.uses[pass.first_use];
    size_t number = 0;
    for (uint32_t i = 0; i < planned.pass; ++i) number += graph.passes[i].kind == PassKind::Readback;
    const gpu::Image& source = image(use.resource);
    const VkBufferImageCopy region{.imageSubresource = {gpu::aspect_of(source.info.format), 0, 0, 1},
                                   .imageExtent = {source.info.extent.width, source.info.extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, source.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           readback_buffers_[number].handle, 1, &region);
    VkMemoryBarrier2 to_host{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                             .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                             .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                             .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT | VK_PIPELINE_STAGE_2_COPY_BIT,
                             .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
    emit(commands, {}, &to_host);
  } else {
    const gpu::Pipelines::Bound bound = bind_pipeline(graph, pass);
    if (pass.kind != PassKind::Compute) begin_rendering(graph, pass, commands);
    vkCmdBindPipeline(commands, bound.point, bound.pipeline);
    push_descriptors(graph, pass, bound, commands, uniforms);
    const Recorder recorder{commands, bound.layout};
    if (pass.kind == PassKind::Compute) {
      const Size size = graph.resources[pass.over].desc.size;
      const uint32_t* local = pass.pipeline.interface->local_size;
      vkCmdDispatch(commands, (size.width + local[0] - 1) / local[0], (size.height + local[1] - 1) / local[1], 1);
    } else {
      if (pass.kind == PassKind::Fullscreen) {
        recorder.set_cull(VK_CULL_MODE_NONE, VK_FRONT_FACE_COUNTER_CLOCKWISE);
        vkCmdDraw(commands, 3, 1, 0, 0);
      } else if (pass.draw.invoke) {
        pass.draw.invoke(pass.draw.storage, recorder);
      }
      vkCmdEndRendering(commands);
    }
  }
  gpu::write_timestamp(device_, frame, options.timing);
  device_.end_label(commands);
}

void Recorder::bind_vertex_streams(std::span<const VkBuffer> buffers) const {
  const VkDeviceSize offsets[8] = {};
  vkCmdBindVertexBuffers(commands, 0, uint32_t(buffers.size()), buffers.data(), offsets);
}
void Recorder::bind_indices(VkBuffer buffer) const {
  vkCmdBindIndexBuffer(commands, buffer, 0, VK_INDEX_TYPE_UINT32);
}
void Recorder::bind_set1(VkDescriptorSet set) const {
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 1, 1, &set, 0, nullptr);
}
void Recorder::set_cull(VkCullModeFlags mode, VkFrontFace front) const {
  vkCmdSetCullMode(commands, mode);
  vkCmdSetFrontFace(commands, front);
}
void Recorder::draw_indexed_indirect(VkBuffer buffer, VkDeviceSize offset, uint32_t count) const {
  vkCmdDrawIndexedIndirect(commands, buffer, offset, count, sizeof(VkDrawIndexedIndirectCommand));
}

}  // namespace nf::graph
