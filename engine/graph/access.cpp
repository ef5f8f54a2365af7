// The access table.
#include "graph/access.h"

namespace nf::graph {

namespace {

Access exact_access(Use use, PassKind kind) {
  const VkPipelineStageFlags2 shader =
      kind == PassKind::Compute      ? VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT
      : kind == PassKind::Fullscreen ? VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT
                                     : VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
  constexpr VkAccessFlags2 storage_read = VK_ACCESS_2_SHADER_STORAGE_READ_BIT,
                           storage_write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  constexpr VkImageLayout no_layout = VK_IMAGE_LAYOUT_UNDEFINED;
  switch (use) {
    case Use::SampledImage:
      return {shader,
              VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
              0,
              VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
              VK_IMAGE_USAGE_SAMPLED_BIT,
              "sampled"};
    case Use::StorageImageRead:
      return {shader, storage_read, 0, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_USAGE_STORAGE_BIT, "storage_read"};
    case Use::StorageImageWrite:
      return {shader, 0, storage_write, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_USAGE_STORAGE_BIT, "storage_write"};
    case Use::StorageImageReadWrite:
      return {shader,
              storage_read,
              storage_write,
              VK_IMAGE_LAYOUT_GENERAL,
              VK_IMAGE_USAGE_STORAGE_BIT,
              "storage_read_write"};
    case Use::ColorAttachment:
      return {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
              VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT,
              VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
              VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
              "color"};
    case Use::DepthAttachment:
      return {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
              VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
              VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
              VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
              VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
              "depth"};
    case Use::CopySource:
      return {VK_PIPELINE_STAGE_2_COPY_BIT,         VK_ACCESS_2_TRANSFER_READ_BIT,   0,
              VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_USAGE_TRANSFER_SRC_BIT, "copy_source"};
    case Use::CopyDestination:
      return {VK_PIPELINE_STAGE_2_COPY_BIT,    0,
              VK_ACCESS_2_TRANSFER_WRITE_BIT,  VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
              VK_IMAGE_USAGE_TRANSFER_DST_BIT, "copy_destination"};
    case Use::StorageBufferRead:
      return {shader, storage_read, 0, no_layout, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "buffer_read"};
    case Use::StorageBufferWrite:
      return {shader, 0, storage_write, no_layout, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "buffer_write"};
    case Use::StorageBufferReadWrite:
      return {shader, storage_read, storage_write, no_layout, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "buffer_read_write"};
    case Use::IndirectArguments:
      return {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
              VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT,
              0,
              no_layout,
              VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT,
              "indirect"};
    case Use::Indices:
      return {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT,
              VK_ACCESS_2_INDEX_READ_BIT,
              0,
              no_layout,
              VK_BUFFER_USAGE_INDEX_BUFFER_BIT,
              "indices"};
  }
  return {};
}

}  // namespace

Access access_of(Use use, PassKind kind, LayoutPolicy layouts) {
  Access access = exact_access(use, kind);
  if (layouts == LayoutPolicy::General && access.layout != VK_IMAGE_LAYOUT_UNDEFINED)
    access.layout = VK_IMAGE_LAYOUT_GENERAL;
  return access;
}

const char* kind_name(PassKind kind) {
  switch (kind) {
    case PassKind::Compute:
      return "compute";
    case PassKind::Fullscreen:
      return "fullscreen";
    case PassKind::Raster:
      return "raster";
    case PassKind::Copy:
      return "copy";
    case PassKind::Readback:
      return "readback";
    case PassKind::HandOver:
      return "hand_over";
  }
  return "";
}

}  // namespace nf::graph
