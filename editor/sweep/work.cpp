// Measuring cells: scenes, references, groups of cells in turn.
#include <algorithm>
#include <cmath>
#include <fcntl.h>

#include "cli/progress.h"
#include "core/log.h"
#include "image/file.h"
#include "reference/reference.h"
#include "scene/animation.h"
#include "scene/gltf.h"
#include "scene/view.h"
#include "sweep/sweep.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

image::Image8 to_picture(const image::Image& layer) {
  image::Image8 out{layer.width, layer.height, 3, {}};
  for (size_t texel = 0; texel < size_t(layer.width) * layer.height; ++texel)
    for (uint32_t c = 0; c < 3; ++c) {
      const float value = layer.pixels[texel * layer.channels + std::min(c, layer.channels - 1)];
      out.pixels.push_back(uint8_t(255 * image::srgb_from_linear(std::clamp(value, 0.0f, 1.0f)) + 0.5f));
    }
  return out;
}

// A file name that no other id has.
std::string file_name(const std::string& id) {
  uint32_t hash = 2166136261u;
  std::string name;
  for (const char c : id) {
    hash = (hash ^ uint8_t(c)) * 16777619u;
    name += std::isalnum(uint8_t(c)) || c == '.' || c == '=' ? c : '_';
  }
  return fmt::format("{}_{:08x}", name.substr(0, 80), hash);
}

fs::path reference_file(const SweepWork& work, const SweepPlace& place) {
  const SweepReference& reference = *work.spec.reference;
  if (reference.file.empty()) return work.folder / "references" / (file_name(place.id) + ".exr");
  std::string name = reference.file;
  for (const auto& [mark, with] : {std::pair<std::string, std::string>("{place}", place.id),
                                   {"{scene}", fs::path(place.scene).stem().string()},
                                   {"{camera}", place.view}})
    for (size_t at = 0; (at = name.find(mark, at)) != std::string::npos; at += with.size())
      name.replace(at, mark.size(), with);
  return name;
}

// A place made ready. Whatever is not needed is not made.
struct Stage {
  scene::Scene scene;
  passes::FrameView view;
  Stage(const SweepSpec& spec, const SweepPlace& place) : scene(scene::load_gltf(place.scene)) {
    scene::animate(scene, spec.measure.time);
    view.size = spec.size;
    view.seed = spec.seed;
    view.camera = view.previous_camera = scene::select_view(place.view, scene);
  }
};

image::Image read_reference(const SweepWork& work, const SweepPlace& place) {
  const fs::path file = reference_file(work, place);
  for (image::Layer& layer : image::read_exr(file).layers)
    if (layer.name == work.spec.layer) {
      if (layer.image.width != work.spec.size.x || layer.image.height != work.spec.size.y)
        fail(Exit::Input, "the reference '{}' is {}x{}, the sweep's size is {}x{}: make it in that size", file.string(),
             layer.image.width, layer.image.height, work.spec.size.x, work.spec.size.y);
      return std::move(layer.image);
    }
  fail(Exit::Input, "the reference '{}' has no layer '{}'", file.string(), work.spec.layer);
}

bool trace_reference(const SweepWork& work, const SweepPlace& place) {
  const SweepSpec& spec = work.spec;
  const Stage stage(spec, place);
  reference::Settings settings{.camera = stage.view.camera, .size = spec.size, .bounces = spec.reference->bounces};
  settings.seed = spec.seed;
  for (const SweepRun& run : spec.runs) {
    settings.lambert |= run.base.value("material.lambert", false);
    const float albedo = run.base.value("material.albedo_scale", 1.0f),
                emissive = run.base.value("material.emissive_scale", 1.0f);
    if (&run != &spec.runs[0] && (albedo != settings.albedo_scale || emissive != settings.emissive_scale))
      fail(Exit::Input,
           "the sweep's runs differ in material.albedo_scale or material.emissive_scale, and have one "
           "reference: give all the same, or make two sweeps");
    settings.albedo_scale = albedo;
    settings.emissive_scale = emissive;
  }
  reference::Tracer tracer(stage.scene, settings, {spec.layer});
  Progress progress("reference of " + place.id, spec.reference->spp, work.options);
  while (tracer.samples() < spec.reference->spp) {
    if (interrupted()) return false;
    tracer.sample(std::min(8u, spec.reference->spp - tracer.samples()));
    progress.update(tracer.samples());
  }
  fs::create_directories(work.folder / "references");
  image::write_exr(reference_file(work, place), tracer.layers(),
                   {{"nearfield.version", version_short()}, {"nearfield.spp", std::to_string(spec.reference->spp)}},
                   image::Precision::Float);
  return true;
}

std::string command_of(const SweepSpec& spec, const SweepCell& cell, const SweepPlace& place) {
  const SweepRun& run = spec.runs[cell.run];
  const auto quoted = [](const std::string& text) {
    return text.find_first_of(" '\"$&|;()*") == std::string::npos ? text : "'" + text + "'";
  };
  std::string text = "nearfield bench " + quoted(place.scene);
  if (!place.view.empty()) text += " --view " + quoted(place.view);
  text +=
      fmt::format(" --technique {} --size {}x{} --seed {} --fps 0 --frames {} --warmup {} --repeats {}", run.technique,
                  spec.size.x, spec.size.y, spec.seed, spec.measure.frames, spec.measure.warmup, spec.measure.repeats);
  if (!run.mode.empty()) text += " --mode " + run.mode;
  for (const auto& [id, value] : cell.params.items())
    text += " --set " + quoted(id + "=" + (value.is_string() ? value.get<std::string>() : value.dump()));
  return text;
}

// Measures cells of one place.
class PlaceWork {
 public:
  PlaceWork(const SweepWork& work, gpu::Device& device, const SweepPlace& place)
      : work_(work),
        place_(place),
        device_(device),
        stage_(work.spec, place),
        renderer_(device, stage_.scene, executor_options(work.options)) {
    if (!work.spec.reference) return;
    reference_ = read_reference(work, place);
    reference_picture_ = "pictures/" + file_name("reference " + place.id) + ".png";
    image::write_png(work.folder / reference_picture_, to_picture(reference_));
  }

  Measured measure(const std::vector<Subject>& subjects, const MeasureOptions& options) {
    Meter meter(device_, stage_.scene, renderer_, stage_.view, options, &passes::find_aov(work_.spec.layer));
    return meter.run(subjects, work_.options.timeout);
  }

  bool run(const std::vector<const SweepCell*>& cells, SweepStore& store) {
    std::vector<Subject> subjects;
    for (const SweepCell* cell : cells) subjects.push_back(subject_of(work_.spec, *cell));
    const capture::LoadWatch watch;
    const Measured measured = measure(subjects, work_.spec.measure);
    if (!measured.complete) return false;
    std::vector<Subject> without = subjects;
    for (Subject& subject : without) subject.settings.technique = &passes::find_technique("none");
    MeasureOptions once = work_.spec.measure;
    once.warmup = 0, once.frames = once.repeats = 1;
    const Measured plain = measure(without, once);
    if (!plain.complete) return false;
    for (size_t i = 0; i < cells.size(); ++i)
      store.add(row(*cells[i], subjects[i], measured.runs[i], measured.last[i],
                    technique_time(measured.runs[i], plain.runs[i]), watch.load()));
    return true;
  }

 private:
  // Of the passes that this frame without its technique, `plain`, does not have.
  static capture::Statistics technique_time(const capture::Run& run, const capture::Run& plain) {
    std::set<std::string> others;
    for (const capture::PassInfo& pass : plain.passes) others.insert(pass.path);
    std::vector<double> sums;
    for (const capture::FrameSample& frame : run.frames) {
      double& sum = sums.emplace_back(0);
      for (const capture::PassSample& pass : frame.passes)
        if (!others.count(run.passes[pass.pass].path)) sum += pass.gpu_ms;
    }
    return capture::statistics(sums);
  }

  json row(const SweepCell& cell, const Subject& subject, const capture::Run& run, const LastFrame& last,
           const capture::Statistics& technique_ms, const capture::HostLoad& load) {
    const SweepSpec& spec = work_.spec;
    const capture::Summary summary = capture::summarise(run);
    const capture::Trust trust = capture::judge(run, summary, circumstances(device_, load, spec.measure));
    json passes = json::object(), errors = json::object();
    for (size_t p = 0; p < run.passes.size(); ++p) passes[run.passes[p].path] = summary.passes[p].gpu.median;
    const std::string picture = "pictures/" + file_name(subject.name) + ".png";
    // A technique that does not give the layer has no error and no picture.
    const bool given = last.layer.width > 0;
    if (given) image::write_png(work_.folder / picture, to_picture(last.layer));
    if (given && spec.reference) {
      const image::Pair pair = image::make_pair(last.layer, reference_);
      for (const image::MetricInfo* metric : spec.metrics) {
        const double value = image::measure(metric->metric, pair, true).value;
        errors[metric->id] = std::isfinite(value) ? json(value) : json(nullptr);
      }
    }
    std::vector<std::string> warnings = trust.warnings;
    warnings.insert(warnings.end(), trust.noisy.begin(), trust.noisy.end());
    return {{"schema", "nearfield.cell/1"},
            {"id", subject.name},
            {"setting", cell.setting(spec)},
            {"place", place_.id},
            {"run", spec.runs[cell.run].name},
            {"technique", spec.runs[cell.run].technique},
            {"mode", subject.mode},
            {"params", cell.params},
            {"size", {spec.size.x, spec.size.y}},
            {"seed", spec.seed},
            {"gpu_ms", capture::to_json(summary.frame.gpu)},
            {"technique_ms", capture::to_json(technique_ms)},
            {"cost", spec.cost},
            {"per_repeat_median", summary.frame.per_repeat},
            {"passes", passes},
            {"errors", errors},
            {"noisy", !trust.noisy.empty()},
            {"warnings", warnings},
            {"picture", given ? picture : ""},
            {"reference_picture", reference_picture_},
            {"command", command_of(spec, cell, place_)},
            {"context", context_json(device_, load, device_.validation)}};
  }

  const SweepWork& work_;
  const SweepPlace& place_;
  gpu::Device& device_;
  Stage stage_;
  passes::Renderer renderer_;
  image::Image reference_;
  std::string reference_picture_;
};

}  // namespace

bool make_references(const SweepWork& work) {
  if (!work.spec.reference) return true;
  for (const SweepPlace& place : work.spec.places) {
    const fs::path file = reference_file(work, place);
    if (fs::exists(file)) continue;
    if (!work.spec.reference->file.empty())
      fail(Exit::Input,
           "there is no reference '{}': make it with `nearfield reference`, or let the sweep do that with "
           "\"reference\": {{\"spp\": 256}}",
           file.string());
    if (!trace_reference(work, place)) return false;
  }
  return true;
}

bool run_cells(const SweepWork& work, const std::vector<SweepCell>& cells, SweepStore& store) {
  fs::create_directories(work.folder / "pictures");
  if (!make_references(work)) return false;
  std::vector<const SweepCell*> left;
  for (const SweepCell& cell : cells)
    if (!store.has(cell.id(work.spec))) left.push_back(&cell);
  if (left.empty()) return true;
  std::stable_sort(left.begin(), left.end(),
                   [](const SweepCell* a, const SweepCell* b) { return a->place < b->place; });
  gpu::Device device(device_options(work.options));
  if (device.facts.software) log::warn("{} is a software device: all times are CPU times", device.info.name);
  Progress progress("sweep", left.size(), work.options);
  for (size_t at = 0; at < left.size();) {
    const size_t place = left[at]->place;
    PlaceWork stage(work, device, work.spec.places[place]);
    while (at < left.size() && left[at]->place == place) {
      std::vector<const SweepCell*> group;
      while (at < left.size() && left[at]->place == place && group.size() < work.spec.group)
        group.push_back(left[at++]);
      if (!stage.run(group, store)) return false;
      progress.update(at, group.back()->id(work.spec));
    }
  }
  if (const size_t messages = device.take_messages().size())
    fail(Exit::CheckFailed, "{} validation messages (above)", messages);
  return true;
}

double estimate_seconds(const SweepWork& work, const std::vector<SweepCell>& cells) {
  const SweepSpec& spec = work.spec;
  MeasureOptions probe = spec.measure;
  probe.warmup = 1, probe.frames = 2, probe.repeats = 1;
  SweepWork without = work;
  SweepSpec plain = spec;
  plain.reference.reset();
  const SweepWork probing{plain, without.options, without.folder};
  gpu::Device device(device_options(work.options));
  const double frames =
      spec.measure.warmup + 1 +
      spec.measure.repeats * (double(spec.measure.frames) +
                              std::ceil(double(spec.measure.frames) / spec.measure.block) * Meter::settle_frames);
  double seconds = 0;
  for (size_t place = 0; place < spec.places.size(); ++place) {
    PlaceWork stage(probing, device, spec.places[place]);
    for (size_t run = 0; run < spec.runs.size() && !interrupted(); ++run) {
      std::vector<const SweepCell*> of_run;
      for (const SweepCell& cell : cells)
        if (cell.place == place && cell.run == run) of_run.push_back(&cell);
      if (of_run.empty()) continue;
      double ms = 0;
      const std::set<const SweepCell*> ends = {of_run.front(), of_run.back()};
      for (const SweepCell* cell : ends) {
        const Measured m = stage.measure({subject_of(spec, *cell)}, probe);
        const capture::Summary summary = capture::summarise(m.runs[0]);
        ms += (summary.wall.median + summary.frame.record.median) / double(ends.size());
      }
      seconds += double(of_run.size()) * frames * ms / 1000;
    }
  }
  return seconds;
}

}  // namespace nf::editor
