// The path tracer in the background: what it publishes, how it stops, and errors against it.
#include "live_reference.h"

#include <chrono>
#include <sys/resource.h>
#include <thread>

#include "core/error.h"
#include "image/metrics.h"
#include "reference_bed.h"

namespace nf::editor {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using test::vec3;

scene::Scene room() {
  content::Builder b;
  b.room({0, 1, 0}, vec3(1), b.material({.base_color = vec3(0.7f, 0.6f, 0.5f)}));
  b.quad({-0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, 0.3f}, {-0.3f, 1.98f, 0.3f},
         b.material({.emissive = vec3(8)}));
  b.point_light({-0.5f, 1.5f, 0.4f}, 1);
  return test::scene_of(b.glb());
}

LiveSettings small_settings(uint32_t most_spp) {
  LiveSettings s;
  s.tracer.camera = test::camera({-0.7f, 1.2f, 0.8f}, {0.2f, 0.7f, -0.3f}, 70);
  s.tracer.size = {24, 16};
  s.tracer.bounces = 2;
  s.tracer.sampler = reference::SamplerKind::Independent;  // whose noise falls as 1/sqrt(n), no faster
  s.layers = {"", "gi"};
  s.most_spp = most_spp;
  s.publish_seconds = 0.02;
  s.nice = 0;  // else a test among many waits for all of them
  return s;
}

// Every picture of the run until it is complete.
std::vector<LiveReference::Picture> all_of(LiveReference& live, uint64_t run) {
  std::vector<LiveReference::Picture> all;
  const auto start = Clock::now();
  LiveReference::Picture picture;
  while (Clock::now() - start < 400s) {
    if (live.poll(picture)) {
      EXPECT_EQ(picture.run, run);
      all.push_back(picture);
      if (picture.complete) return all;
    }
    std::this_thread::sleep_for(1ms);
  }
  ADD_FAILURE() << "no complete picture in time; " << live.error();
  return all;
}

void wait_until_idle(const LiveReference& live) {
  while (live.busy()) std::this_thread::sleep_for(1ms);
}

TEST(LiveReference, RefinesToWhatTheTracerFinds) {
  const scene::Scene scene = room();
  const LiveSettings settings = small_settings(1024);
  LiveReference live;
  LiveReference::Picture none;
  EXPECT_FALSE(live.poll(none));
  EXPECT_FALSE(live.busy());
  const auto all = all_of(live, live.start(scene, settings));
  ASSERT_GE(all.size(), 4u);
  for (size_t i = 1; i < all.size(); ++i) EXPECT_GT(all[i].spp, all[i - 1].spp);
  const LiveReference::Picture& last = all.back();
  EXPECT_EQ(last.spp, 1024u);
  EXPECT_FALSE(live.poll(none)) << "each picture is given out once";

  // Whatever the steps were, the bytes are those of the tracer alone.
  reference::Tracer tracer(scene, settings.tracer, settings.layers);
  tracer.sample(1024);
  const auto layers = tracer.layers(), a = tracer.half(0), b = tracer.half(1);
  ASSERT_EQ(last.layers.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(last.layers[i].name, settings.layers[i]);
    EXPECT_EQ(last.layers[i].mean.pixels, layers[i].image.pixels);
    EXPECT_EQ(last.layers[i].halves[0].pixels, a[i].image.pixels);
    EXPECT_EQ(last.layers[i].halves[1].pixels, b[i].image.pixels);
    EXPECT_EQ(last.layers[i].noise, tracer.noise()[i].rmse);
  }

  // Its own noise falls as one over the root of the samples: the slope in the logarithms is -1/2.
  const auto first = std::find_if(all.begin(), all.end(), [](const auto& p) { return p.spp >= 8; });
  ASSERT_LT(first->spp, 512u) << "the steps grow too fast to be looked at";
  const double slope =
      std::log(last.layer("gi")->noise / first->layer("gi")->noise) / std::log(double(last.spp) / double(first->spp));
  std::printf("%zu pictures, noise of gi %.4f at %u spp, %.4f at %u spp: slope %.3f\n", all.size(),
              first->layer("gi")->noise, first->spp, last.layer("gi")->noise, last.spp, slope);
  EXPECT_NEAR(slope, -0.5, 0.1);
}

// Threads of this process that run at this priority.
int threads_at(int nice) {
  int count = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
    count += getpriority(PRIO_PROCESS, id_t(std::stoi(task.path().filename()))) == nice;
  return count;
}

TEST(LiveReference, GivesWayToOthers) {
  const int base = getpriority(PRIO_PROCESS, 0), low = std::min(base + 3, 19);
  if (low == base) GTEST_SKIP() << "nothing runs lower than this process";
  LiveReference live;
  LiveSettings settings = small_settings(1u << 20);
  EXPECT_EQ(threads_at(low), 0);
  settings.nice = 3;
  const uint64_t run = live.start(room(), settings);
  for (LiveReference::Picture picture; !live.poll(picture);) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(run, 1u);
  EXPECT_GE(threads_at(low), 1);
  EXPECT_GE(threads_at(base), 1) << "and only its own";
}

TEST(LiveReference, AnotherCameraIsAnotherPicture) {
  LiveReference live;
  EXPECT_EQ(live.look({}, {8, 8}), 0u) << "nothing to look at yet";
  const LiveSettings settings = small_settings(16);
  const scene::Scene scene = room();
  const uint64_t one = live.start(scene, settings);
  const auto first = all_of(live, one).back();
  const scene::Camera other = test::camera({0.5f, 0.4f, 0.8f}, {0, 1, -0.5f}, 60);
  const uint64_t two = live.look(other, {20, 12});
  EXPECT_GT(two, one);
  const auto second = all_of(live, two).back();
  EXPECT_EQ(second.layers[0].mean.width, 20u);
  reference::Settings same = settings.tracer;
  same.camera = other;
  same.size = {20, 12};
  reference::Tracer tracer(scene, same, settings.layers);
  tracer.sample(16);
  EXPECT_EQ(second.layers[0].mean.pixels, tracer.layers()[0].image.pixels);
  // Back again, on top of one another: only the last counts, and nothing of the others comes.
  for (int i = 0; i < 20; ++i) live.look(other, {20, 12});
  const auto third = all_of(live, live.look(settings.tracer.camera, settings.tracer.size)).back();
  EXPECT_EQ(third.layers[0].mean.pixels, first.layers[0].mean.pixels);
  // A scene that was not taken yet goes with the view that follows it.
  live.start(scene, settings);
  const auto fourth = all_of(live, live.look(other, {20, 12})).back();
  EXPECT_EQ(fourth.layers[0].mean.pixels, second.layers[0].mean.pixels);
  LiveSettings wrong = settings;
  wrong.layers = {"girl"};
  EXPECT_THROW(live.start(scene, wrong), Error);
}

// In the middle of building the structure of a large scene, and of a step that takes seconds.
TEST(LiveReference, StopsAtOnce) {
  content::Builder b;
  const auto white = b.material({.base_color = vec3(0.7f)});
  for (int i = 0; i < 12000; ++i)
    b.box({float(i % 110), float(i / 110 % 3), float(i / 330)}, vec3(0.3f), 0.1f * float(i), white);
  const scene::Scene large = test::scene_of(b.glb());
  LiveSettings settings = small_settings(1u << 20);
  settings.tracer.size = {1600, 900};
  settings.tracer.bounces = 8;
  double longest = 0;
  const auto stopped = [&](LiveReference& live) {
    const auto start = Clock::now();
    live.stop();
    const double call = std::chrono::duration<double>(Clock::now() - start).count();
    wait_until_idle(live);
    longest = std::max(longest, std::chrono::duration<double>(Clock::now() - start).count());
    EXPECT_LT(call, 0.05) << "the call itself does not wait";
    LiveReference::Picture picture;
    EXPECT_FALSE(live.poll(picture));
  };
  LiveReference live;
  for (const auto wait : {0ms, 20ms, 60ms, 200ms, 500ms, 900ms}) {
    live.start(large, settings);
    EXPECT_TRUE(live.busy());
    std::this_thread::sleep_for(wait);
    EXPECT_TRUE(live.busy()) << "it would go on for hours";
    stopped(live);
  }
  EXPECT_EQ(live.look(settings.tracer.camera, {8, 8}), 0u) << "the scene is forgotten";
  for (const auto wait : {0ms, 30ms, 300ms}) {
    auto other = std::make_unique<LiveReference>();
    other->start(large, settings);
    std::this_thread::sleep_for(wait);
    const auto start = Clock::now();
    other.reset();
    longest = std::max(longest, std::chrono::duration<double>(Clock::now() - start).count());
  }
  std::printf("the longest stop took %.0f ms\n", longest * 1000);
  EXPECT_LT(longest, 3) << "on a machine that has better things to do";
  EXPECT_EQ(live.error(), "");
}

TEST(LiveReference, ErrorsLeaveItsNoiseOut) {
  const scene::Scene scene = room();
  LiveReference live;
  const LiveReference::Picture good = all_of(live, live.start(scene, small_settings(1024))).back();
  LiveSettings quick = small_settings(16);
  quick.tracer.seed = 7;
  const LiveReference::Picture noisy = all_of(live, live.start(scene, quick)).back();
  const image::Image& truth = good.layer("gi")->mean;
  const double noise = noisy.layer("gi")->noise;

  // The truth, against a noisy reference: almost all that is seen is the reference's noise.
  const LiveError none = error_against(truth, noisy, "gi");
  const double seen = image::measure(image::Metric::Rmse, {truth, noisy.layer("gi")->mean, {}}, true).value;
  std::printf(
      "the truth at %u spp: RMSE %.4f seen, %.4f left, floor %.4f; relMSE %.5f of %.5f; MAE %.4f, floor %.4f; "
      "FLIP %.4f, floor %.4f\n",
      none.spp, seen, none.rmse, none.rmse_floor, none.relmse, none.relmse_plain, none.mae, none.mae_floor, none.flip,
      none.flip_floor);
  EXPECT_EQ(none.spp, 16u);
  EXPECT_NEAR(seen, noise, 0.1 * noise);
  EXPECT_LT(none.rmse, 1.5 * none.rmse_floor);
  EXPECT_LT(none.relmse, 0.3 * none.relmse_plain);
  EXPECT_NEAR(none.mae, none.mae_floor, 0.15 * none.mae);
  EXPECT_NEAR(none.flip, none.flip_floor, 0.15 * none.flip);

  // A picture that is wrong by a known amount, below the noise.
  image::Image wrong{truth.width, truth.height, 4, {}};
  for (size_t i = 0; i < truth.pixels.size(); i += 3) {
    for (size_t c = 0; c < 3; ++c) wrong.pixels.push_back(truth.pixels[i + c] + float(noise));
    wrong.pixels.push_back(1);
  }
  const LiveError known = error_against(wrong, noisy, "gi", {}, false);
  EXPECT_NEAR(known.rmse, noise, 0.15 * noise);
  EXPECT_NEAR(known.bias, noise, 0.15 * noise);
  EXPECT_EQ(known.flip, -1);
  // Where the mask says so, and nowhere else.
  std::vector<uint8_t> mask(size_t(truth.width) * truth.height, 0);
  std::fill(mask.begin(), mask.begin() + 100, uint8_t(1));
  image::Image half = truth;
  for (size_t i = 300; i < half.pixels.size(); ++i) half.pixels[i] += 100;
  EXPECT_LT(error_against(half, good, "gi", mask).mae, 0.1);
  EXPECT_GT(error_against(half, good, "gi").mae, 10);

  EXPECT_THROW(error_against(truth, noisy, "direct"), Error);
  EXPECT_THROW(error_against(image::Image{2, 2, 3, std::vector<float>(12)}, noisy, "gi"), Error);
}

}  // namespace
}  // namespace nf::editor
