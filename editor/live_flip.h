// FLIP of two pictures of the window in the background, on a thread of its own that gives way to all others. No call
// but the destructor waits for it.
//
//   LiveFlip flip;
//   flip.start({.size = size, .test = ..., .reference = ...});   // instead of what waits, not of what is being done
//   LiveFlip::Result result;
//   if (flip.poll(result)) show(result.colors);
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "image/metrics.h"
#include "ui/renderer.h"

namespace nf::editor {

class LiveFlip {
 public:
  // Texels as the window keeps them: sRGB bytes, or floats of which the first `channels` mean something.
  struct Side {
    uint64_t version = 0;
    std::vector<uint8_t> rgba;
    std::vector<float> floats;
    uint32_t channels = 3;
  };
  struct Job {
    glm::uvec2 size{0};
    ui::PictureId against = ui::PictureId::SlotA;  // where `reference` stood
    Side test, reference;
  };
  struct Result {
    uint64_t test = 0, reference = 0;  // versions
    ui::PictureId against = ui::PictureId::SlotA;
    bool hdr = false;  // as `nearfield compare` chooses: of floats
    glm::uvec2 size{0};
    image::Pooled pooled;
    std::vector<uint8_t> colors;  // RGBA, magma
    std::string error;            // why there is none
    double ms = 0;
  };

  LiveFlip();
  ~LiveFlip();
  LiveFlip(const LiveFlip&) = delete;
  LiveFlip& operator=(const LiveFlip&) = delete;

  void start(Job job);
  // The newest result, where there is one that was not yet given out.
  bool poll(Result& out);
  bool busy() const;

 private:
  void live();
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool quit_ = false, working_ = false;
  std::optional<Job> next_;
  std::optional<Result> newest_;
  std::thread thread_;  // last: the others are there when it starts
};

// What the thread does: `nearfield compare` of the two pictures saved has the same numbers.
LiveFlip::Result flip_of(const LiveFlip::Job& job);

struct Editor;
bool shows_flip(const Editor& editor);
// Each frame of the interface: while the difference is shown as FLIP the thread has the two pictures as they are shown.
void update_flip(Editor& editor, LiveFlip& flip);

}  // namespace nf::editor
