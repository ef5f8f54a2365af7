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
  CopySource,
  CopyDestination,
  StorageBufferRead,
  StorageBufferWrite,
  StorageBufferReadWrite,
  IndirectArguments,
  Indices,
};

enum class PassKind : uint8_t { Compute, Fullscreen, Raster, Copy, Readback, HandOver };
constexpr bool has_shader(PassKind kind) {
  return kind == PassKind::Compute || kind == PassKind::Fullscreen || kind == PassKind::Raster;
}
// Takes something out of the frame, so it is run whether or not a pass needs it.
constexpr bool leaves_the_frame(PassKind kind) {
  return kind == PassKind::Readback || kind == PassKind::HandOver;
}

// Exact: each use in its own layout. General: everything in VK_IMAGE_LAYOUT_GENERAL, so that only an image's first use
// in a frame is a transition.
enum class LayoutPolicy : uint8_t { Exact, General };

struct Access {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 read, write;
  VkImageLayout layout;  // images only
  VkFlags usage;         // of the image or of the buffer
  const char* name;
};

Access access_of(Use use, PassKind kind, LayoutPolicy layouts = LayoutPolicy::Exact);
constexpr bool is_attachment(Use use) {
  return use == Use::ColorAttachment || use == Use::DepthAttachment;
}
constexpr bool writes(Use use) {
  return is_attachment(use) || use == Use::StorageImageWrite || use == Use::StorageImageReadWrite ||
         use == Use::StorageBufferWrite || use == Use::StorageBufferReadWrite || use == Use::CopyDestination;
}
// Whether the use needs what was there before. Attachments do unless they are cleared or first written (compile knows).
constexpr bool reads(Use use) {
  return !writes(use) || use == Use::StorageImageReadWrite || use == Use::StorageBufferReadWrite;
}
const char* kind_name(PassKind kind);

}  // namespace nf::graph
