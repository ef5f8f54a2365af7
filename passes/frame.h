// The whole frame, top to bottom, and what a program needs to run it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "accumulate.h"
#include "aov.h"
#include "blend.h"
#include "denoise.h"
#include "feedback.h"
#include "gi/techniques.h"
#include "graph/executor.h"
#include "resolution.h"
#include "taa.h"
#include "view.h"

namespace nf::passes {

// Everything a user can set. The technique and the modes change the graph; values never do.
struct FrameSettings {
  const Technique* technique = &find_technique("vbgi");
  GiSettings gi;
  MaterialParams material;
  LightParams lights;
  ShadowParams shadow;
  TonemapParams tonemap;
  // Reconstruction runs as its parameters say, or, for who measures the technique itself, not at all.
  bool reconstruct = false;
  FeedbackParams feedback;
  ResolutionParams resolution;
  TemporalParams temporal;
  DenoiseParams denoise;
  TaaParams taa;
  DebugParams debug;

  // Tables of everything, for --set, presets and help.
  std::vector<ParamBlock> blocks();
  // Every stage of reconstruction off, each by its own parameter: a later assignment can switch it on again.
  void switch_off_reconstruction();
};

// Whether the technique, as set, takes the scene's own radius for gi.radius. A Renderer does so by itself; who makes a
// reference of the settings gives them that radius first, as far as the scene has one.
bool finds_radius(const FrameSettings& settings);
void find_radius(FrameSettings& settings, const scene::Scene& scene);

// Applies the technique's paper form to the parameters. Throws nf::Error (Exit::Usage) when it has none.
void set_paper_mode(FrameSettings& settings);

// Device, pipelines, scene tables and executor of one view.
class Renderer {
 public:
  Renderer(gpu::Device& device, const scene::Scene& scene, const graph::ExecutorOptions& options = {});
  ~Renderer();

  // After scene::animate() or update(), at most once a frame: copies what changed.
  void update(const scene::Changes& changes);

  // After the scene's environment was replaced: its maps, and the shaders' variants that read them. Waits for the
  // device; filtering a map takes the CPU a while. Throws nf::Error as the constructor does; then all is as before.
  void update_environment();

  // Adds all passes up to `lit`. The graph refers to this renderer's tables and must run before the next build(). With
  // another technique than the last time, all histories start anew.
  FrameOutputs build(graph::Graph& graph, const FrameView& view, const FrameSettings& settings);

  // Tone-maps `lit`, or its mean over frames when `mean_frame` >= 0 (which is then this frame's number): RGBA8.
  graph::Tex add_picture(graph::Graph& graph, const FrameOutputs& outputs, const FrameSettings& settings,
                         int64_t mean_frame = -1);
  // The floats of a layer, or their mean. Invalid when this frame does not have what the layer shows.
  graph::Tex add_layer(graph::Graph& graph, const FrameOutputs& outputs, const Aov& aov, int64_t mean_frame = -1);

  gpu::Pipelines& pipelines() { return *pipelines_; }
  graph::Executor& executor() { return *executor_; }
  uint32_t draws() const { return camera_draws_.draws; }
  size_t batches() const { return camera_draws_.batches.size(); }

 private:
  const scene::Scene& scene_;
  std::unique_ptr<gpu::Pipelines> pipelines_;
  std::unique_ptr<SceneTables> tables_;
  std::unique_ptr<Lights> lights_;
  DrawList camera_draws_;
  std::vector<DrawList> shadow_draws_;  // two a map
  DeformPass deform_;
  GBufferPass gbuffer_;
  ShadowPass shadow_;
  LightingPass lighting_;
  BlendPass blend_;
  std::unique_ptr<GiPipelines> gi_;
  std::unique_ptr<Noise> noise_;
  AovPass aovs_;
  AccumulatePass accumulate_;
  gpu::Device& device_;
  EnvironmentMaps environment_;
  const Technique* last_technique_ = nullptr;
  std::optional<float> peak_distance_;         // of the scene as it stood when first asked for
  std::vector<std::string> mean_names_;        // by row of aovs()
  std::unique_ptr<graph::Executor> executor_;  // last: goes first
};

// Tables of blocks that no user sets.
std::vector<const ParamTable*> inner_tables();

// Compiles shaders with every table of the passes and the device's facts; also what tests use for shaders of their own.
gpu::ShaderCompiler make_shader_compiler(const gpu::Device& device, const std::filesystem::path& folder,
                                         const std::filesystem::path& cache);

}  // namespace nf::passes
