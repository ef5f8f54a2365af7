// Staging copies from the CPU to buffers and images, and back, finished when the call returns. For loading, not for
// frames.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gpu/memory.h"

namespace nf::gpu {

// A device buffer with these bytes. An empty span gives a buffer of 16 zero bytes, so that it can be bound.
Buffer upload_buffer(Device& device, std::span<const std::byte> data, VkBufferUsageFlags usage,
                     const std::string& name);

template <class T>
Buffer upload_table(Device& device, const std::vector<T>& rows, VkBufferUsageFlags usage, const std::string& name) {
  return upload_buffer(device, std::as_bytes(std::span(rows)), usage, name);
}

// Texels of one mip of one layer, tightly packed.
struct ImagePart {
  uint32_t mip = 0, layer = 0;
  std::span<const std::byte> texels;
};
// Fills the whole image and leaves it in SHADER_READ_ONLY_OPTIMAL. info.usage gets SAMPLED and TRANSFER_DST added.
Image upload_image(Device& device, ImageInfo info, std::span<const ImagePart> parts, const std::string& name,
                   WholeView view);

// The first mip and layer, rows tightly packed; the image stays in SHADER_READ_ONLY_OPTIMAL.
std::vector<std::byte> download_image(Device& device, const LentImage& lent);

}  // namespace nf::gpu
