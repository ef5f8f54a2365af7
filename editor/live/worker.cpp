// The renderer's thread: takes what is wanted, renders one frame, publishes it, and sleeps when the picture is done.
#include "live/worker.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "cli/measure.h"
#include "cli/options.h"
#include "core/log.h"
#include "live/engine.h"

namespace nf::editor::live {

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
  if (published_ && published_->picture.image) options_.handover->take();
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
  if (frame.picture.image) options_.handover->publish();
  published_ = std::move(frame);
}

void Worker::release() {
  std::unique_lock lock(mutex_);
  release_ = true;
  wake_.notify_all();
  wake_.wait(lock, [&] { return !release_; });
}

void Worker::lend(Handover& handover) {
  const std::lock_guard lock(mutex_);
  options_.handover = &handover;
}

void Worker::tell(Event event) {
  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
}

// Under the mutex.
bool Worker::has_work(const Engine& e) const {
  if (!commands_.empty() || release_) return true;
  if (e.lost || !e.renderer || wanted_.scene != e.serial) return false;
  if (wanted_.paused)
    return e.number > 0 && wanted_.revision != e.failed_revision &&
           (wanted_.pick_serial != e.pick || !e.save_layers.empty() || wanted_.probe != e.last.probe ||
            wanted_.inspect != e.last.inspect);
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
    WorkerOptions options;
    {
      const std::lock_guard lock(mutex_);
      options = options_;
    }
    engine.open(options);
    tell({.kind = EventKind::DeviceOpened,
          .text = engine.device->info.name,
          .context = context_json(*engine.device, {}, options.device.validation),
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
      if (release_) {
        lock.unlock();
        engine.close();
        lock.lock();
        published_.reset();
        release_ = false;
        wake_.notify_all();
      }
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
            if (!engine.scene) fail(Exit::Input, "open a scene first: an environment goes round one");
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
          if (engine.renderer) reload(engine, {});
          break;
        case CommandKind::DropBarrier:
          engine.drop_next = true;
          engine.revision = ~uint64_t{0};
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
      render = commands_.empty() && !release_ && has_work(engine);
    }
    if (render) {
      const bool failed_before = engine.failed_revision != ~uint64_t{0};
      if (guarded(engine, [&] { publish(wanted.paused ? engine.look(wanted) : engine.frame(wanted)); })) {
        if (failed_before) tell({.kind = EventKind::Mended});
        engine.failed_revision = ~uint64_t{0};
      } else {
        engine.failed_revision = wanted.revision;
      }
    }
    if (engine.saved) tell(*std::exchange(engine.saved, std::nullopt));
    if (engine.device) {
      const uint64_t messages = engine.device->take_messages().size();  // each is in the log
      const std::lock_guard lock(mutex_);
      messages_ += messages;
    }
  }
}

}  // namespace nf::editor::live
