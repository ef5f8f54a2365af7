// Staging copies. The barriers here and the empty one after timestamps are the only ones outside graph/execute.
#include "gpu/upload.h"

#include <algorithm>
#include <cstring>
#include <functional>

namespace nf::gpu {
namespace {

VkResult run_now(Device& device, const std::function<void(VkCommandBuffer)>& record, TimelinePoint after = {}) {
  VkCommandPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                 .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                 .queueFamilyIndex = device.queue_family};
  VkCommandPool pool = VK_NULL_HANDLE;
  NF_VK(vkCreateCommandPool(device.handle, &create, nullptr, &pool));
  VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                       .commandPool = pool,
                                       .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                       .commandBufferCount = 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  NF_VK(vkAllocateCommandBuffers(device.handle, &allocate, &commands));
  VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                 .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  NF_VK(vkBeginCommandBuffer(commands, &begin));
  record(commands);
  NF_VK(vkEndCommandBuffer(commands));
  VkCommandBufferSubmitInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, .commandBuffer = commands};
  const VkSemaphoreSubmitInfo wait{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                   .semaphore = after.semaphore,
                                   .value = after.value,
                                   .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
  VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                       .waitSemaphoreInfoCount = after.semaphore ? 1u : 0u,
                       .pWaitSemaphoreInfos = &wait,
                       .commandBufferInfoCount = 1,
                       .pCommandBufferInfos = &info};
  const VkResult submitted = device.submit(submit);
  device.wait_idle();
  vkDestroyCommandPool(device.handle, pool, nullptr);
  return submitted;
}

Buffer stage(Device& device, VkDeviceSize size, const std::string& name) {
  return create_buffer(device, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Where::Host, name + " (staging)");
}

void image_barrier(VkCommandBuffer commands, const Image& image, VkImageLayout from, VkImageLayout to,
                   VkPipelineStageFlags2 src, VkAccessFlags2 src_access, VkPipelineStageFlags2 dst,
                   VkAccessFlags2 dst_access) {
  VkImageMemoryBarrier2 barrier{
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
      .srcStageMask = src,
      .srcAccessMask = src_access,
      .dstStageMask = dst,
      .dstAccessMask = dst_access,
      .oldLayout = from,
      .newLayout = to,
      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .image = image.handle,
      .subresourceRange = {aspect_of(image.info.format), 0, image.info.mips, 0, image.info.layers}};
  VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace

Buffer upload_buffer(Device& device, std::span<const std::byte> data, VkBufferUsageFlags usage,
                     const std::string& name) {
  const VkDeviceSize size = std::max<VkDeviceSize>(data.size(), 16);
  Buffer staging = stage(device, size, name);
  std::memset(staging.mapped, 0, 16);
  if (!data.empty()) std::memcpy(staging.mapped, data.data(), data.size());
  Buffer buffer = create_buffer(device, size, usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, Where::Device, name);
  const VkResult done = run_now(device, [&](VkCommandBuffer commands) {
    const VkBufferCopy region{.size = size};
    vkCmdCopyBuffer(commands, staging.handle, buffer.handle, 1, &region);
    VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                             .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                             .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                             .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                             .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT};
    VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
  });
  destroy(device, staging);
  if (done != VK_SUCCESS) destroy(device, buffer);
  check(done, "vkQueueSubmit2", __FILE__, __LINE__);
  return buffer;
}

Image upload_image(Device& device, ImageInfo info, std::span<const ImagePart> parts, const std::string& name,
                   WholeView view) {
  info.usage |= VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  Image image = create_image(device, info, name, view);
  VkDeviceSize total = 0;
  for (const ImagePart& part : parts) total += part.texels.size();
  Buffer staging = stage(device, total, name);
  std::vector<VkBufferImageCopy> regions;
  VkDeviceSize offset = 0;
  for (const ImagePart& part : parts) {
    std::memcpy(staging.mapped + offset, part.texels.data(), part.texels.size());
    regions.push_back({.bufferOffset = offset,
                       .imageSubresource = {aspect_of(info.format), part.mip, part.layer, 1},
                       .imageExtent = {std::max(info.extent.width >> part.mip, 1u),
                                       std::max(info.extent.height >> part.mip, 1u), 1}});
    offset += part.texels.size();
  }
  const VkResult done = run_now(device, [&](VkCommandBuffer commands) {
    image_barrier(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_PIPELINE_STAGE_2_NONE, 0, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    vkCmdCopyBufferToImage(commands, staging.handle, image.handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                           uint32_t(regions.size()), regions.data());
    image_barrier(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                  VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                  VK_ACCESS_2_SHADER_READ_BIT);
  });
  destroy(device, staging);
  if (done != VK_SUCCESS) destroy(device, image);
  check(done, "vkQueueSubmit2", __FILE__, __LINE__);
  return image;
}

std::vector<std::byte> download_image(Device& device, const LentImage& lent) {
  const Image& image = lent.image;
  const VkExtent2D& extent = image.info.extent;
  std::vector<std::byte> texels(size_t(extent.width) * extent.height * texel_bytes(image.info.format));
  Buffer staging =
      create_buffer(device, texels.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, Where::Host, "download (staging)");
  const auto record = [&](VkCommandBuffer commands) {
    image_barrier(commands, image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                  VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT, VK_PIPELINE_STAGE_2_COPY_BIT,
                  VK_ACCESS_2_TRANSFER_READ_BIT);
    const VkBufferImageCopy region{.imageSubresource = {aspect_of(image.info.format), 0, 0, 1},
                                   .imageExtent = {extent.width, extent.height, 1}};
    vkCmdCopyImageToBuffer(commands, image.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.handle, 1, &region);
    image_barrier(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                  VK_PIPELINE_STAGE_2_COPY_BIT, 0, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT);
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT,
                                   .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                   .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
  };
  const VkResult done = run_now(device, record, lent.written);
  if (done == VK_SUCCESS) std::memcpy(texels.data(), staging.mapped, texels.size());
  destroy(device, staging);
  check(done, "vkQueueSubmit2", __FILE__, __LINE__);
  return texels;
}

}  // namespace nf::gpu
