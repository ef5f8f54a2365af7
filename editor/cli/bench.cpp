// `nearfield bench`: what techniques and presets cost on this device, measured against each other.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <memory>

#include "capture/baseline.h"
#include "capture/csv.h"
#include "capture/trace.h"
#include "cli/bench_tables.h"
#include "cli/measure.h"
#include "cli/paper_spec.h"
#include "cli/progress.h"
#include "cli/scene_input.h"
#include "core/log.h"
#include "image/file.h"
#include "report/report.h"
#include "scene/animation.h"
#include "scene/view.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct BenchOptions : CommonOptions {
  std::string scene, preset_set, markdown, path, json_file, csv, trace, html, pictures, baseline, fail_above = "5%";
  std::vector<std::string> techniques;
  MeasureOptions measure;
};

// "5%" or "0.05".
double parse_share(const std::string& text) {
  char* end = nullptr;
  double value = std::strtod(text.c_str(), &end);
  if (end != text.c_str() && std::string_view(end) == "%") value /= 100, ++end;
  if (end == text.c_str() || *end || !(value >= 0) || !std::isfinite(value))
    fail(Exit::Usage, "bad --fail-above '{}': write a share, e.g. 5% or 0.05", text);
  return value;
}

std::vector<Subject> make_subjects(const BenchOptions& o) {
  std::vector<Subject> subjects;
  const auto add = [&](std::string name, CommonOptions own) {
    const passes::FrameSettings settings = make_settings(own, Reconstruction::Default);
    if (name.empty()) name = settings.technique->id;
    subjects.push_back({name, settings, own.mode.empty() ? "radiometric" : own.mode});
  };
  for (const std::string& technique : o.techniques) {
    CommonOptions own = o;
    own.technique = technique;
    own.technique_given = true;
    add(technique, own);
  }
  if (!o.preset_set.empty()) {
    if (!o.preset.empty()) fail(Exit::Usage, "--preset and --preset-set exclude each other");
    for (const fs::path& preset : find_presets(o.preset_set)) {
      CommonOptions own = o;
      own.preset = preset;
      // A set compares settings at one size and view: what the command line says, or the defaults.
      own.size_given = own.view_given = own.seed_given = true;
      own.technique_given = false;
      add(preset.stem(), own);
    }
  }
  if (subjects.empty()) add("", o);
  for (size_t i = 0; i < subjects.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (subjects[i].name == subjects[k].name)
        fail(Exit::Usage, "'{}' is to be measured twice: name it once", subjects[i].name);
  return subjects;
}

class BenchJob {
 public:
  explicit BenchJob(BenchOptions& options) : o_(options) {}

  int run() {
    fail_above_ = parse_share(o_.fail_above);
    check_outputs();
    if (!o_.preset_set.empty() && fs::exists(preset_folder(o_.preset_set) / paper_tables_file)) return run_tables();
    if (!o_.markdown.empty()) fail(Exit::Usage, "--markdown is for a preset set of tables, e.g. --preset-set papers");
    read_baseline();
    const std::vector<Subject> subjects = make_subjects(o_);
    // Of one technique or none, its preset may say size, view and seed as well.
    if (!o_.preset.empty()) make_settings(o_);
    view_.size = parse_size(o_.size);
    view_.seed = o_.seed;
    o_.measure.timing = parse_timing(o_.timing);
    if (!o_.path.empty()) o_.measure.path = scene::load_path(o_.path);
    read_hook();

    scene::Scene scene = open_scene(o_.scene, o_);
    scene::animate(scene, o_.measure.time);
    view_.camera = view_.previous_camera = choose_view(o_, scene);
    gpu::Device device(device_options(o_));
    if (device.facts.software) log::warn("{} is a software device: all times are CPU times", device.info.name);
    passes::Renderer renderer(device, scene, executor_options(o_));
    const capture::LoadWatch watch;
    Measured measured = measure(device, scene, renderer, subjects);
    const capture::HostLoad load = watch.load();

    std::vector<capture::RunResult> results;
    for (size_t i = 0; i < subjects.size(); ++i) {
      capture::Run& run = measured.runs[i];
      run.settings = settings_json(subjects[i], view_);
      run.scene = scene_json(o_.scene, o_.preset_view ? o_.preset : o_.view, scene.triangles(),
                             scene.directional.size() + scene.punctual.size());
      if (!o_.pictures.empty() && measured.last[i].picture.width) {
        const fs::path file = fs::path(o_.pictures) / (run.name + ".png");
        image::write_png(file, measured.last[i].picture);
        written_.push_back(file);
        run.picture = fs::proximate(file, fs::absolute(o_.json_file).parent_path());
      }
      capture::Summary summary = capture::summarise(run);
      capture::Trust trust = capture::judge(run, summary, circumstances(device, load, o_.measure));
      results.push_back({&run, std::move(summary), std::move(trust)});
    }
    const json document = capture::timing_document(context_json(device, load, device.validation),
                                                   method_json(o_.measure), results, measured.complete);
    const std::vector<capture::Change> changes = baseline_.is_null()
                                                     ? std::vector<capture::Change>{}
                                                     : capture::compare_timings(baseline_, document, fail_above_);
    write(document, results, device);
    if (!o_.html.empty()) write_html(document, measured, subjects);
    print(device, results, changes, document);
    if (const size_t messages = device.take_messages().size())
      fail(Exit::CheckFailed, "{} validation messages (above)", messages);
    if (!measured.complete) return int(Exit::Interrupted);
    for (const capture::Change& change : changes)
      if (change.verdict == capture::Verdict::Regression)
        fail(Exit::CheckFailed, "{} of {} takes {:.3f} ms, {:+.1f} % on the baseline's {:.3f} ms", change.pass,
             change.run, change.after, change.percent(), change.before);
    return int(Exit::Ok);
  }

 private:
  // A set that is tables says itself what is measured, at what size.
  int run_tables() {
    if (!o_.preset.empty() || !o_.techniques.empty() || !o_.sets.empty() || o_.size_given)
      fail(Exit::Usage, "--preset-set {} has its own settings: leave --technique, --preset, --set and --size away",
           o_.preset_set);
    PaperTables tables(preset_folder(o_.preset_set) / paper_tables_file);
    view_.seed = o_.seed;
    o_.measure.timing = parse_timing(o_.timing);
    o_.measure.fps = 0;
    scene::Scene scene = open_scene(o_.scene, o_);
    view_.camera = view_.previous_camera = choose_view(o_, scene);
    gpu::Device device(device_options(o_));
    passes::Renderer renderer(device, scene, executor_options(o_));
    const capture::LoadWatch watch;
    bool complete = false;
    {
      Progress progress("bench", 1, o_);
      complete = tables.run(device, scene, renderer, view_, o_.measure,
                            [&](const std::string& what) { progress.update(0, what); });
    }
    if (!complete) return int(Exit::Interrupted);
    const std::string markdown =
        tables.markdown(device.info.name, device.facts.software, fs::path(o_.scene).filename(), o_.measure);
    json document = tables.document();
    document["context"] = context_json(device, watch.load(), device.validation);
    if (!o_.json_file.empty() && o_.json_file != "-") image::write_file(o_.json_file, document.dump(1) + "\n");
    if (!o_.markdown.empty()) image::write_file(o_.markdown, markdown);
    if (o_.json_file == "-")
      fmt::print("{}\n", document.dump(1));
    else if (!o_.quiet)
      fmt::print("{}", markdown);
    if (const size_t messages = device.take_messages().size())
      fail(Exit::CheckFailed, "{} validation messages (above)", messages);
    return int(Exit::Ok);
  }

  // Found out now, not after minutes of work.
  void check_outputs() {
    for (const std::string& folder : {o_.csv, o_.pictures}) {
      if (folder.empty()) continue;
      std::error_code error;
      fs::create_directories(folder, error);
      if (!fs::is_directory(folder))
        fail(Exit::Output, "cannot write into '{}': it is no folder and cannot be made one", folder);
    }
    for (const std::string& name : {o_.json_file, o_.trace, o_.html, o_.markdown}) {
      const fs::path folder = fs::path(name).parent_path();
      if (!folder.empty() && !fs::is_directory(folder))
        fail(Exit::Output, "cannot write '{}': there is no folder '{}'; make it first", name, folder.string());
    }
  }

  void read_baseline() {
    if (o_.baseline.empty()) return;
    const std::vector<uint8_t> bytes = image::read_file(o_.baseline);
    baseline_ = json::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (!baseline_.is_object() || baseline_.value("schema", json()) != "nearfield.timing/1")
      fail(Exit::Input, "the baseline '{}' is no nearfield.timing/1 document: make one with bench --json", o_.baseline);
  }

  // NEARFIELD_TEST_SLOW=pass:share makes a compute pass do that share of its work twice: a slowdown that is known, to
  // see that --baseline notices.
  void read_hook() {
    const char* hook = std::getenv("NEARFIELD_TEST_SLOW");
    if (!hook) return;
    const std::string text = hook;
    const size_t colon = text.rfind(':');
    if (colon == std::string::npos) fail(Exit::Usage, "NEARFIELD_TEST_SLOW is 'pass:share', not '{}'", text);
    o_.measure.slow_pass = text.substr(0, colon);
    o_.measure.slow_share = std::strtof(text.c_str() + colon + 1, nullptr);
    log::warn("test hook: {:.0f} % of {} runs twice", 100 * o_.measure.slow_share, o_.measure.slow_pass);
  }

  Measured measure(gpu::Device& device, scene::Scene& scene, passes::Renderer& renderer,
                   const std::vector<Subject>& subjects) {
    Meter meter(device, scene, renderer, view_, o_.measure);
    std::unique_ptr<capture::FramesCsv> frames;
    if (!o_.csv.empty()) frames = std::make_unique<capture::FramesCsv>(fs::path(o_.csv) / "frames.csv");
    if (frames) meter.on_frame = [&](const capture::Run& run, const capture::FrameSample& f) { frames->add(run, f); };
    std::unique_ptr<Progress> progress;
    meter.on_progress = [&](uint64_t done, uint64_t total, double ms) {
      if (!progress) progress = std::make_unique<Progress>("bench", total, o_);
      progress->update(done, fmt::format("{:.1f} ms", ms));
    };
    return meter.run(subjects, o_.timeout);
  }

  void write(const json& document, const std::vector<capture::RunResult>& results, const gpu::Device& device) {
    const auto write_text = [&](const std::string& name, const std::string& text) {
      image::write_file(name, text);
      written_.push_back(name);
    };
    if (!o_.csv.empty()) {
      written_.push_back((fs::path(o_.csv) / "frames.csv").string());
      write_text((fs::path(o_.csv) / "summary.csv").string(), capture::summary_csv(results));
    }
    if (!o_.trace.empty()) {
      std::vector<const capture::Run*> runs;
      for (const capture::RunResult& result : results) runs.push_back(result.run);
      write_text(o_.trace, capture::trace_document(runs, {{"git", build_info().git}, {"device", device.info.name}},
                                                   device.facts.calibrated_clock)
                               .dump());
    }
    if (!o_.json_file.empty() && o_.json_file != "-") write_text(o_.json_file, document.dump(1) + "\n");
  }

  void write_html(const json& document, const Measured& measured, const std::vector<Subject>& subjects) {
    ReportData data;
    data.timings.push_back(document);
    for (size_t i = 0; i < subjects.size(); ++i)
      if (measured.last[i].picture.width)
        data.pictures.push_back({subjects[i].name, subjects[i].name, image::encode_png(measured.last[i].picture)});
    for (const std::string& name : write_report(o_.html, data)) written_.push_back(name);
  }

  void print(const gpu::Device& device, const std::vector<capture::RunResult>& results,
             const std::vector<capture::Change>& changes, const json& document) {
    if (o_.json_file == "-") {
      fmt::print("{}\n", document.dump(1));
      return;
    }
    if (!o_.quiet) {
      for (const capture::RunResult& result : results) print_run(device, result);
      print_changes(changes);
    }
    for (const std::string& name : written_) fmt::print("{}\n", name);
  }

  void print_run(const gpu::Device& device, const capture::RunResult& result) {
    const capture::Run& run = *result.run;
    const capture::Summary& s = result.summary;
    fmt::print("{} on {} ({}), {}x{}, {} frames, ms ({}{}):\n", run.name, device.info.name, device.info.type,
               view_.size.x, view_.size.y, s.frame.gpu.count, o_.timing, device.facts.software ? ", CPU times" : "");
    fmt::print("  {:28} {:>9} {:>9} {:>9} {:>9} {:>8} {:>7}\n", "pass", "median", "p95", "p99", "max", "mad", "share");
    const auto row = [&](const std::string& name, const capture::Statistics& t) {
      fmt::print("  {:28} {:9.3f} {:9.3f} {:9.3f} {:9.3f} {:8.3f} {:5.1f} %\n", name, t.median, t.p95, t.p99, t.max,
                 t.mad, s.frame.gpu.median > 0 ? 100 * t.median / s.frame.gpu.median : 0);
    };
    for (size_t p = 0; p < run.passes.size(); ++p) row(run.passes[p].path, s.passes[p].gpu);
    row("unattributed", s.unattributed);
    row("frame", s.frame.gpu);
    fmt::print("  submit to fence {:.3f}, CPU {:.3f} (build, plan, record); transient images {:.1f} MiB of {:.1f}\n",
               s.wall.median, s.frame.record.median, run.memory.value("placed_bytes", 0.0) / 1048576,
               run.memory.value("unaliased_bytes", 0.0) / 1048576);
    for (const capture::PassInfo& pass : run.passes)
      if (!pass.counts.is_null()) {
        std::string text;
        for (const auto& [name, value] : pass.counts.items()) text += fmt::format(" {} {}", name, value.dump());
        fmt::print("  {:28}{}\n", pass.path, text);
      }
    for (const std::string& text : result.trust.warnings) fmt::print("  warning: {}\n", text);
    for (const std::string& text : result.trust.noisy) fmt::print("  noisy: {}\n", text);
  }

  void print_changes(const std::vector<capture::Change>& changes) {
    if (changes.empty()) return;
    fmt::print("against {} (median ms; what is below the noise is the same; fails above {:.3g} %):\n", o_.baseline,
               100 * fail_above_);
    for (const capture::Change& c : changes)
      fmt::print("  {:12} {:28} {:9.3f} -> {:9.3f}  {:+7.1f} %  noise {:.3f}  {}\n", c.run, c.pass, c.before, c.after,
                 c.percent(), c.noise, capture::verdict_name(c.verdict));
  }

  BenchOptions& o_;
  double fail_above_ = 0;
  passes::FrameView view_;
  json baseline_;
  std::vector<std::string> written_;
};

void add_method_flags(CLI::App& app, MeasureOptions& m) {
  app.add_option("--frames", m.frames, "Frames in each repeat")->check(CLI::Range(1u, 1000000u))->capture_default_str();
  app.add_option("--warmup", m.warmup, "Frames before the first ones that count")
      ->check(CLI::Range(0u, 1000000u))
      ->capture_default_str();
  app.add_option("--repeats", m.repeats, "Repeats")->check(CLI::Range(1u, 10000u))->capture_default_str();
  app.add_flag("--interleave,!--no-interleave", m.interleave,
               "Blocks of frames of each technique in turn (default), so that what disturbs one disturbs all");
  app.add_option("--block", m.block, "Frames of a block")->check(CLI::Range(1u, 1000000u))->capture_default_str();
  app.add_option("--fps", m.fps, "Fixed clock: simulated seconds per frame are 1 / FPS, 0 = the scene stands still")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--time", m.time, "The scene's time at the first frame, in seconds")
      ->type_name("S")
      ->capture_default_str();
  app.add_flag("--counts", m.counts, "Pipeline statistics of every pass, where the device has them; costs some time");
}

}  // namespace

Command add_bench(CLI::App& parent) {
  auto state = std::make_shared<BenchOptions>();
  CLI::App* app = parent.add_subcommand("bench", "Measure what techniques cost, pass by pass, against each other");
  app->add_option("SCENE", state->scene, "glTF scene (.gltf, .glb)")->required();
  add_render_flags(*app, *state);
  app->remove_option(app->get_option("--technique"));
  app->add_option("--technique", state->techniques, "GI technique; repeat it to measure several against each other")
      ->type_name("ID")
      ->allow_extra_args(false)
      ->envname("NEARFIELD_TECHNIQUE");
  app->add_option("--preset-set", state->preset_set,
                  "All presets of content/presets/NAME, or of a folder; papers: the papers' tables as ratios")
      ->type_name("NAME");
  app->add_option("--markdown", state->markdown, "With a preset set of tables: the page, next to what is published")
      ->type_name("FILE");
  add_method_flags(*app, state->measure);
  app->add_option("--path", state->path, "Camera path, by frame number (README, \"View files\")")->type_name("FILE");
  app->add_option("--json", state->json_file, "nearfield.timing/1 document; - for stdout")->type_name("FILE");
  app->add_option("--csv", state->csv, "Folder for summary.csv and frames.csv")->type_name("DIR");
  app->add_option("--trace", state->trace, "Trace for ui.perfetto.dev or chrome://tracing")->type_name("FILE");
  app->add_option("--html", state->html, "Report: one HTML file with tables, charts and pictures")->type_name("FILE");
  app->add_option("--pictures", state->pictures, "Folder for a picture of each technique")->type_name("DIR");
  app->add_option("--baseline", state->baseline, "Earlier --json file: exit code 1 when a pass became slower")
      ->type_name("FILE");
  app->add_option("--fail-above", state->fail_above, "Growth that --baseline lets pass, beyond the noise")
      ->type_name("SHARE")
      ->capture_default_str();
  app->footer(
      "Times are GPU times between timestamps. The median decides; a difference below 3 MAD is noise. `noisy` says why "
      "figures should not be trusted.\n"
      "Examples:\n  nearfield bench scene.glb --technique none --technique vbgi --size 640x360 --json t.json\n"
      "  nearfield bench scene.glb --baseline t.json --fail-above 5%");
  return {app, [state] {
            start_log(*state);
            watch_interrupt();
            return BenchJob(*state).run();
          }};
}

}  // namespace nf::editor
