// A window's swapchain, filled from host memory: the user interface is rendered to an image of its own graph, which
// also serves screenshots and runs without a window, and comes here as texels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gpu/memory.h"

namespace nf::gpu {

class Swapchain {
 public:
  // Owns the surface from here on. The device must have been made with window_extensions. Throws nf::Error
  // (Exit::NoDevice) when its queue cannot present to the surface.
  Swapchain(Device& device, VkSurfaceKHR surface);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  // Shows RGBA8 texels, `size` of them, rows tightly packed. Where the surface has another size the picture's top left
  // part is shown. Nothing happens for a surface without pixels (a minimised window). Returns once the copy is done.
  void present(VkExtent2D size, std::span<const std::byte> rgba);

 private:
  void recreate();
  void destroy_swapchain();
  Device& device_;
  VkSurfaceKHR surface_;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  VkExtent2D extent_{};
  bool bgra_ = false;
  std::vector<VkImage> images_;
  std::vector<VkSemaphore> copied_;  // by image
  VkSemaphore acquired_ = VK_NULL_HANDLE;
  VkFence done_ = VK_NULL_HANDLE;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  Buffer staging_;
};

}  // namespace nf::gpu
