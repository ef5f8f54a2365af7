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
enum class WholeView { None, Flat, Array, Cube };  // Cube: six square layers
// `view` covers all mips and layers, or is null.
struct Image {
  VkImage handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  WholeView whole = WholeView::None;  // what kind of view
  ImageInfo info;
  VkDeviceSize bytes = 0;
};
// An image that another user of the VkDevice has filled, in SHADER_READ_ONLY_OPTIMAL, and what to wait for before using
// it.
struct LentImage {
  Image image;
  TimelinePoint written;
};
Image create_image(Device& device, const ImageInfo& info, const std::string& name, WholeView view = WholeView::Flat);
void destroy(Device& device, Image& image);
// A view of some mips and layers. The caller destroys it, before the image, with destroy_view().
VkImageView create_view(Device& device, const Image& image, VkImageViewType type, const VkImageSubresourceRange& range);
void destroy_view(Device& device, VkImageView view);
// The usages that the format can be made with on this device.
VkImageUsageFlags possible_usage(const Device& device, VkFormat format);

// What a resource would ask for, without making one. `dedicated`: it must have memory of its own.
struct MemoryNeeds {
  VkDeviceSize size = 0, alignment = 1;
  uint32_t type_bits = ~0u;
  bool dedicated = false;
};
MemoryNeeds image_needs(const Device& device, const ImageInfo& info);
MemoryNeeds buffer_needs(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage);

// Memory that images and buffers are placed in. They do not own it: destroy them first.
struct Heap {
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize size = 0;
  uint32_t type_bits = 0;
};
Heap create_heap(Device& device, VkDeviceSize size, uint32_t type_bits, const std::string& name);
void destroy(Device& device, Heap& heap);
// A buffer over the whole heap, to fill it. Does not own the memory.
Buffer cover(Device& device, const Heap& heap);
Image place_image(Device& device, const ImageInfo& info, const std::string& name, const Heap& heap,
                  VkDeviceSize offset);
Buffer place_buffer(Device& device, VkDeviceSize size, VkBufferUsageFlags usage, const std::string& name,
                    const Heap& heap, VkDeviceSize offset);

VkImageAspectFlags aspect_of(VkFormat format);
// Bytes of a texel; 0 for formats this engine does not use.
uint32_t texel_bytes(VkFormat format);
const char* format_name(VkFormat format);

}  // namespace nf::gpu
