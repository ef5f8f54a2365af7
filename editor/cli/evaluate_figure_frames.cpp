// Figures that need frames one after another: the noise of a single frame, stage by stage, and the holes that a moved
// camera leaves in what is fed back; and those of direct light.
#include <cmath>

#include "cli/evaluate.h"
#include "graph/probe.h"
#include "scene/gltf.h"
#include "scene/view.h"

namespace nf::editor {
namespace {

using nlohmann::json;

// Means of `side` x `side` pixels; what does not fill a block is left out.
image::Image blocks(const image::Image& in, uint32_t side) {
  image::Image out{in.width / side, in.height / side, in.channels, {}};
  out.pixels.assign(size_t(out.width) * out.height * out.channels, 0);
  const float share = 1.0f / float(side * side);
  for (uint32_t y = 0; y < out.height * side; ++y)
    for (uint32_t x = 0; x < out.width * side; ++x)
      for (uint32_t c = 0; c < in.channels; ++c)
        out.pixels[(size_t(y / side) * out.width + x / side) * in.channels + c] +=
            share * in.pixels[(size_t(y) * in.width + x) * in.channels + c];
  return out;
}

// The row of a resource; the last pass of a name.
uint16_t resource_row(const graph::Graph& graph, std::string_view name) {
  for (size_t i = 0; i < graph.resources.size(); ++i)
    if (graph.resources[i].name == name) return uint16_t(i);
  fail(Exit::Input, "no '{}' in the frame: set feedback.reprojection", name);
}
uint32_t last_pass(const graph::Graph& graph, std::string_view name) {
  for (size_t i = graph.passes.size(); i-- > 0;)
    if (graph.passes[i].name == name) return uint32_t(i);
  fail(Exit::Input, "no pass '{}' in the frame", name);
}

scene::Camera moved_camera(scene::Camera camera, const glm::vec3& by, float degrees) {
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
  camera.position += right * by.x + camera.up * by.y - camera.forward * by.z;
  camera.forward = glm::mat3(glm::rotate(glm::mat4(1), glm::radians(degrees), camera.up)) * camera.forward;
  return camera;
}

}  // namespace

FrameStage::FrameStage(gpu::Device& device, const EvaluateOptions& options, const Place& place)
    : options_(options), scene_(scene::load_gltf(place.scene)) {
  view_.size = parse_size(options.size);
  view_.camera = view_.previous_camera = scene::select_view(place.view, scene_);
  renderer_ = std::make_unique<passes::Renderer>(device, scene_, executor_options(options));
}

// Two runs that share nothing but the scene: half the mean square of their difference is the variance.
json FrameStage::noise(const passes::FrameSettings& settings, uint32_t frames) {
  const passes::Aov& layer = passes::find_aov("gi");
  const passes::Aov* const layers[] = {&layer};
  double difference[2] = {}, mean = 0;
  size_t counts[2] = {}, count = 0;
  for (uint32_t pair = 0; pair < options_.frames / 2; ++pair) {
    image::Image last[2];
    for (uint32_t run = 0; run < 2; ++run) {
      passes::FrameView view = view_;
      view.seed = options_.seed + 2 * pair + run;
      for (uint32_t n = 0; n < frames; ++n) {
        if (interrupted()) return nullptr;
        view.frame_index = n;
        run_frame(*renderer_, view, settings, {.layers = layers, .forget = n == 0});
      }
      last[run] = to_layer(layer, renderer_->executor().take_readbacks().front()).image;
    }
    for (const uint32_t side : {1u, 4u}) {
      const image::Image a = blocks(last[0], side), b = blocks(last[1], side);
      for (size_t i = 0; i < a.pixels.size(); ++i) {
        const double apart = double(a.pixels[i]) - double(b.pixels[i]);
        difference[side == 4] += apart * apart / 2;
        ++counts[side == 4];
        if (side == 1) mean += (double(a.pixels[i]) + double(b.pixels[i])) / 2, ++count;
      }
    }
  }
  mean /= double(count);
  return {{"pixel", difference[0] / double(counts[0]) / (mean * mean)},
          {"4x4", difference[1] / double(counts[1]) / (mean * mean)}};
}

json FrameStage::holes(const passes::FrameSettings& settings, const glm::vec3& by, float degrees) {
  const size_t pixels = size_t(view_.size.x) * view_.size.y;
  const scene::Camera from = moved_camera(view_.camera, by, degrees);
  // One frame; what was fed back, RGBA, and the same with its holes filled.
  std::vector<float> fed, filled;
  const auto frame = [&](passes::FrameView& view, bool forget) {
    graph::Graph graph(renderer_->executor().histories());
    if (forget) graph.forget_histories();
    const passes::FrameOutputs outputs = renderer_->build(graph, view, settings);
    graph.readback("readback.picture", renderer_->add_picture(graph, outputs, settings));
    const graph::Probe probes[] = {
        {.pass = last_pass(graph, "feedback.pull"),
         .resource = resource_row(graph, "feedback.filled"),
         .name = "probe.filled"},
        {.pass = last_pass(graph, settings.feedback.reprojection == 1 ? "feedback.gather" : "feedback.take"),
         .resource = resource_row(graph, "feedback.fed"),
         .name = "probe.fed"}};
    for (const graph::Probe& probe : probes)
      if (const std::string fault = graph::add_probe(graph, probe); !fault.empty()) fail(Exit::Input, "{}", fault);
    renderer_->executor().run(graph, {});
    view.previous_camera = view.camera;
    renderer_->executor().finish();
    const std::vector<graph::Readback> readbacks = renderer_->executor().take_readbacks();
    uint32_t channels = 0;
    fed = graph::to_floats(*graph::find_readback(readbacks, "probe.fed"), channels);
    filled = graph::to_floats(*graph::find_readback(readbacks, "probe.filled"), channels);
    NF_CHECK(channels == 4 && fed.size() == pixels * 4, "fed has {} channels, {} values", channels, fed.size());
  };
  // Two means of runs that differ in noise alone: a hole is one in all of them.
  image::Image none{view_.size.x, view_.size.y, 3, std::vector<float>(pixels * 3, 0)};
  image::Halves made{none, none}, truth{none, none};
  std::vector<uint8_t> hole(pixels), empty(pixels);
  const uint32_t each = 4 * ((options_.frames + 1) / 2);
  for (uint32_t run = 0; run < 2 * each; ++run) {
    if (interrupted()) return nullptr;
    const auto add = [&](image::Halves& to, const std::vector<float>& light) {
      std::vector<float>& sum = (run % 2 ? to.b : to.a).pixels;
      for (size_t i = 0; i < pixels * 3; ++i) sum[i] += light[i / 3 * 4 + i % 3] / float(each);
    };
    passes::FrameView view = view_;
    view.seed = options_.seed + run;
    view.camera = view.previous_camera = from;
    frame(view, true);
    view.frame_index = 1, view.camera = view_.camera;
    frame(view, false);
    for (size_t i = 0; i < pixels; ++i) {
      hole[i] = !(fed[4 * i + 3] > 0);
      empty[i] = !(filled[4 * i + 3] > 0);
    }
    add(made, filled);
    // What the frame before would have fed back, had the camera been here.
    view.camera = view.previous_camera = view_.camera;
    view.frame_index = 0;
    frame(view, true);
    view.frame_index = 1;
    frame(view, false);
    add(truth, fed);
  }
  const passes::Aov* const depth_layer[] = {&passes::find_aov("depth")};
  passes::FrameView view = view_;
  run_frame(*renderer_, view, settings, {.layers = depth_layer});
  const std::vector<float> depth =
      to_layer(*depth_layer[0], renderer_->executor().take_readbacks().front()).image.pixels;
  std::vector<uint8_t> surface(pixels), others(pixels);
  size_t surfaces = 0, holes = 0, left = 0;
  for (size_t i = 0; i < pixels; ++i) {
    surface[i] = depth[i] > 0;
    others[i] = surface[i] && !hole[i];
    hole[i] = surface[i] && hole[i];
    surfaces += surface[i], holes += hole[i], left += surface[i] && empty[i];
  }
  const image::Image mean = image::mean_of(truth);
  const double average = image::bias({mean, mean, surface}).reference;
  const auto rmse = [&](const std::vector<uint8_t>& mask, size_t count) {
    if (!count || !(average > 0)) return json();
    const image::ErrorPart part = image::error_between(made, truth, mask);
    return json{{"rmse", part.rmse / average}, {"floor", part.floor / average}};
  };
  return {{"holes", double(holes) / double(surfaces)},
          {"holes left", double(left) / double(surfaces)},
          {"rmse of holes", rmse(hole, holes)},
          {"rmse of others", rmse(others, surfaces - holes)}};
}

image::Image FrameStage::mean(const passes::FrameSettings& settings, const char* name, uint32_t seed, uint32_t frames) {
  const passes::Aov* const layers[] = {&passes::find_aov(name)};
  passes::FrameView view = view_;
  view.seed = seed;
  std::vector<image::Layer> means = mean_layers(*renderer_, view, settings, layers, frames);
  return means.empty() ? image::Image() : std::move(means.front().image);
}

json FrameStage::direct(const passes::FrameSettings& of, TruthStore& store, image::Image& seen, image::Image& truth) {
  passes::FrameSettings settings = of, lit = of;
  settings.reconstruct = lit.reconstruct = false;
  lit.shadow.enabled = false;
  const Truth* traced = store.direct(scene_, view_.camera, settings);
  if (!traced) return nullptr;
  const uint32_t half = (options_.frames + 1) / 2;
  const image::Halves test{mean(settings, "direct_diffuse", 2 * options_.seed, half),
                           mean(settings, "direct_diffuse", 2 * options_.seed + 1, half)};
  const image::Image open = mean(lit, "direct_diffuse", options_.seed, 1), depth = mean(lit, "depth", options_.seed, 1);
  if (interrupted()) return nullptr;
  const image::Halves& path = traced->at("direct_diffuse");
  uint64_t left_out = 0;
  const std::vector<uint8_t> mask = image::common_surfaces(depth.pixels, traced->at("depth").a.pixels, left_out);
  seen = image::mean_of(test), truth = image::mean_of(path);
  const double average = image::bias({truth, truth, mask}).reference;
  if (!(average > 0)) fail(Exit::Input, "there is no direct light in this view: give it a lamp");
  // Where light could arrive, the share that does not.
  const auto sum = [](const image::Image& light, size_t pixel) {
    double all = 0;
    for (uint32_t c = 0; c < 3; ++c) all += double(light.pixels[pixel * light.channels + c]);
    return all;
  };
  double dark[2] = {}, pixels[2] = {};  // where the path tracer has light, and where it has shadow
  for (size_t p = 0; p < mask.size(); ++p) {
    const double most = sum(open, p);
    if (!mask[p] || most <= 0) continue;
    const bool shadow = sum(truth, p) < 0.5 * most;
    dark[shadow] += 1 - sum(seen, p) / most;
    pixels[shadow] += 1;
  }
  const image::ErrorPart part = image::error_between(test, path, mask);
  const auto share = [&](bool shadow) { return pixels[shadow] > 0 ? json(dark[shadow] / pixels[shadow]) : json(); };
  return {{"rmse", {{"rmse", part.rmse / average}, {"floor", part.floor / average}}},
          {"bias", part.bias / average},
          {"shadow found", share(true)},
          {"shadow made up", share(false)}};
}

}  // namespace nf::editor
