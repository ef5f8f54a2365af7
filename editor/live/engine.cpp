#include "live/engine.h"

#include <algorithm>
#include <cstring>

#include "cli/frames.h"
#include "graph/dump.h"
#include "graph/probe.h"
#include "live/graph_info.h"
#include "live/pixel_images.h"
#include "scene/animation.h"
#include "scene/gltf.h"

namespace nf::editor::live {
namespace {

SceneLights lights_of(const scene::Scene& scene) {
  return {scene.directional, scene.punctual, scene.environment.color};
}

SceneInfo describe(const scene::Scene& scene) {
  SceneInfo info{.path = scene.path,
                 .cameras = scene.cameras,
                 .bounds = scene.bounds,
                 .triangles = scene.triangles(),
                 .instances = scene.instances.size(),
                 .materials = scene.materials.size(),
                 .textures = scene.textures.size(),
                 .joints = scene.joints.size(),
                 .lights = lights_of(scene),
                 .environment = scene.environment};
  info.environment.texels.clear();
  for (const scene::Clip& clip : scene.animations.clips) {
    info.clips.push_back(clip.name);
    info.duration = std::max(info.duration, clip.duration);
  }
  return info;
}

Pixels to_pixels(const std::string& name, glm::uvec2 size, uint32_t channels, const std::vector<float>& floats) {
  Pixels out{.size = size, .channels = channels, .name = name};
  const size_t count = size_t(size.x) * size.y;
  out.floats.assign(count * 4, 0);
  for (size_t i = 0; i < count; ++i)
    for (uint32_t c = 0; c < std::min(channels, 4u); ++c) out.floats[i * 4 + c] = floats[i * channels + c];
  return out;
}

Pixels to_pixels(const image::Layer& layer) {
  return to_pixels(layer.name, {layer.image.width, layer.image.height}, layer.image.channels, layer.image.pixels);
}

Pixels to_pixels(const graph::Readback& readback, const std::string& name) {
  uint32_t channels = 0;
  const std::vector<float> floats = graph::to_floats(readback, channels);
  return to_pixels(name, {readback.desc.size.width, readback.desc.size.height}, channels, floats);
}

// Puts the probe into the frame; what is wrong with it comes back.
std::string look_at(graph::Graph& built, const ProbeWanted& wanted) {
  const auto pass = std::find_if(built.passes.begin(), built.passes.end(), [&](const graph::PassRow& row) {
    return wanted.pass == graph::pass_label(built, uint32_t(&row - built.passes.data()));
  });
  const auto resource =
      std::find_if(built.resources.begin(), built.resources.end(), [&](const graph::ResourceRow& row) {
        return wanted.resource == graph::resource_name(built, uint16_t(&row - built.resources.data()));
      });
  if (pass == built.passes.end()) return fmt::format("this frame has no pass '{}'", wanted.pass);
  if (resource == built.resources.end()) return fmt::format("this frame has no resource '{}'", wanted.resource);
  return graph::add_probe(built, {.pass = uint32_t(pass - built.passes.begin()),
                                  .before = wanted.before,
                                  .resource = uint16_t(resource - built.resources.begin()),
                                  .mip = wanted.mip,
                                  .layer = wanted.layer,
                                  .name = "readback.probe"});
}

}  // namespace

void Engine::open(const WorkerOptions& options) {
  close();
  handover = options.handover;
  device = handover ? std::make_unique<gpu::Device>(gpu::SecondUser{handover->owner})
                    : std::make_unique<gpu::Device>(options.device);
  if (scene) renderer = std::make_unique<passes::Renderer>(*device, *scene, options.executor);
  lost = false;
  start_anew();
}

void Engine::close() {
  renderer.reset();
  device.reset();
  handover = nullptr;
  lost = true;
}

void Engine::start_anew() {
  revision = history = failed_revision = ~uint64_t{0};
  hash = 0;
  graph = graph::Graph();
}

SceneInfo Engine::load(const Command& command, const WorkerOptions& options) {
  auto loaded = std::make_unique<scene::Scene>(scene::load_gltf(command.path));
  scene::animate(*loaded, 0);
  const SceneLights own = lights_of(*loaded);
  const scene::Environment own_environment = loaded->environment;
  scene::Camera start = scene::select_view(command.view, *loaded);
  if (command.lit) {
    scene::apply_view(*command.lit, *loaded);
    if (command.lit->camera) start = *command.lit->camera;
  }
  renderer.reset();
  scene = std::move(loaded);
  time = 0;
  ++serial;
  lights = ~uint64_t{0};
  start_anew();
  if (device) renderer = std::make_unique<passes::Renderer>(*device, *scene, options.executor);
  SceneInfo info = describe(*scene);
  info.serial = serial;
  info.start = start;
  info.own_lights = own;
  info.own_environment =
      own_environment.kind == scene->environment.kind && own_environment.file == scene->environment.file;
  return info;
}

SceneInfo Engine::surround(const std::string& path) {
  scene::Environment map = scene::load_environment_map(path);
  scene->environment = std::move(map);
  if (renderer) renderer->update_environment();
  revision = history = ~uint64_t{0};
  SceneInfo info = describe(*scene);
  info.own_environment = false;
  return info;
}

// The scene at this frame's time, with the lights as wanted.
void Engine::move(const Wanted& wanted, bool anew) {
  if (wanted.lights_revision != lights) {
    lights = wanted.lights_revision;
    scene->directional = wanted.lights.directional;
    scene->punctual = wanted.lights.punctual;
    if (scene->environment.kind == scene::EnvironmentKind::Constant)
      scene->environment.color = wanted.lights.environment;
  }
  const auto now = std::chrono::steady_clock::now();
  const double wall = std::chrono::duration<double>(now - last_frame).count();
  last_frame = now;
  if (wanted.playing) time += wanted.step > 0 ? wanted.step : wall;
  if (wanted.steps != steps) time += double(int64_t(wanted.steps - steps)) * (wanted.step > 0 ? wanted.step : 1.0 / 60);
  steps = wanted.steps;
  renderer->update(scene::animate(*scene, time));
  if (anew) view.previous_camera = wanted.camera;
}

Published Engine::look(const Wanted& wanted) {
  Wanted same = last;
  same.playing = false;
  same.pick_serial = wanted.pick_serial;
  same.pick = wanted.pick;
  same.probe = wanted.probe;
  same.inspect = wanted.inspect;
  return frame(same);
}

Published Engine::frame(const Wanted& wanted) {
  last = wanted;
  if (std::exchange(lose_next, false)) device->pretend_lost();
  const bool anew = wanted.history != history || view.size != wanted.size || view.seed != wanted.seed;
  if (wanted.revision != revision) settled = 0;
  revision = wanted.revision;
  history = wanted.history;
  if (anew) view.frame_index = last_index = kept_index = 0;
  if (wanted.hold_noise) view.frame_index = last_index;
  view.previous_frame_index = anew ? std::nullopt : std::optional(kept_index);
  view.culling_camera = wanted.culling_camera;
  view.size = wanted.size;
  view.seed = wanted.seed;
  view.averaged = wanted.bare;
  view.camera = wanted.camera;
  view.inspect = wanted.inspect;
  move(wanted, anew);

  graph::Graph built(renderer->executor().histories());
  if (anew) built.forget_histories();
  const passes::FrameOutputs outputs = renderer->build(built, view, wanted.settings);
  Published out{.revision = revision};
  const passes::Aov* layer = wanted.layer.empty() ? nullptr : &passes::find_aov(wanted.layer);
  const graph::Tex layer_texels = layer ? renderer->add_layer(built, outputs, *layer) : graph::Tex{};
  if (layer_texels) built.readback("readback.layer", layer_texels);
  if (outputs.loop_energy) built.readback("readback.loop_energy", outputs.loop_energy);
  if (outputs.clamped_energy) built.readback("readback.clamped_energy", outputs.clamped_energy);
  if (outputs.nan_scan.found) built.readback("readback.nan_scan", outputs.nan_scan.found);
  const graph::Tex picture = layer_texels ? graph::Tex{} : renderer->add_picture(built, outputs, wanted.settings);
  if (picture && handover) {
    const graph::Size size = built.desc(picture).size;
    const gpu::LentImage& lent = handover->write({size.width, size.height});
    built.hand_over("hand_over.picture", picture, lent.image);
    out.picture = {.size = view.size, .image = &lent};
  } else if (picture) {
    built.readback("readback.picture", picture);
  }
  if (layer && picture)
    out.picture.note = fmt::format("{} gives no layer '{}'", wanted.settings.technique->id, layer->name);
  describe_graph(built, out);
  const size_t resources = built.resources.size();
  std::vector<const passes::Aov*> asked;
  for (const std::string& name : wanted.layers)
    if (const graph::Tex texels = renderer->add_layer(built, outputs, passes::find_aov(name))) {
      built.readback("readback.asked", texels);
      asked.push_back(&passes::find_aov(name));
    }
  // What the user looks into is not part of the frame that the panels show.
  std::vector<const passes::Aov*> picked;
  if (wanted.pick_serial != pick || !save_layers.empty()) pick_layers(built, outputs, picked);
  if (wanted.pick_serial != pick)
    out.picked =
        Picked{.serial = wanted.pick_serial,
               .pixel = wanted.pick,
               .layers = {},
               .images = read_pixel(built, resources, glm::min(wanted.pick, view.size - 1u), view.size, outputs.border),
               .made_with = {}};
  out.probe_of = wanted.probe;
  if (wanted.probe) out.probe_error = look_at(built, *wanted.probe);
  if (wanted.inspect) {
    out.inspected = Inspected{.technique = wanted.settings.technique->id,
                              .frame = number + 1,
                              .size = view.size,
                              .vfov = view.camera.vfov,
                              .possible = bool(outputs.inspection.records),
                              .data = {}};
    if (outputs.inspection.records) built.readback("readback.inspection", outputs.inspection.records);
  }

  graph::ExecuteOptions execute{.hold_histories = wanted.hold_history,
                                .then = out.picture.image ? out.picture.image->written : gpu::TimelinePoint{}};
  // The one that hands an attachment over to a shader.
  if (std::exchange(drop_next, false))
    for (size_t i = 0; i < plan.barriers.size() && execute.drop_barrier < 0; ++i)
      if (plan.barriers[i].old_layout == VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL) execute.drop_barrier = int(i);
  renderer->executor().run(built, execute);
  const graph::FrameResult result = renderer->executor().finish();
  last_index = view.frame_index++;
  if (!renderer->executor().held()) {
    view.previous_camera = view.camera;
    kept_index = last_index;
  }
  out.number = ++number;
  out.settled = ++settled;
  out.moving = wanted.moving;
  out.reduced = wanted.reduced;
  out.made_with = {.settings = wanted.settings,
                   .camera = wanted.camera,
                   .size = view.size,
                   .seed = view.seed,
                   .history = wanted.history,
                   .lights = wanted.lights.directional.size() + wanted.lights.punctual.size()};
  out.time = time;
  out.draws = renderer->draws();

  std::map<std::string, size_t> rows;
  for (const graph::PassTime& pass : result.passes) {
    const bool readback = pass.kind == graph::PassKind::Readback;
    const std::string name = readback ? "readback" : pass.name;
    const auto [row, first] = rows.emplace(name, out.passes.size());
    if (first)
      out.passes.push_back({.name = name,
                            .description = readback ? "Copies of pictures and layers for the window" : pass.description,
                            .kind = graph::kind_name(pass.kind),
                            .begin_ms = float(pass.begin_ms)});
    out.passes[row->second].ms += float(pass.ms);
    out.passes[row->second].record_ms += float(pass.record_ms);
  }
  out.frame_ms = float(result.frame_ms);
  out.wall_ms = float(result.wall_ms);
  out.record_ms = float(result.record_ms);
  out.submit_ns = int64_t(result.submit_ns);

  collect(wanted, outputs, asked, picked, out);
  return out;
}

// What was copied to the host, as the window takes it.
void Engine::collect(const Wanted& wanted, const passes::FrameOutputs& outputs,
                     const std::vector<const passes::Aov*>& asked, const std::vector<const passes::Aov*>& picked,
                     Published& out) {
  const passes::Aov* layer = wanted.layer.empty() ? nullptr : &passes::find_aov(wanted.layer);
  size_t next_pick = 0, next_image = 0;
  const bool picks = out.picked.has_value();
  if (picks) out.picked->made_with = out.made_with;
  std::vector<image::Layer> layers;
  for (const graph::Readback& readback : renderer->executor().take_readbacks()) {
    const std::string_view name = readback.name;
    out.host_bytes += readback.texels.size();
    if (name == "readback.layer") {
      out.picture = to_pixels(to_layer(*layer, readback));
    } else if (name == "readback.pick") {
      layers.push_back(to_layer(*picked[next_pick], readback));
      if (!picks) {
        ++next_pick;
        continue;
      }
      const image::Layer& values = layers.back();
      LayerValue value{.name = *picked[next_pick]->name ? picked[next_pick]->name : "final",
                       .channels = picked[next_pick]->channels};
      const glm::uvec2 at = glm::min(wanted.pick, view.size - 1u);
      const size_t first = (size_t(at.y) * values.image.width + at.x) * values.image.channels;
      value.values.assign(values.image.pixels.begin() + long(first),
                          values.image.pixels.begin() + long(first + values.image.channels));
      out.picked->layers.push_back(std::move(value));
      ++next_pick;
    } else if (name == pixel_readback) {
      while (!out.picked->images[next_image].of_view) ++next_image;
      take_texel(readback, out.picked->images[next_image++]);
    } else if (name == "readback.nan_scan") {
      for (const passes::NonFiniteTexels& image : read_nan_scan(outputs.nan_scan, readback))
        if (image.any())
          out.not_finite.push_back(fmt::format("{}: {} NaN, {} infinite of {}x{}, the first at {}, {}", image.image,
                                               image.nan, image.inf, image.size.width, image.size.height, image.first.x,
                                               image.first.y));
    } else if (name == "readback.asked") {
      out.layers.push_back(to_layer(*asked[out.layers.size()], readback));
    } else if (name == "readback.inspection") {
      out.inspected->data = passes::read_inspection(outputs.inspection, readback);
    } else if (name == "readback.probe") {
      out.probe = to_pixels(readback, wanted.probe->resource);
    } else if (name == "readback.picture") {
      out.picture.size = view.size;
      out.picture.rgba.resize(readback.texels.size());
      std::memcpy(out.picture.rgba.data(), readback.texels.data(), readback.texels.size());
    }
  }
  pick = wanted.pick_serial;
  const std::string path = std::exchange(save_layers, {});
  if (path.empty()) return;
  try {
    image::write_exr(path, layers,
                     {{"nearfield.technique", wanted.settings.technique->id},
                      {"nearfield.seed", fmt::format("{}", view.seed)},
                      {"nearfield.scene", scene->path}},
                     image::Precision::Half);
    saved = Event{.kind = EventKind::Saved, .text = path};
    saved->made_with = out.made_with;
  } catch (const Error& error) {  // a full disk is no reason to lose the frame
    saved = Event{.kind = EventKind::Failed, .text = error.what()};
  }
}

// Planned once more, but only when it is another graph.
void Engine::describe_graph(const graph::Graph& built, Published& out) {
  const uint64_t now = graph::topology_hash(built);
  if (now == hash) return;
  graph::require_valid(built);
  graph::Plan plan_now = renderer->executor().plan_for(built);
  out.graph = make_graph_info(graph::to_json(built, plan_now));
  if (hash) out.graph->diff = graph::diff_text(graph, plan, built, plan_now);
  hash = now;
  plan = std::move(plan_now);
  graph = built;
}

void Engine::pick_layers(graph::Graph& built, const passes::FrameOutputs& outputs,
                         std::vector<const passes::Aov*>& picked) {
  for (const passes::Aov& aov : passes::aovs())
    if (const graph::Tex texels = renderer->add_layer(built, outputs, aov)) {
      built.readback("readback.pick", texels);
      picked.push_back(&aov);
    }
}

}  // namespace nf::editor::live
