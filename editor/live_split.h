// A technique's error in its two parts, of the view that is shown, worked out in the background: the path tracer and
// the same-information marcher refine side by side on a thread that gives way to all others, and the technique's frames
// are averaged meanwhile in two halves. No call but the destructor waits for it.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "image/error_split.h"
#include "reference/same_information.h"

namespace nf::editor {

struct SplitSettings {
  std::string test, truth, same;      // layers of the technique, the path tracer and the marcher that are one quantity
  std::vector<image::Layer> buffers;  // depth, normal, radiance of a frame, whose size everything has
  reference::MarchSettings march;     // `seed` and `threads` as for the tracer
  std::optional<reference::Settings> tracer;  // none: as before, and its samples stay
  std::optional<scene::Scene> scene;          // a copy; none: the one before
  uint32_t most_spp = 4096;                   // of the tracer; the marcher takes eight times as many, which are cheap
  double publish_seconds = 0.5;
  int nice = 10;  // added to the process's, 0 to 19
};

class LiveSplit {
 public:
  enum Part { Total, Estimator, Missing };
  struct Result {
    uint64_t run = 0;                             // what start() returned
    uint32_t frames = 0, spp = 0, march_spp = 0;  // what each of the three had
    double seconds = 0;
    bool complete = false;  // of the tracer and the marcher
    image::ErrorSplit split;
    double level = 0;     // mean of the truth
    uint64_t pixels = 0;  // that count: those whose surface is the same to the frame and to the tracer
    glm::uvec2 size{0};
    std::array<std::vector<float>, 3> maps;  // absolute errors by part, a number a pixel; 0 where it does not count
    float range = 1;                         // the 95th percentile of the total's
  };

  LiveSplit();
  ~LiveSplit();
  LiveSplit(const LiveSplit&) = delete;
  LiveSplit& operator=(const LiveSplit&) = delete;

  // Instead of whatever it does. Returns the number of the run.
  uint64_t start(SplitSettings settings);
  // A frame's `test` layer. Frames of one `key` are averaged; another key begins anew.
  void add(image::Image frame, uint64_t key);
  // No result comes after this, and the scene is forgotten.
  void stop();
  bool poll(Result& out);
  bool busy() const { return busy_; }
  std::string error() const;

 private:
  struct Work;
  void live();
  void set_up(Work& work, SplitSettings job);
  void refine(Work& work);
  bool publish(Work& work);

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool quit_ = false, forget_ = false;
  uint64_t run_ = 0;
  std::optional<SplitSettings> next_;
  std::vector<std::pair<uint64_t, image::Image>> frames_;
  std::optional<Result> newest_;
  std::string error_;
  std::atomic<bool> cancel_ = false, busy_ = false;
  std::thread thread_;  // last: the others are there when it starts
};

}  // namespace nf::editor
