// Allocation: one VkDeviceMemory a resource.
#include "gpu/memory.h"

#include <array>

namespace nf::gpu {
namespace {

uint32_t find_memory_type(const Device& device, uint32_t bits, VkMemoryPropertyFlags required,
                          VkMemoryPropertyFlags preferred) {
  uint32_t fallback = ~0u;
  for (uint32_t i = 0; i < device.memory.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = device.memory.memoryTypes[i].propertyFlags;
    if (!(bits & (1u << i)) || (flags & required) != required) continue;
    if ((flags & preferred) == preferred) return i;
    if (fallback == ~0u) fallback = i;
  }
  NF_CHECK(fallback != ~0u, "no memory type in bits {:#x} with flags {:#x}", bits, required);
  return fallback;
}

VkDeviceMemory allocate(Device& device, const VkMemoryRequirements& needs, Where where, const std::string& name) {
  const bool host = where == Where::Host;
  const VkMemoryPropertyFlags required =
      host ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT : VkMemoryPropertyFlags(0);
  const VkMemoryPropertyFlags preferred =
      host ? required | VK_MEMORY_PROPERTY_HOST_CACHED_BIT : VkMemoryPropertyFlags(VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  VkMemoryAllocateInfo allocate_info{
      .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
      .allocationSize = needs.size,
      .memoryTypeIndex = find_memory_type(device, needs.memoryTypeBits, required, preferred)};
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const Doing doing(fmt::format("allocating {:.1f} MiB for {}", double(needs.size) / 1048576.0, name));
  NF_VK(vkAllocateMemory(device.handle, &allocate_info, nullptr, &memory));
  ++device.counts.allocations;
  return memory;
}

void release(Device& device, VkDeviceMemory memory) {
  if (!memory) return;
  vkFreeMemory(device.handle, memory, nullptr);
  --device.counts.allocations;
}

struct FormatRow {
  VkFormat format;
  uint32_t bytes;
  const char* name;
};
constexpr std::array format_rows = {
    FormatRow{VK_FORMAT_R8_UNORM, 1, "R8_UNORM"},
    FormatRow{VK_FORMAT_R8G8_UNORM, 2, "R8G8_UNORM"},
    FormatRow{VK_FORMAT_R8G8B8A8_UNORM, 4, "R8G8B8A8_UNORM"},
    FormatRow{VK_FORMAT_R8G8B8A8_SRGB, 4, "R8G8B8A8_SRGB"},
    FormatRow{VK_FORMAT_A2B10G10R10_UNORM_PACK32, 4, "A2B10G10R10_UNORM"},
    FormatRow{VK_FORMAT_B10G11R11_UFLOAT_PACK32, 4, "B10G11R11_UFLOAT"},
    FormatRow{VK_FORMAT_R16_SFLOAT, 2, "R16_SFLOAT"},
    FormatRow{VK_FORMAT_R16G16_SFLOAT, 4, "R16G16_SFLOAT"},
    FormatRow{VK_FORMAT_R16G16B16A16_SFLOAT, 8, "R16G16B16A16_SFLOAT"},
    FormatRow{VK_FORMAT_R16G16B16A16_UNORM, 8, "R16G16B16A16_UNORM"},
    FormatRow{VK_FORMAT_R32_UINT, 4, "R32_UINT"},
    FormatRow{VK_FORMAT_R32_SFLOAT, 4, "R32_SFLOAT"},
    FormatRow{VK_FORMAT_R32G32_SFLOAT, 8, "R32G32_SFLOAT"},
    FormatRow{VK_FORMAT_R32G32B32A32_SFLOAT, 16, "R32G32B32A32_SFLOAT"},
    FormatRow{VK_FORMAT_D32_SFLOAT, 4, "D32_SFLOAT"},
    FormatRow{VK_FORMAT_D16_UNORM, 2, "D16_UNORM"},
};

const FormatRow* find_row(VkFormat format) {
  for (const FormatRow& row : format_rows)
    if (row.format == format) return &row;
  return nullptr;
}

VkBufferCreateInfo create_info(VkDeviceSize size, VkBufferUsageFlags usage) {
  return {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
}

// The buffer without memory.
void begin_buffer(Device& device, Buffer& buffer, VkDeviceSize size, VkBufferUsageFlags usage,
                  VkMemoryRequirements& needs) {
  const VkBufferCreateInfo create = create_info(size, usage);
  NF_VK(vkCreateBuffer(device.handle, &create, nullptr, &buffer.handle));
  ++device.counts.buffers;
  vkGetBufferMemoryRequirements(device.handle, buffer.handle, &needs);
}

}  // namespace

Buffer create_buffer(Device& device, VkDeviceSize size, VkBufferUsageFlags usage, Where where,
                     const std::string& name) {
  Buffer buffer{.size = size};
  VkMemoryRequirements needs;
  begin_buffer(device, buffer, size, usage, needs);
  buffer.memory = allocate(device, needs, where, name);
  NF_VK(vkBindBufferMemory(device.handle, buffer.handle, buffer.memory, 0));
  if (where == Where::Host) {
    void* mapped = nullptr;
    NF_VK(vkMapMemory(device.handle, buffer.memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    buffer.mapped = static_cast<std::byte*>(mapped);
  }
  device.name_object(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer.handle), name);
  return buffer;
}

Buffer place_buffer(Device& device, VkDeviceSize size, VkBufferUsageFlags usage, const std::string& name,
                    const Heap& heap, VkDeviceSize offset) {
  Buffer buffer{.size = size};
  VkMemoryRequirements needs;
  begin_buffer(device, buffer, size, usage, needs);
  NF_CHECK(offset % needs.alignment == 0 && offset + needs.size <= heap.size, "{} at {} of {}", name, offset,
           heap.size);
  NF_VK(vkBindBufferMemory(device.handle, buffer.handle, heap.memory, offset));
  device.name_object(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer.handle), name);
  return buffer;
}

void destroy(Device& device, Buffer& buffer) {
  if (!buffer.handle) return;
  vkDestroyBuffer(device.handle, buffer.handle, nullptr);
  --device.counts.buffers;
  release(device, buffer.memory);
  buffer = {};
}

namespace {

VkImageCreateInfo create_info(const ImageInfo& info) {
  const bool cube = info.layers == 6 && info.extent.width == info.extent.height;
  return {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
          .flags = VkImageCreateFlags(cube ? VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT : 0),
          .imageType = VK_IMAGE_TYPE_2D,
          .format = info.format,
          .extent = {info.extent.width, info.extent.height, 1},
          .mipLevels = info.mips,
          .arrayLayers = info.layers,
          .samples = VK_SAMPLE_COUNT_1_BIT,
          .tiling = VK_IMAGE_TILING_OPTIMAL,
          .usage = info.usage};
}

// The image without memory and view.
Image begin_image(Device& device, const ImageInfo& info, const std::string& name, VkMemoryRequirements& needs) {
  if (info.extent.width > device.facts.max_image_size || info.extent.height > device.facts.max_image_size)
    fail(Exit::Gpu, "cannot make the image '{}' of {}x{}: {} takes {} pixels a side at most; use a smaller --size",
         name, info.extent.width, info.extent.height, device.info.name, device.facts.max_image_size);
  Image image{.info = info};
  const VkImageCreateInfo create = create_info(info);
  NF_VK(vkCreateImage(device.handle, &create, nullptr, &image.handle));
  ++device.counts.images;
  vkGetImageMemoryRequirements(device.handle, image.handle, &needs);
  image.bytes = needs.size;
  return image;
}

}  // namespace

VkImageView create_view(Device& device, const Image& image, VkImageViewType type,
                        const VkImageSubresourceRange& range) {
  VkImageViewCreateInfo create{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                               .image = image.handle,
                               .viewType = type,
                               .format = image.info.format,
                               .subresourceRange = range};
  VkImageView view = VK_NULL_HANDLE;
  NF_VK(vkCreateImageView(device.handle, &create, nullptr, &view));
  ++device.counts.views;
  return view;
}

void destroy_view(Device& device, VkImageView view) {
  if (!view) return;
  vkDestroyImageView(device.handle, view, nullptr);
  --device.counts.views;
}

Image create_image(Device& device, const ImageInfo& info, const std::string& name, WholeView view) {
  VkMemoryRequirements needs;
  Image image = begin_image(device, info, name, needs);
  image.memory = allocate(device, needs, Where::Device, name);
  NF_VK(vkBindImageMemory(device.handle, image.handle, image.memory, 0));
  device.name_object(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image.handle), name);
  constexpr VkImageViewType types[] = {VK_IMAGE_VIEW_TYPE_2D, VK_IMAGE_VIEW_TYPE_2D, VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                       VK_IMAGE_VIEW_TYPE_CUBE};
  if (view != WholeView::None)
    image.view =
        create_view(device, image, types[size_t(view)], {aspect_of(info.format), 0, info.mips, 0, info.layers});
  image.whole = view;
  return image;
}

Image place_image(Device& device, const ImageInfo& info, const std::string& name, const Heap& heap,
                  VkDeviceSize offset) {
  VkMemoryRequirements needs;
  Image image = begin_image(device, info, name, needs);
  NF_CHECK(offset % needs.alignment == 0 && offset + needs.size <= heap.size, "{} at {} of {}", name, offset,
           heap.size);
  NF_VK(vkBindImageMemory(device.handle, image.handle, heap.memory, offset));
  device.name_object(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image.handle), name);
  return image;
}

VkImageUsageFlags possible_usage(const Device& device, VkFormat format) {
  VkFormatProperties properties;
  vkGetPhysicalDeviceFormatProperties(device.physical, format, &properties);
  static const std::pair<VkFormatFeatureFlags, VkImageUsageFlags> table[] = {
      {VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT, VK_IMAGE_USAGE_SAMPLED_BIT},
      {VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT, VK_IMAGE_USAGE_STORAGE_BIT},
      {VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT},
      {VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT},
      {VK_FORMAT_FEATURE_TRANSFER_SRC_BIT, VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
      {VK_FORMAT_FEATURE_TRANSFER_DST_BIT, VK_IMAGE_USAGE_TRANSFER_DST_BIT}};
  VkImageUsageFlags usage = 0;
  for (const auto& [feature, allowed] : table)
    if (properties.optimalTilingFeatures & feature) usage |= allowed;
  return usage;
}

MemoryNeeds image_needs(const Device& device, const ImageInfo& info) {
  const VkImageCreateInfo create = create_info(info);
  VkDeviceImageMemoryRequirements query{.sType = VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS,
                                        .pCreateInfo = &create};
  VkMemoryDedicatedRequirements dedicated{.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_REQUIREMENTS};
  VkMemoryRequirements2 needs{.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2, .pNext = &dedicated};
  vkGetDeviceImageMemoryRequirements(device.handle, &query, &needs);
  const VkMemoryRequirements& plain = needs.memoryRequirements;
  return {plain.size, plain.alignment, plain.memoryTypeBits, dedicated.requiresDedicatedAllocation == VK_TRUE};
}

MemoryNeeds buffer_needs(const Device& device, VkDeviceSize size, VkBufferUsageFlags usage) {
  const VkBufferCreateInfo create = create_info(size, usage);
  VkDeviceBufferMemoryRequirements query{.sType = VK_STRUCTURE_TYPE_DEVICE_BUFFER_MEMORY_REQUIREMENTS,
                                         .pCreateInfo = &create};
  VkMemoryDedicatedRequirements dedicated{.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_REQUIREMENTS};
  VkMemoryRequirements2 needs{.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2, .pNext = &dedicated};
  vkGetDeviceBufferMemoryRequirements(device.handle, &query, &needs);
  const VkMemoryRequirements& plain = needs.memoryRequirements;
  return {plain.size, plain.alignment, plain.memoryTypeBits, dedicated.requiresDedicatedAllocation == VK_TRUE};
}

Heap create_heap(Device& device, VkDeviceSize size, uint32_t type_bits, const std::string& name) {
  const VkMemoryRequirements needs{.size = size, .alignment = 1, .memoryTypeBits = type_bits};
  return {allocate(device, needs, Where::Device, name), size, type_bits};
}

Buffer cover(Device& device, const Heap& heap) {
  Buffer buffer{.size = heap.size / 4 * 4};
  VkMemoryRequirements needs;
  begin_buffer(device, buffer, buffer.size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, needs);
  if (!(needs.memoryTypeBits & heap.type_bits) || needs.size > heap.size)
    fail(Exit::Gpu, "cannot poison: {} keeps buffers and images in different memory", device.info.name);
  NF_VK(vkBindBufferMemory(device.handle, buffer.handle, heap.memory, 0));
  return buffer;
}

void destroy(Device& device, Heap& heap) {
  release(device, heap.memory);
  heap = {};
}

void destroy(Device& device, Image& image) {
  if (!image.handle) return;
  destroy_view(device, image.view);
  vkDestroyImage(device.handle, image.handle, nullptr);
  --device.counts.images;
  release(device, image.memory);
  image = {};
}

VkImageAspectFlags aspect_of(VkFormat format) {
  return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                                         : VK_IMAGE_ASPECT_COLOR_BIT;
}

uint32_t texel_bytes(VkFormat format) {
  const FormatRow* row = find_row(format);
  return row ? row->bytes : 0;
}

const char* format_name(VkFormat format) {
  const FormatRow* row = find_row(format);
  return row ? row->name : "UNKNOWN";
}

}  // namespace nf::gpu
