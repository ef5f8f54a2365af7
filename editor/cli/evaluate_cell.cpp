// One cell: a technique's expected value and its time, held against both references.
#include <algorithm>
#include <cmath>

#include "cli/evaluate.h"
#include "cli/reference_options.h"
#include "core/fingerprint.h"
#include "core/log.h"
#include "image/file.h"
#include "scene/gltf.h"
#include "scene/view.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Of this program and its shaders: another build's numbers are not this one's.
uint64_t program_fingerprint() {
  static const uint64_t value = [] {
    Fingerprint f;
    f.add(image::read_file("/proc/self/exe"));
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(gpu::find_shader_folder()))
      if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) f.add(image::read_file(file));
    return f.value();
  }();
  return value;
}

// The pixels whose first surface is the same to the rasteriser and to the tracer; `left_out` are those that differ.
std::vector<uint8_t> common_surfaces(const std::vector<float>& seen, const std::vector<float>& traced,
                                     uint64_t& left_out) {
  std::vector<uint8_t> mask(seen.size());
  for (size_t i = 0; i < seen.size(); ++i) {
    mask[i] = seen[i] > 0 && traced[i] > 0 && std::abs(seen[i] - traced[i]) <= 0.02f * traced[i];
    left_out += !mask[i] && (seen[i] > 0 || traced[i] > 0);
  }
  return mask;
}

double mean_value(const image::Image& picture, const std::vector<uint8_t>& mask) {
  return image::bias({picture, picture, mask}).reference;
}

constexpr const char* radius_names[] = {"ball", "ball_falloff", "disc"};

json part_json(const image::ErrorPart& part) {
  return {{"bias", part.bias}, {"rmse", part.rmse}, {"floor", part.floor}};
}

const image::Image* find(const std::vector<image::Layer>& layers, std::string_view name) {
  for (const image::Layer& layer : layers)
    if (layer.name == name) return &layer.image;
  return nullptr;
}

}  // namespace

Stage::Stage(gpu::Device& device, const EvaluateOptions& options, const Place& place)
    : device_(device), options_(options), place_(place), scene_(scene::load_gltf(place.scene)) {
  view_.size = parse_size(options.size);
  view_.camera = view_.previous_camera = scene::select_view(place.view, scene_);
}

uint64_t Stage::key(const Contender& contender) const {
  passes::FrameSettings settings = contender.settings;
  reference::Settings s;
  s.camera = view_.camera;
  s.size = view_.size;
  s.seed = options_.seed;
  Fingerprint f;
  f.add(program_fingerprint()), f.add(reference::fingerprint(scene_, s, {}));
  f.add(contender.label), f.add(params::to_json(settings.blocks(), true).dump());
  f.add(options_.frames), f.add(options_.timed), f.add(options_.spp), f.add(options_.timing);
  f.add(device_.info.name), f.add(device_.info.driver), f.add(device_.info.driver_info);
  return f.value();
}

std::vector<image::Layer> Stage::mean(const passes::FrameSettings& settings, std::span<const passes::Aov* const> layers,
                                      uint32_t seed, uint32_t frames) {
  passes::FrameView view = view_;
  view.seed = seed;
  for (uint32_t n = 0; n < frames; ++n) {
    if (interrupted()) return {};
    view.frame_index = n;
    run_frame(*renderer_, view, settings, {.layers = layers, .mean = n, .forget = n == 0});
  }
  const std::vector<graph::Readback> readbacks = renderer_->executor().take_readbacks();
  std::vector<image::Layer> out;
  for (size_t i = 0; i < layers.size(); ++i) out.push_back(to_layer(*layers[i], readbacks[i]));
  return out;
}

PassTimes Stage::time(const passes::FrameSettings& settings) {
  constexpr uint32_t warmup = 2;
  passes::FrameView view = view_;
  PassTimes times;
  for (uint32_t n = 0; n < warmup + options_.timed && !interrupted(); ++n) {
    view.frame_index = n;
    const graph::FrameResult frame = run_frame(
        *renderer_, view, settings, {.picture = true, .timing = parse_timing(options_.timing), .forget = n == 0});
    if (n >= warmup) times.add(frame);
  }
  return times;
}

// What is on the screen, and the passes that every technique's frame has.
void Stage::look(const passes::FrameSettings& of) {
  if (!renderer_) renderer_ = std::make_unique<passes::Renderer>(device_, scene_, executor_options(options_));
  passes::FrameSettings settings = of;
  settings.technique = &passes::find_technique("none");
  const ParamBlock visible[] = {{&passes::MaterialParams::table(), &settings.material},
                                {&passes::LightParams::table(), &settings.lights},
                                {&passes::ShadowParams::table(), &settings.shadow}};
  const std::string now = params::to_json(visible, true).dump();
  if (now == looked_with_) return;
  std::vector<const passes::Aov*> layers;
  for (const char* name : {"depth", "normal", "radiance", "albedo"}) layers.push_back(&passes::find_aov(name));
  const std::vector<image::Layer> seen = mean(settings, layers, options_.seed, std::min(options_.frames, 16u));
  if (seen.empty()) return;
  buffers_ = reference::buffers_from(seen);
  common_passes_.clear();
  run_frame(*renderer_, view_, settings, {.picture = true});
  for (const auto& row : time(settings).order) common_passes_.insert(row);
  looked_with_ = now;
}

json Stage::measure(const Contender& contender, TruthStore& store, const fs::path& folder) {
  const passes::FrameSettings& settings = contender.settings;
  const bool lambert = settings.material.lambert != 0;
  look(settings);
  reference::MarchSettings march = march_settings(settings, view_.camera);
  march.seed = options_.seed;
  march.threads = options_.threads;
  // A perfect estimator's ambient light is known for Lambert surfaces only.
  if (lambert) march.environment = &scene_.environment;
  const Truth* truth = interrupted() ? nullptr : store.path_traced(scene_, view_.camera, settings);
  const Truth* same = truth ? store.same_information(buffers_, march) : nullptr;
  if (!same) return nullptr;

  std::vector<const passes::Aov*> layers;
  for (const Quantity& q : quantities())
    if (!q.not_there) layers.push_back(&passes::find_aov(q.layer));
  layers = layers_given(*renderer_, view_, settings, layers);
  const uint32_t half = (options_.frames + 1) / 2;
  const std::vector<image::Layer> a = mean(settings, layers, options_.seed * 2, half),
                                  b = mean(settings, layers, options_.seed * 2 + 1, half),
                                  one = mean(settings, layers, options_.seed, 1);
  const PassTimes times = time(settings);
  if (interrupted()) return nullptr;

  uint64_t left_out = 0;
  const std::vector<uint8_t> mask = common_surfaces(buffers_.depth, truth->at("depth").a.pixels, left_out);
  json measured = json::object(), absent = json::object();
  for (const Quantity& q : quantities()) {
    const image::Image* first = find(a, q.layer);
    if (q.not_there || !first) {
      absent[q.id] = q.not_there ? q.not_there : "the technique does not give it";
      continue;
    }
    const image::Halves test{*first, *find(b, q.layer)}, &path = truth->at(q.truth);
    const image::Image test_mean = image::mean_of(test), path_mean = image::mean_of(path);
    if (const image::NonFinite bad = image::find_non_finite(test_mean); bad.any())
      log::error("{}, {}: {} has {} NaN and infinite values", place_.label, contender.label, q.title,
                 bad.nan + bad.inf);
    const double average = mean_value(path_mean, mask);
    if (average == 0) {
      absent[q.id] = "there is no such light in this view";
      continue;
    }
    const image::Pair pair{test_mean, path_mean, mask};
    json row = {
        {"reference_mean", average},
        {"total", part_json(image::error_between(test, path, mask))},
        {"single_frame_rmse", image::error_between({*find(one, q.layer), *find(one, q.layer)}, path, mask).rmse},
        {"relmse", image::measure(image::Metric::RelMse, pair, true).value},
        {"flip", image::measure(image::Metric::Flip, pair, true).value},
        {"noise", {{"technique", image::noise_of(test, mask)}, {"path_traced", image::noise_of(path, mask)}}}};
    if (const auto known = same->find(q.same); known != same->end()) {
      const image::ErrorSplit parts = image::split_error(test, known->second, path, mask);
      row["estimator"] = part_json(parts.estimator);
      row["missing"] = part_json(parts.missing);
      row["noise"]["same_information"] = image::noise_of(known->second, mask);
      if (options_.pictures) {
        const std::string name = fmt::format("{}.{}.{}.png", place_.label, contender.label, q.id);
        image::write_png(folder / name,
                         image::split_picture(test_mean, image::mean_of(known->second), path_mean, mask));
        row["picture"] = name;
      }
    }
    measured[q.id] = row;
  }

  double technique_ms = 0;
  const auto rows = times.rows();
  for (const auto& [name, statistics] : rows)
    if (!common_passes_.count(name)) technique_ms += statistics.median;
  json ms = nullptr;
  if (!times.frame_ms.empty())
    ms = {{"technique", technique_ms},
          {"frame", capture::statistics(times.frame_ms).median},
          {"passes", times_json(rows)}};
  passes::FrameSettings all = settings;
  return {{"place", place_.label},
          {"scene", place_.scene},
          {"view", place_.view},
          {"contender", contender.label},
          {"technique", contender.technique},
          {"mode", contender.mode},
          {"preset", contender.preset},
          {"params", params::to_json(all.blocks())},
          {"radius", fmt::format("{} m {}", march.radius, radius_names[int(march.radius_mode)])},
          {"note", march_note(settings)},
          {"lambert", lambert},
          {"pixels", std::count(mask.begin(), mask.end(), 1)},
          {"pixels_left_out", left_out},
          {"ms", ms},
          {"quantities", measured},
          {"absent", absent}};
}

}  // namespace nf::editor
