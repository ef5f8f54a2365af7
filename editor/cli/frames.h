// Frames as commands run them: one at a time, with pass times, and layers and pictures read back.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "capture/statistics.h"
#include "frame.h"
#include "image/image.h"

namespace nf::editor {

struct FrameRequest {
  std::span<const passes::Aov* const> layers;
  bool picture = false;
  int64_t mean = -1;  // number of this frame in the running mean that is read back; below 0 this frame itself
  gpu::Timing timing = gpu::Timing::Serialize;
  bool forget = false;  // histories start anew
};

// Builds, runs and waits for one frame. Its read-backs are the executor's until the next: the layers in their order,
// what the frame measures of itself, then the picture. They are part of every frame, so that the plan is the same and
// the passes are not culled.
graph::FrameResult run_frame(passes::Renderer& renderer, passes::FrameView& view, const passes::FrameSettings& settings,
                             const FrameRequest& request);

// The means of layers over frames from no history on; empty: interrupted.
std::vector<image::Layer> mean_layers(passes::Renderer& renderer, passes::FrameView view,
                                      const passes::FrameSettings& settings, std::span<const passes::Aov* const> layers,
                                      uint32_t frames);

// The samples of one pixel, which costs a frame; nothing where the technique does not tell them.
std::optional<passes::Inspection> inspect_pixel(passes::Renderer& renderer, passes::FrameView view,
                                                const passes::FrameSettings& settings, glm::uvec2 pixel);

// Those of the layers that this frame has: a technique may lack some.
std::vector<const passes::Aov*> layers_given(passes::Renderer& renderer, const passes::FrameView& view,
                                             const passes::FrameSettings& settings,
                                             std::span<const passes::Aov* const> layers);

// Times of passes by name, in the order of the frame; 0 in a frame that did without the pass.
struct PassTimes {
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> ms;
  std::vector<double> frame_ms;
  // Read-backs are one row: there is one for each layer.
  void add(const graph::FrameResult& frame);
  std::vector<std::pair<std::string, capture::Statistics>> rows() const;
};
nlohmann::json times_json(const std::vector<std::pair<std::string, capture::Statistics>>& rows);

image::Layer to_layer(const passes::Aov& aov, const graph::Readback& readback);
image::Image8 to_image8(const graph::Readback& readback);  // of RGBA8

}  // namespace nf::editor
