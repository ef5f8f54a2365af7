// Acquire, copy, present: one picture at a time. The two barriers here belong to the presentation engine, which no
// graph knows.
#include "gpu/swapchain.h"

#include <algorithm>
#include <cstring>

namespace nf::gpu {
namespace {

void image_barrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                   VkPipelineStageFlags2 src, VkAccessFlags2 src_access, VkPipelineStageFlags2 dst,
                   VkAccessFlags2 dst_access) {
  VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                .srcStageMask = src,
                                .srcAccessMask = src_access,
                                .dstStageMask = dst,
                                .dstAccessMask = dst_access,
                                .oldLayout = from,
                                .newLayout = to,
                                .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                .image = image,
                                .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands, &dependency);
}

VkFence create_fence(VkDevice device) {
  VkFenceCreateInfo create{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VkFence fence = VK_NULL_HANDLE;
  NF_VK(vkCreateFence(device, &create, nullptr, &fence));
  return fence;
}

VkSemaphore create_semaphore(VkDevice device) {
  VkSemaphoreCreateInfo create{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  NF_VK(vkCreateSemaphore(device, &create, nullptr, &semaphore));
  return semaphore;
}

void wait(VkDevice device, VkFence fence) {
  NF_VK(vkWaitForFences(device, 1, &fence, VK_TRUE, ~uint64_t{0}));
  NF_VK(vkResetFences(device, 1, &fence));
}

}  // namespace

Swapchain::Swapchain(Device& device, VkSurfaceKHR surface) : device_(device), surface_(surface) {
  VkBool32 supported = VK_FALSE;
  NF_VK(vkGetPhysicalDeviceSurfaceSupportKHR(device.physical, device.queue_family, surface, &supported));
  if (!supported) {
    vkDestroySurfaceKHR(device.instance, surface, nullptr);
    fail(Exit::NoDevice, "{} cannot show pictures in this window; choose another with --device, e.g. --device cpu",
         device.info.name);
  }
  acquired_ = create_semaphore(device.handle);
  done_ = create_fence(device.handle);
  VkCommandPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                 .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                 .queueFamilyIndex = device.queue_family};
  NF_VK(vkCreateCommandPool(device.handle, &create, nullptr, &pool_));
  VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                       .commandPool = pool_,
                                       .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                       .commandBufferCount = 1};
  NF_VK(vkAllocateCommandBuffers(device.handle, &allocate, &commands_));
}

Swapchain::~Swapchain() {
  device_.wait_idle();
  destroy_swapchain();
  gpu::destroy(device_, staging_);
  vkDestroyCommandPool(device_.handle, pool_, nullptr);
  vkDestroySemaphore(device_.handle, acquired_, nullptr);
  vkDestroyFence(device_.handle, done_, nullptr);
  vkDestroySurfaceKHR(device_.instance, surface_, nullptr);
}

void Swapchain::destroy_swapchain() {
  for (VkSemaphore semaphore : copied_) vkDestroySemaphore(device_.handle, semaphore, nullptr);
  copied_.clear();
  images_.clear();
  if (swapchain_) vkDestroySwapchainKHR(device_.handle, swapchain_, nullptr);
  swapchain_ = VK_NULL_HANDLE;
}

void Swapchain::recreate() {
  device_.wait_idle();
  destroy_swapchain();
  VkSurfaceCapabilitiesKHR can{};
  NF_VK(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical, surface_, &can));
  extent_ = can.currentExtent;
  if (extent_.width == 0 || extent_.height == 0) return;
  uint32_t count = 0;
  NF_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical, surface_, &count, nullptr));
  std::vector<VkSurfaceFormatKHR> formats(count);
  NF_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical, surface_, &count, formats.data()));
  const auto find = [&](VkFormat wanted) {
    return std::find_if(formats.begin(), formats.end(), [&](const auto& f) { return f.format == wanted; });
  };
  auto format = find(VK_FORMAT_R8G8B8A8_UNORM);
  bgra_ = format == formats.end();
  if (bgra_) format = find(VK_FORMAT_B8G8R8A8_UNORM);
  if (format == formats.end())
    fail(Exit::NoDevice, "{} shows no 8-bit RGBA in this window; choose another with --device", device_.info.name);
  const uint32_t images = std::max(can.minImageCount, 2u);
  VkSwapchainCreateInfoKHR create{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                  .surface = surface_,
                                  .minImageCount = can.maxImageCount ? std::min(images, can.maxImageCount) : images,
                                  .imageFormat = format->format,
                                  .imageColorSpace = format->colorSpace,
                                  .imageExtent = extent_,
                                  .imageArrayLayers = 1,
                                  .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                  .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                  .preTransform = can.currentTransform,
                                  .compositeAlpha = can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                                                        ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                                                        : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
                                  .presentMode = VK_PRESENT_MODE_FIFO_KHR,
                                  .clipped = VK_TRUE};
  NF_VK(vkCreateSwapchainKHR(device_.handle, &create, nullptr, &swapchain_));
  NF_VK(vkGetSwapchainImagesKHR(device_.handle, swapchain_, &count, nullptr));
  images_.resize(count);
  NF_VK(vkGetSwapchainImagesKHR(device_.handle, swapchain_, &count, images_.data()));
  for (uint32_t i = 0; i < count; ++i) copied_.push_back(create_semaphore(device_.handle));
  const VkDeviceSize bytes = VkDeviceSize(extent_.width) * extent_.height * 4;
  if (staging_.size < bytes) {
    gpu::destroy(device_, staging_);
    staging_ = create_buffer(device_, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Where::Host, "swapchain.staging");
  }
}

void Swapchain::present(VkExtent2D size, std::span<const std::byte> rgba) {
  uint32_t index = 0;
  for (int attempt = 0;; ++attempt) {
    if (!swapchain_) recreate();
    if (!swapchain_) return;
    const VkResult got =
        vkAcquireNextImageKHR(device_.handle, swapchain_, ~uint64_t{0}, acquired_, VK_NULL_HANDLE, &index);
    if (got == VK_SUCCESS || got == VK_SUBOPTIMAL_KHR) break;
    if (got != VK_ERROR_OUT_OF_DATE_KHR || attempt == 3) NF_VK(got);
    destroy_swapchain();
  }
  // Grey where the surface is larger than the picture: only for the moment until the picture follows a resize.
  const uint32_t width = std::min(size.width, extent_.width), height = std::min(size.height, extent_.height);
  if (width < extent_.width || height < extent_.height)
    std::memset(staging_.mapped, 0x20, size_t(extent_.width) * extent_.height * 4);
  for (uint32_t y = 0; y < height; ++y) {
    const std::byte* from = rgba.data() + size_t(y) * size.width * 4;
    std::byte* to = staging_.mapped + size_t(y) * extent_.width * 4;
    if (!bgra_) {
      std::memcpy(to, from, size_t(width) * 4);
      continue;
    }
    for (uint32_t x = 0; x < width; ++x) {
      uint32_t texel;
      std::memcpy(&texel, from + size_t(x) * 4, 4);
      texel = (texel & 0xff00ff00u) | ((texel & 0xffu) << 16) | ((texel >> 16) & 0xffu);
      std::memcpy(to + size_t(x) * 4, &texel, 4);
    }
  }
  VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                 .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  NF_VK(vkBeginCommandBuffer(commands_, &begin));
  image_barrier(commands_, images_[index], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                VK_PIPELINE_STAGE_2_COPY_BIT, 0, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {extent_.width, extent_.height, 1}};
  vkCmdCopyBufferToImage(commands_, staging_.handle, images_[index], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
  image_barrier(commands_, images_[index], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0);
  NF_VK(vkEndCommandBuffer(commands_));
  VkCommandBufferSubmitInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, .commandBuffer = commands_};
  VkSemaphoreSubmitInfo signal{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                               .semaphore = copied_[index],
                               .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
  // The device waits for the image, not the host: when the host waited for a fence here while another thread submitted
  // to the queue, validation layer 1.3.239 now and then reported a write after present.
  VkSemaphoreSubmitInfo ready{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                              .semaphore = acquired_,
                              .stageMask = VK_PIPELINE_STAGE_2_COPY_BIT};
  VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                       .waitSemaphoreInfoCount = 1,
                       .pWaitSemaphoreInfos = &ready,
                       .commandBufferInfoCount = 1,
                       .pCommandBufferInfos = &info,
                       .signalSemaphoreInfoCount = 1,
                       .pSignalSemaphoreInfos = &signal};
  if (const VkResult submitted = device_.submit(submit, done_); submitted != VK_SUCCESS) {
    // The acquire is still going to signal its semaphore, and nobody waits for that any more: to destroy it in that
    // state is an error, in which validation layer 1.3.239 crashes. A device that is really lost refuses this, too, and
    // may.
    const VkSubmitInfo2 nothing{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .waitSemaphoreInfoCount = 1, .pWaitSemaphoreInfos = &ready};
    device_.submit_although_lost(nothing);
    check(submitted, "vkQueueSubmit2", __FILE__, __LINE__);
  }
  VkPresentInfoKHR present{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                           .waitSemaphoreCount = 1,
                           .pWaitSemaphores = &copied_[index],
                           .swapchainCount = 1,
                           .pSwapchains = &swapchain_,
                           .pImageIndices = &index};
  const VkResult shown = device_.present(present);
  wait(device_.handle, done_);
  if (shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR)
    device_.wait_idle(), destroy_swapchain();
  else
    NF_VK(shown);
}

}  // namespace nf::gpu
