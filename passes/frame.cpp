// The frame.
#include "frame.h"

#include "energy.h"
#include "marcher.h"
#include "scene/camera.h"
#include "scene/peaks.h"

namespace nf::passes {

std::vector<ParamBlock> FrameSettings::blocks() {
  std::vector<ParamBlock> all = {{&GiParams::table(), &gi.shared},      {&MaterialParams::table(), &material},
                                 {&LightParams::table(), &lights},      {&ShadowParams::table(), &shadow},
                                 {&FeedbackParams::table(), &feedback}, {&ResolutionParams::table(), &resolution},
                                 {&TemporalParams::table(), &temporal}, {&DenoiseParams::table(), &denoise},
                                 {&TaaParams::table(), &taa},           {&TonemapParams::table(), &tonemap},
                                 {&DebugParams::table(), &debug}};
  for (const Technique& t : techniques())
    if (const ParamBlock block = t.params(gi); block.table) all.push_back(block);
  return all;
}

void set_paper_mode(FrameSettings& settings) {
  if (settings.technique->paper_mode.empty())
    fail(Exit::Usage, "{} has no paper mode: leave --mode away or use --mode radiometric", settings.technique->id);
  for (const char* assignment : settings.technique->paper_mode) params::assign(settings.blocks(), assignment);
}

bool finds_radius(const FrameSettings& settings) {
  return settings.technique->finds_radius && settings.technique->finds_radius(settings.gi);
}

void find_radius(FrameSettings& settings, const scene::Scene& scene) {
  const float found = finds_radius(settings) ? scene::peak_distance(scene) : 0;
  if (found > 0) settings.gi.shared.radius = found;
}

void FrameSettings::switch_off_reconstruction() {
  feedback.reprojection = 0;
  resolution.gi = 0;
  resolution.overscan = 0;
  resolution.edge_fade = 0;
  temporal.enabled = 0;
  denoise.method = 0;
  taa.enabled = 0;
}

std::vector<const ParamTable*> inner_tables() {
  return {&FrameBlock::table(),         &AccumulateBlock::table(),  &SunBlock::table(),     &ShadowViewBlock::table(),
          &LightViewBlock::table(),     &EnvironmentBlock::table(), &DeformBlock::table(),  &ReprojectBlock::table(),
          &TemporalBlock::table(),      &DenoiseBlock::table(),     &TaaBlock::table(),     &SplitBlock::table(),
          &EdgeFadeBlock::table(),      &UpsampleBlock::table(),    &CropBlock::table(),    &FeedbackBlock::table(),
          &FeedbackMergeBlock::table(), &MarcherBlock::table(),     &NanScanBlock::table(), &InspectBlock::table()};
}

gpu::ShaderCompiler make_shader_compiler(const gpu::Device& device, const std::filesystem::path& folder,
                                         const std::filesystem::path& cache) {
  gpu::ShaderCompiler compiler(folder, cache, gpu::shipped_spirv());
  FrameSettings settings;
  for (const ParamBlock& block : settings.blocks()) compiler.add_table(*block.table);
  for (const ParamTable* table : inner_tables()) compiler.add_table(*table);
  if (device.facts.fetch_storage) compiler.add_define("NF_FETCH_STORAGE", "1");
  return compiler;
}

Renderer::Renderer(gpu::Device& device, const scene::Scene& scene, const graph::ExecutorOptions& options)
    : scene_(scene), device_(device) {
  const std::filesystem::path cache = gpu::cache_folder();
  pipelines_ =
      std::make_unique<gpu::Pipelines>(device, make_shader_compiler(device, gpu::find_shader_folder(), cache), cache);
  tables_ = std::make_unique<SceneTables>(device, scene);
  lights_ = std::make_unique<Lights>(device);
  deform_ = create_deform(*pipelines_);
  gbuffer_ = create_gbuffer(*pipelines_, *tables_);
  shadow_ = create_shadow(*pipelines_, *tables_);
  environment_ = create_environment(device, scene.environment);
  lighting_ = create_lighting(*pipelines_, environment_.any());
  blend_ = create_blend(*pipelines_, *tables_, environment_.any());
  gi_ = std::make_unique<GiPipelines>(*pipelines_);
  noise_ = std::make_unique<Noise>(device);
  aovs_ = create_aovs(*pipelines_, environment_.any());
  accumulate_ = create_accumulate(*pipelines_);
  for (const Aov& aov : aovs()) mean_names_.push_back(fmt::format("{}.mean", *aov.name ? aov.name : "final"));
  executor_ = std::make_unique<graph::Executor>(device, *pipelines_, options);
}

Renderer::~Renderer() {
  executor_.reset();
  tables_->destroy_list(camera_draws_);
  for (DrawList& list : shadow_draws_) tables_->destroy_list(list);
  destroy(device_, environment_);
}

void Renderer::update(const scene::Changes& changes) {
  tables_->update(changes);
}

void Renderer::update_environment() {
  EnvironmentMaps maps = create_environment(device_, scene_.environment);
  try {
    LightingPass lighting = create_lighting(*pipelines_, maps.any());
    BlendPass blend = create_blend(*pipelines_, *tables_, maps.any());
    aovs_ = create_aovs(*pipelines_, maps.any());
    lighting_ = std::move(lighting);
    blend_ = std::move(blend);
  } catch (...) {
    destroy(device_, maps);
    throw;
  }
  device_.wait_idle();
  destroy(device_, environment_);
  environment_ = std::move(maps);
}

FrameOutputs Renderer::build(graph::Graph& graph, const FrameView& asked, const FrameSettings& settings) {
  if (settings.technique != last_technique_) graph.forget_histories();
  last_technique_ = settings.technique;
  const bool temporal = settings.reconstruct && settings.temporal.enabled;
  const bool taa = settings.reconstruct && settings.taa.enabled;
  FrameView view = asked;
  if (taa) {
    view.jitter = halton_jitter(view.frame_index);
    view.previous_jitter = halton_jitter(view.previous_frame_index.value_or(view.frame_index - 1));
  }
  // Noise that changes from frame to frame only flickers where nothing averages it.
  const bool averaged = view.averaged || temporal || taa;
  if (!averaged) view.frame_index = 0;
  FrameOutputs out;
  if (settings.reconstruct && settings.resolution.overscan > 0) {
    out.border = overscan_border(view.size, settings.resolution.overscan);
    view = with_border(view, out.border);
  }
  const FrameBlock frame = make_frame_block(view, scene_, settings.material);
  graph.share(frame);
  const Blending blending = Blending(settings.material.blend);
  glm::mat4 culled_with = frame.jittered_clip_from_world;
  if (view.culling_camera) {
    FrameView from = view;
    from.camera = *view.culling_camera;
    culled_with = make_frame_block(from, scene_, settings.material).jittered_clip_from_world;
  }
  tables_->build_draws(camera_draws_, scene::frustum_from_clip(culled_with), view.camera.position, blending);
  const ShadowPlan shadows = plan_shadows(view.camera, view.size, scene_, settings.shadow, blending);
  lights_->update(scene_, view.camera, view.size, view.jitter, shadows, settings.lights);

  const graph::Buf deformed = add_deform(graph, deform_, *tables_);
  out.gbuffer = add_gbuffer(graph, gbuffer_, {view.size.x, view.size.y}, *tables_, camera_draws_, deformed);
  const ShadowMaps maps = add_shadows(graph, shadow_, settings.shadow, shadows, *tables_, shadow_draws_, deformed);
  const DirectLights lights{shadows, maps, *lights_, settings.shadow, settings.lights};
  out.direct = add_direct(graph, lighting_, out.gbuffer, lights);
  const ReprojectBlock reproject = make_reproject_block(view);
  const std::string_view gives = settings.technique->outputs;
  const bool feed = settings.reconstruct && settings.feedback.reprojection && gives.find("gi") != gives.npos;
  PreviousSurface previous;
  if (feed || (temporal && !gives.empty())) previous = keep_surface(graph, out.gbuffer);
  Feedback feedback;
  if (feed) {
    graph.optional(out.direct.radiance);
    feedback = add_feedback(graph, *pipelines_, out.gbuffer, previous, reproject, out.direct, settings.feedback,
                            settings.temporal);
    out.direct.radiance = feedback.radiance;
  }
  if (settings.technique->gathers_specular && settings.technique->gathers_specular(settings.gi)) {
    graph.optional(out.direct.radiance);
    out.direct.radiance = add_specular_source(graph, lighting_, out.direct);
  }
  const PixelGrid grid =
      settings.reconstruct ? make_grid(settings.resolution.gi, view.frame_index, averaged) : PixelGrid{};
  GiSettings gi = settings.gi;
  if (finds_radius(settings)) {
    // Once: a radius that follows what moves would make the light flicker.
    if (!peak_distance_) peak_distance_ = scene::peak_distance(scene_);
    if (*peak_distance_ > 0) gi.shared.radius = *peak_distance_;
  }
  size_t small_picture = 0, inspected_picture = 0;
  if (view.inspect) {
    const glm::ivec2 pixel = glm::ivec2(glm::min(*view.inspect, asked.size - 1u));
    for (size_t i = 0; i < grid.offsets.size(); ++i)
      if ((pixel + out.border - grid.offsets[i]) % grid.factor == glm::ivec2(0)) inspected_picture = i;
    out.inspection = make_inspect_request(gi, pixel, glm::ivec2(view.size), grid.factor,
                                          grid.offsets[inspected_picture], out.border);
  }
  out.gi_raw = add_at_resolution(
      graph, *pipelines_, frame, grid, out.gbuffer, out.direct, settings.resolution,
      [&](const GBuffer& gbuffer, const Radiance& radiance) {
        const bool inspect = view.inspect && small_picture++ == inspected_picture;
        gi_->inspect(inspect);
        return settings.technique->add(
            graph, *gi_, {gbuffer, radiance, environment_, *noise_, inspect ? &out.inspection : nullptr}, gi);
      });
  out.gi = out.gi_raw;
  if (settings.reconstruct) {
    graph::Tex moments;
    if (temporal && out.gi.any()) {
      const Temporal mean =
          add_temporal(graph, *pipelines_, out.gbuffer, previous, reproject, out.gi, settings.temporal);
      out.gi = mean.gi;
      moments = mean.moments;
      if (mean.gi.gi && settings.temporal.firefly_clamp > 0)
        out.clamped_energy = add_energy(graph, *pipelines_, "temporal.clamped", mean.gi.gi);
    }
    out.gi = add_denoise(graph, *pipelines_, out.gbuffer, out.gi, moments, settings.denoise, settings.temporal);
  }
  if (feed)
    out.loop_energy =
        add_feedback_keep(graph, *pipelines_, out.gbuffer, feedback, out.gi, environment_, settings.feedback);
  // Of what is shown only: light that is fed back stays what it is.
  if (settings.reconstruct && settings.resolution.edge_fade > 0)
    out.gi = add_edge_fade(graph, *pipelines_, out.gbuffer, out.gi, environment_,
                           0.01f * settings.resolution.edge_fade * float(asked.size.y));
  out.lit = add_composite(graph, lighting_, out.gbuffer, out.direct, out.gi, *tables_, environment_);
  add_blend(graph, blend_, out.lit, out.gbuffer, lights, *tables_, camera_draws_, deformed, environment_);
  if (taa) out.lit = add_taa(graph, *pipelines_, out.gbuffer, reproject, out.lit, settings.taa);
  if (out.border != glm::ivec2(0)) out.lit = add_crop(graph, *pipelines_, out.lit, out.border);
  // What a frame offers. Whoever runs it reads what he wants to see.
  const graph::Tex offered[] = {out.gbuffer.depth,    out.gbuffer.normal,
                                out.gbuffer.albedo,   out.gbuffer.material,
                                out.gbuffer.emissive, out.gbuffer.velocity,
                                out.direct.diffuse,   out.direct.specular,
                                out.direct.radiance,  out.gi_raw.visibility,
                                out.gi_raw.bent,      out.gi_raw.gi,
                                out.gi_raw.ambient,   out.gi.visibility,
                                out.gi.bent,          out.gi.gi,
                                out.gi.ambient,       out.lit};
  if (settings.debug.nan_scan) out.nan_scan = add_nan_scan(graph, *pipelines_, offered);
  for (const graph::Tex tex : offered) graph.optional(tex);
  return out;
}

graph::Tex Renderer::add_picture(graph::Graph& graph, const FrameOutputs& outputs, const FrameSettings& settings,
                                 int64_t mean_frame) {
  const graph::Tex lit = mean_frame < 0 ? outputs.lit
                                        : add_accumulate(graph, accumulate_, "picture.mean", outputs.lit,
                                                         VK_FORMAT_R32G32B32A32_SFLOAT, uint32_t(mean_frame));
  return add_tonemap(graph, lighting_, lit, settings.tonemap);
}

graph::Tex Renderer::add_layer(graph::Graph& graph, const FrameOutputs& outputs, const Aov& aov, int64_t mean_frame) {
  graph::Tex value = add_aov(graph, aovs_, aov, outputs, *tables_, environment_);
  if (value && *aov.name && outputs.border != glm::ivec2(0))
    value = add_crop(graph, *pipelines_, value, outputs.border);
  if (!value || mean_frame < 0) return value;
  return add_accumulate(graph, accumulate_, mean_names_[size_t(&aov - aovs().data())].c_str(), value, aov.format,
                        uint32_t(mean_frame));
}

}  // namespace nf::passes
