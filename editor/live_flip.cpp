#include "live_flip.h"

#include <algorithm>
#include <utility>

#include "background.h"
#include "core/error.h"
#include "editor.h"

namespace nf::editor {
namespace {

constexpr double least_seconds = 0.5;  // from one start to the next

image::Image linear_image(glm::uvec2 size, const LiveFlip::Side& side) {
  const uint32_t channels = side.rgba.empty() ? std::clamp(side.channels, 1u, 3u) : 3;
  image::Image out{size.x, size.y, channels, {}};
  const size_t count = size_t(size.x) * size.y;
  out.pixels.reserve(count * channels);
  for (size_t i = 0; i < count; ++i)
    for (size_t c = 0; c < channels; ++c)
      out.pixels.push_back(side.rgba.empty() ? side.floats[i * 4 + c]
                                             : image::linear_from_srgb(float(side.rgba[i * 4 + c]) / 255));
  return out;
}

LiveFlip::Side side_of(ui::Renderer& pictures, ui::PictureId id) {
  return {.version = pictures.version_of(id),
          .rgba = pictures.texels(id),
          .floats = pictures.floats(id),
          .channels = pictures.channels_of(id)};
}

}  // namespace

LiveFlip::Result flip_of(const LiveFlip::Job& job) {
  const Clock::time_point start = Clock::now();
  LiveFlip::Result out{.test = job.test.version,
                       .reference = job.reference.version,
                       .against = job.against,
                       .hdr = job.test.rgba.empty(),
                       .size = job.size,
                       .pooled = {},
                       .colors = {},
                       .error = {}};
  try {
    const image::Pair pair = image::make_pair(linear_image(job.size, job.test), linear_image(job.size, job.reference));
    const image::Measured measured = image::measure(image::Metric::Flip, pair, out.hdr);
    out.pooled = measured.pooled;
    out.colors.reserve(measured.map.pixels.size() * 4);
    for (const float error : measured.map.pixels) {
      const image::Rgb8 c = image::magma_color(error);
      out.colors.insert(out.colors.end(), {c.r, c.g, c.b, 255});
    }
  } catch (const std::exception& error) {
    out.error = error.what();
  }
  out.ms = seconds_since(start) * 1e3;
  return out;
}

LiveFlip::LiveFlip() : thread_([this] { live(); }) {}

LiveFlip::~LiveFlip() {
  {
    const std::lock_guard hold(mutex_);
    quit_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void LiveFlip::start(Job job) {
  {
    const std::lock_guard hold(mutex_);
    next_ = std::move(job);
  }
  wake_.notify_one();
}

bool LiveFlip::poll(Result& out) {
  const std::lock_guard hold(mutex_);
  if (!newest_) return false;
  out = std::move(*newest_);
  newest_.reset();
  return true;
}

bool LiveFlip::busy() const {
  const std::lock_guard hold(mutex_);
  return next_ || working_ || newest_;
}

void LiveFlip::live() {
  give_way(getpriority(PRIO_PROCESS, 0), 10);
  for (;;) {
    Job job;
    {
      std::unique_lock hold(mutex_);
      working_ = false;
      wake_.wait(hold, [&] { return quit_ || next_; });
      if (quit_) return;
      job = *std::exchange(next_, std::nullopt);
      working_ = true;
    }
    Result result = flip_of(job);
    const std::lock_guard hold(mutex_);
    newest_ = std::move(result);
  }
}

bool shows_flip(const Editor& e) {
  return e.viewport.compare == CompareMode::Difference && differences[e.viewport.difference].flip;
}

void update_flip(Editor& e, LiveFlip& flip) {
  const Viewport& v = e.viewport;
  FlipView& f = e.flip;
  LiveFlip::Result result;
  const bool came = flip.poll(result), on = shows_flip(e);
  f.busy = on && flip.busy();
  if (!on) {
    f = {};
    return;
  }
  ui::Renderer& p = *e.pictures;
  if (came && result.error.empty()) {
    p.set_picture(ui::PictureId::Flip, result.size, std::span<const uint8_t>(result.colors));
    result.colors = {};
    f.has = true;
  }
  if (came) f.result = std::move(result);
  const ui::PictureId scene = ui::PictureId::Scene;
  const uint64_t test = p.version_of(scene), reference = p.version_of(v.against);
  f.has &= f.result.against == v.against;
  f.current = f.has && f.result.test == test && f.result.reference == reference;
  f.note = f.result.error;
  const bool alike = p.size_of(scene) == p.size_of(v.against) && p.has_floats(scene) == p.has_floats(v.against);
  if (!alike) f.note = "the pictures are not of one size and kind";
  const bool asked = f.asked_test == test && f.asked_reference == reference;
  if (!alike || f.busy || asked || e.now - f.started < least_seconds || p.size_of(scene).x == 0) return;
  f.started = e.now;
  f.asked_test = test;
  f.asked_reference = reference;
  f.busy = true;
  flip.start({p.size_of(scene), v.against, side_of(p, scene), side_of(p, v.against)});
}

}  // namespace nf::editor
