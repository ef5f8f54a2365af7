// The error's parts worked out in the background: pictures whose parts are known, frames in two halves, views one after
// another.
#include "live_split.h"

#include <chrono>
#include <thread>

#include "image/metrics.h"
#include "reference_bed.h"

namespace nf::editor {
namespace {

using namespace std::chrono_literals;
using test::vec3;

constexpr glm::uvec2 size{32, 24};

// A room with a box in it, behind which the depth buffer does not see.
scene::Scene room() {
  content::Builder b;
  b.room({0, 1, 0}, vec3(1), b.material({.base_color = vec3(0.7f, 0.6f, 0.5f)}));
  b.box({0.1f, 0.35f, -0.2f}, vec3(0.25f, 0.35f, 0.2f), 0.4f, b.material({.base_color = vec3(0.5f)}));
  b.quad({-0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, 0.3f}, {-0.3f, 1.98f, 0.3f},
         b.material({.emissive = vec3(8)}));
  return test::scene_of(b.glb());
}

const image::Layer& layer(const std::vector<image::Layer>& layers, std::string_view name) {
  for (const image::Layer& l : layers)
    if (l.name == name) return l;
  throw std::runtime_error("no such layer");
}

struct Bed {
  scene::Scene scene = room();
  reference::Settings tracer;
  SplitSettings settings;
  image::Image truth, same;

  Bed() {
    tracer.camera = test::camera({-0.7f, 1.2f, 0.8f}, {0.2f, 0.7f, -0.3f}, 70);
    tracer.size = size;
    tracer.bounces = 1;
    tracer.radius = 1;
    tracer.bound_gi = true;
    tracer.seed = 99;
    reference::Tracer exact(scene, tracer, {"visibility", "gi", "depth", "normal", "direct"});
    exact.sample(256);
    const std::vector<image::Layer> layers = exact.layers();
    truth = layer(layers, "visibility").image;
    settings = {.test = "visibility", .truth = "visibility", .same = "visibility"};
    settings.buffers = {layer(layers, "depth"), layer(layers, "normal"), layer(layers, "direct")};
    settings.buffers[2].name = "radiance";
    settings.march.camera = tracer.camera;
    settings.march.radius = 1;
    settings.march.radius_mode = reference::RadiusMode::Ball;
    settings.march.seed = 99;
    reference::Marcher marcher(reference::buffers_from(settings.buffers), settings.march);
    marcher.sample(1024);
    same = layer(marcher.layers(), "visibility").image;
    settings.tracer = tracer;
    settings.tracer->seed = settings.march.seed = 5;  // not those of what is judged
    settings.scene = scene;
    settings.most_spp = 64;
    settings.publish_seconds = 0.02;
    settings.nice = 0;
  }
};

// With white noise of `amount`, another one for each `n`.
image::Image noisy(image::Image picture, float amount, uint32_t n) {
  uint32_t state = n * 2654435761u + 1;
  for (float& x : picture.pixels) {
    state = state * 1664525u + 1013904223u;
    x += amount * (float(state >> 8) / float(1u << 24) * 2 - 1);
  }
  return picture;
}

LiveSplit::Result finished(LiveSplit& live, uint64_t run, uint32_t frames) {
  LiveSplit::Result result;
  for (const auto start = std::chrono::steady_clock::now(); std::chrono::steady_clock::now() - start < 200s;) {
    if (live.poll(result)) {
      EXPECT_EQ(result.run, run);
      if (result.complete && result.frames == frames) return result;
    }
    std::this_thread::sleep_for(1ms);
  }
  ADD_FAILURE() << "no complete result in time: " << live.error();
  return result;
}

TEST(LiveSplit, TellsWhoseTheErrorIs) {
  Bed bed;
  LiveSplit live;
  const uint64_t run = live.start(bed.settings);
  for (uint32_t n = 0; n < 2; ++n) live.add(bed.same, 1);
  const LiveSplit::Result best = finished(live, run, 2);
  EXPECT_EQ(best.spp, 64u);
  EXPECT_EQ(best.march_spp, 512u);
  EXPECT_EQ(best.size, size);
  EXPECT_GT(best.pixels, size.x * size.y / 2);
  // What the marcher makes of the screen has no error of its own: all of it is missing information.
  EXPECT_LT(best.split.estimator.rmse, 0.2 * best.split.missing.rmse);
  EXPECT_NEAR(best.split.total.rmse, best.split.missing.rmse, 0.1 * best.split.missing.rmse);
  EXPECT_GT(best.split.missing.rmse, 3 * best.split.missing.floor) << "a view in which something is hidden";

  // The truth itself: its distance from the screen's best is both parts, and they cancel.
  for (uint32_t n = 0; n < 2; ++n) live.add(bed.truth, 2);
  const LiveSplit::Result right = finished(live, run, 2);
  EXPECT_LT(right.split.total.rmse, 0.3 * right.split.missing.rmse);
  EXPECT_NEAR(right.split.estimator.bias, -right.split.missing.bias, 0.1 * std::abs(right.split.missing.bias) + 1e-3);
  for (const LiveSplit::Result* r : {&best, &right})
    EXPECT_NEAR(r->split.total.bias, r->split.estimator.bias + r->split.missing.bias, 1e-6);

  // A screen-space picture that is 0.1 too bright is the estimator's fault, and the map says so everywhere.
  image::Image bright = bed.same;
  for (float& x : bright.pixels) x += 0.1f;
  for (uint32_t n = 0; n < 2; ++n) live.add(bright, 3);
  const LiveSplit::Result wrong = finished(live, run, 2);
  EXPECT_NEAR(wrong.split.estimator.bias, 0.1, 0.01);
  EXPECT_NEAR(wrong.split.missing.bias, best.split.missing.bias, 1e-6) << "no samples were lost over another key";
  double mean = 0;
  for (const float x : wrong.maps[LiveSplit::Estimator]) mean += double(x) / double(wrong.pixels);
  EXPECT_NEAR(mean, 0.1, 0.01);
}

// Noise of frames that differ is no error; noise that is always the same is one.
TEST(LiveSplit, AveragesFramesInHalves) {
  Bed bed;
  LiveSplit live;
  const uint64_t run = live.start(bed.settings);
  for (uint32_t n = 0; n < 16; ++n) live.add(noisy(bed.same, 0.3f, n), 1);
  const LiveSplit::Result apart = finished(live, run, 16);
  for (uint32_t n = 0; n < 16; ++n) live.add(noisy(bed.same, 0.3f, 7), 2);
  const LiveSplit::Result alike = finished(live, run, 16);
  EXPECT_LT(apart.split.estimator.rmse, 0.03);
  EXPECT_NEAR(alike.split.estimator.rmse, 0.3 / std::sqrt(3.0), 0.02);
}

TEST(LiveSplit, AnotherViewBeginsAnewAndStopForgets) {
  Bed bed;
  LiveSplit live;
  SplitSettings endless = bed.settings;
  endless.most_spp = 1u << 20;
  live.start(endless);
  live.add(bed.same, 1);
  live.add(bed.same, 1);
  LiveSplit::Result result;
  while (!live.poll(result)) std::this_thread::sleep_for(1ms);
  // The same scene, but another quantity and no new tracer: its samples stay.
  SplitSettings other = bed.settings;
  other.scene.reset();
  other.tracer.reset();
  other.most_spp = result.spp + 64;
  const uint64_t second = live.start(other);
  live.add(bed.same, 2);
  live.add(bed.same, 2);
  while (!live.poll(result) || result.run != second) std::this_thread::sleep_for(1ms);
  EXPECT_GE(result.spp, 2u);
  // A frame of another size is left out until the view has that size.
  live.add({4, 4, 1, std::vector<float>(16, 0.5f)}, 3);
  const uint64_t third = live.start(bed.settings);
  live.add(bed.same, 4);
  live.add(bed.same, 4);
  EXPECT_GT(finished(live, third, 2).pixels, 0u);
  live.stop();
  std::this_thread::sleep_for(50ms);
  EXPECT_FALSE(live.poll(result));
  EXPECT_EQ(live.error(), "");
}

}  // namespace
}  // namespace nf::editor
