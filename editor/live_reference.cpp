// The thread, its mailbox, and errors against what it has so far.
#include "live_reference.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "background.h"
#include "core/error.h"
#include "core/log.h"
#include "image/error_split.h"

namespace nf::editor {
namespace {

std::vector<LiveReference::Layer> layers_of(const reference::Tracer& tracer) {
  std::vector<LiveReference::Layer> out;
  std::vector<image::Layer> means = tracer.layers(), a = tracer.half(0), b = tracer.half(1);
  const std::vector<reference::Noise> noise = tracer.noise();
  for (size_t i = 0; i < means.size(); ++i) {
    LiveReference::Layer layer{.name = means[i].name,
                               .channels = means[i].channels,
                               .mean = std::move(means[i].image),
                               .halves = {std::move(a[i].image), std::move(b[i].image)}};
    for (const reference::Noise& n : noise)
      if (n.layer == layer.name) layer.noise = n.rmse, layer.level = n.mean;
    out.push_back(std::move(layer));
  }
  return out;
}

}  // namespace

// What the thread keeps from one view to the next.
struct LiveReference::Work {
  scene::Scene scene;
  std::unique_ptr<reference::Tracer> tracer;
  LiveSettings settings;
  uint64_t run = 0;
  Clock::time_point start;
};

const LiveReference::Layer* LiveReference::Picture::layer(std::string_view name) const {
  for (const Layer& layer : layers)
    if (layer.name == name) return &layer;
  return nullptr;
}

LiveReference::LiveReference() : thread_([this] { live(); }) {}

LiveReference::~LiveReference() {
  {
    const std::lock_guard hold(mutex_);
    quit_ = true;
    cancel_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

uint64_t LiveReference::start(scene::Scene scene, LiveSettings settings) {
  std::string list;
  for (const std::string& name : settings.layers) list += (list.empty() ? "" : ",") + name;
  reference::parse_layers(list, settings.tracer.bounces);
  settings.tracer.cancel = &cancel_;
  const std::lock_guard hold(mutex_);
  settings_ = settings;
  has_scene_ = true;
  post({++run_, std::move(scene), std::move(settings)});
  return run_;
}

uint64_t LiveReference::look(const scene::Camera& camera, glm::uvec2 size) {
  const std::lock_guard hold(mutex_);
  if (!has_scene_) return 0;
  settings_.tracer.camera = camera;
  settings_.tracer.size = size;
  // A scene that the thread has not taken yet goes with the new view.
  std::optional<scene::Scene> waiting;
  if (next_) waiting = std::move(next_->scene);
  post({++run_, std::move(waiting), settings_});
  return run_;
}

void LiveReference::stop() {
  const std::lock_guard hold(mutex_);
  ++run_;
  next_.reset();
  newest_.reset();
  has_scene_ = false;
  forget_ = true;
  cancel_ = true;
  wake_.notify_one();
}

// With the mutex held.
void LiveReference::post(Job job) {
  next_ = std::move(job);
  newest_.reset();
  error_.clear();
  busy_ = true;
  cancel_ = true;
  wake_.notify_one();
}

bool LiveReference::poll(Picture& out) {
  const std::lock_guard hold(mutex_);
  if (!newest_) return false;
  out = std::move(*newest_);
  newest_.reset();
  return true;
}

std::string LiveReference::error() const {
  const std::lock_guard hold(mutex_);
  return error_;
}

void LiveReference::live() {
  Work work;
  const int base = getpriority(PRIO_PROCESS, 0);
  for (;;) {
    std::optional<Job> job;
    {
      std::unique_lock hold(mutex_);
      if (!next_) busy_ = false;
      wake_.wait(hold, [&] { return quit_ || next_ || forget_; });
      if (quit_) return;
      job = std::exchange(next_, {});
      if (std::exchange(forget_, false) && !job) {
        hold.unlock();
        work.tracer.reset();
        work.scene = {};
        continue;
      }
      cancel_ = false;
    }
    give_way(base, job->settings.nice);
    work.start = Clock::now();
    work.run = job->run;
    work.settings = std::move(job->settings);
    try {
      if (job->scene) {
        work.tracer.reset();
        work.scene = std::move(*job->scene);
      }
      if (work.tracer)
        work.tracer->set_view(work.settings.tracer.camera, work.settings.tracer.size);
      else
        work.tracer = std::make_unique<reference::Tracer>(work.scene, work.settings.tracer, work.settings.layers);
      trace(work);
    } catch (const reference::Cancelled&) {
      // The scene is kept: the next view may be of it.
    } catch (const std::exception& error) {
      const std::lock_guard hold(mutex_);
      if (work.run == run_) error_ = error.what();
      work.tracer.reset();
    }
  }
}

// Samples until there are enough or something else is asked for; steps grow while they are quick.
void LiveReference::trace(Work& work) {
  reference::Tracer& tracer = *work.tracer;
  const uint32_t most = work.settings.most_spp;
  uint32_t step = 2;  // one for each half: there is no less
  while (tracer.samples() < most) {
    const Clock::time_point before = Clock::now();
    // What it held is lost with a cancelled step; the next view starts anew anyway.
    if (!tracer.sample(std::min(step, most - tracer.samples()))) return;
    const double took = seconds_since(before);
    if (took < work.settings.publish_seconds / 2) step = std::min(step * 2, 256u);
    if (took > work.settings.publish_seconds * 2) step = std::max(step / 4 * 2, 2u);
    Picture picture{.run = work.run,
                    .spp = tracer.samples(),
                    .rays = tracer.rays(),
                    .seconds = seconds_since(work.start),
                    .complete = tracer.samples() >= most,
                    .layers = layers_of(tracer)};
    const std::lock_guard hold(mutex_);
    if (work.run != run_) return;
    newest_ = std::move(picture);
  }
}

LiveError error_against(const image::Image& test, const LiveReference::Picture& picture, std::string_view layer_name,
                        const std::vector<uint8_t>& mask, bool with_flip) {
  const LiveReference::Layer* layer = picture.layer(layer_name);
  if (!layer) fail(Exit::Input, "the reference has no layer '{}'", layer_name);
  const image::Image& mean = layer->mean;
  if (test.width != mean.width || test.height != mean.height || test.channels < mean.channels)
    fail(Exit::Input, "a picture of {}x{} with {} channels cannot be held against a reference of {}x{} with {}",
         test.width, test.height, test.channels, mean.width, mean.height, mean.channels);
  image::Image same{mean.width, mean.height, mean.channels, {}};
  same.pixels.reserve(mean.pixels.size());
  for (size_t pixel = 0; pixel < size_t(mean.width) * mean.height; ++pixel)
    for (uint32_t c = 0; c < mean.channels; ++c) same.pixels.push_back(test.pixels[pixel * test.channels + c]);

  const image::Pair pair{same, mean, mask}, halves{layer->halves[0], layer->halves[1], mask};
  LiveError error{.spp = picture.spp};
  const image::ErrorPart part = image::error_between({same, same}, {layer->halves[0], layer->halves[1]}, mask);
  error.bias = part.bias;
  error.rmse = part.rmse;
  error.rmse_floor = part.floor;
  error.relmse_plain = image::measure(image::Metric::RelMse, pair, true).value;
  double sum = 0;
  uint64_t count = 0;
  for (size_t i = 0; i < mean.pixels.size(); ++i) {
    if (!pair.counts(i / mean.channels)) continue;
    const double value = double(mean.pixels[i]);
    sum += (double(same.pixels[i]) - double(layer->halves[0].pixels[i])) *
           (double(same.pixels[i]) - double(layer->halves[1].pixels[i])) / (value * value + image::relative_epsilon);
    ++count;
  }
  error.relmse = count ? std::max(sum / double(count), 0.0) : 0;
  error.mae = image::measure(image::Metric::Mae, pair, true).value;
  // The mean differs from the truth by half of what its halves differ by.
  error.mae_floor = image::measure(image::Metric::Mae, halves, true).value / 2;
  error.flip = error.flip_floor = -1;
  if (with_flip) {
    const bool hdr = mean.channels == 3;
    error.flip = image::measure(image::Metric::Flip, pair, hdr).value;
    image::Pair noise{mean, mean, mask};
    for (size_t i = 0; i < mean.pixels.size(); ++i)
      noise.test.pixels[i] += (layer->halves[0].pixels[i] - layer->halves[1].pixels[i]) / 2;
    error.flip_floor = image::measure(image::Metric::Flip, noise, hdr).value;
  }
  return error;
}

}  // namespace nf::editor
