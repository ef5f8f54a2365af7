// Vulkan's header and the check macro for its calls. Only engine/gpu and engine/graph include this.
#pragma once

#include <vulkan/vulkan.h>

#include "core/error.h"

namespace nf::gpu {

const char* result_name(VkResult result);

// Device loss and memory exhaustion are the world's doing (Exit::Gpu); everything else is a bug of ours.
void check(VkResult result, const char* call, const char* file, int line);

}  // namespace nf::gpu

#define NF_VK(call) ::nf::gpu::check((call), #call, __FILE__, __LINE__)
