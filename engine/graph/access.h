// One table: what a kind of use means to Vulkan. Everything else about a use is derived from its row.
#pragma once

#include <cstdint>

#include "gpu/shader.h"

namespace nf::graph {

enum class Use : uint8_t {
  SampledImage,       // texelFetch / texture in a shader
  StorageImageRead,   // imageLoad
  StorageImageWrite,  // imageStore
  StorageImageReadWrite,
  ColorAttachment,
  DepthAttachment,
  CopySource,  // read-back
  StorageBufferRead,
};

enum class PassKind : uint8_t { Compute, Fullscreen, Raster, Readback };

struct Access {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 read, write;
  VkImageLayout layout;  // images only
  VkImageUsageFlags usage;
  const char* name;
};

Access access_of(Use use, PassKind kind);
inline bool writes(Use use) {
  return use == Use::StorageImageWrite || use == Use::StorageImageReadWrite || use == Use::ColorAttachment ||
         use == Use::DepthAttachment;
}
// Whether the use needs what was there before. Attachments do unless they are cleared or first written (compile knows).
inline bool reads(Use use) {
  return use != Use::StorageImageWrite && use != Use::ColorAttachment && use != Use::DepthAttachment;
}
const char* kind_name(PassKind kind);

}  // namespace nf::graph
