// Runs graphs: makes a plan real (images, views), records and submits it, keeps histories between frames, and hands out
// timings and read-backs of finished frames.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "gpu/frame_ring.h"
#include "graph/plan.h"

namespace nf::graph {

struct ExecuteOptions {
  gpu::Timing timing = gpu::Timing::Serialize;
  // Fills the transients' memory with 0xFF (NaN, 1.0) before the frame: a pass that does not write all of what it first
  // writes then shows.
  bool poison = false;
  // Test hook: this barrier of the plan (by row) is left out, so that a test can see that validation notices.
  int drop_barrier = -1;
};

struct PassTime {
  const char* name;
  const char* description;
  double ms;
};

// What a finished frame leaves behind.
struct FrameResult {
  std::vector<PassTime> passes;
  double frame_ms = 0;  // from the first pass's begin to the last one's end; 0 without timestamps
};

// Texels as they are in the image, rows tightly packed.
struct Readback {
  const char* name;
  ImageDesc desc;
  std::vector<std::byte> texels;
};

class Executor {
 public:
  // `alias` false: every transient has bytes of its own.
  Executor(gpu::Device& device, gpu::Pipelines& pipelines, bool alias = true);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // How this executor compiles: with its device's sizes.
  Plan plan_for(const Graph& graph) const;
  // For Graph's constructor.
  std::span<const HistoryState> histories() const { return history_states_; }
  // Forget what was written: the next graph gets invalid histories.
  void invalidate_histories();

  // Plans (or takes the kept plan), records, submits. Throws nf::Error (Exit::Internal) with all diagnostics of a wrong
  // graph.
  void run(const Graph& graph, const ExecuteOptions& options = {});
  // Waits for the last run; its times and read-backs.
  FrameResult finish();
  std::vector<Readback> take_readbacks();

  const Plan& plan() const { return plan_; }
  uint64_t replans() const { return replans_; }

 private:
  struct PhysicalHistory {
    const char* name;
    ImageDesc desc;
    VkImageUsageFlags usage;
    gpu::Image images[2];
    VkImageLayout layouts[2];
    bool used = false;
  };
  void replan(const Graph& graph, uint64_t hash);
  void release();
  void settle(const Graph& graph, VkCommandBuffer commands);
  void poison(VkCommandBuffer commands);
  const gpu::Image& image(uint16_t resource) const;
  void record_pass(const Graph& graph, const PlannedPass& planned, gpu::Frame& frame, const ExecuteOptions& options,
                   std::span<const gpu::UniformRange> uniforms);
  void record_barriers(const PlannedPass& planned, VkCommandBuffer commands, const ExecuteOptions& options);
  void push_descriptors(const Graph& graph, const PassRow& pass, const gpu::Pipelines::Bound& bound,
                        VkCommandBuffer commands, std::span<const gpu::UniformRange> uniforms);
  void begin_rendering(const Graph& graph, const PassRow& pass, VkCommandBuffer commands);
  gpu::Pipelines::Bound bind_pipeline(const Graph& graph, const PassRow& pass);

  gpu::Device& device_;
  gpu::Pipelines& pipelines_;
  gpu::FrameRing ring_;
  Plan plan_;
  uint64_t hash_ = 0;
  uint64_t replans_ = 0;
  bool fresh_ = false;  // the plan has not run yet
  bool alias_;
  std::vector<gpu::Heap> heaps_;          // by row of Plan::heaps
  std::vector<gpu::Buffer> poison_;       // over the heaps, made when first needed
  std::vector<gpu::Image> images_;        // by resource; empty for histories
  std::vector<int> history_of_;           // by resource: row of histories_, or -1
  std::vector<uint8_t> history_is_next_;  // by resource
  std::vector<PhysicalHistory> histories_;
  std::vector<HistoryState> history_states_;
  uint32_t parity_ = 0;  // which physical image is `next` this frame
  std::vector<gpu::Buffer> readback_buffers_;
  std::vector<std::pair<const char*, ImageDesc>> readback_rows_;
  gpu::Frame* last_ = nullptr;
  std::vector<std::pair<const char*, const char*>> last_passes_;
};

// Writes the read-back of a texel format into floats, `channels` a texel. Packed formats of ours (normal, radiance) are
// the passes' business: they have a float copy made before reading back.
std::vector<float> to_floats(const Readback& readback, uint32_t& channels);

}  // namespace nf::graph
