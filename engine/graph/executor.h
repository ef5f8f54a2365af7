// Runs graphs: makes plans real (images, buffers, heaps) and keeps a few of them, records and submits, keeps histories
// between frames, and hands out timings and read-backs of finished frames.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "gpu/frame_ring.h"
#include "graph/plan.h"

namespace nf::graph {

// Fills transient memory with 0xFF (NaN, 1.0): what does not write all of what it first writes then shows.
enum class Poison : uint8_t {
  Off,
  Frame,     // all of it before each frame
  Handover,  // each resource's bytes before its first use in a frame
};

struct ExecutorOptions {
  bool alias = true;  // false: every transient has bytes of its own
  LayoutPolicy layouts = LayoutPolicy::Exact;
  uint64_t order_seed = 0;     // see CompileOptions
  bool merge_barriers = true;  // false: a vkCmdPipelineBarrier2 for each barrier, to see them one by one in a capture
  Poison poison = Poison::Off;
};

struct ExecuteOptions {
  gpu::Timing timing = gpu::Timing::Serialize;
  bool counts = false;  // pipeline statistics of every pass, where the device has them
  // What this frame writes to histories is not kept: the next frame reads what this one read. A frame that reads a
  // history which is not valid yet does not hold.
  bool hold_histories = false;
  gpu::TimelinePoint after, then;  // the device waits for the one before the frame, and tells the other after it
  // Test hooks, so that a test can see that validation notices: this barrier of the plan (by row) is left out; this one
  // changes the layout and waits for nothing.
  int drop_barrier = -1, loosen_barrier = -1;
  bool drop_hand_over = false;  // likewise: the barrier behind the copy of a hand_over()
  // Test hook: this compute pass runs this share of its workgroups a second time, and so takes longer by that.
  const char* slow_pass = nullptr;
  float slow_share = 0;
};

inline gpu::CountedWork counted_work(PassKind kind) {
  return kind == PassKind::Compute ? gpu::CountedWork::Compute : gpu::CountedWork::Graphics;
}

// Times in milliseconds; `begin_ms` from the frame's first timestamp, `record_ms` what recording the pass took.
struct PassTime {
  const char* name;
  const char* description;
  PassKind kind;
  double ms = 0, begin_ms = 0, record_ms = 0;
  std::optional<gpu::PassCounts> counts;
};

// What a finished frame leaves behind.
struct FrameResult {
  std::vector<PassTime> passes;
  double frame_ms = 0;      // from the first pass's begin to the last one's end; 0 without timestamps
  double record_ms = 0;     // planning and recording, on the CPU
  double wall_ms = 0;       // from submission to the moment the host knew that the frame was done
  double submit_ns = 0;     // when it was submitted, on CLOCK_MONOTONIC
  double gpu_begin_ns = 0;  // the first timestamp, on the device's clock
};

// Texels of one mip of one layer as they are in the image, rows tightly packed; or a buffer's bytes.
struct Readback {
  const char* name;
  ImageDesc desc;  // of buffers: without format
  std::vector<std::byte> texels;
};

class Executor {
 public:
  Executor(gpu::Device& device, gpu::Pipelines& pipelines, const ExecutorOptions& options = {});
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  ExecutorOptions options;  // may change between frames

  // How this executor compiles: with its options and its device's sizes.
  Plan plan_for(const Graph& graph) const;
  // For Graph's constructor.
  std::span<const HistoryState> histories() const { return history_states_; }
  // Forget what was written: the next graph gets invalid histories.
  void invalidate_histories() { history_states_.clear(); }
  // Whether the last run held them.
  bool held() const { return held_; }

  // Plans (or takes a kept plan), records, submits. Throws nf::Error (Exit::Internal) with all diagnostics of a wrong
  // graph; the plans kept so far stay good. On a device with validation, and in debug builds, each new plan is replayed
  // by find_hazards() first.
  void run(const Graph& graph, const ExecuteOptions& options = {});
  // Waits for the last run; its times and read-backs.
  FrameResult finish();
  std::vector<Readback> take_readbacks();

  // Of the last run.
  const Plan& plan() const { return plans_.at(current_).plan; }
  uint64_t replans() const { return replans_; }
  size_t kept_plans() const { return plans_.size(); }

 private:
  friend struct Recorder;
  struct View {
    Part part;
    VkImageViewType type;
    VkImageView view;
  };
  // An image or a buffer.
  struct Physical {
    gpu::Image image;
    gpu::Buffer buffer;
    std::vector<View> views;  // made when first needed
  };
  struct PhysicalHistory {
    std::string name;
    ImageDesc desc;
    uint64_t bytes;
    Physical sides[2];                      // a kept image has one
    std::vector<VkImageLayout> layouts[2];  // by cell
    uint64_t written = 0;                   // number of the last run that wrote next, or had the kept image
  };
  struct ReadbackRow {
    ImageDesc desc;
    gpu::Buffer buffer;
  };
  // A plan and what it runs on.
  struct RealPlan {
    uint64_t hash = 0, last_run = 0;
    Plan plan;
    std::vector<Physical> resources;          // by row; only transients
    std::vector<PhysicalHistory*> histories;  // by row of resources
    std::vector<ReadbackRow> readbacks;       // in declared order
    std::vector<size_t> heaps;                // by row of Plan::heaps: row of heaps_
  };
  // Shared by all plans: one of them runs at a time.
  struct SharedHeap {
    bool buffers;
    gpu::Heap heap;
    gpu::Buffer cover;  // to poison it, made when first needed
  };
  // Destroyed when the frame of this number is done.
  struct Retired {
    uint64_t frame;
    VkImageView view = VK_NULL_HANDLE;
    gpu::Image image;
    gpu::Buffer buffer;
    gpu::Heap heap;
  };

  // realize.cpp
  void select_plan(const Graph& graph);
  void realize(const Graph& graph, RealPlan& real);
  size_t find_heap(const PlannedHeap& wanted);
  PhysicalHistory* find_history(const ResourceRow& row);
  void evict(size_t plan);
  void retire(RealPlan& real);
  void retire(Physical& physical);
  void drop_unused_histories();
  void collect(uint64_t finished);
  Physical& physical(const Graph& graph, uint16_t resource);
  VkBuffer buffer(const Graph& graph, uint16_t resource);
  VkImageView view(Physical& physical, const Part& part, VkImageViewType type);

  // execute.cpp
  void settle(const Graph& graph, VkCommandBuffer commands);
  void settle_history(PhysicalHistory& history, uint32_t side, bool clear, const PlannedCell* expected,
                      VkCommandBuffer commands);
  void poison(VkCommandBuffer commands, uint32_t position);
  void record_pass(const Graph& graph, uint32_t position, gpu::Frame& frame, const ExecuteOptions& options,
                   std::span<const gpu::UniformRange> uniforms);
  void record_barriers(const Graph& graph, const PlannedPass& planned, VkCommandBuffer commands,
                       const ExecuteOptions& execute);
  void dispatch(const Graph& graph, const PassRow& pass, VkCommandBuffer commands, const ExecuteOptions& options);
  void record_copy(const Graph& graph, const PassRow& pass, VkCommandBuffer commands);
  void record_readback(const Graph& graph, uint32_t pass, VkCommandBuffer commands);
  void record_hand_over(const Graph& graph, const PassRow& pass, VkCommandBuffer commands,
                        const ExecuteOptions& options);
  void push_descriptors(const Graph& graph, const PassRow& pass, const gpu::Pipelines::Bound& bound,
                        VkCommandBuffer commands, std::span<const gpu::UniformRange> uniforms);
  VkExtent2D begin_rendering(const Graph& graph, const PassRow& pass, VkCommandBuffer commands);
  gpu::Pipelines::Bound bind_pipeline(const Graph& graph, const PassRow& pass);

  gpu::Device& device_;
  gpu::Pipelines& pipelines_;
  gpu::FrameRing ring_;
  std::vector<RealPlan> plans_;
  size_t current_ = 0;
  bool switched_ = false;  // this run's plan is not the last run's
  uint64_t replans_ = 0, runs_ = 0;
  std::vector<SharedHeap> heaps_;
  std::vector<std::unique_ptr<PhysicalHistory>> histories_;  // pointed to
  std::vector<HistoryState> history_states_;
  uint32_t parity_ = 0;  // which side of a history is `next` in this run
  bool held_ = false;
  std::vector<Retired> retired_;
  const Graph* graph_ = nullptr;  // during run(), for Recorder
  gpu::Frame* last_ = nullptr;
  std::vector<PassTime> last_passes_;
  bool last_counted_ = false;
  double last_record_ms_ = 0, last_submit_ns_ = 0;
  std::vector<const char*> last_readbacks_;
};

// A read-back image's texels as a shader would read them, `channels` a texel: depth as it is stored, integers as
// numbers (above 2^24 rounded; what is packed into them is the passes' business). Throws nf::Error (Exit::Internal) for
// a buffer.
std::vector<float> to_floats(const Readback& readback, uint32_t& channels);

}  // namespace nf::graph
