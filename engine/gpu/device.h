// The Vulkan 1.3 device: one queue, dynamic rendering, synchronization2, push descriptors, a timeline semaphore. Needs
// no window system. Every other part of gpu/ takes a Device&.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "gpu/vulkan.h"

namespace nf::gpu {

struct DeviceOptions {
  std::string select;       // "" = best, an index, "cpu", "gpu", or a part of the name
  bool validation = false;  // core and synchronization validation, queue submissions included
  // What a window system asks of the instance; when there are any, the device can make swapchains.
  std::vector<std::string> window_extensions;
};

struct DeviceInfo {
  std::string name, type, driver, driver_info, api;
  uint32_t index = 0;
  std::string missing;  // what this engine needs and the device lacks; empty = usable
};

// Facts that shaders and passes choose by.
struct DeviceFacts {
  bool software = false;        // a CPU device: its times are CPU times
  bool fetch_storage = false;   // read neighbours with imageLoad rather than texelFetch (measured: software devices)
  float timestamp_period = 1;   // nanoseconds a tick
  uint64_t timestamp_mask = 0;  // 0 = no timestamps
  bool pipeline_statistics = false, calibrated_clock = false;
  uint32_t max_push_descriptors = 0;
  uint32_t max_image_layers = 0, max_image_size = 0;
};

// One moment on the clock of the timestamps and on CLOCK_MONOTONIC, in nanoseconds.
struct ClockPair {
  double device_ns = 0, host_ns = 0;
};

// Objects alive, for tests and the editor's memory view.
struct DeviceCounts {
  uint32_t images = 0, views = 0, buffers = 0, allocations = 0;
  bool operator==(const DeviceCounts&) const = default;
};

struct Device {
  explicit Device(const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice handle = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queue_family = 0;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  DeviceFacts facts;
  DeviceInfo info;
  bool validation = false;
  DeviceCounts counts;

  PFN_vkCmdPushDescriptorSetKHR push_descriptor_set = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT set_name = nullptr;

  // Validation messages since the last call, and forget them. Any message is a failure.
  std::vector<std::string> take_messages();
  void add_message(std::string message);
  void wait_idle() const;
  // Nothing where the device cannot tell.
  std::optional<ClockPair> clocks() const;
  void name_object(VkObjectType type, uint64_t object, const std::string& name) const;

 private:
  PFN_vkGetCalibratedTimestampsEXT get_clocks_ = nullptr;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

// All devices, usable or not. Throws nf::Error (Exit::NoDevice) when there is no Vulkan at all.
std::vector<DeviceInfo> list_devices();

}  // namespace nf::gpu
