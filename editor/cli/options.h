// What all commands share: flags, the exit code of a failure, and how a command is registered.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "frame.h"
#include "gpu/device.h"
#include "scene/view.h"

namespace nf::editor {

enum class ProgressMode { Auto, Bar, Plain, Json, None };

struct CommonOptions {
  std::string device;
  std::string size = "1280x720";
  std::string view, variant, technique, mode, preset, log_file, timing = "serialize", progress = "auto",
                                                                barriers = "merged", layouts = "exact", poison;
  std::vector<std::string> sets;
  uint32_t seed = 1;
  uint64_t order_seed = 0;
  double timeout = 0;  // seconds; 0 = none
  bool validation = false, quiet = false, verbose = false, no_alias = false;
  std::optional<scene::View> preset_view;  // the preset's own, where it does not name one and no flag does
  // Which of the flags that a preset can also set were given: they win.
  bool size_given = false, seed_given = false, technique_given = false, mode_given = false, view_given = false;
};

// A command's options and what it does. `run` returns the process's exit code.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

// Flags of every command that makes a picture, on whatever device: size, view, preset, seed, progress.
void add_picture_flags(CLI::App& app, CommonOptions& options);
// Those, and the flags of every command that renders on a GPU.
void add_render_flags(CLI::App& app, CommonOptions& options);
// Flags of every command.
void add_log_flags(CLI::App& app, CommonOptions& options);
void start_log(const CommonOptions& options);

// "a,b" to its parts; empty ones are left out.
std::vector<std::string> split_list(const std::string& list);
// "640x360" to pixels, 1 to 16384 a side. Throws nf::Error (Exit::Usage).
glm::uvec2 parse_size(const std::string& text);
// Reconstruction: none, for who measures a technique; as the parameters say; the same with every stage off that neither
// preset nor flags switch on.
enum class Reconstruction : uint8_t { None, Default, IfSet };
// Technique, mode, the preset's parameters and --set, in this order: what comes later wins. Applies the preset to
// `options` too.
passes::FrameSettings make_settings(CommonOptions& options, Reconstruction reconstruction = Reconstruction::None);
gpu::Timing parse_timing(const std::string& text);
graph::ExecutorOptions executor_options(const CommonOptions& options);
gpu::DeviceOptions device_options(const CommonOptions& options);

Command add_edit(CLI::App& app);
Command add_render(CLI::App& app);
Command add_bench(CLI::App& app);
Command add_info(CLI::App& app);
Command add_graph(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_reference(CLI::App& app);
Command add_evaluate(CLI::App& app);
Command add_report(CLI::App& app);
Command add_sweep(CLI::App& app);

// The command line without its output files: the same for runs that must give the same bytes.
void keep_command_line(int argc, char** argv);
const std::string& command_line();

// version.cpp
std::string version_line();
std::string version_short();
struct BuildInfo {
  std::string version, git, type, compiler;
  bool debug = false;  // without optimisation, or with sanitizers: its times mean little
};
BuildInfo build_info();

// Set by Ctrl-C: a command finishes its frame, writes what it has and exits with 130.
bool interrupted();
void watch_interrupt();

}  // namespace nf::editor
