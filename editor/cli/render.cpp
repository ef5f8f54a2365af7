// `nearfield render`: pictures and layers of a scene, without a display, and the time of every pass.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/frames.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/scene_input.h"
#include "core/log.h"
#include "gpu/renderdoc.h"
#include "image/file.h"
#include "image/image.h"
#include "scene/animation.h"
#include "scene/view.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct RenderOptions : CommonOptions {
  std::string scene, aov, json_file, precision = "half";
  std::vector<std::string> outputs;
  uint32_t frames = 1, warmup = 0;
  double fps = 60, time = 0;
  bool accumulate = false, fps_given = false;
  std::optional<uint32_t> renderdoc;
};

struct Output {
  std::string pattern;  // may hold {frame:04}
  bool exr = false, every_frame = false;
};

// "f_{frame:04}.png" with the frame's number in place.
std::string output_name(const Output& output, uint32_t frame) {
  const size_t open = output.pattern.find("{frame"), close = output.pattern.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return output.pattern;
  const std::string width = output.pattern.substr(open + 6, close - open - 6);
  const int digits = width.size() > 1 && width[0] == ':' ? std::atoi(width.c_str() + 1) : 0;
  return output.pattern.substr(0, open) + fmt::format("{:0{}}", frame, std::clamp(digits, 0, 12)) +
         output.pattern.substr(close + 1);
}

// Found out now, not after minutes of work.
void check_folder(const std::string& name) {
  const fs::path folder = fs::path(name).parent_path();
  if (!folder.empty() && !fs::is_directory(folder))
    fail(Exit::Output, "cannot write '{}': there is no folder '{}'; make it first", name, folder.string());
}

std::vector<Output> parse_outputs(const RenderOptions& o) {
  std::vector<Output> outputs;
  for (const std::string& name : o.outputs) {
    const std::string extension = fs::path(name).extension().string();
    if (extension != ".png" && extension != ".exr")
      fail(Exit::Usage, "bad output '{}': the name must end in .png or .exr", name);
    Output output{.pattern = name, .exr = extension == ".exr", .every_frame = name.find("{frame") != std::string::npos};
    if (output.every_frame && o.accumulate)
      fail(Exit::Usage, "bad output '{}': --accumulate writes one picture, the mean; leave {{frame}} out", name);
    check_folder(name);
    outputs.push_back(output);
  }
  check_folder(o.json_file);
  return outputs;
}

// The layers to write: those asked for; of "all", those that the technique has.
std::vector<const passes::Aov*> parse_layers(const RenderOptions& o, const std::vector<Output>& outputs) {
  const bool any_exr = std::any_of(outputs.begin(), outputs.end(), [](const Output& out) { return out.exr; });
  if (!o.aov.empty() && !any_exr) fail(Exit::Usage, "--aov needs an .exr output: layers do not fit into a PNG");
  std::vector<const passes::Aov*> layers;
  if (!any_exr) return layers;
  layers.push_back(&passes::find_aov(""));
  if (o.aov == "all") {
    for (const passes::Aov& aov : passes::aovs())
      if (*aov.name) layers.push_back(&aov);
    return layers;
  }
  for (size_t at = 0; at < o.aov.size();) {
    const size_t comma = std::min(o.aov.find(',', at), o.aov.size());
    const passes::Aov* layer = &passes::find_aov(o.aov.substr(at, comma - at));
    if (std::find(layers.begin(), layers.end(), layer) == layers.end()) layers.push_back(layer);
    at = comma + 1;
  }
  return layers;
}

class RenderJob {
 public:
  explicit RenderJob(RenderOptions& options) : o_(options), start_(Clock::now()) {}

  int run() {
    const std::vector<Output> outputs = parse_outputs(o_);
    const passes::FrameSettings settings =
        make_settings(o_, o_.accumulate ? Reconstruction::IfSet : Reconstruction::Default);
    view_.averaged = o_.accumulate;
    view_.size = parse_size(o_.size);
    view_.seed = o_.seed;
    std::vector<const passes::Aov*> layers = parse_layers(o_, outputs);
    const bool pictures = std::any_of(outputs.begin(), outputs.end(), [](const Output& out) { return !out.exr; });
    const bool each = std::any_of(outputs.begin(), outputs.end(), [](const Output& out) { return out.every_frame; });

    scene::Scene scene = open_scene(o_.scene, o_);
    scene::animate(scene, o_.time);
    view_.camera = view_.previous_camera = choose_view(o_, scene);
    if (o_.renderdoc) {
      if (*o_.renderdoc >= o_.frames)
        fail(Exit::Usage, "--renderdoc {}: frames are numbered from 0, and there are {}", *o_.renderdoc, o_.frames);
      gpu::load_renderdoc(fs::path(outputs[0].pattern).replace_extension().string());
    }
    gpu::Device device(device_options(o_));
    if (device.facts.software) log::warn("{} is a software device: pass times are CPU times", device.info.name);
    passes::Renderer renderer(device, scene, executor_options(o_));
    check_layers(renderer, settings, layers);

    const uint32_t total = o_.warmup + o_.frames;
    bool complete = true;
    {
      Progress progress("render", total, o_);
      for (uint32_t n = 0; n < total; ++n) {
        const bool last = n + 1 == total || interrupted();
        move(scene, renderer, n);
        const bool captured = o_.renderdoc && n == o_.warmup + *o_.renderdoc;
        if (captured) gpu::begin_capture(device);
        run_frame(renderer, settings, layers, pictures, n, last || (each && n >= o_.warmup));
        if (captured) written_.push_back(gpu::end_capture(device));
        if (n >= o_.warmup && each) write(outputs, layers, device, n - o_.warmup, true, true);
        progress.update(n + 1, fmt::format("{:.1f} ms", times_.frame_ms.empty() ? 0.0 : times_.frame_ms.back()));
        if (last) {
          complete = n + 1 == total;
          break;
        }
        if (o_.timeout > 0 && std::chrono::duration<double>(Clock::now() - start_).count() > o_.timeout)
          fail(Exit::Gpu,
               "time limit: {} of {} frames after {} s; raise --timeout, or use a smaller --size or fewer --frames",
               n + 1, total, o_.timeout);
      }
    }
    if (times_.frame_ms.empty() && complete && o_.frames > 0) log::debug("no pass times: the device has no timestamps");
    if (!complete && readbacks_.empty()) return int(Exit::Interrupted);
    write(outputs, layers, device, o_.frames - 1, false, complete);
    report(device, renderer, settings, complete);
    if (const size_t messages = device.take_messages().size())
      fail(Exit::CheckFailed, "{} validation messages (above)", messages);
    return complete ? int(Exit::Ok) : int(Exit::Interrupted);
  }

 private:
  // The scene at the frame's time. A mean of many frames is one of a scene at rest, unless a clock was asked for.
  void move(scene::Scene& scene, passes::Renderer& renderer, uint32_t n) {
    const bool still = o_.fps == 0 || (o_.accumulate && !o_.fps_given);
    renderer.update(scene::animate(scene, o_.time + (still ? 0 : n / o_.fps)));
    if (view_.camera.node != scene::none) scene::place(scene.nodes.world[view_.camera.node], view_.camera);
    if (n == 0) view_.previous_camera = view_.camera;
  }

  // A layer that this technique does not have: dropped from "all", an error when it was asked for by name.
  void check_layers(passes::Renderer& renderer, const passes::FrameSettings& settings,
                    std::vector<const passes::Aov*>& layers) {
    const std::vector<const passes::Aov*> given = layers_given(renderer, view_, settings, layers);
    for (const passes::Aov* aov : layers) {
      if (std::find(given.begin(), given.end(), aov) != given.end()) continue;
      if (o_.aov != "all")
        fail(Exit::Input, "no layer '{}': the technique {} does not give it", aov->name, settings.technique->id);
      log::info("no layer '{}': the technique {} does not give it", aov->name, settings.technique->id);
    }
    layers = given;
  }

  void run_frame(passes::Renderer& renderer, const passes::FrameSettings& settings,
                 const std::vector<const passes::Aov*>& layers, bool pictures, uint32_t n, bool wanted) {
    view_.frame_index = n;
    const bool counted = n >= o_.warmup;
    const int64_t mean = o_.accumulate && counted ? int64_t(n - o_.warmup) : -1;
    const graph::FrameResult result =
        editor::run_frame(renderer, view_, settings,
                          {.layers = layers, .picture = pictures, .mean = mean, .timing = parse_timing(o_.timing)});
    if (counted) times_.add(result);
    if (wanted) readbacks_ = renderer.executor().take_readbacks();
    if (wanted) measure();
  }

  // What the frame says about its own feedback and clamp.
  void measure() {
    for (const graph::Readback& readback : readbacks_) {
      const std::string_view name = readback.name;
      if (name != "readback.loop_energy" && name != "readback.clamped_energy") continue;
      uint32_t channels = 0;
      const std::vector<float> sums = graph::to_floats(readback, channels);
      const double x = double(sums[0]), y = double(sums[1]);
      if (name == "readback.loop_energy")
        measured_["loop_gain"] = y > 0 ? x / y : 0;
      else
        measured_["clamped_share"] = x + y > 0 ? y / (x + y) : 0;
    }
  }

  void write(const std::vector<Output>& outputs, const std::vector<const passes::Aov*>& layers,
             const gpu::Device& device, uint32_t frame, bool every_frame, bool complete) {
    std::vector<image::Layer> exr;
    for (size_t i = 0; i < layers.size(); ++i) {
      exr.push_back(to_layer(*layers[i], readbacks_[i]));
      const image::NonFinite bad = image::find_non_finite(exr.back().image);
      if (bad.any())
        log::error("layer '{}': {} NaN and {} infinite values, the first at pixel {},{}", layers[i]->name, bad.nan,
                   bad.inf, bad.first_x, bad.first_y);
    }
    for (const Output& output : outputs) {
      if (output.every_frame != every_frame) continue;
      const std::string name = output_name(output, frame);
      if (output.exr) {
        const std::map<std::string, std::string> header = {
            {"nearfield.command", command_line()},
            {"nearfield.version", version_short()},
            {"nearfield.device",
             fmt::format("{}, {} {}", device.info.name, device.info.driver, device.info.driver_info)},
            {"nearfield.seed", fmt::format("{}", o_.seed)},
            {"nearfield.frames", fmt::format("{}{}", o_.frames, o_.accumulate ? " accumulated" : "")},
            {"nearfield.complete", complete ? "true" : "false"}};
        image::write_exr(name, exr, header, o_.precision == "float" ? image::Precision::Float : image::Precision::Half);
      } else {
        image::write_png(name, to_image8(readbacks_.back()));
      }
      written_.push_back(name);
    }
  }

  void report(const gpu::Device& device, passes::Renderer& renderer, const passes::FrameSettings& settings,
              bool complete) {
    const std::vector<std::pair<std::string, capture::Statistics>> rows = times_.rows();
    const capture::Statistics frame = capture::statistics(times_.frame_ms);
    double sum = 0;
    for (const auto& [name, s] : rows) sum += s.median;
    const graph::Plan& plan = renderer.executor().plan();
    if (!o_.json_file.empty()) {
      const nlohmann::json document = {{"schema", "nearfield.render/1"},
                                       {"complete", complete},
                                       {"version", version_line()},
                                       {"command", command_line()},
                                       {"device",
                                        {{"name", device.info.name},
                                         {"type", device.info.type},
                                         {"driver", device.info.driver},
                                         {"driver_info", device.info.driver_info}}},
                                       {"technique", settings.technique->id},
                                       {"size", {view_.size.x, view_.size.y}},
                                       {"seed", o_.seed},
                                       {"frames", times_.frame_ms.size()},
                                       {"timing", o_.timing},
                                       {"draws", renderer.draws()},
                                       {"batches", renderer.batches()},
                                       {"passes", times_json(rows)},
                                       {"frame_ms", times_json({{"frame", frame}})[0]["gpu_ms"]},
                                       {"memory",
                                        {{"placed_bytes", plan.placed_bytes},
                                         {"max_live_bytes", plan.max_live_bytes},
                                         {"unaliased_bytes", plan.unaliased_bytes}}},
                                       {"measured", measured_},
                                       {"written", written_}};
      if (o_.json_file == "-") {
        fmt::print("{}\n", document.dump(1));
        return;
      }
      const std::string text = document.dump(1) + "\n";
      image::write_file(o_.json_file, text);
      written_.push_back(o_.json_file);
    }
    if (!rows.empty() && !o_.quiet) {
      fmt::print("{} on {} ({}), {}x{}, {} frame{}, median ms ({}{}):\n", settings.technique->id, device.info.name,
                 device.info.type, view_.size.x, view_.size.y, times_.frame_ms.size(),
                 times_.frame_ms.size() == 1 ? "" : "s", o_.timing, device.facts.software ? ", CPU times" : "");
      for (const auto& [name, s] : rows)
        fmt::print("  {:24} {:9.3f}  {:5.1f} %\n", name, s.median,
                   frame.median > 0 ? 100 * s.median / frame.median : 0);
      fmt::print("  {:24} {:9.3f}  {:5.1f} %\n", "unattributed", std::max(frame.median - sum, 0.0),
                 frame.median > 0 ? 100 * std::max(frame.median - sum, 0.0) / frame.median : 0);
      fmt::print("  {:24} {:9.3f}   p95 {:.3f}\n", "frame", frame.median, frame.p95);
      fmt::print("  {} draws in {} batches; transient images: {:.1f} MiB placed of {:.1f}\n", renderer.draws(),
                 renderer.batches(), double(plan.placed_bytes) / 1048576.0, double(plan.unaliased_bytes) / 1048576.0);
    }
    if (!o_.quiet && measured_.count("loop_gain"))
      fmt::print("  feedback: {:.3f} of the light gathered goes round again\n", measured_["loop_gain"]);
    if (!o_.quiet && measured_.count("clamped_share"))
      fmt::print("  firefly clamp: takes {:.2f} % of the light\n", 100 * measured_["clamped_share"]);
    for (const std::string& name : written_) fmt::print("{}\n", name);
  }

  RenderOptions& o_;
  Clock::time_point start_;
  passes::FrameView view_;
  std::map<std::string, double> measured_;
  PassTimes times_;
  std::vector<std::string> written_;
  std::vector<graph::Readback> readbacks_;
};

}  // namespace

Command add_render(CLI::App& parent) {
  auto state = std::make_shared<RenderOptions>();
  CLI::App* app = parent.add_subcommand("render", "Render a scene to PNG or EXR and print the GPU time of every pass");
  app->add_option("SCENE", state->scene, "glTF scene (.gltf, .glb)")->required();
  app->add_option("-o,--output", state->outputs,
                  "Where to write: .png, .exr, or a pattern like 'f_{frame:04}.png' (repeatable)")
      ->type_name("FILE")
      ->required()
      ->allow_extra_args(false);
  app->add_option("--aov", state->aov, "Layers for the EXR: all, or a list like gi,visibility,normal,depth")
      ->type_name("LIST");
  app->add_option("--frames", state->frames, "Frames to render; the last is written")
      ->check(CLI::Range(1u, 1000000u))
      ->capture_default_str();
  app->add_option("--warmup", state->warmup, "Frames before these that are not timed, accumulated or written")
      ->check(CLI::Range(0u, 1000000u))
      ->capture_default_str();
  app->add_flag("--accumulate", state->accumulate,
                "Write the linear mean of all frames: the technique's expected value");
  app->add_option("--time", state->time, "The scene's time at the first frame, in seconds")
      ->type_name("S")
      ->capture_default_str();
  app->add_option("--fps", state->fps,
                  "Fixed clock: simulated seconds per frame are 1 / FPS, 0 = the scene stands still; with --accumulate "
                  "it does so unless this is given")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app->add_option(
         "--renderdoc", state->renderdoc,
         "Capture this frame (the first is 0) for RenderDoc, beside the picture, where its library is installed")
      ->type_name("FRAME");
  app->add_option("--precision", state->precision, "EXR channels")
      ->check(CLI::IsMember({"half", "float"}))
      ->capture_default_str();
  app->add_option("--json", state->json_file, "Times, sizes and paths as one JSON document; - for stdout")
      ->type_name("FILE");
  add_render_flags(*app, *state);
  app->footer(
      "Surfaces with alphaMode BLEND are drawn over the finished picture, outside GI and the other layers; "
      "--set material.blend=cutout cuts them out instead.\n"
      "Examples:\n  nearfield render scene.glb -o a.png --size 640x360 --frames 8\n  nearfield render scene.glb --view "
      "view.json -o a.exr --aov all --frames 64 --accumulate");
  return {app, [state, app] {
            start_log(*state);
            state->fps_given = app->count("--fps") > 0;
            watch_interrupt();
            return RenderJob(*state).run();
          }};
}

}  // namespace nf::editor
