// `nearfield graph`: the frame's passes, barriers and memory.
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "cli/scene_input.h"
#include "graph/dump.h"
#include "scene/view.h"

namespace nf::editor {

namespace {

struct Planned {
  graph::Graph graph;
  graph::Plan plan;
};

Planned plan_frame(passes::Renderer& renderer, const passes::FrameView& view, const passes::FrameSettings& settings) {
  Planned result{graph::Graph(renderer.executor().histories()), {}};
  const passes::FrameOutputs outputs = renderer.build(result.graph, view, settings);
  result.graph.readback("picture", renderer.add_picture(result.graph, outputs, settings));
  graph::require_valid(result.graph);
  result.plan = renderer.executor().plan_for(result.graph);
  return result;
}

}  // namespace

Command add_graph(CLI::App& parent) {
  struct State : CommonOptions {
    std::string scene, format = "text", diff;
  };
  auto state = std::make_shared<State>();
  CLI::App* app = parent.add_subcommand("graph", "Print the frame graph of a scene: passes, uses, barriers, memory");
  app->add_option("SCENE", state->scene, "glTF scene (.gltf, .glb)")->required();
  app->add_option("--format", state->format, "Output")
      ->check(CLI::IsMember({"text", "dot", "json"}))
      ->capture_default_str();
  app->add_option("--diff", state->diff, "Print what changes in passes, barriers and bytes with this technique instead")
      ->type_name("ID");
  add_render_flags(*app, *state);
  app->footer(
      "Examples:\n  nearfield graph scene.glb\n  nearfield graph scene.glb --technique none --diff vbgi\n"
      "  nearfield graph scene.glb --format dot | dot -Tsvg > frame.svg");
  return {app, [state] {
            start_log(*state);
            passes::FrameSettings settings = make_settings(*state, Reconstruction::Default);
            const passes::Technique* other = state->diff.empty() ? nullptr : &passes::find_technique(state->diff);
            passes::FrameView view;
            view.size = parse_size(state->size);
            scene::Scene scene = open_scene(state->scene, *state);
            view.camera = view.previous_camera = choose_view(*state, scene);
            gpu::Device device(device_options(*state));
            passes::Renderer renderer(device, scene, executor_options(*state));
            const Planned frame = plan_frame(renderer, view, settings);
            if (other) {
              settings.technique = other;
              const Planned changed = plan_frame(renderer, view, settings);
              fmt::print("{}", graph::diff_text(frame.graph, frame.plan, changed.graph, changed.plan));
            } else if (state->format == "json") {
              fmt::print("{}\n", graph::to_json(frame.graph, frame.plan).dump(1));
            } else {
              fmt::print("{}", state->format == "dot" ? graph::to_dot(frame.graph, frame.plan)
                                                      : graph::to_text(frame.graph, frame.plan));
            }
            return int(Exit::Ok);
          }};
}

}  // namespace nf::editor
