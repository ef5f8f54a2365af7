// The renderer's thread: takes what is wanted, renders one frame, publishes it, and sleeps when the picture is done.
#include "live/worker.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "cli/frames.h"
#include "cli/measure.h"
#include "cli/options.h"
#include "core/log.h"
#include "graph/dump.h"
#include "graph/probe.h"
#include "live/graph_info.h"
#include "scene/animation.h"
#include "scene/gltf.h"

namespace nf::editor::live {
namespace {

using Clock = std::chrono::steady_clock;

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

Pixels to_pixels(const image::Layer& layer) {
  Pixels out{.size = {layer.image.width, layer.image.height}, .channels = layer.image.channels, .name = layer.name};
  const size_t count = size_t(out.size.x) * out.size.y;
  out.floats.assign(count * 4, 0);
  for (size_t i = 0; i < count; ++i)
    for (uint32_t c = 0; c < std::min(layer.image.channels, 4u); ++c)
      out.floats[i * 4 + c] = layer.image.pixels[i * layer.image.channels + c];
  return out;
}

Pixels to_pixels(const graph::Readback& readback, const std::string& name) {
  Pixels out{.size = {readback.desc.size.width, readback.desc.size.height}, .name = name};
  const std::vector<float> floats = graph::to_floats(readback, out.channels);
  const size_t count = size_t(out.size.x) * out.size.y;
  out.floats.assign(count * 4, 0);
  for (size_t i = 0; i < count; ++i)
    for (uint32_t c = 0; c < std::min(out.channels, 4u); ++c) out.floats[i * 4 + c] = floats[i * out.channels + c];
  return out;
}

// Puts the probe into the frame; what is wrong with it comes back.
std::string look_at(graph::Graph& built, const ProbeWanted& wanted) {
  const auto pass = std::find_if(built.passes.begin(), built.passes.end(),
                                 [&](const graph::PassRow& row) { return wanted.pass == row.name; });
  const auto resource =
      std::find_if(built.resources.begin(), built.resources.end(), [&](const graph::ResourceRow& row) {
        const bool previous = row.lifetime == graph::Lifetime::HistoryPrev;
        return wanted.resource == (previous ? fmt::format("{}.prev", row.name) : row.name);
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

struct Worker::Engine {
  std::unique_ptr<gpu::Device> device;
  std::unique_ptr<scene::Scene> scene;
  std::unique_ptr<passes::Renderer> renderer;
  passes::FrameView view;
  uint64_t serial = 0, number = 0;
  uint64_t revision = ~uint64_t{0}, history = ~uint64_t{0}, lights = ~uint64_t{0}, steps = 0, pick = 0;
  uint64_t failed_revision = ~uint64_t{0};
  uint32_t settled = 0;
  bool moving = false, lost = false, lose_next = false;
  double time = 0;
  std::string save_layers;  // with the next frame
  Clock::time_point last_frame = Clock::now();
  // The last frame's, for what a change makes of it.
  uint64_t hash = 0;
  std::optional<gpu::ShaderWatch> watch;
  graph::Graph graph;
  graph::Plan plan;

  ~Engine() { renderer.reset(); }

  void open(const WorkerOptions& options) {
    renderer.reset();
    device.reset();
    device = std::make_unique<gpu::Device>(options.device);
    if (scene) renderer = std::make_unique<passes::Renderer>(*device, *scene, options.executor);
    lost = false;
    start_anew();
  }
  // The next frame is one of a new picture, whatever was rendered before.
  void start_anew() {
    revision = history = failed_revision = ~uint64_t{0};
    hash = 0;
    graph = graph::Graph();
  }
  SceneInfo load(const Command& command, const WorkerOptions& options) {
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
    renderer = std::make_unique<passes::Renderer>(*device, *scene, options.executor);
    SceneInfo info = describe(*scene);
    info.serial = serial;
    info.start = start;
    info.own_lights = own;
    info.own_environment =
        own_environment.kind == scene->environment.kind && own_environment.file == scene->environment.file;
    return info;
  }
  // Another map from all sides.
  SceneInfo surround(const std::string& path) {
    scene::Environment map = scene::load_environment_map(path);
    scene->environment = std::move(map);
    renderer->update_environment();
    revision = history = ~uint64_t{0};
    SceneInfo info = describe(*scene);
    info.own_environment = false;
    return info;
  }

  Published frame(const Wanted& wanted);
  void describe_graph(const graph::Graph& built, Published& out);
  void pick_layers(graph::Graph& graph, const passes::FrameOutputs& outputs, std::vector<const passes::Aov*>& picked);
  void move(const Wanted& wanted, bool anew);
};

// The scene at this frame's time, with the lights as wanted.
void Worker::Engine::move(const Wanted& wanted, bool anew) {
  if (wanted.lights_revision != lights) {
    lights = wanted.lights_revision;
    scene->directional = wanted.lights.directional;
    scene->punctual = wanted.lights.punctual;
    if (scene->environment.kind == scene::EnvironmentKind::Constant)
      scene->environment.color = wanted.lights.environment;
  }
  const Clock::time_point now = Clock::now();
  const double wall = std::chrono::duration<double>(now - last_frame).count();
  last_frame = now;
  if (wanted.playing) time += wanted.step > 0 ? wanted.step : wall;
  if (wanted.steps != steps) time += double(int64_t(wanted.steps - steps)) * (wanted.step > 0 ? wanted.step : 1.0 / 60);
  steps = wanted.steps;
  renderer->update(scene::animate(*scene, time));
  if (anew) view.previous_camera = wanted.camera;
}

Published Worker::Engine::frame(const Wanted& wanted) {
  if (std::exchange(lose_next, false)) fail(Exit::Gpu, "the GPU was lost: a test asked for it");
  const bool anew = wanted.history != history || view.size != wanted.size || view.seed != wanted.seed;
  if (wanted.revision != revision) settled = 0;
  revision = wanted.revision;
  history = wanted.history;
  if (anew) view.frame_index = 0;
  view.size = wanted.size;
  view.seed = wanted.seed;
  view.averaged = false;
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
  built.readback("readback.picture", renderer->add_picture(built, outputs, wanted.settings));
  describe_graph(built, out);
  const passes::Aov* compared = wanted.compared ? &passes::find_aov(*wanted.compared) : nullptr;
  const graph::Tex compared_texels = compared ? renderer->add_layer(built, outputs, *compared) : graph::Tex{};
  if (compared_texels) built.readback("readback.compared", compared_texels);
  // What the user looks into is not part of the frame that the panels show.
  std::vector<const passes::Aov*> picked;
  if (wanted.pick_serial != pick || !save_layers.empty()) pick_layers(built, outputs, picked);
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

  renderer->executor().run(built);
  const graph::FrameResult result = renderer->executor().finish();
  view.previous_camera = view.camera;
  ++view.frame_index;
  out.number = ++number;
  out.settled = ++settled;
  out.moving = wanted.moving;
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

  size_t next_pick = 0;
  std::vector<image::Layer> layers;
  for (const graph::Readback& readback : renderer->executor().take_readbacks()) {
    const std::string_view name = readback.name;
    if (name == "readback.layer") {
      out.picture = to_pixels(to_layer(*layer, readback));
    } else if (name == "readback.pick") {
      if (!out.picked) out.picked = Picked{wanted.pick_serial, wanted.pick, {}};
      layers.push_back(to_layer(*picked[next_pick], readback));
      const image::Layer& values = layers.back();
      LayerValue value{.name = *picked[next_pick]->name ? picked[next_pick]->name : "final",
                       .channels = picked[next_pick]->channels};
      const glm::uvec2 at = glm::min(wanted.pick, view.size - 1u);
      const size_t first = (size_t(at.y) * values.image.width + at.x) * values.image.channels;
      value.values.assign(values.image.pixels.begin() + long(first),
                          values.image.pixels.begin() + long(first + values.image.channels));
      out.picked->layers.push_back(std::move(value));
      ++next_pick;
    } else if (name == "readback.nan_scan") {
      for (const passes::NonFiniteTexels& image : read_nan_scan(outputs.nan_scan, readback))
        if (image.any())
          out.not_finite.push_back(fmt::format("{}: {} NaN, {} infinite of {}x{}, the first at {}, {}", image.image,
                                               image.nan, image.inf, image.size.width, image.size.height, image.first.x,
                                               image.first.y));
    } else if (name == "readback.compared") {
      out.compared = to_pixels(to_layer(*compared, readback));
    } else if (name == "readback.inspection") {
      out.inspected->data = passes::read_inspection(outputs.inspection, readback);
    } else if (name == "readback.probe") {
      out.probe = to_pixels(readback, wanted.probe->resource);
    } else if (name == "readback.picture" && !layer_texels) {
      out.picture.size = view.size;
      out.picture.rgba.resize(readback.texels.size());
      std::memcpy(out.picture.rgba.data(), readback.texels.data(), readback.texels.size());
      if (layer) out.picture.note = fmt::format("{} gives no layer '{}'", wanted.settings.technique->id, layer->name);
    }
  }
  pick = wanted.pick_serial;
  if (const std::string path = std::exchange(save_layers, {}); !path.empty())
    image::write_exr(path, layers,
                     {{"nearfield.technique", wanted.settings.technique->id},
                      {"nearfield.seed", fmt::format("{}", view.seed)},
                      {"nearfield.scene", scene->path}},
                     image::Precision::Half);

  return out;
}

// Planned once more, but only when it is another graph.
void Worker::Engine::describe_graph(const graph::Graph& built, Published& out) {
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

void Worker::Engine::pick_layers(graph::Graph& built, const passes::FrameOutputs& outputs,
                                 std::vector<const passes::Aov*>& picked) {
  for (const passes::Aov& aov : passes::aovs())
    if (const graph::Tex texels = renderer->add_layer(built, outputs, aov)) {
      built.readback("readback.pick", texels);
      picked.push_back(&aov);
    }
}

Worker::Worker(const WorkerOptions& options) : options_(options), thread_([this] { run(); }) {}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Worker::want(const Wanted& wanted) {
  {
    const std::lock_guard lock(mutex_);
    wanted_ = wanted;
  }
  wake_.notify_all();
}

void Worker::send(Command command) {
  {
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
    busy_ = true;
  }
  wake_.notify_all();
}

std::optional<Published> Worker::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(published_, std::nullopt);
}

std::vector<Event> Worker::take_events() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

bool Worker::idle() const {
  const std::lock_guard lock(mutex_);
  return !busy_ && commands_.empty() && !published_ && events_.empty();
}

uint64_t Worker::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

// A frame that was not taken yet gives way to the newer one, but not what it alone has.
void Worker::publish(Published&& frame) {
  const std::lock_guard lock(mutex_);
  if (published_) {
    if (!frame.graph) frame.graph = std::move(published_->graph);
    if (!frame.picked) frame.picked = std::move(published_->picked);
  }
  published_ = std::move(frame);
}

void Worker::tell(Event event) {
  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
}

// Under the mutex.
bool Worker::has_work(const Engine& e) const {
  if (!commands_.empty()) return true;
  if (e.lost || !e.renderer || wanted_.scene != e.serial || wanted_.paused) return false;
  if (wanted_.revision == e.failed_revision) return false;
  return wanted_.revision != e.revision || e.settled < wanted_.settle || wanted_.playing || wanted_.steps != e.steps ||
         wanted_.pick_serial != e.pick;
}

template <class Work>
bool Worker::guarded(Engine& engine, const Work& work) {
  try {
    work();
    return true;
  } catch (const Error& e) {
    if (e.exit() == Exit::Gpu || e.exit() == Exit::NoDevice) {
      engine.lost = true;
      tell({.kind = EventKind::DeviceLost, .text = e.what()});
    } else {
      Event event{.kind = e.exit() == Exit::Shader ? EventKind::ShaderBroken : EventKind::Failed, .text = e.what()};
      if (e.exit() == Exit::Shader && engine.renderer)
        event.faults = gpu::shader_errors(engine.renderer->pipelines().compiler(), e.what());
      if (!event.faults.empty()) event.text = "A shader does not compile; the last picture stays.";
      tell(std::move(event));
    }
  } catch (const std::bad_alloc&) {
    tell({.kind = EventKind::Failed, .text = "out of memory: try a smaller scene or render scale"});
  } catch (const std::exception& e) {
    tell({.kind = EventKind::Failed, .text = fmt::format("internal error: {}", e.what())});
  }
  return false;
}

// Programs that do not compile stay as they were, and are told with file and line.
void Worker::reload(Engine& engine, const std::vector<std::string>& changed) {
  guarded(engine, [&] {
    gpu::Reload result = engine.renderer->pipelines().reload(changed);
    if (!result.errors.empty()) {
      tell({.kind = EventKind::ShaderBroken,
            .text = "Shaders do not compile; the last good ones stay in use.",
            .faults = std::move(result.errors)});
      return;
    }
    if (result.recompiled == 0) return;
    // What could not be built before may be now, and the picture is another.
    engine.failed_revision = engine.revision = engine.history = ~uint64_t{0};
    tell({.kind = EventKind::ShadersLoaded,
          .text = fmt::format("{} programs compiled", result.recompiled),
          .ms = result.ms});
  });
}

void Worker::run() {
  // The window goes before the scene: a software device's threads have the priority of the thread that opens it.
  setpriority(PRIO_PROCESS, id_t(gettid()), 8);
  Engine engine;
  const auto open = [&] {
    engine.open(options_);
    tell({.kind = EventKind::DeviceOpened,
          .text = engine.device->info.name,
          .context = context_json(*engine.device, {}, options_.device.validation),
          .software = engine.device->facts.software});
  };
  guarded(engine, open);
  for (;;) {
    Wanted wanted;
    std::vector<Command> commands;
    {
      std::unique_lock lock(mutex_);
      busy_ = has_work(engine);
      if (!busy_) wake_.wait_for(lock, std::chrono::milliseconds(200), [&] { return quit_ || has_work(engine); });
      if (quit_) return;
      busy_ = has_work(engine);
      wanted = wanted_;
      commands = std::exchange(commands_, {});
    }
    for (const Command& command : commands) {
      switch (command.kind) {
        case CommandKind::LoadScene:
          tell({.kind = EventKind::SceneLoading, .text = command.path});
          guarded(engine, [&] {
            tell({.kind = EventKind::SceneLoaded, .text = command.path, .scene = engine.load(command, options_)});
          });
          break;
        case CommandKind::LoadEnvironment:
          guarded(engine, [&] {
            if (!engine.renderer) fail(Exit::Input, "open a scene first: an environment goes round one");
            tell({.kind = EventKind::EnvironmentLoaded, .text = command.path, .scene = engine.surround(command.path)});
          });
          break;
        case CommandKind::CopyScene:
          if (engine.scene)
            tell({.kind = EventKind::SceneCopied, .copy = std::make_unique<scene::Scene>(*engine.scene)});
          break;
        case CommandKind::SaveLayers:
          engine.save_layers = command.path;
          engine.revision = ~uint64_t{0};
          break;
        case CommandKind::Restart:
          guarded(engine, open);
          break;
        case CommandKind::ReloadShaders:
          reload(engine, {});
          break;
        case CommandKind::LoseDevice:
          engine.lose_next = true;
          engine.revision = ~uint64_t{0};
          break;
      }
    }
    if (engine.renderer && !engine.lost) {
      if (!engine.watch) engine.watch.emplace(gpu::find_shader_folder());
      if (const std::vector<std::string> changed = engine.watch->changed(); !changed.empty()) reload(engine, changed);
    }
    bool render = false;
    {
      const std::lock_guard lock(mutex_);
      wanted = wanted_;
      render = commands_.empty() && has_work(engine);
    }
    if (render) {
      const bool failed_before = engine.failed_revision != ~uint64_t{0};
      if (guarded(engine, [&] { publish(engine.frame(wanted)); })) {
        if (failed_before) tell({.kind = EventKind::Mended});
        engine.failed_revision = ~uint64_t{0};
      } else {
        engine.failed_revision = wanted.revision;
      }
    }
    if (engine.device) {
      const uint64_t messages = engine.device->take_messages().size();  // each is in the log
      const std::lock_guard lock(mutex_);
      messages_ += messages;
    }
  }
}

}  // namespace nf::editor::live
