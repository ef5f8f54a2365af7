// The Vulkan 1.3 device: dynamic rendering, synchronization2, push descriptors, a timeline semaphore. Needs no window
// system. Every other part of gpu/ takes a Device&, which belongs to one thread; a second thread takes a second Device
// on the same VkDevice (SecondUser).
#pragma once

#include <atomic>
#include <memory>
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
  bool second_queue = false;  // for a second user, where the family has two
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

// A value of a timeline semaphore; without a semaphore, nothing.
struct TimelinePoint {
  VkSemaphore semaphore = VK_NULL_HANDLE;
  uint64_t value = 0;
};

// Vulkan wants one thread at a time at a queue. Two users of one queue share this.
struct Queue {
  VkQueue handle = VK_NULL_HANDLE;
  std::mutex mutex;
};

struct Device;
// Of that device, which has to outlive the second user.
struct SecondUser {
  Device& of;
};

// What is the same for both users of a VkDevice.
struct DeviceHandles {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice handle = VK_NULL_HANDLE;
  uint32_t queue_family = 0;
  uint32_t queues = 1;  // that the VkDevice has
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  DeviceFacts facts;
  DeviceInfo info;
  bool validation = false;
  PFN_vkCmdPushDescriptorSetKHR push_descriptor_set = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT set_name = nullptr;
  PFN_vkGetCalibratedTimestampsEXT get_clocks = nullptr;  // not on every device
};

struct Device : DeviceHandles {
  explicit Device(const DeviceOptions& options);
  // The same VkDevice for another thread: its counts are its own, so is its queue when there are two. Messages of
  // validation are common to both, each is taken once; a lost device is lost for both.
  explicit Device(SecondUser second);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  DeviceCounts counts;

  // Validation messages since the last call, and forget them. Any message is a failure.
  std::vector<std::string> take_messages();
  void add_message(std::string message);
  // To this user's queue, one thread at a time. submit() and present() return what Vulkan does.
  VkResult submit(const VkSubmitInfo2& submit, VkFence fence = VK_NULL_HANDLE);
  VkResult present(const VkPresentInfoKHR& present);
  // As submit(), but to the driver even where the loss is only pretended: for what has to be tidied up.
  VkResult submit_although_lost(const VkSubmitInfo2& submit, VkFence fence = VK_NULL_HANDLE);
  // All that was submitted to this user's queue is done. At once when the device is lost: nothing will come of it.
  void wait_idle() const;
  // Test hook: whatever is submitted, by either user, finds the device lost, from now on or from the window's next
  // picture on, which meets it with an image of its swapchain in hand.
  enum class Loss : uint8_t { None, AtPicture, Now };
  void pretend_lost(Loss loss = Loss::Now);
  // Nothing where the device cannot tell.
  std::optional<ClockPair> clocks() const;
  void name_object(VkObjectType type, uint64_t object, const std::string& name) const;

 private:
  Device* owner_ = nullptr;  // of a second user
  Queue own_queues_[2];      // the owner's
  Queue* queue_ = nullptr;
  std::atomic<Loss> pretended_ = Loss::None;  // the owner's
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

// All devices, usable or not. Throws nf::Error (Exit::NoDevice) when there is no Vulkan at all.
std::vector<DeviceInfo> list_devices();

}  // namespace nf::gpu
