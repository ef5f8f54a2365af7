// One cell: a technique's expected value and its time, held against both references.
#include <algorithm>
#include <cmath>

#include "cli/evaluate.h"
#include "cli/reference_options.h"
#include "core/fingerprint.h"
#include "core/log.h"
#include "graph/probe.h"
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

double mean_value(const image::Image& picture, const std::vector<uint8_t>& mask) {
  return image::bias({picture, picture, mask}).reference;
}

// What frames are made with: the technique alone and, where a resolution is asked for, that with its upsampling.
passes::FrameSettings measured(const Contender& contender) {
  passes::FrameSettings settings = contender.settings;
  const int resolution = settings.resolution.gi;
  settings.switch_off_reconstruction();
  settings.reconstruct = !contender.resolution.empty();
  if (settings.reconstruct) settings.resolution.gi = resolution;
  return settings;
}

constexpr const char* radius_names[] = {"ball", "ball_falloff", "disc"};

json part_json(const image::ErrorPart& part) {
  return {{"bias", part.bias}, {"rmse", part.rmse}, {"floor", part.floor}};
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
  f.add(options_.frames), f.add(options_.timed), f.add(options_.spp), f.add(options_.bounces), f.add(options_.timing);
  f.add(device_.info.name), f.add(device_.info.driver), f.add(device_.info.driver_info);
  return f.value();
}

std::vector<image::Layer> Stage::mean(const passes::FrameSettings& settings, std::span<const passes::Aov* const> layers,
                                      uint32_t seed, uint32_t frames) {
  passes::FrameView view = view_;
  view.seed = seed;
  return mean_layers(*renderer_, view, settings, layers, frames);
}

std::vector<image::Layer> Stage::settled_mean(const Contender& of, const passes::Aov& layer, uint32_t seed,
                                              uint32_t frames, double& gain, uint32_t& before) {
  // Of what is left out by beginning to count, all bounces behind this share of the first.
  constexpr double left = 1e-3;
  constexpr uint32_t least = 4, most = 128;
  passes::FrameSettings settings = measured(of);
  settings.reconstruct = true;
  const int reprojection = of.settings.feedback.reprojection;
  settings.feedback.reprojection = reprojection ? reprojection : 1;
  const passes::Aov* const layers[] = {&layer};
  passes::FrameView view = view_;
  view.seed = seed;
  std::vector<image::Layer> out;
  before = 0;
  for (uint32_t n = 0, counted = 0; counted < frames; ++n) {
    if (interrupted()) return {};
    view.frame_index = n;
    const bool counts = before > 0;
    run_frame(*renderer_, view, settings, {.layers = layers, .mean = counts ? counted : 0, .forget = n == 0});
    const std::vector<graph::Readback> readbacks = renderer_->executor().take_readbacks();
    counted += counts;
    if (counted == frames) out.push_back(to_layer(layer, readbacks.front()));
    if (counts) continue;
    const graph::Readback* energy = graph::find_readback(readbacks, "readback.loop_energy");
    NF_CHECK(energy, "{} has no feedback", of.technique);
    uint32_t have = 0;
    const std::vector<float> sums = graph::to_floats(*energy, have);
    gain = sums[1] > 0 ? sums[0] / sums[1] : 0;
    // A frame adds a bounce, of `gain` of the one before.
    if (n + 1 >= least && (n + 1 >= most || std::pow(gain, n + 1) < left)) before = n + 1;
  }
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

json Stage::count_samples(const passes::FrameSettings& settings) {
  constexpr uint32_t grid = 8;
  passes::FrameView view = view_;
  std::map<passes::InspectReason, size_t> counts;
  size_t all = 0, pixels = 0;
  for (uint32_t n = 0; n < grid * grid; ++n) {
    if (interrupted()) return nullptr;
    view.frame_index = n;
    const glm::uvec2 cell(n % grid, n / grid);
    const std::optional<passes::Inspection> seen =
        inspect_pixel(*renderer_, view, settings, (2u * cell + 1u) * view.size / (2 * grid));
    if (!seen) return nullptr;
    pixels += seen->depth > 0;
    all += seen->samples.size();
    for (const passes::InspectedSample& sample : seen->samples) ++counts[sample.reason];
  }
  if (all == 0) return nullptr;
  json out = {
      {"samples", all}, {"pixels", pixels}, {"idle", 1 - double(counts[passes::InspectReason::Counted]) / double(all)}};
  for (const auto& [reason, count] : counts) out[passes::inspect_reason_name(reason)] = double(count) / double(all);
  return out;
}

// What is on the screen, and the passes that every technique's frame has.
void Stage::look(const passes::FrameSettings& of) {
  if (!renderer_) renderer_ = std::make_unique<passes::Renderer>(device_, scene_, executor_options(options_));
  passes::FrameSettings settings = of;
  settings.technique = &passes::find_technique("none");
  settings.reconstruct = false;
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

json Stage::errors(const Measurement& of, const std::vector<uint8_t>& mask) const {
  const image::Image test_mean = image::mean_of(of.test), path_mean = image::mean_of(of.path);
  if (const image::NonFinite bad = image::find_non_finite(test_mean); bad.any())
    log::error("{}, {}: {} has {} NaN and infinite values", place_.label, of.label, of.quantity.title,
               bad.nan + bad.inf);
  const double average = mean_value(path_mean, mask);
  if (average == 0) return nullptr;
  if (on_means) on_means(of.quantity, of.test, of.path, mask);
  const image::Pair pair{test_mean, path_mean, mask};
  json row = {
      {"reference_mean", average},
      {"total", part_json(image::error_between(of.test, of.path, mask))},
      {"relmse", image::measure(image::Metric::RelMse, pair, true).value},
      {"flip", image::measure(image::Metric::Flip, pair, true).value},
      {"noise", {{"technique", image::noise_of(of.test, mask)}, {"path_traced", image::noise_of(of.path, mask)}}}};
  if (of.one) row["single_frame_rmse"] = image::error_between({*of.one, *of.one}, of.path, mask).rmse;
  if (!of.same) return row;
  const image::ErrorSplit parts = image::split_error(of.test, *of.same, of.path, mask);
  row["estimator"] = part_json(parts.estimator);
  row["missing"] = part_json(parts.missing);
  row["noise"]["same_information"] = image::noise_of(*of.same, mask);
  if (!of.picture.empty()) {
    image::write_png(of.picture, image::split_picture(test_mean, image::mean_of(*of.same), path_mean, mask));
    row["picture"] = of.picture.filename().string();
  }
  return row;
}

json Stage::measure_bounces(const Contender& contender, const Quantity& q, TruthStore& store,
                            const reference::MarchSettings& march, const std::vector<uint8_t>& mask,
                            const fs::path& picture) {
  const passes::FrameSettings& settings = contender.settings;
  const Truth* truth = store.path_traced_bounces(scene_, view_.camera, settings);
  if (!truth) return nullptr;
  // What a surface reflects is known of Lambert surfaces only, and the marcher's first bounce has no sky to begin with.
  const bool known = settings.material.lambert && !settings.feedback.include_ambient && settings.feedback.emissive;
  const Truth* same = known ? store.same_information_bounces(buffers_, march, settings.feedback.albedo_limit) : nullptr;
  if (known && !same) return nullptr;
  double gain = 0;
  uint32_t before = 0;
  const uint32_t half = (options_.frames + 1) / 2;
  const passes::Aov& layer = passes::find_aov(q.layer);
  std::vector<image::Layer> a = settled_mean(contender, layer, options_.seed * 2, half, gain, before);
  std::vector<image::Layer> b = settled_mean(contender, layer, options_.seed * 2 + 1, half, gain, before);
  if (a.empty() || b.empty()) return nullptr;
  const image::Halves test{std::move(a[0].image), std::move(b[0].image)};
  json row = errors(
      {q, test, truth->at(q.truth), same ? &same->at(q.same) : nullptr, nullptr, contender.label, picture}, mask);
  if (!row.is_object()) return row;
  row["bounces"] = options_.bounces;
  row["loop_gain"] = gain;
  row["settled_after"] = before;
  row["last_bounce"] = mean_value(image::mean_of(truth->at("last")), mask) / row["reference_mean"].get<double>();
  return row;
}

json Stage::measure(const Contender& of, TruthStore& store, const fs::path& folder) {
  Contender contender = of;
  passes::find_radius(contender.settings, scene_);
  const passes::FrameSettings settings = measured(contender);
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
    if (!q.with_bounces) layers.push_back(&passes::find_aov(q.layer));
  layers = layers_given(*renderer_, view_, settings, layers);
  const uint32_t half = (options_.frames + 1) / 2;
  const std::vector<image::Layer> a = mean(settings, layers, options_.seed * 2, half),
                                  b = mean(settings, layers, options_.seed * 2 + 1, half),
                                  one = mean(settings, layers, options_.seed, 1);
  const PassTimes times = time(settings);
  const json samples = count_samples(settings);
  if (interrupted()) return nullptr;

  uint64_t left_out = 0;
  const std::vector<uint8_t> mask = image::common_surfaces(buffers_.depth, truth->at("depth").a.pixels, left_out);
  json measured = json::object(), absent = json::object();
  for (const Quantity& q : quantities()) {
    if (!image::find_layer(a, q.layer)) {
      absent[q.id] = "the technique does not give it";
      continue;
    }
    const std::string name = fmt::format("{}.{}.{}.png", place_.label, contender.label, q.id),
                      picture = options_.pictures ? (folder / name).string() : "";
    json row;
    if (q.with_bounces) {
      if (options_.bounces < 2) {
        absent[q.id] = "not asked for: --bounces";
        continue;
      }
      row = measure_bounces(contender, q, store, march, mask, picture);
      if (interrupted()) return nullptr;
    } else {
      const image::Halves test{image::find_layer(a, q.layer)->image, image::find_layer(b, q.layer)->image};
      const auto known = same->find(q.same);
      row = errors({q, test, truth->at(q.truth), known == same->end() ? nullptr : &known->second,
                    &image::find_layer(one, q.layer)->image, contender.label, picture},
                   mask);
    }
    if (row.is_null())
      absent[q.id] = "there is no such light in this view";
    else
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
  passes::FrameSettings all = contender.settings;
  return {{"place", place_.label},
          {"scene", place_.scene},
          {"view", place_.view},
          {"contender", contender.label},
          {"technique", contender.technique},
          {"mode", contender.mode},
          {"preset", contender.preset},
          {"resolution", contender.resolution},
          {"params", params::to_json(all.blocks())},
          {"radius", fmt::format("{} m {}", march.radius, radius_names[int(march.radius_mode)])},
          {"note", march_note(settings)},
          {"lambert", lambert},
          {"pixels", std::count(mask.begin(), mask.end(), 1)},
          {"pixels_left_out", left_out},
          {"ms", ms},
          {"samples", samples},
          {"quantities", measured},
          {"absent", absent}};
}

}  // namespace nf::editor
