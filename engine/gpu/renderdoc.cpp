// The library is opened at run time: nothing depends on it being there.
#include "gpu/renderdoc.h"

#include <dlfcn.h>
#include <renderdoc_app.h>

#include "core/error.h"
#include "gpu/device.h"

namespace nf::gpu {
namespace {

RENDERDOC_API_1_4_1* api = nullptr;

void* pointer_of(const Device& device) {
  return RENDERDOC_DEVICEPOINTER_FROM_VKINSTANCE(device.instance);
}

}  // namespace

void load_renderdoc(const std::string& prefix) {
  void* library = dlopen("librenderdoc.so", RTLD_NOW);
  const auto get = library ? reinterpret_cast<pRENDERDOC_GetAPI>(dlsym(library, "RENDERDOC_GetAPI")) : nullptr;
  void* found = nullptr;
  if (!get || get(eRENDERDOC_API_Version_1_4_1, &found) != 1)
    fail(Exit::NoDevice,
         "cannot capture for RenderDoc: its library librenderdoc.so is not there or too old; install it (Debian: "
         "renderdoc), or leave --renderdoc away");
  api = static_cast<RENDERDOC_API_1_4_1*>(found);
  api->SetCaptureFilePathTemplate(prefix.c_str());
  api->SetCaptureKeys(nullptr, 0);
  api->MaskOverlayBits(0, 0);
}

bool renderdoc_loaded() {
  return api != nullptr;
}

void begin_capture(const Device& device) {
  NF_CHECK(api, "RenderDoc's library is not loaded");
  api->StartFrameCapture(pointer_of(device), nullptr);
}

std::string end_capture(const Device& device) {
  NF_CHECK(api, "RenderDoc's library is not loaded");
  const uint32_t good = api->EndFrameCapture(pointer_of(device), nullptr);
  const uint32_t count = api->GetNumCaptures();
  std::string path(4096, '\0');
  uint32_t length = uint32_t(path.size());
  if (good != 1 || count == 0 || api->GetCapture(count - 1, path.data(), &length, nullptr) != 1)
    fail(Exit::Output, "RenderDoc wrote no capture: is the folder writable, and its Vulkan layer installed?");
  path.resize(length > 0 ? length - 1 : 0);
  return path;
}

}  // namespace nf::gpu
