// A path tracer that refines a view in the background, on a thread of its own that gives way to all others. No call but
// the destructor waits for it.
//
//   LiveReference reference;
//   reference.start(scene, settings);                   // a copy of the scene: the editor's may go on changing
//   LiveReference::Picture picture;
//   if (reference.poll(picture)) show(picture.layer("gi")->mean);
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "reference/reference.h"

namespace nf::editor {

struct LiveSettings {
  reference::Settings tracer;  // camera and size, bounces, radius of visibility, seed, threads; `cancel` is ours
  // Names as reference::parse_layers() takes them; "" is the final radiance.
  std::vector<std::string> layers = {"", "direct", "gi", "ambient", "visibility"};
  uint32_t most_spp = 1u << 16;   // then it rests
  double publish_seconds = 0.25;  // about how often there is a new picture, where samples come faster
  int nice = 10;                  // added to the process's, 0 to 19
};

class LiveReference {
 public:
  struct Layer {
    std::string name, channels;
    image::Image mean, halves[2];  // the two halves of the samples are independent of each other
    double noise = 0, level = 0;   // RMSE of `mean`, and the mean of its absolute value
  };
  struct Picture {
    uint64_t run = 0;  // what start() or look() returned
    uint32_t spp = 0;
    uint64_t rays = 0;
    double seconds = 0;     // since then, the ray structure included
    bool complete = false;  // most_spp: there will be no other
    std::vector<Layer> layers;
    const Layer* layer(std::string_view name) const;
  };

  LiveReference();
  ~LiveReference();
  LiveReference(const LiveReference&) = delete;
  LiveReference& operator=(const LiveReference&) = delete;

  // Instead of whatever it does. Returns the number of the run. Throws nf::Error (Exit::Input) for an unknown layer.
  uint64_t start(scene::Scene scene, LiveSettings settings);
  // The same scene and settings from another camera: the ray structure stays. 0, and nothing happens, before start().
  uint64_t look(const scene::Camera& camera, glm::uvec2 size);
  // Rests within about 50 ms (later where others keep the cores busy), and forgets the scene. No picture comes after
  // this.
  void stop();

  // The newest picture, where there is one that was not yet given out.
  bool poll(Picture& out);
  bool busy() const { return busy_; }
  // Why the last run ended before its time (out of memory, say); empty when it did not.
  std::string error() const;

 private:
  struct Job {
    uint64_t run = 0;
    std::optional<scene::Scene> scene;  // none: the one before
    LiveSettings settings;
  };
  struct Work;
  void post(Job job);
  void live();
  void trace(Work& work);

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool quit_ = false, forget_ = false, has_scene_ = false;
  uint64_t run_ = 0;  // of the newest job
  LiveSettings settings_;
  std::optional<Job> next_;
  std::optional<Picture> newest_;
  std::string error_;
  std::atomic<bool> cancel_ = false, busy_ = false;
  std::thread thread_;  // last: the others are there when it starts
};

// How far a picture is from the reference so far. Where the reference's noise can be told from the difference it is
// left out: RMSE and relMSE multiply the differences from its two halves, whose noise is independent, so that it
// cancels. Where it cannot, the floor says what the noise alone would give; an error is not less than its floor.
struct LiveError {
  uint32_t spp = 0;
  double bias = 0;                      // mean of test - reference
  double rmse = 0, rmse_floor = 0;      // noise left out; below the floor it is not told from none
  double relmse = 0, relmse_plain = 0;  // noise left out (in the difference); as it is
  double mae = 0, mae_floor = 0;
  double flip = 0, flip_floor = 0;  // -1: not asked for
};
// `test` has the layer's size, and its channels or more. `mask` may be empty; else a byte a pixel, not 0 where it
// counts. FLIP takes by far the longest. Throws nf::Error (Exit::Input) for another size or too few channels.
LiveError error_against(const image::Image& test, const LiveReference::Picture& picture, std::string_view layer,
                        const std::vector<uint8_t>& mask = {}, bool with_flip = true);

}  // namespace nf::editor
