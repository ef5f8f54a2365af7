// Shared flags and what they mean.
#include "cli/options.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/log.h"
#include "preset.h"

namespace nf::editor {
namespace {

std::atomic<bool> stop{false};
std::string kept_command_line;

extern "C" void on_interrupt(int) {
  // A second Ctrl-C ends the process at once, in the middle of a frame.
  if (stop.exchange(true)) std::_Exit(int(Exit::Interrupted));
}

using nlohmann::json;

// What the preset says and no flag does goes to `options`; returns its parameters.
json apply_preset(CommonOptions& options) {
  Preset preset = read_preset(options.preset);
  if (preset.technique && !options.technique_given) options.technique = *preset.technique;
  if (preset.mode && !options.mode_given) options.mode = *preset.mode;
  if (preset.size && !options.size_given) options.size = *preset.size;
  if (preset.seed && !options.seed_given) options.seed = *preset.seed;
  if (preset.view && !options.view_given) {
    if (const auto* name = std::get_if<std::string>(&*preset.view))
      options.view = *name;
    else
      options.preset_view = std::get<scene::View>(std::move(*preset.view));
  }
  return std::move(preset.params);
}

}  // namespace

std::vector<std::string> split_list(const std::string& list) {
  std::vector<std::string> parts;
  for (size_t at = 0; at < list.size();) {
    const size_t comma = std::min(list.find(',', at), list.size());
    if (comma > at) parts.push_back(list.substr(at, comma - at));
    at = comma + 1;
  }
  return parts;
}

void add_log_flags(CLI::App& app, CommonOptions& o) {
  app.add_flag("--quiet", o.quiet, "Only errors on stderr");
  app.add_flag("-v,--verbose", o.verbose, "More on stderr");
  app.add_option("--log-file", o.log_file, "Also write the log to this file")->type_name("FILE");
}

void add_picture_flags(CLI::App& app, CommonOptions& o) {
  app.add_option("--size", o.size, "Picture size in pixels")
      ->type_name("WxH")
      ->capture_default_str()
      ->envname("NEARFIELD_SIZE");
  app.add_option("--view", o.view,
                 "Camera: a view FILE.json (camera and lights), a camera's NAME in the scene, or its INDEX")
      ->envname("NEARFIELD_VIEW");
  app.add_option("--variant", o.variant, "Materials of this variant (KHR_materials_variants; `nearfield info --scene`)")
      ->type_name("NAME");
  app.add_option("--preset", o.preset, "JSON preset; flags win over it")
      ->type_name("FILE")
      ->envname("NEARFIELD_PRESET");
  app.add_option("--seed", o.seed, "Seed of all noise")->capture_default_str()->envname("NEARFIELD_SEED");
  app.add_option("--progress", o.progress, "Progress on stderr")
      ->check(CLI::IsMember({"auto", "bar", "plain", "json", "none"}))
      ->capture_default_str();
}

void add_render_flags(CLI::App& app, CommonOptions& o) {
  add_picture_flags(app, o);
  app.add_option("--device", o.device, "Vulkan device: INDEX, part of its NAME, cpu or gpu (default: the fastest)")
      ->envname("NEARFIELD_DEVICE");
  app.add_option("--technique", o.technique, "GI technique (`nearfield info --techniques`; default vbgi)")
      ->type_name("ID")
      ->envname("NEARFIELD_TECHNIQUE");
  app.add_option("--mode", o.mode, "Form of the technique")
      ->check(CLI::IsMember({"paper", "radiometric"}))
      ->envname("NEARFIELD_MODE");
  app.add_option("--set", o.sets, "Set a parameter, e.g. --set gi.radius=2 (repeatable; `nearfield info --params`)")
      ->type_name("ID=VALUE")
      ->allow_extra_args(false);
  app.add_option("--timing", o.timing,
                 "How passes are timed: serialize (exact, no overlap) or overlap (as the frame really runs)")
      ->check(CLI::IsMember({"serialize", "overlap"}))
      ->capture_default_str()
      ->envname("NEARFIELD_TIMING");
  app.add_option("--timeout", o.timeout, "Give up after this many seconds (exit code 6)")
      ->type_name("S")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--validation", o.validation, "Vulkan validation, synchronization included; slow")
      ->envname("NEARFIELD_VALIDATION");
  app.add_flag("--no-alias", o.no_alias, "Give every transient image memory of its own");
  app.add_flag("--poison{frame}", o.poison,
               "Fill transient memory with 0xFF before each frame, or with --poison=handover at each change of owner; "
               "pictures must not change")
      ->check(CLI::IsMember({"frame", "handover"}));
  app.add_option("--barriers", o.barriers, "Barriers of a pass in one call, or each in a call of its own")
      ->check(CLI::IsMember({"merged", "each"}))
      ->capture_default_str();
  app.add_option("--layouts", o.layouts, "Image layouts: the exact one for each use, or general everywhere")
      ->check(CLI::IsMember({"exact", "general"}))
      ->capture_default_str();
  app.add_option("--order-seed", o.order_seed,
                 "Run the passes in another legal order, the same for the same number; pictures must not change (0: as "
                 "declared)")
      ->type_name("N");
  add_log_flags(app, o);
  app.parse_complete_callback([&app, &o] {
    o.size_given = app.count("--size") > 0;
    o.seed_given = app.count("--seed") > 0;
    o.mode_given = !o.mode.empty();
    o.technique_given = app.count("--technique") > 0;
    o.view_given = app.count("--view") > 0;
  });
}

void start_log(const CommonOptions& o) {
  log::init(o.quiet ? log::Level::Quiet : o.verbose ? log::Level::Verbose : log::Level::Normal, o.log_file);
}

glm::uvec2 parse_size(const std::string& text) {
  glm::uvec2 size(0);
  const char* end = text.data() + text.size();
  const auto [x, x_error] = std::from_chars(text.data(), end, size.x);
  const bool cross = x_error == std::errc() && x != end && *x == 'x';
  const auto [y, y_error] =
      cross ? std::from_chars(x + 1, end, size.y) : std::from_chars_result{end, std::errc::invalid_argument};
  if (y_error != std::errc() || y != end || size.x < 1 || size.y < 1 || size.x > 16384 || size.y > 16384)
    fail(Exit::Usage, "bad size '{}': write it as WIDTHxHEIGHT, 1 to 16384 each, e.g. 1280x720", text);
  return size;
}

gpu::Timing parse_timing(const std::string& text) {
  return text == "overlap" ? gpu::Timing::Overlap : gpu::Timing::Serialize;
}

graph::ExecutorOptions executor_options(const CommonOptions& options) {
  return {.alias = !options.no_alias,
          .layouts = options.layouts == "general" ? graph::LayoutPolicy::General : graph::LayoutPolicy::Exact,
          .order_seed = options.order_seed,
          .merge_barriers = options.barriers == "merged",
          .poison = options.poison == "frame"      ? graph::Poison::Frame
                    : options.poison == "handover" ? graph::Poison::Handover
                                                   : graph::Poison::Off};
}

gpu::DeviceOptions device_options(const CommonOptions& o) {
  return {.select = o.device, .validation = o.validation};
}

passes::FrameSettings make_settings(CommonOptions& o, Reconstruction reconstruction) {
  passes::FrameSettings settings;
  settings.reconstruct = reconstruction != Reconstruction::None;
  if (reconstruction == Reconstruction::IfSet) settings.switch_off_reconstruction();
  const json values = o.preset.empty() ? json::object() : apply_preset(o);
  if (!o.technique.empty()) settings.technique = &passes::find_technique(o.technique);
  if (o.mode == "paper") set_paper_mode(settings);
  try {
    params::from_json(settings.blocks(), values);
  } catch (const Error& e) {
    fail(e.exit(), "cannot read the preset '{}': {}", o.preset, e.what());
  }
  for (const std::string& assignment : o.sets) params::assign(settings.blocks(), assignment);
  return settings;
}

void keep_command_line(int argc, char** argv) {
  kept_command_line = "nearfield";
  for (int i = 1; i < argc; ++i) {
    const std::string_view arg = argv[i];
    if (arg == "-o" || arg == "--output" || arg == "--json")
      ++i;
    else if (!arg.starts_with("-o") && !arg.starts_with("--output=") && !arg.starts_with("--json="))
      kept_command_line += fmt::format(" {}", arg);
  }
}
const std::string& command_line() {
  return kept_command_line;
}

bool interrupted() {
  return stop;
}
void watch_interrupt() {
  std::signal(SIGINT, on_interrupt);
}

}  // namespace nf::editor
