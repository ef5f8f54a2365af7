// One frame, its times, and its read-backs as pictures.
#include "cli/frames.h"

#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "core/log.h"
#include "graph/probe.h"

namespace nf::editor {

namespace {

void tell_non_finite(const passes::NanScan& scan, const std::vector<graph::Readback>& readbacks, uint32_t frame) {
  const graph::Readback* found = graph::find_readback(readbacks, "readback.nan_scan");
  if (!found) return;
  for (const passes::NonFiniteTexels& image : read_nan_scan(scan, *found))
    if (image.any())
      log::error("frame {}: '{}' has {} texels with NaN and {} infinite ones, the first at {},{}", frame, image.image,
                 image.nan, image.inf, image.first.x, image.first.y);
}

}  // namespace

graph::FrameResult run_frame(passes::Renderer& renderer, passes::FrameView& view, const passes::FrameSettings& settings,
                             const FrameRequest& request) {
  graph::Graph graph(renderer.executor().histories());
  if (request.forget) graph.forget_histories();
  const passes::FrameOutputs outputs = renderer.build(graph, view, settings);
  for (const passes::Aov* aov : request.layers)
    graph.readback("readback.layer", renderer.add_layer(graph, outputs, *aov, request.mean));
  if (outputs.loop_energy) graph.readback("readback.loop_energy", outputs.loop_energy);
  if (outputs.clamped_energy) graph.readback("readback.clamped_energy", outputs.clamped_energy);
  if (outputs.nan_scan.found) graph.readback("readback.nan_scan", outputs.nan_scan.found);
  if (request.picture || request.layers.empty())
    graph.readback("readback.picture", renderer.add_picture(graph, outputs, settings, request.mean));
  renderer.executor().run(graph, {.timing = request.timing});
  view.previous_camera = view.camera;
  graph::FrameResult result = renderer.executor().finish();
  if (outputs.nan_scan.found) tell_non_finite(outputs.nan_scan, renderer.executor().take_readbacks(), view.frame_index);
  return result;
}

std::optional<passes::Inspection> inspect_pixel(passes::Renderer& renderer, passes::FrameView view,
                                                const passes::FrameSettings& settings, glm::uvec2 pixel) {
  view.inspect = pixel;
  graph::Graph graph;
  const passes::FrameOutputs outputs = renderer.build(graph, view, settings);
  if (!outputs.inspection.records) return {};
  graph.readback("readback.inspection", outputs.inspection.records);
  renderer.executor().run(graph);
  renderer.executor().finish();
  return passes::read_inspection(outputs.inspection, renderer.executor().take_readbacks().front());
}

std::vector<const passes::Aov*> layers_given(passes::Renderer& renderer, const passes::FrameView& view,
                                             const passes::FrameSettings& settings,
                                             std::span<const passes::Aov* const> layers) {
  graph::Graph graph;
  const passes::FrameOutputs outputs = renderer.build(graph, view, settings);
  std::vector<const passes::Aov*> given;
  for (const passes::Aov* aov : layers)
    if (renderer.add_layer(graph, outputs, *aov)) given.push_back(aov);
  return given;
}

void PassTimes::add(const graph::FrameResult& frame) {
  std::map<std::string, double> merged;
  std::vector<std::string> here;
  for (const graph::PassTime& pass : frame.passes) {
    const std::string name = std::string_view(pass.name).starts_with("readback.") ? "readback" : pass.name;
    if (!merged.count(name)) here.push_back(name);
    merged[name] += pass.ms;
  }
  for (const std::string& name : here)
    if (!ms.count(name)) {
      order.push_back(name);
      ms[name].assign(frame_ms.size(), 0.0);
    }
  if (frame.passes.empty()) return;
  for (const std::string& name : order) ms[name].push_back(merged.count(name) ? merged[name] : 0.0);
  frame_ms.push_back(frame.frame_ms);
}

std::vector<std::pair<std::string, capture::Statistics>> PassTimes::rows() const {
  std::vector<std::pair<std::string, capture::Statistics>> rows;
  for (const std::string& name : order) rows.emplace_back(name, capture::statistics(ms.at(name)));
  return rows;
}

image::Layer to_layer(const passes::Aov& aov, const graph::Readback& readback) {
  uint32_t have = 0;
  const std::vector<float> floats = graph::to_floats(readback, have);
  image::Layer layer{.name = aov.name, .channels = aov.channels, .image = {}};
  const uint32_t wanted = uint32_t(layer.channels.size());
  layer.image = {readback.desc.size.width, readback.desc.size.height, wanted,
                 std::vector<float>(floats.size() / have * wanted)};
  for (size_t texel = 0; texel < floats.size() / have; ++texel)
    for (uint32_t c = 0; c < wanted; ++c) layer.image.pixels[texel * wanted + c] = floats[texel * have + c];
  return layer;
}

std::vector<image::Layer> mean_layers(passes::Renderer& renderer, passes::FrameView view,
                                      const passes::FrameSettings& settings, std::span<const passes::Aov* const> layers,
                                      uint32_t frames) {
  for (uint32_t n = 0; n < frames; ++n) {
    if (interrupted()) return {};
    view.frame_index = n;
    run_frame(renderer, view, settings, {.layers = layers, .mean = n, .forget = n == 0});
  }
  const std::vector<graph::Readback> readbacks = renderer.executor().take_readbacks();
  std::vector<image::Layer> out;
  for (size_t i = 0; i < layers.size(); ++i) out.push_back(to_layer(*layers[i], readbacks[i]));
  return out;
}

image::Image8 to_image8(const graph::Readback& readback) {
  image::Image8 out{readback.desc.size.width, readback.desc.size.height, 3, {}};
  out.pixels.reserve(readback.texels.size() / 4 * 3);
  for (size_t i = 0; i < readback.texels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) out.pixels.push_back(uint8_t(readback.texels[i + c]));
  return out;
}

nlohmann::json times_json(const std::vector<std::pair<std::string, capture::Statistics>>& rows) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& [name, s] : rows)
    out.push_back({{"path", name},
                   {"gpu_ms",
                    {{"count", s.count},
                     {"min", s.min},
                     {"median", s.median},
                     {"p95", s.p95},
                     {"p99", s.p99},
                     {"max", s.max},
                     {"mean", s.mean},
                     {"stddev", s.stddev},
                     {"mad", s.mad}}}});
  return out;
}

}  // namespace nf::editor
