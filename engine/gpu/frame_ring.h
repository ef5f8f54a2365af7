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

// Pipeline statistics of one frame's passes: of graphics and of compute in pools of their own, because lavapipe crashes
// when the compute bit is counted inside a rendering scope.
struct StatisticsPools {
  VkQueryPool graphics = VK_NULL_HANDLE, compute = VK_NULL_HANDLE;
  uint32_t capacity = 0;  // of each
};

struct Frame {
  VkCommandPool pool = VK_NULL_HANDLE;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  uint64_t value = 0;  // the timeline's value when this frame is done; 0 = never submitted
  Buffer uniforms;     // host-visible, a bump allocator
  VkDeviceSize uniforms_used = 0;
  TimestampPool timestamps;
  StatisticsPools statistics;
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

  // Waits until the slot's last submission is done, then starts recording. `uniform_bytes`, `timestamps` and the number
  // of passes to count `statistics` of are upper bounds.
  Frame& begin(VkDeviceSize uniform_bytes, uint32_t timestamps, uint32_t statistics = 0);
  // Waits on the device for `after`; tells `then` when the frame is done.
  void submit(Frame& frame, TimelinePoint after = {}, TimelinePoint then = {});
  void wait(const Frame& frame);
  // How many frames were submitted, and how many of them are done.
  uint64_t submitted() const { return submitted_; }
  uint64_t finished() const;
  UniformRange push_uniform(Frame& frame, std::span<const std::byte> data);
  VkDeviceSize uniform_stride(VkDeviceSize bytes) const;

 private:
  void prepare(StatisticsPools& pools, uint32_t count);
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
// The frame's timestamps after wait(), in nanoseconds from the first one; that one, on the device's clock, in `first`.
// Where passes overlap a later one can be earlier. Empty on a device without timestamps.
std::vector<double> read_timestamps(Device& device, Frame& frame, double* first = nullptr);

// What a pass made the device do. Of a compute pass only the last.
struct PassCounts {
  uint64_t vertices = 0, primitives = 0, vertex_invocations = 0, clipped_in = 0, clipped_out = 0,
           fragment_invocations = 0, compute_invocations = 0;
};
enum class CountedWork : uint8_t { Graphics, Compute };
// Around a pass, outside of its rendering scope; `pass` is a number below what begin() was told.
void begin_counts(Frame& frame, CountedWork work, uint32_t pass);
void end_counts(Frame& frame, CountedWork work, uint32_t pass);
// After wait().
PassCounts read_counts(Device& device, const Frame& frame, CountedWork work, uint32_t pass);

}  // namespace nf::gpu
