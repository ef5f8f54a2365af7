// Command buffers, uniform memory and timestamps of the frames in flight, ordered by one timeline semaphore.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gpu/memory.h"

namespace nf::gpu {

// Timestamps of one frame: pairs of begin and end, written in order.
struct TimestampPool {
  VkQueryPool pool = VK_NULL_HANDLE;
  uint32_t capacity = 0, used = 0;
};

struct Frame {
  VkCommandPool pool = VK_NULL_HANDLE;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  uint64_t value = 0;  // the timeline's value when this frame is done; 0 = never submitted
  Buffer uniforms;     // host-visible, a bump allocator
  VkDeviceSize uniforms_used = 0;
  TimestampPool timestamps;
};

struct UniformRange {
  VkBuffer buffer;
  VkDeviceSize offset, size;
};

class FrameRing {
 public:
  static constexpr uint32_t size = 2;
  // Copies of a host-visible table that a frame's graph is built with: begin() waits for the oldest frame only after
  // that, so there is one more than frames in flight, and nobody else need wait.
  static constexpr uint32_t table_sides = size + 1;

  explicit FrameRing(Device& device);
  ~FrameRing();
  FrameRing(const FrameRing&) = delete;
  FrameRing& operator=(const FrameRing&) = delete;

  // Waits until the slot's last submission is done, then starts recording. `uniform_bytes` and `timestamps` are upper
  // bounds.
  Frame& begin(VkDeviceSize uniform_bytes, uint32_t timestamps);
  void submit(Frame& frame);
  void wait(const Frame& frame);
  // How many frames were submitted, and how many of them are done.
  uint64_t submitted() const { return submitted_; }
  uint64_t finished() const;
  UniformRange push_uniform(Frame& frame, std::span<const std::byte> data);
  VkDeviceSize uniform_stride(VkDeviceSize bytes) const;

 private:
  Device& device_;
  VkSemaphore timeline_ = VK_NULL_HANDLE;
  uint64_t submitted_ = 0;
  uint32_t next_ = 0;
  std::array<Frame, size> frames_;
};

// How passes are timed. Serialize: a barrier after each timestamp, which makes it right on lavapipe (trap 1) and passes
// do not overlap; Overlap: none, as the frame really runs.
enum class Timing : uint8_t { Serialize, Overlap };

// Writes the next timestamp of the frame, at the end of all earlier work.
void write_timestamp(Device& device, Frame& frame, Timing timing);
// The frame's timestamps in nanoseconds, after wait(). Empty on a device without timestamps.
std::vector<double> read_timestamps(Device& device, Frame& frame);

}  // namespace nf::gpu
