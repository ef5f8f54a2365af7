// The frame.
#include "frame.h"

#include "scene/camera.h"

namespace nf::passes {

std::vector<ParamBlock> FrameSettings::blocks() {
  std::vector<ParamBlock> all = {{&GiParams::table(), &gi.shared},      {&MaterialParams::table(), &material},
                                 {&LightParams::table(), &lights},      {&ShadowParams::table(), &shadow},
                                 {&TemporalParams::table(), &temporal}, {&DenoiseParams::table(), &denoise},
                                 {&TaaParams::table(), &taa},           {&TonemapParams::table(), &tonemap}};
  for (const Technique& t : techniques())
    if (const ParamBlock block = t.params(gi); block.table) all.push_back(block);
  return all;
}

void set_paper_mode(FrameSettings& settings) {
  if (settings.technique->paper_mode.empty())
    fail(Exit::Usage, "{} has no paper mode: leave --mode away or use --mode radiometric", settings.technique->id);
  for (const char* assignment : settings.technique->paper_mode) params::assign(settings.blocks(), assignment);
}

void FrameSettings::switch_off_reconstruction() {
  temporal.enabled = 0;
  denoise.method = 0;
  taa.enabled = 0;
}

std::vector<const ParamTable*> inner_tables() {
  return {&FrameBlock::table(),     &AccumulateBlock::table(),  &SunBlock::table(),    &ShadowViewBlock::table(),
          &LightViewBlock::table(), &EnvironmentBlock::table(), &DeformBlock::table(), &ReprojectBlock::table(),
          &TemporalBlock::table(),  &DenoiseBlock::table(),     &TaaBlock::table()};
}

gpu::ShaderCompiler make_shader_compiler(const gpu::Device& device, const std::filesystem::path& folder,
                                         const std::filesystem::path& cache) {
  gpu::ShaderCompiler compiler(folder, cache);
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
  noise_ = std::make_unique<Noise>(device, cache);
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

FrameOutputs Renderer::build(graph::Graph& graph, const FrameView& asked, const FrameSettings& settings) {
  if (settings.technique != last_technique_) graph.forget_histories();
  last_technique_ = settings.technique;
  const bool temporal = settings.reconstruct && settings.temporal.enabled;
  const bool taa = settings.reconstruct && settings.taa.enabled;
  FrameView view = asked;
  if (taa) {
    view.jitter = halton_jitter(view.frame_index);
    view.previous_jitter = halton_jitter(view.frame_index - 1);
  }
  // Noise that changes from frame to frame only flickers where nothing averages it.
  if (!view.averaged && !temporal && !taa) view.frame_index = 0;
  const FrameBlock frame = make_frame_block(view, scene_, settings.material);
  graph.share(frame);
  const Blending blending = Blending(settings.material.blend);
  tables_->build_draws(camera_draws_, scene::frustum_from_clip(frame.jittered_clip_from_world), view.camera.position,
                       blending);
  const ShadowPlan shadows = plan_shadows(view.camera, view.size, scene_, settings.shadow, blending);
  lights_->update(scene_, view.camera, view.size, view.jitter, shadows, settings.lights);

  FrameOutputs out;
  const graph::Buf deformed = add_deform(graph, deform_, *tables_);
  out.gbuffer = add_gbuffer(graph, gbuffer_, {view.size.x, view.size.y}, *tables_, camera_draws_, deformed);
  const ShadowMaps maps = add_shadows(graph, shadow_, settings.shadow, shadows, *tables_, shadow_draws_, deformed);
  const DirectLights lights{shadows, maps, *lights_, settings.shadow, settings.lights};
  out.direct = add_direct(graph, lighting_, out.gbuffer, lights);
  out.gi_raw = settings.technique->add(graph, *gi_, {out.gbuffer, out.direct, environment_, *noise_}, settings.gi);
  out.gi = out.gi_raw;
  const ReprojectBlock reproject = make_reproject_block(view);
  if (settings.reconstruct) {
    graph::Tex moments;
    if (temporal && out.gi.any()) {
      const PreviousSurface previous = keep_surface(graph, out.gbuffer);
      const Temporal mean =
          add_temporal(graph, *pipelines_, out.gbuffer, previous, reproject, out.gi, settings.temporal);
      out.gi = mean.gi;
      moments = mean.moments;
    }
    out.gi = add_denoise(graph, *pipelines_, out.gbuffer, out.gi, moments, settings.denoise, settings.temporal);
  }
  out.lit = add_composite(graph, lighting_, out.gbuffer, out.direct, out.gi, *tables_, environment_);
  add_blend(graph, blend_, out.lit, out.gbuffer, lights, *tables_, camera_draws_, deformed, environment_);
  if (taa) out.lit = add_taa(graph, *pipelines_, out.gbuffer, reproject, out.lit, settings.taa);
  // What a frame offers. Whoever runs it reads what he wants to see.
  for (const graph::Tex offered :
       {out.gbuffer.depth, out.gbuffer.normal, out.gbuffer.albedo, out.gbuffer.material, out.gbuffer.emissive,
        out.gbuffer.velocity, out.direct.diffuse, out.direct.specular, out.direct.radiance, out.gi_raw.visibility,
        out.gi_raw.bent, out.gi_raw.gi, out.gi_raw.ambient, out.gi.visibility, out.gi.bent, out.gi.gi, out.gi.ambient,
        out.lit})
    graph.optional(offered);
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
  const graph::Tex value = add_aov(graph, aovs_, aov, outputs, *tables_, environment_);
  if (!value || mean_frame < 0) return value;
  return add_accumulate(graph, accumulate_, mean_names_[size_t(&aov - aovs().data())].c_str(), value, aov.format,
                        uint32_t(mean_frame));
}

}  // namespace nf::passes
