// Recording of a plan. The only file that emits barriers in a frame.
#include <algorithm>
#include <cstring>

#include "graph/executor.h"

namespace nf::graph {
namespace {

VkImageMemoryBarrier2 image_barrier(const gpu::Image& image, const Part& part) {
  return {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .image = image.handle,
          .subresourceRange = {gpu::aspect_of(image.info.format), part.mip, part.mips, part.layer, part.layers}};
}

void emit(VkCommandBuffer commands, std::span<const VkImageMemoryBarrier2> images,
          std::span<const VkBufferMemoryBarrier2> buffers, std::span<const VkMemoryBarrier2> memory = {}) {
  const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                    .memoryBarrierCount = uint32_t(memory.size()),
                                    .pMemoryBarriers = memory.data(),
                                    .bufferMemoryBarrierCount = uint32_t(buffers.size()),
                                    .pBufferMemoryBarriers = buffers.data(),
                                    .imageMemoryBarrierCount = uint32_t(images.size()),
                                    .pImageMemoryBarriers = images.data()};
  vkCmdPipelineBarrier2(commands, &dependency);
}

void emit(VkCommandBuffer commands, VkPipelineStageFlags2 src, VkAccessFlags2 src_access, VkPipelineStageFlags2 dst,
          VkAccessFlags2 dst_access) {
  const VkMemoryBarrier2 memory{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                .srcStageMask = src,
                                .srcAccessMask = src_access,
                                .dstStageMask = dst,
                                .dstAccessMask = dst_access};
  emit(commands, {}, {}, {&memory, 1});
}

// Fills belong to the stage CLEAR; validation layer 1.3.239 takes them for copies.
constexpr VkPipelineStageFlags2 all_stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                fill_stages = VK_PIPELINE_STAGE_2_CLEAR_BIT | VK_PIPELINE_STAGE_2_COPY_BIT;
constexpr VkAccessFlags2 any_write = VK_ACCESS_2_MEMORY_WRITE_BIT,
                         any_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

}  // namespace

// Before the pass at `position`.
void Executor::poison(VkCommandBuffer commands, uint32_t position) {
  const RealPlan& real = plans_[current_];
  struct Range {
    SharedHeap* heap;
    uint64_t begin, size;
  };
  std::vector<Range> ranges;
  if (options.poison == Poison::Frame && position == 0)
    for (const size_t heap : real.heaps) ranges.push_back({&heaps_[heap], 0, VK_WHOLE_SIZE});
  if (options.poison == Poison::Handover)
    for (const PlannedResource& planned : real.plan.resources)
      if (planned.live && planned.heap >= 0 && planned.first == position)
        ranges.push_back({&heaps_[real.heaps[size_t(planned.heap)]], planned.offset, planned.bytes / 4 * 4});
  if (ranges.empty()) return;
  emit(commands, all_stages, any_write, fill_stages, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  for (const Range& range : ranges) {
    if (!range.heap->cover.handle) range.heap->cover = gpu::cover(device_, range.heap->heap);
    vkCmdFillBuffer(commands, range.heap->cover.handle, range.begin, range.size, 0xffffffffu);
  }
  emit(commands, fill_stages, VK_ACCESS_2_TRANSFER_WRITE_BIT, all_stages, any_access);
}

// Before a plan's first frame: everything earlier is finished, and histories are where the plan expects them. A history
// that the frame before did not write is cleared, so that reading it is defined.
void Executor::settle(const Graph& graph, VkCommandBuffer commands) {
  const RealPlan& real = plans_[current_];
  if (switched_) emit(commands, all_stages, any_write, all_stages, any_access);
  for (uint16_t r = 0; r < graph.resources.size(); ++r) {
    const ResourceRow& row = graph.resources[r];
    const bool kept = row.lifetime == Lifetime::Kept;
    if ((row.lifetime != Lifetime::HistoryPrev && !kept) || !real.plan.resources[r].live) continue;
    PhysicalHistory& history = *real.histories[r];
    const bool clear = !row.valid || history.written + 1 != runs_;
    if (clear || switched_)
      settle_history(history, kept ? 0 : 1 - parity_, clear, &real.plan.cells[real.plan.resources[r].first_cell],
                     commands);
  }
}

// `expected` by cell: the layouts that the plan's barriers take it from.
void Executor::settle_history(PhysicalHistory& history, uint32_t side, bool clear, const PlannedCell* expected,
                              VkCommandBuffer commands) {
  const gpu::Image& image = history.sides[side].image;
  if (!image.handle) {
    if (!clear) return;
    emit(commands, all_stages, any_write, fill_stages, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    vkCmdFillBuffer(commands, history.sides[side].buffer.handle, 0, VK_WHOLE_SIZE, 0);
    emit(commands, fill_stages, VK_ACCESS_2_TRANSFER_WRITE_BIT, all_stages, any_access);
    return;
  }
  for (uint32_t c = 0; c < history.layouts[side].size(); ++c) {
    if (expected[c].before == VK_IMAGE_LAYOUT_UNDEFINED) continue;  // not read
    const Part part{uint8_t(c % history.desc.mips), 1, uint8_t(c / history.desc.mips), 1};
    VkImageMemoryBarrier2 barrier = image_barrier(image, part);
    barrier.srcStageMask = barrier.dstStageMask = all_stages;
    barrier.srcAccessMask = any_write;
    barrier.dstAccessMask = any_access;
    barrier.oldLayout = history.layouts[side][c];
    if (clear || barrier.oldLayout == VK_IMAGE_LAYOUT_UNDEFINED) {
      barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
      barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
      emit(commands, {&barrier, 1}, {});
      const VkClearColorValue black{};
      const VkClearDepthStencilValue far_away{};
      if (barrier.subresourceRange.aspectMask == VK_IMAGE_ASPECT_DEPTH_BIT)
        vkCmdClearDepthStencilImage(commands, image.handle, barrier.newLayout, &far_away, 1, &barrier.subresourceRange);
      else
        vkCmdClearColorImage(commands, image.handle, barrier.newLayout, &black, 1, &barrier.subresourceRange);
      barrier.oldLayout = barrier.newLayout;
    }
    barrier.newLayout = expected[c].before;
    emit(commands, {&barrier, 1}, {});
  }
}

void Executor::record_barriers(const Graph& graph, const PlannedPass& planned, VkCommandBuffer commands,
                               const ExecuteOptions& execute) {
  std::vector<VkImageMemoryBarrier2> images;
  std::vector<VkBufferMemoryBarrier2> buffers;
  for (uint32_t i = planned.first_barrier; i < planned.first_barrier + planned.barrier_count; ++i) {
    if (execute.drop_barrier == int(i)) continue;
    Barrier b = plans_[current_].plan.barriers[i];
    // In a plan's first frame its memory was another plan's. The barrier of settle() is between them, but the
    // validation layer wants this write in the source scope of the barrier that discards the content.
    if (switched_ && b.old_layout == VK_IMAGE_LAYOUT_UNDEFINED) b.src_stages = all_stages, b.src_access = any_write;
    if (execute.loosen_barrier == int(i)) b.src_stages = VK_PIPELINE_STAGE_2_NONE, b.src_access = 0;
    if (graph.resources[b.resource].is_buffer) {
      buffers.push_back({.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2,
                         .srcStageMask = b.src_stages,
                         .srcAccessMask = b.src_access,
                         .dstStageMask = b.dst_stages,
                         .dstAccessMask = b.dst_access,
                         .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                         .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                         .buffer = buffer(graph, b.resource),
                         .size = VK_WHOLE_SIZE});
      continue;
    }
    VkImageMemoryBarrier2& barrier = images.emplace_back(image_barrier(physical(graph, b.resource).image, b.part));
    barrier.srcStageMask = b.src_stages;
    barrier.srcAccessMask = b.src_access;
    barrier.dstStageMask = b.dst_stages;
    barrier.dstAccessMask = b.dst_access;
    barrier.oldLayout = b.old_layout;
    barrier.newLayout = b.new_layout;
  }
  if (options.merge_barriers) {
    if (!images.empty() || !buffers.empty()) emit(commands, images, buffers);
    return;
  }
  for (const VkImageMemoryBarrier2& barrier : images) emit(commands, {&barrier, 1}, {});
  for (const VkBufferMemoryBarrier2& barrier : buffers) emit(commands, {}, {&barrier, 1});
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
    if (graph.resources[use.resource].is_buffer) {
      write(slot, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, nullptr,
            &buffers.emplace_back(VkDescriptorBufferInfo{buffer(graph, use.resource), 0, VK_WHOLE_SIZE}));
    } else {
      const Access access = access_of(use.use, pass.kind, plans_[current_].plan.layouts);
      const bool sampled = use.use == Use::SampledImage;
      const VkImageViewType type = slot.shape == gpu::SlotShape::Cube    ? VK_IMAGE_VIEW_TYPE_CUBE
                                   : slot.shape == gpu::SlotShape::Array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY
                                                                         : VK_IMAGE_VIEW_TYPE_2D;
      const gpu::Image* lent = graph.resources[use.resource].imported_image;
      const VkImageView seen = lent ? lent->view : view(physical(graph, use.resource), use.part, type);
      const VkImageLayout layout = lent ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL : access.layout;
      write(slot, sampled ? VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
            &images.emplace_back(VkDescriptorImageInfo{VK_NULL_HANDLE, seen, layout}), nullptr);
    }
  }
  const auto write_block = [&](const ParamRow& row, const gpu::UniformRange& range) {
    if (const gpu::Slot* slot = pass.pipeline.interface->find(row.table->prefix))
      write(*slot, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, nullptr,
            &buffers.emplace_back(VkDescriptorBufferInfo{range.buffer, range.offset, range.size}));
  };
  for (uint32_t i = 0; i < pass.param_count; ++i)
    write_block(graph.params[pass.first_param + i], uniforms[pass.first_param + i]);
  // A pass's own block goes before the shared one of the same table.
  const std::span own(graph.params.data() + pass.first_param, pass.param_count);
  for (size_t i = 0; i < graph.shared.size(); ++i)
    if (std::none_of(own.begin(), own.end(), [&](const ParamRow& p) { return p.table == graph.shared[i].table; }))
      write_block(graph.shared[i], uniforms[graph.params.size() + i]);
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

VkExtent2D Executor::begin_rendering(const Graph& graph, const PassRow& pass, VkCommandBuffer commands) {
  const Plan& plan = plans_[current_].plan;
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
    attachment.imageView = view(physical(graph, use.resource), use.part, VK_IMAGE_VIEW_TYPE_2D);
    attachment.imageLayout = access_of(use.use, pass.kind, plan.layouts).layout;
    attachment.loadOp = plan.uses[i].load;
    attachment.storeOp = plan.uses[i].store;
    if (is_depth)
      attachment.clearValue.depthStencil = {use.clear.color[0], 0};
    else
      std::copy_n(use.clear.color, 4, attachment.clearValue.color.float32);
    const Size size = size_of(graph.resources[use.resource].desc, use.part.mip);
    extent = {size.width, size.height};
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
  return extent;
}

void Executor::record_copy(const Graph& graph, const PassRow& pass, VkCommandBuffer commands) {
  const UseRow &from = graph.uses[pass.first_use], &to = graph.uses[pass.first_use + 1];
  if (graph.resources[to.resource].is_buffer) {
    const VkBufferCopy region{.size = graph.resources[to.resource].bytes};
    vkCmdCopyBuffer(commands, buffer(graph, from.resource), buffer(graph, to.resource), 1, &region);
    return;
  }
  const LayoutPolicy layouts = plans_[current_].plan.layouts;
  const gpu::Image &source = physical(graph, from.resource).image, &target = physical(graph, to.resource).image;
  const VkImageAspectFlags aspect = gpu::aspect_of(source.info.format);
  for (uint32_t i = 0; i < from.part.mips; ++i) {
    const Size size = size_of(graph.resources[from.resource].desc, from.part.mip + i);
    const VkImageCopy region{.srcSubresource = {aspect, from.part.mip + i, from.part.layer, from.part.layers},
                             .dstSubresource = {aspect, to.part.mip + i, to.part.layer, to.part.layers},
                             .extent = {size.width, size.height, 1}};
    vkCmdCopyImage(commands, source.handle, access_of(from.use, pass.kind, layouts).layout, target.handle,
                   access_of(to.use, pass.kind, layouts).layout, 1, &region);
  }
}

void Executor::record_readback(const Graph& graph, uint32_t pass, VkCommandBuffer commands) {
  const UseRow& use = graph.uses[graph.passes[pass].first_use];
  size_t number = 0;
  for (uint32_t i = 0; i < pass; ++i) number += graph.passes[i].kind == PassKind::Readback;
  const RealPlan& real = plans_[current_];
  const VkBuffer host = real.readbacks[number].buffer.handle;
  if (graph.resources[use.resource].is_buffer) {
    const VkBufferCopy region{.size = graph.resources[use.resource].bytes};
    vkCmdCopyBuffer(commands, buffer(graph, use.resource), host, 1, &region);
  } else {
    const gpu::Image& source = physical(graph, use.resource).image;
    const PassRow& row = graph.passes[pass];
    const Size size = row.one_texel ? Size{} : size_of(graph.resources[use.resource].desc, use.part.mip);
    const VkBufferImageCopy region{
        .imageSubresource = {gpu::aspect_of(source.info.format), use.part.mip, use.part.layer, 1},
        .imageOffset = {int32_t(row.texel.x), int32_t(row.texel.y), 0},
        .imageExtent = {size.width, size.height, 1}};
    vkCmdCopyImageToBuffer(commands, source.handle, access_of(use.use, PassKind::Readback, real.plan.layouts).layout,
                           host, 1, &region);
  }
  emit(commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
       VK_PIPELINE_STAGE_2_HOST_BIT | VK_PIPELINE_STAGE_2_COPY_BIT,
       VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
}

// The image belongs to nobody while it is written: whoever read it has finished. The barriers order this user's earlier
// copies into it, and, for readers on the same queue, what they read.
void Executor::record_hand_over(const Graph& graph, const PassRow& pass, VkCommandBuffer commands,
                                const ExecuteOptions& execute) {
  const UseRow& use = graph.uses[pass.first_use];
  const gpu::Image& source = physical(graph, use.resource).image;
  VkImageMemoryBarrier2 barrier = image_barrier(*pass.target, {0, 1, 0, 1});
  barrier.srcStageMask = all_stages;
  barrier.srcAccessMask = any_write;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  emit(commands, {&barrier, 1}, {});
  const VkImageAspectFlags aspect = gpu::aspect_of(source.info.format);
  const VkImageCopy region{.srcSubresource = {aspect, use.part.mip, use.part.layer, 1},
                           .dstSubresource = {aspect, 0, 0, 1},
                           .extent = {pass.target->info.extent.width, pass.target->info.extent.height, 1}};
  vkCmdCopyImage(commands, source.handle, access_of(use.use, pass.kind, plans_[current_].plan.layouts).layout,
                 pass.target->handle, barrier.newLayout, 1, &region);
  if (execute.drop_hand_over) return;
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  barrier.dstStageMask = all_stages;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT;
  barrier.oldLayout = barrier.newLayout;
  barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  emit(commands, {&barrier, 1}, {});
}

void Executor::record_pass(const Graph& graph, uint32_t position, gpu::Frame& frame, const ExecuteOptions& execute,
                           std::span<const gpu::UniformRange> uniforms) {
  const PlannedPass& planned = plans_[current_].plan.passes[position];
  const PassRow& pass = graph.passes[planned.pass];
  const VkCommandBuffer commands = frame.commands;
  if (options.poison != Poison::Off) poison(commands, position);
  VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = pass.name};
  device_.begin_label(commands, &label);
  gpu::write_timestamp(device_, frame, execute.timing);
  record_barriers(graph, planned, commands, execute);

  if (pass.kind == PassKind::Readback) {
    record_readback(graph, planned.pass, commands);
  } else if (pass.kind == PassKind::HandOver) {
    record_hand_over(graph, pass, commands, execute);
  } else if (pass.kind == PassKind::Copy) {
    record_copy(graph, pass, commands);
  } else {
    const gpu::Pipelines::Bound bound = bind_pipeline(graph, pass);
    const bool counted = execute.counts && device_.facts.pipeline_statistics;
    if (counted) gpu::begin_counts(frame, counted_work(pass.kind), position);
    const VkExtent2D extent = pass.kind == PassKind::Compute ? VkExtent2D{} : begin_rendering(graph, pass, commands);
    vkCmdBindPipeline(commands, bound.point, bound.pipeline);
    push_descriptors(graph, pass, bound, commands, uniforms);
    const Recorder recorder{commands, bound.layout, this, extent};
    if (pass.kind == PassKind::Compute) {
      dispatch(graph, pass, commands, execute);
    } else {
      if (pass.kind == PassKind::Fullscreen) {
        recorder.set_cull(VK_CULL_MODE_NONE, VK_FRONT_FACE_COUNTER_CLOCKWISE);
        vkCmdDraw(commands, 3, 1, 0, 0);
      } else if (pass.draw.invoke) {
        pass.draw.invoke(pass.draw.storage, recorder);
      }
      vkCmdEndRendering(commands);
    }
    if (counted) gpu::end_counts(frame, counted_work(pass.kind), position);
  }
  gpu::write_timestamp(device_, frame, execute.timing);
  device_.end_label(commands);
}

void Executor::dispatch(const Graph& graph, const PassRow& pass, VkCommandBuffer commands,
                        const ExecuteOptions& execute) {
  const uint32_t* local = pass.pipeline.interface->local_size;
  if (pass.threads) return vkCmdDispatch(commands, (pass.threads + local[0] - 1) / local[0], 1, 1);
  if (!pass.has_over) {
    for (const UseRow& use : graph.uses_of(pass))
      if (use.use == Use::IndirectArguments)
        vkCmdDispatchIndirect(commands, buffer(graph, use.resource), pass.argument_offset);
    return;
  }
  const Size size = size_of(graph.resources[pass.over].desc, pass.over_part.mip);
  const uint32_t groups[3] = {(size.width + local[0] - 1) / local[0], (size.height + local[1] - 1) / local[1],
                              (pass.over_part.layers + local[2] - 1) / local[2]};
  vkCmdDispatch(commands, groups[0], groups[1], groups[2]);
  if (execute.slow_pass && !std::strcmp(execute.slow_pass, pass.name))
    vkCmdDispatch(commands, groups[0], uint32_t(float(groups[1]) * execute.slow_share), groups[2]);
}

VkBuffer Recorder::buffer(Buf of) const {
  NF_CHECK(executor->graph_ && of.valid(), "a draw callback asks for buffer {}", of.id);
  return executor->buffer(*executor->graph_, of.id);
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
void Recorder::set_scissor(int32_t x, int32_t y, uint32_t width, uint32_t height) const {
  const VkRect2D scissor{{x, y}, {width, height}};
  vkCmdSetScissor(commands, 0, 1, &scissor);
}
void Recorder::draw_indexed(uint32_t first_index, uint32_t count) const {
  vkCmdDrawIndexed(commands, count, 1, first_index, 0, 0);
}
void Recorder::draw_indexed_indirect(VkBuffer buffer, VkDeviceSize offset, uint32_t count) const {
  vkCmdDrawIndexedIndirect(commands, buffer, offset, count, sizeof(VkDrawIndexedIndirectCommand));
}
void Recorder::clear_depth(float value) const {
  const VkClearAttachment what{.aspectMask = VK_IMAGE_ASPECT_DEPTH_BIT, .clearValue = {.depthStencil = {value, 0}}};
  const VkClearRect all{{{0, 0}, extent}, 0, 1};
  vkCmdClearAttachments(commands, 1, &what, 1, &all);
}

}  // namespace nf::graph
