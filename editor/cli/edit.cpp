// `nearfield edit`: the window; also what `nearfield` without a command is.
#include <memory>

#include "app.h"

namespace nf::editor {

Command add_edit(CLI::App& parent) {
  auto state = std::make_shared<EditOptions>();
  CLI::App* app = parent.add_subcommand("edit", "Open a scene in a window: swap techniques and turn parameters live");
  app->add_option("SCENE", state->scene, "glTF scene (.gltf, .glb); without it the bundled atrium");
  app->add_option("--window", state->window, "The window's size in pixels")->type_name("WxH")->capture_default_str();
  app->add_option("--ui-scale", state->ui_scale, "Size of the interface, 0.75 to 3, on top of the display's")
      ->check(CLI::Range(0.75f, 3.0f))
      ->type_name("F");
  app->add_option("--ui-script", state->ui_script,
                  "Drive the window from this file of JSON lines, then quit; exit code 1 when a check in it fails")
      ->type_name("FILE");
  app->add_option("--ui-state", state->ui_state,
                  "Keep this file up to date with what the window shows: widgets, values, counters")
      ->type_name("FILE");
  app->add_flag("--reset-settings", state->reset_settings, "Forget the kept settings and layout");
  app->add_flag("--offscreen", state->offscreen,
                "No window: the interface is rendered all the same, for scripts and screenshots");
  app->add_option("--device-sharing", state->sharing,
                  "Whether window and renderer share a device: shared hands pictures over on it, separate copies them "
                  "through host memory; auto shares all but software devices")
      ->check(CLI::IsMember({"auto", "shared", "separate"}))
      ->capture_default_str();
  add_render_flags(*app, *state);
  // Flags of the commands that render to files, which mean nothing here.
  static constexpr const char* absent[][2] = {
      {"--size", "the window's size is --window"},
      {"--variant", "`nearfield render` and the other commands have it"},
      {"--timing", "the window's passes are serialized; `nearfield bench` has it"},
      {"--timeout", "close the window"},
      {"--progress", "the window shows it"}};
  for (const auto& [flag, instead] : absent) app->get_option(flag)->group("")->envname("");
  app->footer(
      "F1 in the window lists all keys.\n"
      "Examples:\n  nearfield edit scene.glb --technique gtao\n  nearfield edit --offscreen --ui-script tour.jsonl");
  return {app, [state, app] {
            start_log(*state);
            for (const auto& [flag, instead] : absent)
              if (app->count(flag)) fail(Exit::Usage, "nearfield edit has no {}: {}", flag, instead);
            watch_interrupt();
            return run_editor(*state);
          }};
}

}  // namespace nf::editor
