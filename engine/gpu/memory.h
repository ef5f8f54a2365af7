// Buffers and images with memory of their own, and their destruction. Owners are plain structs; destroy() is called by
// whoever owns the table they stand in.
#pragma once

#include <cstddef>
#include <string>

#include "gpu/device.h"

namespace nf::gpu {

enum class Where { Device, Host };  // Host: mapped, coherent, cached when it can be

struct Buffer {
  VkBuffer handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize size = 0;
  std::byte* mapped = nullptr;
};
Buffer create_buffer(Device& device, VkDeviceSize size, VkBufferUsageFlags usage, Where where, const std::string& name);
void destroy(Device& device, Buffer& buffer);

struct ImageInfo {
  VkExtent2D extent{1, 1};
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint32_t mips = 1, layers = 1;
  VkImageUsageFlags usage = 0;
};
// `view` covers all mips and layers: 2D, or 2D array when `array`.
struct Image {
  VkImage handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  ImageInfo info;
  VkDeviceSize bytes = 0;
};
Image create_image(Device& device, const ImageInfo& info, const std::string& name, bool array = false);
void destroy(Device& device, Image& image);

VkImageAspectFlags aspect_of(VkFormat format);
// Bytes of a texel; 0 for formats this engine does not use.
uint32_t texel_bytes(VkFormat format);
const char* format_name(VkFormat format);

}  // namespace nf::gpu
