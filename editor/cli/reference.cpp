// `nearfield reference`: the path-traced truth of a view, layer by layer, to a number of samples, a time or an error.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/progress.h"
#include "cli/reference_options.h"
#include "cli/scene_input.h"
#include "core/log.h"
#include "image/file.h"
#include "marcher.h"
#include "scene/view.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

void check_output(const std::string& name, const char* extension) {
  if (fs::path(name).extension() != extension)
    fail(Exit::Usage, "bad output '{}': the name must end in {}", name, extension);
  const fs::path folder = fs::path(name).parent_path();
  if (!folder.empty() && !fs::is_directory(folder))
    fail(Exit::Output, "cannot write '{}': there is no folder '{}'; make it first", name, folder.string());
}

class ReferenceJob {
 public:
  explicit ReferenceJob(ReferenceOptions& options) : o_(options), checkpoint_(o_.output + ".checkpoint") {}

  int run() {
    check_output(o_.output, ".exr");
    if (!o_.json_file.empty() && o_.json_file != "-") check_output(o_.json_file, ".json");
    passes::FrameSettings frame = make_settings(o_);
    reference::Settings settings = tracer_settings(o_, frame.material);
    const std::vector<std::string> layers = reference::parse_layers(o_.aov, o_.bounces);
    check_kind();
    scene::Scene scene = open_scene(o_.scene, o_);
    passes::find_radius(frame, scene);
    describe_radius(frame.gi.shared);
    settings.camera = choose_view(o_, scene);
    start_ = Clock::now();
    if (o_.same_information) {
      reference::Buffers buffers = read_buffers(scene, settings);
      reference::MarchSettings march = march_settings(o_, frame, settings.camera);
      // Ambient light can be told where albedo is the diffuse reflectance.
      if (frame.material.lambert != 0) march.environment = &scene.environment;
      if (const std::string note = march_note(frame); !note.empty()) log::warn("{}", note);
      if (o_.gpu) {
        gpu::Device device(device_options(o_));
        backend_ = fmt::format("{}, {} {}", device.info.name, device.info.driver, device.info.driver_info);
        passes::GpuMarcher marcher(device, std::move(buffers), march);
        return finish(marcher);
      }
      reference::Marcher marcher(std::move(buffers), march);
      return finish(marcher);
    }
    reference::Tracer tracer(scene, settings, layers);
    log::debug("ray structure of {} triangles after {:.2f} s", scene.triangles(), elapsed());
    if (o_.resume && fs::exists(checkpoint_)) {
      tracer.load(checkpoint_);
      log::info("resuming at {} samples a pixel", tracer.samples());
    }
    return finish(tracer);
  }

 private:
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  void check_kind() const {
    if (o_.same_information && o_.resume)
      fail(Exit::Usage, "--same-information has no checkpoints: leave --resume away");
    if (!o_.same_information && (!o_.buffers.empty() || o_.any_emitter || o_.directions != "cosine" || o_.gpu))
      fail(Exit::Usage, "--buffers, --any-emitter, --directions and --gpu belong to --same-information: add it");
  }

  void describe_radius(const passes::GiParams& gi) {
    const std::string radius = !o_.radius.empty()    ? o_.radius
                               : o_.same_information ? fmt::format("{}", gi.radius)
                                                     : "inf";
    constexpr const char* modes[] = {"disc", "ball", "ball_falloff"};
    const std::string mode = !o_.radius_mode.empty() ? o_.radius_mode
                             : o_.same_information   ? modes[gi.radius_mode]
                                                     : "ball";
    radius_text_ = radius + " " + mode;
  }

  // What the techniques see: out of a file, or made here from the first surfaces and their direct light.
  reference::Buffers read_buffers(const scene::Scene& scene, const reference::Settings& settings) {
    if (o_.buffers.empty()) {
      reference::Tracer tracer(scene, settings, {"depth", "normal", "radiance", "albedo"});
      tracer.sample(2);
      inputs_ = tracer.layers();
    } else {
      for (image::Layer& layer : image::read_exr(o_.buffers).layers)
        if (layer.name == "depth" || layer.name == "normal" || layer.name == "radiance" || layer.name == "albedo")
          inputs_.push_back(std::move(layer));
    }
    return reference::buffers_from(inputs_);
  }

  template <class Estimator>
  int finish(Estimator& estimator) {
    const bool complete = work(estimator);
    write(estimator, complete);
    report(estimator, complete);
    return int(complete ? Exit::Ok : Exit::Interrupted);
  }

  template <class Estimator>
  static constexpr bool traces = std::is_same_v<Estimator, reference::Tracer>;

  // Rounds of about half a second; false when interrupted before the target.
  template <class Estimator>
  bool work(Estimator& tracer) {
    const bool by_count = o_.spp || (!o_.seconds && !o_.until_error);
    const uint32_t target = by_count ? o_.spp.value_or(default_spp) : most_spp;
    Progress progress("reference", by_count ? target : o_.seconds ? uint64_t(*o_.seconds * 10) + 1 : 1000, o_);
    uint32_t round = 2;
    double saved = elapsed();
    while (tracer.samples() < target) {
      if (o_.seconds && tracer.samples() > 0 && elapsed() >= *o_.seconds) break;
      if (interrupted() && tracer.samples() > 0) return false;
      const double before = elapsed();
      tracer.sample(std::min(round, target - tracer.samples()));
      const double took = elapsed() - before;
      if (took < 0.25) round = std::min(round * 2, 4096u);
      if (took > 1 && round > 2) round = std::max(2u, round / 4 * 2);
      const double error = worst(tracer);
      if (o_.until_error && tracer.samples() >= 16 && error <= *o_.until_error) break;
      const std::string note = fmt::format("{} spp, noise {:.2f} %", tracer.samples(), 100 * error);
      // Towards an error the way is as the square of its ratio.
      const double goal = o_.until_error ? *o_.until_error : 0;
      progress.update(by_count     ? tracer.samples()
                      : o_.seconds ? uint64_t(std::min(elapsed(), *o_.seconds) * 10)
                                   : uint64_t(std::min(999.0, error > 0 ? 1000 * goal * goal / (error * error) : 0)),
                      note);
      if constexpr (traces<Estimator>) {
        if (elapsed() - saved > 60) {
          tracer.save(checkpoint_);
          saved = elapsed();
        }
      }
    }
    return true;
  }

  // The relative noise of the layer that has most of it.
  template <class Estimator>
  static double worst(const Estimator& tracer) {
    double most = 0;
    for (const reference::Noise& n : tracer.noise()) most = std::max(most, n.relative());
    return most;
  }

  template <class Estimator>
  void write(Estimator& tracer, bool complete) {
    std::string noise;
    for (const reference::Noise& n : tracer.noise())
      noise += fmt::format("{}{}={:.6g}", noise.empty() ? "" : " ", n.layer.empty() ? "RGB" : n.layer, n.rmse);
    const std::map<std::string, std::string> header = {{"nearfield.command", command_line()},
                                                       {"nearfield.version", version_short()},
                                                       {"nearfield.device", backend_},
                                                       {"nearfield.seed", fmt::format("{}", o_.seed)},
                                                       {"nearfield.spp", fmt::format("{}", tracer.samples())},
                                                       {"nearfield.bounces", fmt::format("{}", o_.bounces)},
                                                       {"nearfield.radius", radius_text_},
                                                       {"nearfield.noise_rmse", noise},
                                                       {"nearfield.complete", complete ? "true" : "false"}};
    const image::Precision precision = o_.precision == "half" ? image::Precision::Half : image::Precision::Float;
    const auto put = [&](const std::string& name, const std::vector<image::Layer>& layers) {
      for (const image::Layer& layer : layers) {
        const image::NonFinite bad = image::find_non_finite(layer.image);
        if (bad.any())
          log::error("layer '{}': {} NaN and {} infinite values, the first at pixel {},{}", layer.name, bad.nan,
                     bad.inf, bad.first_x, bad.first_y);
      }
      image::write_exr(name, layers, header, precision);
      written_.push_back(name);
    };
    std::vector<image::Layer> all = tracer.layers();
    all.insert(all.end(), inputs_.begin(), inputs_.end());
    put(o_.output, all);
    if (o_.halves) {
      const std::string stem = o_.output.substr(0, o_.output.size() - 4);
      put(stem + ".a.exr", tracer.half(0));
      put(stem + ".b.exr", tracer.half(1));
    }
    if constexpr (traces<Estimator>) {
      if (!complete || o_.resume) {
        tracer.save(checkpoint_);
        written_.push_back(checkpoint_);
      } else {
        std::error_code ignored;
        fs::remove(checkpoint_, ignored);
      }
    }
  }

  template <class Estimator>
  void report(const Estimator& tracer, bool complete) {
    const double seconds = elapsed();
    double rays = double(tracer.samples()) * parse_size(o_.size).x * parse_size(o_.size).y / std::max(seconds, 1e-6);
    if constexpr (traces<Estimator>) rays = double(tracer.rays()) / std::max(seconds, 1e-6);
    if (!o_.json_file.empty()) {
      nlohmann::json noise = nlohmann::json::array();
      for (const reference::Noise& n : tracer.noise())
        noise.push_back({{"layer", n.layer}, {"rmse", n.rmse}, {"mean", n.mean}, {"relative", n.relative()}});
      const nlohmann::json document = {{"schema", "nearfield.reference/1"},
                                       {"complete", complete},
                                       {"version", version_line()},
                                       {"command", command_line()},
                                       {"backend", backend_},
                                       {"size", {parse_size(o_.size).x, parse_size(o_.size).y}},
                                       {"spp", tracer.samples()},
                                       {"seconds", seconds},
                                       {"rays_per_second", rays},
                                       {"noise", noise},
                                       {"written", written_}};
      const std::string text = document.dump(1) + "\n";
      if (o_.json_file == "-") {
        fmt::print("{}", text);
        return;
      }
      image::write_file(o_.json_file, text);
      written_.push_back(o_.json_file);
    }
    if (!o_.quiet) {
      fmt::print("{} samples a pixel in {:.1f} s, {:.2f} million rays/s; noise left, from two halves:\n",
                 tracer.samples(), seconds, rays / 1e6);
      for (const reference::Noise& n : tracer.noise())
        fmt::print("  {:16} {:10.3g}  {:6.2f} % of its mean\n", n.layer.empty() ? "R,G,B" : n.layer, n.rmse,
                   100 * n.relative());
    }
    for (const std::string& name : written_) fmt::print("{}\n", name);
  }

  ReferenceOptions& o_;
  std::string checkpoint_;
  Clock::time_point start_;
  std::vector<std::string> written_;
  std::vector<image::Layer> inputs_;  // of --same-information
  std::string radius_text_, backend_ = reference::backend();
};

}  // namespace

Command add_reference(CLI::App& parent) {
  auto state = std::make_shared<ReferenceOptions>();
  CLI::App* app = parent.add_subcommand("reference", "Path-trace the truth of a view into layers, on the CPU");
  add_reference_flags(*app, *state);
  app->parse_complete_callback([app, state = state.get()] {
    state->size_given = app->count("--size") > 0;
    state->seed_given = app->count("--seed") > 0;
    state->view_given = app->count("--view") > 0;
  });
  app->footer(reference_help());
  return {app, [state] {
            start_log(*state);
            watch_interrupt();
            return ReferenceJob(*state).run();
          }};
}

}  // namespace nf::editor
