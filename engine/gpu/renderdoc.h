// Captures of single frames for RenderDoc, through the interface that its library offers to programs. No window is
// needed.
#pragma once

#include <string>

namespace nf::gpu {

struct Device;

// Makes the library known to Vulkan: call it before the Device is made. Captures go to files that begin with `prefix`.
// Throws nf::Error (Exit::NoDevice) where the library is not installed.
void load_renderdoc(const std::string& prefix);
bool renderdoc_loaded();

// What is submitted between the two is captured. Returns the file; throws nf::Error (Exit::Output) when there is none.
void begin_capture(const Device& device);
std::string end_capture(const Device& device);

}  // namespace nf::gpu
