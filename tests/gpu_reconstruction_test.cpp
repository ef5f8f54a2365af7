// Reconstruction on the device: means are kept, a NaN stays where it is, edges get smooth, nothing ghosts.
#include <cstdlib>
#include <fstream>

#include "gpu_fixture.h"
#include "scene/update.h"

namespace nf::test {
namespace {

namespace fs = std::filesystem;
using glm::ivec2;
using glm::vec3;

passes::FrameSettings only(bool temporal, int denoise, bool taa) {
  passes::FrameSettings settings;
  settings.reconstruct = true;
  settings.switch_off_reconstruction();
  settings.temporal.enabled = temporal;
  settings.denoise.method = denoise;
  settings.taa.enabled = taa;
  settings.shadow.resolution = 256;
  settings.shadow.tile_resolution = 64;
  return settings;
}

// Of red, or the only channel.
double mean_of(const image::Image& image) {
  double sum = 0;
  for (size_t i = 0; i < image.pixels.size(); i += image.channels) sum += double(image.pixels[i]);
  return sum / double(image.pixels.size() / image.channels);
}

class Reconstruction : public GpuTest {};

// The picture's mean of the reconstructed light is that of the technique's, for each stage and all of them.
TEST_F(Reconstruction, KeepsTheMean) {
  const scene::Scene scene = load(small_room());
  Request request{.size = {128, 72},
                  .camera = inside_small_room(),
                  .settings = only(false, 0, false),
                  .frames = 16,
                  .accumulate = true,
                  .scan = false};
  const Shot truth = shoot(scene, request);
  request.accumulate = false;
  struct Case {
    bool temporal;
    int denoise;
    double tolerance;
  };
  // One frame of noise, filtered, has the error of that frame's mean: 128 x 72 pixels.
  for (const Case c : {Case{true, 0, 0.01}, Case{false, 1, 0.02}, Case{false, 2, 0.02}, Case{true, 2, 0.01}}) {
    request.settings = only(c.temporal, c.denoise, false);
    request.settings.temporal.antilag = 0;
    const Shot shot = shoot(scene, request);
    const double light = mean_of(shot.layer("gi")) / mean_of(truth.layer("gi")),
                 open = mean_of(shot.layer("visibility")) / mean_of(truth.layer("visibility"));
    std::printf("temporal %d, denoise %d: gi %.4f, visibility %.4f of the raw mean\n", c.temporal, c.denoise, light,
                open);
    EXPECT_NEAR(light, 1, c.tolerance) << c.temporal << c.denoise;
    EXPECT_NEAR(open, 1, c.tolerance) << c.temporal << c.denoise;
    // And there is less noise in it than in a frame of the technique.
    double raw = 0, smooth = 0;
    for (size_t i = 0; i < truth.layer("gi").pixels.size(); i += truth.layer("gi").channels) {
      const double expected = double(truth.layer("gi").pixels[i]);
      raw += std::pow(double(shot.layer("gi_raw").pixels[i]) - expected, 2);
      smooth += std::pow(double(shot.layer("gi").pixels[i]) - expected, 2);
    }
    EXPECT_LT(smooth, 0.25 * raw) << c.temporal << c.denoise;
  }
}

// Engine shaders and one that damages the light, in one folder.
class Damaged : public Reconstruction {
 protected:
  void SetUp() override {
    const fs::path data = temporary("data");
    fs::create_directories(data);
    fs::copy(fs::path(NF_SOURCE_DIR) / "shaders", data / "shaders", fs::copy_options::recursive);
    std::ofstream(data / "shaders" / "damage.frag") << R"(#version 460
#include "common/frame.glsl"
uniform texture2D source;
layout(location = 0) out vec4 target;
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  target = texelFetch(source, p, 0);
  if (frame.frame_index % 2 == 0) {
    if (p == ivec2(20, 12)) target = vec4(uintBitsToFloat(0x7fc00000u));
    if (p == ivec2(40, 20)) target = vec4(uintBitsToFloat(0x7f800000u));
  }
}
)";
    setenv("NEARFIELD_DATA_DIR", data.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("NEARFIELD_DATA_DIR");
    Reconstruction::TearDown();
  }
};

TEST_F(Damaged, ANanNeverSpreads) {
  const scene::Scene scene = load(small_room());
  const glm::uvec2 size(64, 36);
  passes::FrameSettings settings = only(false, 0, false);
  passes::Renderer renderer(device(), scene);
  const gpu::Pipeline damage = renderer.pipelines().fullscreen("damage.frag");
  // [damaged or not][with the temporal mean or without]: light and visibility.
  const auto render = [&](bool damaged, bool temporal) {
    renderer.executor().invalidate_histories();
    std::vector<float> light;
    for (uint32_t frame = 0; frame < 3; ++frame) {
      passes::FrameView view = view_of_small_room(size, frame);
      graph::Graph graph(renderer.executor().histories());
      const passes::FrameOutputs out = renderer.build(graph, view, settings);
      passes::GiResult gi = out.gi_raw;
      graph::Tex moments;
      if (damaged)
        for (graph::Tex* tex : {&gi.gi, &gi.visibility}) {
          const graph::Tex bad = graph.image("damaged", graph.desc(*tex));
          graph.fullscreen("damage", damage).in("source", *tex).out("target", bad);
          *tex = bad;
        }
      const passes::TemporalParams params;
      if (temporal) {
        const passes::PreviousSurface previous = passes::keep_surface(graph, out.gbuffer);
        const passes::Temporal mean = passes::add_temporal(graph, renderer.pipelines(), out.gbuffer, previous,
                                                           passes::make_reproject_block(view), gi, params);
        gi = mean.gi, moments = mean.moments;
      }
      gi = passes::add_denoise(graph, renderer.pipelines(), out.gbuffer, gi, moments, settings.denoise, params);
      graph.readback("light", gi.gi);
      renderer.executor().run(graph);
      uint32_t channels = 0;
      light = graph::to_floats(renderer.executor().take_readbacks().at(0), channels);
    }
    return light;
  };
  for (const bool temporal : {false, true}) {
    settings.denoise.method = 2;
    const std::vector<float> good = render(false, temporal), bad = render(true, temporal);
    double worst = 0, sum = 0;
    size_t differ = 0;
    for (size_t i = 0; i < good.size(); ++i) {
      ASSERT_TRUE(std::isfinite(bad[i])) << i / 4 % size.x << "," << i / 4 / size.x;
      worst = std::max(worst, std::abs(double(bad[i]) - double(good[i])));
      differ += bad[i] != good[i];
      sum += double(good[i]);
    }
    EXPECT_GT(differ, 0u) << "control: there was damage";
    EXPECT_LT(worst, 0.5 * sum / double(good.size())) << "temporal " << temporal;
  }
}

// After 32 frames a slanted edge is as it is in a picture of 8 x 8 samples a pixel seen through the same filter, far
// better than in one frame.
TEST_F(Reconstruction, TaaSmoothsEdges) {
  content::Builder b;
  b.quad({-1, -0.7f, 0}, {0.9f, -0.9f, 0}, {0.7f, 0.8f, 0}, {-0.8f, 1, 0},
         b.material({.base_color = vec3(0), .emissive = vec3(1)}));
  const scene::Scene scene = load(b);
  const scene::Camera camera = look({0, 0, 3}, {0, 0, 0}, 50);
  passes::FrameSettings settings = only(false, 0, false);
  settings.technique = &passes::find_technique("none");
  const image::Image large = shoot(scene, {.size = {512, 384}, .camera = camera, .settings = settings}).layer("");
  const Shot aliased = shoot(scene, {.size = {64, 48}, .camera = camera, .settings = settings});
  settings.taa.enabled = 1;
  settings.taa.sharpness = 0;
  const Shot smooth = shoot(scene, {.size = {64, 48}, .camera = camera, .settings = settings, .frames = 32});
  double error_aliased = 0, error_smooth = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      double expected = 0, weights = 0;
      for (int j = std::max(y * 8 - 8, 0); j < std::min(y * 8 + 16, 384); ++j)
        for (int i = std::max(x * 8 - 8, 0); i < std::min(x * 8 + 16, 512); ++i) {
          const double u = (i + 0.5) / 8 - x - 0.5, v = (j + 0.5) / 8 - y - 0.5, w = std::exp(-2.29 * (u * u + v * v));
          expected += w * double(large.at(uint32_t(i), uint32_t(j), 0));
          weights += w;
        }
      expected /= weights;
      error_aliased += std::pow(double(aliased.value("", {x, y})) - expected, 2);
      error_smooth += std::pow(double(smooth.value("", {x, y})) - expected, 2);
    }
  std::printf("squared error at edges: %.2f aliased, %.2f with TAA\n", error_aliased, error_smooth);
  EXPECT_LT(error_smooth, 0.35 * error_aliased);
}

TEST_F(Reconstruction, AStillPictureHasOneNoise) {
  const scene::Scene scene = load(small_room());
  passes::Renderer renderer(device(), scene);
  const auto frame = [&](uint32_t index, bool averaged, const passes::FrameSettings& settings) {
    passes::FrameView view = view_of_small_room({48, 27}, index);
    view.averaged = averaged;
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("gi", renderer.add_layer(graph, out, passes::find_aov("gi_raw")));
    renderer.executor().run(graph);
    return renderer.executor().take_readbacks().at(0).texels;
  };
  const passes::FrameSettings still = only(false, 2, false), averaging = only(true, 2, false);
  EXPECT_EQ(frame(1, false, still), frame(2, false, still));
  EXPECT_NE(frame(1, true, still), frame(2, true, still)) << "the caller averages";
  EXPECT_NE(frame(1, false, averaging), frame(2, false, averaging)) << "temporal accumulation averages";
}

// A camera that turns back and forth over a still scene: light stays close to what a resting camera sees.
TEST_F(Reconstruction, AMovingCameraKeepsTheLight) {
  const scene::Scene scene = load(small_room());
  passes::Renderer renderer(device(), scene);
  const passes::FrameSettings settings = only(true, 2, false);
  const glm::uvec2 size(160, 90);
  const auto camera_at = [](int frame) {
    const float t = 0.004f * float(24 - frame);
    return look({-0.7f + t, 1.2f, 0.8f}, {0.2f - t, 0.7f, -0.3f}, 70);
  };
  std::vector<float> moving, frames;  // the last frame's light and the frames in its mean
  uint32_t channels = 0;
  for (int frame = 0; frame <= 24; ++frame) {
    passes::FrameView view;
    view.camera = camera_at(frame);
    view.previous_camera = camera_at(std::max(frame - 1, 0));
    view.size = size;
    view.frame_index = uint32_t(frame);
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("gi", renderer.add_layer(graph, out, passes::find_aov("gi")));
    for (uint16_t r = 0; r < graph.resources.size(); ++r)
      if (!std::strcmp(graph.resources[r].name, "temporal.moments") &&
          graph.resources[r].lifetime == graph::Lifetime::HistoryNext)
        graph.readback("moments", graph.tex(r));
    renderer.executor().run(graph);
    const auto readbacks = renderer.executor().take_readbacks();
    moving = graph::to_floats(readbacks.at(0), channels);
    uint32_t ignored = 0;
    frames = graph::to_floats(readbacks.at(1), ignored);
  }
  const Shot rest = shoot(scene, {.size = size, .camera = camera_at(24), .settings = settings, .frames = 24});
  double error = 0, sum = 0, long_past = 0;
  for (size_t i = 0; i < moving.size() / channels; ++i) {
    const double expected = double(rest.layer("gi").pixels[i * channels + 1]);
    error += std::abs(double(moving[i * channels + 1]) - expected);
    sum += expected;
    long_past += frames[i * 4 + 3] > 12;
  }
  std::printf("moving against resting: %.1f %% apart; %.0f %% of the pixels have a past of 12 frames\n",
              100 * error / sum, 100 * long_past / double(moving.size() / channels));
  EXPECT_LT(error / sum, 0.06);
  EXPECT_GT(long_past / double(moving.size() / channels), 0.7);
}

// A box that has stood long is gone: on surfaces that stay, half of what changes is there within 4 frames where the
// changes are followed, and long after without. What is seen for the first time since the camera moves is no change.
class Changes : public Reconstruction {
 protected:
  static content::Builder floor_and_box() {
    content::Builder b;
    const auto grey = b.material({.base_color = vec3(0.5f)});
    b.object("room");
    b.quad({-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, grey);
    b.quad({-3, 0, -2}, {3, 0, -2}, {3, 4, -2}, {-3, 4, -2}, grey);
    b.object("box");
    b.box({0, 0.4f, -0.4f}, vec3(0.4f), 0.4f, grey);
    return b;
  }
  struct Frames {
    std::vector<std::vector<float>> open, depth;
  };
  // `gone_at`: the frame from which on the box is not there; `turn`: of the camera in a frame, radians.
  Frames render(const passes::FrameSettings& settings, uint32_t count, uint32_t gone_at, float turn = 0) {
    scene::Scene scene = load(floor_and_box());
    passes::Renderer renderer(device(), scene);
    passes::FrameView view;
    view.size = {80, 45};
    Frames out;
    for (uint32_t frame = 0; frame < count; ++frame) {
      const float angle = turn * float(frame);
      view.camera = look({4 * std::sin(angle), 2.2f, 4 * std::cos(angle)}, {0, 0.4f, -0.4f}, 45);
      if (frame == 0) view.previous_camera = view.camera;
      view.frame_index = frame;
      if (frame == gone_at)
        for (uint32_t node = 0; node < scene.nodes.size(); ++node)
          if (scene.nodes.name[node] == "box")
            scene::set_local(scene.nodes, node, scene.nodes.translation[node], scene.nodes.rotation[node], vec3(1e-4f));
      renderer.update(scene::update(scene));
      graph::Graph graph(renderer.executor().histories());
      const passes::FrameOutputs result = renderer.build(graph, view, settings);
      for (const char* layer : {"visibility", "depth"})
        graph.readback(layer, renderer.add_layer(graph, result, passes::find_aov(layer)));
      renderer.executor().run(graph);
      const auto readbacks = renderer.executor().take_readbacks();
      uint32_t channels = 0;
      out.open.push_back(graph::to_floats(readbacks.at(0), channels));
      out.depth.push_back(graph::to_floats(readbacks.at(1), channels));
      view.previous_camera = view.camera;
    }
    return out;
  }
};

TEST_F(Changes, WhatGoesLeavesNoGhost) {
  for (const char* technique : {"gtao", "vbao"})
    for (const bool follow : {true, false}) {
      passes::FrameSettings settings = only(true, 2, false);
      settings.technique = &passes::find_technique(technique);
      settings.temporal.antilag = 0;
      if (!follow) settings.temporal.motion = 0;
      const Frames seen = render(settings, 88, 24);
      const std::vector<float>&with = seen.open[23], &without = seen.open[87];
      double before = 0, after = 0;
      for (size_t i = 0; i < with.size(); ++i) {
        if (std::abs(seen.depth[23][i] - seen.depth[24][i]) > 1e-3f) continue;
        const double change = double(with[i] - without[i]);
        before += change * change;
        after += change * double(seen.open[27][i] - without[i]);
      }
      std::printf("%s, %s: %.2f of the ghost is left after 4 frames\n", technique, follow ? "followed" : "not",
                  after / before);
      if (follow)
        EXPECT_LT(after / before, 0.5);
      else
        EXPECT_GT(after / before, 0.75);
    }
}

TEST_F(Changes, WhatTheCameraUncoversIsNone) {
  passes::FrameSettings settings = only(true, 0, false);
  const std::vector<float> followed = render(settings, 12, 99, 0.01f).open.back();
  settings.temporal.motion = 0;
  const std::vector<float> plain = render(settings, 12, 99, 0.01f).open.back();
  size_t differ = 0;
  for (size_t i = 0; i < plain.size(); ++i) differ += followed[i] != plain[i];
  std::printf("%zu of %zu pixels differ\n", differ, plain.size());
  EXPECT_LE(differ, plain.size() / 100);
}

// Fed-back light, frame by frame: what the technique gathers is this frame's direct light and emission and the last
// frame's GI times the reflectance, limited; the two ways to find it agree where both do; and its gain is reported.
TEST_F(Reconstruction, FeedbackIsTheLastFramesLight) {
  content::Builder b;
  b.room({0, 1, 0}, vec3(1, 1, 1), b.material({.base_color = vec3(0.95f), .emissive = vec3(1)}));
  const scene::Scene scene = load(b);
  const glm::uvec2 size(64, 36);
  std::map<int, std::vector<float>> fed_by;
  for (const int how : {1, 2}) {
    passes::FrameSettings settings = only(false, 0, false);
    settings.material.lambert = 1;
    settings.gi.shared.radius = 10;
    settings.feedback.reprojection = how;
    passes::Renderer renderer(device(), scene);
    std::vector<float> last_gi, gathered;
    double gain = 0, mean = 0;
    const float limited = 0.9f;  // of the reflectance 0.95
    for (uint32_t frame = 0; frame < 24; ++frame) {
      passes::FrameView view = view_of_small_room(size, frame);
      view.averaged = false;  // one noise: the transport is a fixed linear map
      graph::Graph graph(renderer.executor().histories());
      const passes::FrameOutputs out = renderer.build(graph, view, settings);
      graph.readback("gi", out.gi_raw.gi);
      graph.readback("radiance", renderer.add_layer(graph, out, passes::find_aov("radiance")));
      graph.readback("gain", out.loop_energy);
      for (uint16_t r = 0; r < graph.resources.size(); ++r)
        if (!std::strcmp(graph.resources[r].name, "feedback.fed")) graph.readback("fed", graph.tex(r));
      renderer.executor().run(graph);
      const auto readbacks = renderer.executor().take_readbacks();
      uint32_t channels = 0;
      gathered = graph::to_floats(readbacks.at(1), channels);
      const std::vector<float> energy = graph::to_floats(readbacks.at(2), channels);
      gain = double(energy[0]) / double(energy[1]);
      fed_by[how] = graph::to_floats(readbacks.at(3), channels);
      double worst = 0;
      mean = 0;
      for (size_t i = 0; i < gathered.size() / 4; ++i) {
        mean += double(gathered[i * 4]) / double(gathered.size() / 4);
        if (frame == 0) continue;
        const double expected = 1 + double(limited * last_gi[i * 4]);
        worst = std::max(worst, std::abs(double(gathered[i * 4]) / expected - 1));
      }
      EXPECT_LT(worst, 5e-3) << "frame " << frame << ", way " << how;
      last_gi = graph::to_floats(readbacks.at(0), channels);
    }
    // A closed room that emits 1: L = 1 / (1 - gain) once it stands still.
    std::printf("way %d: gain %.4f, radiance %.3f, expected %.3f\n", how, gain, mean, 1 / (1 - gain));
    EXPECT_GT(gain, 0.3);
    EXPECT_LT(gain, 0.9);
    EXPECT_NEAR(mean * (1 - gain), 1, 0.01);
  }
  double apart = 0, sum = 0;
  for (size_t i = 0; i < fed_by[1].size(); i += 4) {
    apart += std::abs(double(fed_by[1][i]) - double(fed_by[2][i]));
    sum += double(fed_by[1][i]);
  }
  EXPECT_LT(apart / sum, 0.02);
}

}  // namespace
}  // namespace nf::test
