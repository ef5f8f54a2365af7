// `nearfield graph`: the frame's passes, barriers and memory.
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "graph/dump.h"
#include "scene/gltf.h"
#include "scene/view.h"

namespace nf::editor {

Command add_graph(CLI::App& parent) {
  struct State : CommonOptions {
    std::string scene, format = "text";
  };
  auto state = std::make_shared<State>();
  CLI::App* app = parent.add_subcommand("graph", "Print the frame graph of a scene: passes, uses, barriers, memory");
  app->add_option("SCENE", state->scene, "glTF scene (.gltf, .glb)")->required();
  app->add_option("--format", state->format, "Output")->check(CLI::IsMember({"text", "json"}))->capture_default_str();
  add_render_flags(*app, *state);
  app->footer("Examples:\n  nearfield graph scene.glb\n  nearfield graph scene.glb --format json --technique none");
  return {app, [state] {
            start_log(*state);
            const passes::FrameSettings settings = make_settings(*state);
            const glm::uvec2 size = parse_size(state->size);
            scene::Scene scene = scene::load_gltf(state->scene);
            passes::FrameView view;
            view.camera = view.previous_camera = scene::select_view(state->view, scene);
            view.size = size;
            gpu::Device device(device_options(*state));
            passes::Renderer renderer(device, scene, !state->no_alias);
            graph::Graph graph(renderer.executor().histories());
            const passes::FrameOutputs outputs = renderer.build(graph, view, settings);
            graph.readback("picture", renderer.add_picture(graph, outputs, settings));
            if (const auto wrong = graph::validate(graph); !wrong.empty()) {
              std::string text = "the frame graph is wrong:";
              for (const auto& d : wrong) text += "\n  " + d.text;
              throw Error(Exit::Internal, text);
            }
            const graph::Plan plan = renderer.executor().plan_for(graph);
            if (state->format == "json")
              fmt::print("{}\n", graph::to_json(graph, plan).dump(1));
            else
              fmt::print("{}", graph::to_text(graph, plan));
            return int(Exit::Ok);
          }};
}

}  // namespace nf::editor
