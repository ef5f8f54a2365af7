// The program: finds the command, runs it, and turns failures into one line and an exit code.
#include <algorithm>
#include <filesystem>

#include "cli/options.h"
#include "core/log.h"

namespace nf::editor {
namespace {

constexpr const char* footer =
    R"(Without a command the editor's window opens, on the bundled scene or `nearfield SCENE`.
Examples:
  nearfield render scene.glb -o picture.png --size 1280x720 --set gi.radius=3
  nearfield render scene.glb -o layers.exr --aov all --frames 64 --accumulate
  nearfield bench scene.glb --technique none --technique vbgi --json times.json
  nearfield graph scene.glb --format text
  nearfield reference scene.glb -o reference.exr --size 640x360 --spp 256
  nearfield compare picture.exr reference.exr --layer gi --block 8
Exit codes: 0 done, 1 a check failed, 2 usage, 3 bad input, 4 no device or display, 5 shader, 6 GPU, 7 cannot write, 70 internal, 130 interrupted.
`nearfield COMMAND --help` says more.)";

// `edit` may be left away before a scene or a flag.
bool is_for_the_window(const std::string& first) {
  const std::string extension = std::filesystem::path(first).extension().string();
  if (extension == ".glb" || extension == ".gltf") return true;
  return first.starts_with("--") && first != "--help" && first != "--version";
}

int run(int argc, char** argv) {
  CLI::App app("Nearfield: screen-space global illumination techniques on one frame graph", "nearfield");
  app.set_version_flag("--version", version_line());
  app.footer(footer);
  app.require_subcommand(0, 1);
  const Command commands[] = {add_edit(app),    add_render(app),    add_bench(app),    add_info(app),  add_graph(app),
                              add_compare(app), add_reference(app), add_evaluate(app), add_sweep(app), add_report(app)};
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && is_for_the_window(words[0])) words.insert(words.begin(), "edit");
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(words);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    log::init(log::Level::Normal);
    fail(Exit::Usage, "{}; see `nearfield --help`", e.what());
  }
  for (const Command& command : commands)
    if (command.app->parsed()) return command.run();
  // Without a command: the window, on the bundled scene.
  return commands[0].run();
}

}  // namespace
}  // namespace nf::editor

int nearfield_main(int argc, char** argv);
int nearfield_main(int argc, char** argv) {
  try {
    nf::editor::keep_command_line(argc, argv);
    return nf::editor::run(argc, argv);
  } catch (const nf::Error& e) {
    nf::log::error("{}", e.what());
    return int(e.exit());
  } catch (const std::bad_alloc&) {
    nf::log::error("out of memory: try a smaller --size or scene");
    return int(nf::Exit::Gpu);
  } catch (const std::exception& e) {
    nf::log::error("internal error: {}; please report this with the command line", e.what());
    return int(nf::Exit::Internal);
  }
}
