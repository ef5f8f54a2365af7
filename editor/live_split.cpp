// The thread: rounds of both estimators, the technique's frames, and what the three say together.
#include "live_split.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "background.h"
#include "core/error.h"

namespace nf::editor {
namespace {

// Sums of frames in two halves, whose noise is independent.
struct Mean {
  uint64_t key = 0;
  uint32_t count = 0;
  image::Image sums[2];
  uint32_t counts[2] = {0, 0};

  void add(const image::Image& frame, uint64_t of) {
    if (of != key || frame.pixels.size() != sums[0].pixels.size()) *this = {.key = of};
    image::Image& sum = sums[count % 2];
    if (count < 2)
      sum = frame;
    else
      for (size_t i = 0; i < frame.pixels.size(); ++i) sum.pixels[i] += frame.pixels[i];
    if (count == 0) sums[1] = frame;  // until there is a second
    ++counts[count % 2];
    ++count;
  }
  image::Halves halves() const {
    image::Halves out{sums[0], sums[1]};
    for (float& x : out.a.pixels) x /= float(std::max(counts[0], 1u));
    for (float& x : out.b.pixels) x /= float(std::max(counts[1], 1u));
    return out;
  }
};

}  // namespace

struct LiveSplit::Work {
  std::optional<scene::Scene> scene;
  std::unique_ptr<reference::Tracer> tracer;
  std::unique_ptr<reference::Marcher> marcher;
  std::vector<image::Layer> buffers;
  std::string test, truth, same;
  uint32_t most_spp = 0, trace_step = 2, march_step = 2;
  double publish_seconds = 0.5;
  uint64_t run = 0;
  Mean mean;
  Clock::time_point start, published;
  bool news = false;  // since the last publication

  bool complete() const {
    return tracer && marcher && tracer->samples() >= most_spp && marcher->samples() >= most_spp * 8;
  }
};

LiveSplit::LiveSplit() : thread_([this] { live(); }) {}

LiveSplit::~LiveSplit() {
  {
    const std::lock_guard hold(mutex_);
    quit_ = cancel_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

uint64_t LiveSplit::start(SplitSettings settings) {
  const std::lock_guard hold(mutex_);
  // What was not begun yet goes with what comes now.
  if (next_) {
    if (!settings.scene) settings.scene = std::move(next_->scene);
    if (!settings.tracer) settings.tracer = next_->tracer;
  }
  if (settings.tracer) {
    settings.tracer->cancel = &cancel_;
    cancel_ = true;
  }
  next_ = std::move(settings);
  newest_.reset();
  error_.clear();
  busy_ = true;
  wake_.notify_one();
  return ++run_;
}

void LiveSplit::add(image::Image frame, uint64_t key) {
  const std::lock_guard hold(mutex_);
  frames_.emplace_back(key, std::move(frame));
  wake_.notify_one();
}

void LiveSplit::stop() {
  const std::lock_guard hold(mutex_);
  ++run_;
  next_.reset();
  newest_.reset();
  frames_.clear();
  forget_ = cancel_ = true;
  wake_.notify_one();
}

bool LiveSplit::poll(Result& out) {
  const std::lock_guard hold(mutex_);
  if (!newest_) return false;
  out = std::move(*newest_);
  newest_.reset();
  return true;
}

std::string LiveSplit::error() const {
  const std::lock_guard hold(mutex_);
  return error_;
}

void LiveSplit::set_up(Work& work, SplitSettings job) {
  work.test = job.test, work.truth = job.truth, work.same = job.same;
  work.most_spp = job.most_spp;
  work.publish_seconds = job.publish_seconds;
  work.start = work.published = Clock::now();
  work.buffers = std::move(job.buffers);
  if (job.scene) {
    work.tracer.reset();
    work.scene = std::move(job.scene);
  }
  if (!work.scene) fail(Exit::Internal, "the error split has no scene");
  if (job.tracer) {
    // Both names at once: another quantity needs no other samples.
    work.tracer.reset();
    std::vector<std::string> layers = {"visibility", "gi", "depth"};
    work.trace_step = 2;
    work.tracer = std::make_unique<reference::Tracer>(*work.scene, *job.tracer, layers);
  }
  work.marcher = std::make_unique<reference::Marcher>(reference::buffers_from(work.buffers), job.march);
  work.march_step = 2;
}

// About a tenth of a second of each, so that it stops soon.
void LiveSplit::refine(Work& work) {
  const auto round = [](auto& estimator, uint32_t most, uint32_t& step) {
    if (estimator.samples() >= most) return;
    const Clock::time_point before = Clock::now();
    estimator.sample(std::min(step, most - estimator.samples()));
    const double took = seconds_since(before);
    if (took < 0.1) step = std::min(step * 2, 1024u);
    if (took > 0.4) step = std::max(step / 4 * 2, 2u);
  };
  round(*work.tracer, work.most_spp, work.trace_step);
  if (!cancel_) round(*work.marcher, work.most_spp * 8, work.march_step);
  work.news = true;
}

bool LiveSplit::publish(Work& work) {
  const std::vector<image::Layer> ta = work.tracer->half(0), tb = work.tracer->half(1), ma = work.marcher->half(0),
                                  mb = work.marcher->half(1);
  using image::find_layer;
  const image::Layer *of_truth = find_layer(ta, work.truth), *of_same = find_layer(ma, work.same),
                     *of_frame = find_layer(work.buffers, "depth"), *of_tracer = find_layer(ta, "depth");
  if (!of_truth || !of_same || !of_frame || !of_tracer)
    fail(Exit::Internal, "the error split has no layer '{}'", work.truth);
  const image::Image &truth = of_truth->image, &seen = of_frame->image, &traced = of_tracer->image;
  const size_t count = size_t(truth.width) * truth.height;
  const image::Halves test = work.mean.halves();
  if (test.a.pixels.size() != truth.pixels.size() || seen.pixels.size() != count) return false;  // of another size
  const image::Halves path{truth, find_layer(tb, work.truth)->image},
      march{of_same->image, find_layer(mb, work.same)->image};
  uint64_t left_out = 0;
  const std::vector<uint8_t> mask = image::common_surfaces(seen.pixels, traced.pixels, left_out);
  Result out{.run = work.run,
             .frames = work.mean.count,
             .spp = work.tracer->samples(),
             .march_spp = work.marcher->samples(),
             .seconds = seconds_since(work.start),
             .complete = work.complete(),
             .split = image::split_error(test, march, path, mask),
             .pixels = uint64_t(std::count(mask.begin(), mask.end(), 1)),
             .size = {truth.width, truth.height}};
  const image::Image t = image::mean_of(test), m = image::mean_of(march), p = image::mean_of(path);
  out.level = image::bias({p, p, mask}).reference;
  const image::Image errors[] = {image::absolute_error({t, p, {}}), image::absolute_error({t, m, {}}),
                                 image::absolute_error({m, p, {}})};
  out.range = float(image::pool(errors[Total], mask).p95);
  if (!(out.range > 0 && std::isfinite(out.range))) out.range = 1;
  for (size_t part = 0; part < 3; ++part) {
    out.maps[part] = errors[part].pixels;
    for (size_t i = 0; i < count; ++i)
      if (!mask[i]) out.maps[part][i] = 0;
  }
  const std::lock_guard hold(mutex_);
  if (work.run != run_) return false;
  newest_ = std::move(out);
  return true;
}

void LiveSplit::live() {
  Work work;
  const int base = getpriority(PRIO_PROCESS, 0);
  for (;;) {
    std::optional<SplitSettings> job;
    std::vector<std::pair<uint64_t, image::Image>> frames;
    {
      std::unique_lock hold(mutex_);
      const bool working = work.tracer && work.marcher && !work.complete();
      if (!working && !next_ && frames_.empty() && !work.news) {
        busy_ = false;
        wake_.wait(hold, [&] { return quit_ || forget_ || next_ || !frames_.empty(); });
      }
      if (quit_) return;
      job = std::exchange(next_, {});
      frames = std::exchange(frames_, {});
      if (job) {
        work.run = run_;
        if (job->tracer) cancel_ = false;
      }
      if (std::exchange(forget_, false) && !job) {
        hold.unlock();
        work.tracer.reset();  // before its scene
        work = {};
        continue;
      }
    }
    try {
      if (job) {
        give_way(base, job->nice);
        set_up(work, std::move(*job));
      }
      for (const auto& [key, frame] : frames) {
        work.mean.add(frame, key);
        work.news = true;
      }
      if (!work.tracer || !work.marcher) {
        work.news = false;
        continue;
      }
      if (!work.complete()) refine(work);
      if (cancel_ || work.mean.count < 2 || !work.tracer->samples() || !work.marcher->samples()) {
        if (work.complete()) work.news = false;
        continue;
      }
      if (work.news && (work.complete() || seconds_since(work.published) >= work.publish_seconds)) {
        publish(work);
        work.published = Clock::now();
        work.news = false;
      }
    } catch (const reference::Cancelled&) {
      work.tracer.reset();  // the scene is kept: the next view may be of it
    } catch (const std::exception& error) {
      const std::lock_guard hold(mutex_);
      if (work.run == run_) error_ = error.what();
      work.tracer.reset();
    }
  }
}

}  // namespace nf::editor
