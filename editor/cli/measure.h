// Measures settings against each other on one renderer: blocks of frames, interleaved, so that what disturbs the
// machine disturbs all of them alike.
#pragma once

#include <functional>
#include <optional>

#include "capture/timing.h"
#include "cli/options.h"
#include "image/image.h"
#include "scene/path.h"

namespace nf::editor {

struct Subject {
  std::string name;
  passes::FrameSettings settings;
  std::string mode = "radiometric";
};

struct MeasureOptions {
  uint32_t frames = 300;  // of each subject in each repeat
  uint32_t warmup = 60, repeats = 5;
  uint32_t block = 25;  // frames of a subject before the next one's turn
  bool interleave = true, counts = false;
  double fps = 60, time = 0;
  std::optional<scene::CameraPath> path;
  gpu::Timing timing = gpu::Timing::Serialize;
  // Test hook, see graph::ExecuteOptions.
  std::string slow_pass;
  float slow_share = 0;
};

// A frame behind the timed ones, whose history is as long as the warm-up at least.
struct LastFrame {
  image::Image8 picture;
  image::Image layer;  // what was asked for
};

struct Measured {
  std::vector<capture::Run> runs;  // by row of the subjects; of an interrupted measurement, what there is
  std::vector<LastFrame> last;
  bool complete = true;
};

class Meter {
 public:
  // `view` has camera, size and seed. `layer` is read back from the last frame when there is one.
  Meter(gpu::Device& device, scene::Scene& scene, passes::Renderer& renderer, const passes::FrameView& view,
        const MeasureOptions& options, const passes::Aov* layer = nullptr);

  // Called after each counted frame.
  std::function<void(const capture::Run&, const capture::FrameSample&)> on_frame;
  // Called after each frame, with their total number.
  std::function<void(uint64_t done, uint64_t total, double gpu_ms)> on_progress;

  // Ends early on Ctrl-C. Throws nf::Error (Exit::Gpu) after `timeout` seconds, when that is above 0.
  Measured run(const std::vector<Subject>& subjects, double timeout = 0);

  // Frames before a block that are not counted: after another subject the histories start anew.
  static constexpr uint32_t settle_frames = 3;

 private:
  struct Block {
    size_t subject;
    uint32_t repeat, first, count, settle, finish;  // the last two: frames before and behind that are not counted
  };
  std::vector<Block> order(size_t subjects) const;
  void run_block(const Block& block, const Subject& subject, capture::Run& run);
  void run_frame(const Subject& subject, uint32_t n, capture::Run* run, const Block& block, bool last = false);
  void keep(const graph::FrameResult& result, double cpu_ms, const Block& block, uint32_t n, capture::Run& run);
  LastFrame take_last();

  scene::Scene& scene_;
  passes::Renderer& renderer_;
  passes::FrameView view_;
  const MeasureOptions& o_;
  const passes::Aov* layer_;
  gpu::ClockPair clocks_;
  uint64_t done_ = 0, total_ = 0;
  double start_ns_ = 0;
};

// --- JSON of what was measured
// Machine, device, program: what runs of one process share.
nlohmann::json context_json(const gpu::Device& device, const capture::HostLoad& load, bool validation);
nlohmann::json method_json(const MeasureOptions& options);
nlohmann::json settings_json(const Subject& subject, const passes::FrameView& view);
nlohmann::json scene_json(const std::string& path, const std::string& view_name, uint64_t triangles, size_t lights);
capture::Circumstances circumstances(const gpu::Device& device, const capture::HostLoad& load,
                                     const MeasureOptions& options);

}  // namespace nf::editor
