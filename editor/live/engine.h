// The renderer and all that lives on its device: what the worker's thread has, and nobody else sees.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frame.h"
#include "gpu/reload.h"
#include "live/handover.h"
#include "live/published.h"
#include "live/wanted.h"

namespace nf::editor::live {

struct WorkerOptions {
  gpu::DeviceOptions device;
  graph::ExecutorOptions executor;
  Handover* handover = nullptr;  // the window's device is the renderer's, too
};

struct Engine {
  std::unique_ptr<gpu::Device> device;
  Handover* handover = nullptr;
  std::unique_ptr<scene::Scene> scene;
  std::unique_ptr<passes::Renderer> renderer;
  passes::FrameView view;
  uint64_t serial = 0, number = 0;
  uint64_t revision = ~uint64_t{0}, history = ~uint64_t{0}, lights = ~uint64_t{0}, steps = 0, pick = 0;
  uint64_t failed_revision = ~uint64_t{0};
  uint32_t settled = 0;
  uint32_t last_index = 0, kept_index = 0;  // frame indices: of the last frame, of the one whose histories are kept
  bool lost = false, lose_next = false, drop_next = false;
  double time = 0;
  std::string save_layers;     // with the next frame
  std::optional<Event> saved;  // what came of it
  std::chrono::steady_clock::time_point last_frame = std::chrono::steady_clock::now();
  Wanted last;  // what the last frame was of
  // The last frame's, for what a change makes of it.
  uint64_t hash = 0;
  std::optional<gpu::ShaderWatch> watch;
  graph::Graph graph;
  graph::Plan plan;

  Engine() = default;
  ~Engine() { renderer.reset(); }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  // A new device, and the scene on it if there is one.
  void open(const WorkerOptions& options);
  // Nothing of the device is left, until it is opened again.
  void close();
  // The next frame is one of a new picture, whatever was rendered before.
  void start_anew();
  SceneInfo load(const Command& command, const WorkerOptions& options);
  // Another map from all sides.
  SceneInfo surround(const std::string& path);
  Published frame(const Wanted& wanted);
  // One more frame of the last picture, looked into as wanted now.
  Published look(const Wanted& wanted);

 private:
  void describe_graph(const graph::Graph& built, Published& out);
  void collect(const Wanted& wanted, const passes::FrameOutputs& outputs, const std::vector<const passes::Aov*>& asked,
               const std::vector<const passes::Aov*>& picked, Published& out);
  void pick_layers(graph::Graph& graph, const passes::FrameOutputs& outputs, std::vector<const passes::Aov*>& picked);
  void move(const Wanted& wanted, bool anew);
};

}  // namespace nf::editor::live
