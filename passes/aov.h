// Output layers (AOVs): a table of what a frame can write out, each made by one full-screen pass that decodes it to
// floats.
#pragma once

#include <span>
#include <string_view>

#include "gi/inspect.h"
#include "lighting.h"
#include "nan_scan.h"

namespace nf::passes {

// Everything an AOV can be made of.
struct FrameOutputs {
  GBuffer gbuffer;
  Radiance direct;
  GiResult gi, gi_raw;  // after reconstruction, and before
  graph::Tex lit;
  // 1x1 RGBA32F, where the stage is on. Feedback: x / y is the loop's gain, light fed back per light gathered from. The
  // firefly clamp: y / (x + y) is the share of the light that it took.
  graph::Tex loop_energy, clamped_energy;
  NanScan nan_scan;           // debug.nan_scan
  InspectRequest inspection;  // FrameView::inspect; its records are to be read back
  glm::ivec2 border{0};       // pixels of overscan on each side that all but `lit` still have
};

struct Aov {
  const char* name;      // as in the EXR file; "" is the final radiance
  const char* channels;  // of the EXR layer
  const char* help;
  VkFormat format;
  const char* define;  // of aov.frag
};
std::span<const Aov> aovs();
// Throws nf::Error (Exit::Input) naming the layers there are.
const Aov& find_aov(std::string_view name);

struct AovPass {
  std::vector<gpu::Pipeline> pipelines;     // by row of aovs()
  gpu::Pipeline ambient[ambient_variants];  // by ambient_variant(), instead of the row
};
AovPass create_aovs(gpu::Pipelines& pipelines, bool environment_map);

// Adds the pass; the image holds the layer's floats. Invalid when this frame does not have what the layer shows.
graph::Tex add_aov(graph::Graph& graph, const AovPass& pass, const Aov& aov, const FrameOutputs& outputs,
                   const SceneTables& scene, const EnvironmentMaps& environment);

}  // namespace nf::passes
