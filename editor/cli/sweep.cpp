// `nearfield sweep`: techniques x parameters x views, each with its time and error; what is worth having of them.
#include "sweep/sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

#include "capture/csv.h"
#include "capture/pareto.h"
#include "core/log.h"
#include "image/file.h"
#include "preset.h"
#include "report/report.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct SweepOptions : CommonOptions {
  std::string spec, folder, budget, cells, merge;
  std::vector<std::string> emit;
  bool resume = false, dry_run = false;
};

// "20ms" or "20".
double parse_budget(const std::string& text) {
  double ms = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ms);
  const std::string_view rest(end, size_t(text.data() + text.size() - end));
  if (error != std::errc() || !(ms > 0) || (!rest.empty() && rest != "ms" && rest != " ms"))
    fail(Exit::Usage, "bad --budget '{}': write milliseconds, e.g. 20ms", text);
  return ms;
}

std::pair<size_t, size_t> parse_range(const std::string& text) {
  size_t first = 0, last = 0;
  const char* end = text.data() + text.size();
  const auto [colon, a] = std::from_chars(text.data(), end, first);
  const bool good = a == std::errc() && colon != end && *colon == ':';
  const auto [stop, b] = good ? std::from_chars(colon + 1, end, last) : std::from_chars_result{end, std::errc()};
  if (!good || b != std::errc() || stop != end || last < first)
    fail(Exit::Usage, "bad --cells '{}': write FIRST:END, e.g. 0:4 for the first four", text);
  return {first, last};
}

class SweepJob {
 public:
  explicit SweepJob(SweepOptions& options) : o_(options) {}

  int run() {
    const double budget = o_.budget.empty() ? 0 : parse_budget(o_.budget);
    if (!o_.merge.empty()) return merge(budget);
    if (o_.spec.empty()) fail(Exit::Usage, "SPEC.json is missing; see `nearfield sweep --help`");
    spec_ = read_sweep(o_.spec);
    if (budget > 0 && !spec_.reference)
      fail(Exit::Usage, "--budget needs a sweep with a \"reference\": no errors, no choice");
    if (!o_.emit.empty()) return emit();
    if (o_.folder.empty() && !o_.dry_run) fail(Exit::Usage, "-o DIR is missing: where the results go");
    folder_ = o_.folder;
    if (o_.dry_run) return dry_run();
    std::error_code error;
    fs::create_directories(folder_, error);
    if (!fs::is_directory(folder_))
      fail(Exit::Output, "cannot make the folder '{}': {}", folder_.string(), error.message());
    if (!o_.cells.empty()) return run_part();
    open_plan();
    SweepStore store(folder_ / "cells.jsonl");
    if (!o_.resume && !store.cells().empty())
      fail(Exit::Usage, "'{}' holds {} finished cells: add --resume to go on, or choose another folder",
           folder_.string(), store.cells().size());
    const bool complete = work(store);
    if (!complete && store.cells().empty()) return int(Exit::Interrupted);
    const bool found = finish(store.cells(), budget);
    if (!complete) {
      log::warn("interrupted with {} cells done; --resume goes on", store.cells().size());
      return int(Exit::Interrupted);
    }
    return int(found ? Exit::Ok : Exit::CheckFailed);
  }

 private:
  // --- the plan, on disk: what was asked for, and the cells of each round of narrowing
  void open_plan() {
    const fs::path file = folder_ / "sweep.json";
    plan_ = {{"schema", "nearfield.sweep_plan/1"},
             {"command", command_line() + " -o " + folder_.string()},
             {"spec", spec_.source},
             {"rounds", json::array()}};
    if (fs::exists(file)) {
      const std::vector<uint8_t> bytes = image::read_file(file);
      const json old = json::parse(bytes.begin(), bytes.end(), nullptr, false);
      if (!old.is_object() || !old.contains("spec") || !old.contains("rounds"))
        fail(Exit::Input, "cannot go on from '{}': it is no plan of a sweep; choose another folder", file.string());
      if (o_.resume && old["spec"] != plan_["spec"])
        fail(Exit::Input, "'{}' is of another sweep: its specification differs; choose another folder", file.string());
      if (o_.resume) plan_ = old;
    }
    save_plan();
  }
  void save_plan() const {
    const std::string text = plan_.dump(1) + "\n";
    image::write_file(folder_ / "sweep.json", text);
  }
  std::vector<SweepCell> planned_round(size_t round) const {
    std::vector<SweepCell> cells;
    for (const json& row : plan_["rounds"][round])
      cells.push_back({row["place"].get<size_t>(), row["run"].get<size_t>(), row["params"]});
    return cells;
  }

  // The grid, and then rounds round the front. A round is planned on disk before it begins: after a crash it is the
  // same.
  bool work(SweepStore& store) {
    const SweepWork work{spec_, o_, folder_};
    std::vector<SweepCell> known = plan_cells(spec_);
    if (!run_cells(work, known, store)) return false;
    for (uint32_t round = 0; round < spec_.narrow_rounds; ++round) {
      if (round >= plan_["rounds"].size()) {
        json rows = json::array();
        for (const SweepCell& cell : narrow(spec_, store.cells(), known))
          rows.push_back({{"place", cell.place}, {"run", cell.run}, {"params", cell.params}});
        plan_["rounds"].push_back(rows);
        save_plan();
      }
      const std::vector<SweepCell> cells = planned_round(round);
      if (cells.empty()) break;
      log::info("narrowing, round {}: {} cells", round + 1, cells.size());
      if (!run_cells(work, cells, store)) return false;
      known.insert(known.end(), cells.begin(), cells.end());
    }
    return true;
  }

  int run_part() {
    const auto [first, end] = parse_range(o_.cells);
    const std::vector<SweepCell> all = plan_cells(spec_);
    const SweepWork work{spec_, o_, folder_};
    const size_t from = std::min(first, all.size()), to = std::min(end, all.size());
    if (from == to) return int(make_references(work) ? Exit::Ok : Exit::Interrupted);
    fs::create_directories(folder_ / "parts");
    SweepStore store(folder_ / "parts" / fmt::format("{:06}-{:06}.jsonl", from, to));
    const std::vector<SweepCell> cells(all.begin() + ptrdiff_t(from), all.begin() + ptrdiff_t(to));
    return int(run_cells(work, cells, store) ? Exit::Ok : Exit::Interrupted);
  }

  int emit() {
    if (o_.emit.size() != 2) fail(Exit::Usage, "--emit takes two words: slurm or make, and a folder");
    if (spec_.narrow_rounds)
      log::warn("narrowing needs results: after --merge, run `nearfield sweep SPEC.json -o {} --resume`", o_.emit[1]);
    for (const std::string& name : emit_jobs(o_.emit[0], o_.emit[1], spec_, o_)) fmt::print("{}\n", name);
    return int(Exit::Ok);
  }

  int merge(double budget) {
    folder_ = o_.merge;
    spec_ = read_sweep(folder_ / "spec.json");
    const std::vector<std::string> missing = merge_parts(folder_, spec_);
    o_.resume = true;
    open_plan();
    const SweepStore store(folder_ / "cells.jsonl");
    if (store.cells().empty()) fail(Exit::Input, "'{}' has no finished cells in parts/", folder_.string());
    const bool found = finish(store.cells(), budget);
    if (!missing.empty())
      fail(Exit::CheckFailed, "{} cells are missing, the first is {}: run their tasks again", missing.size(),
           missing[0]);
    return int(found ? Exit::Ok : Exit::CheckFailed);
  }

  int dry_run() {
    const std::vector<SweepCell> cells = plan_cells(spec_);
    size_t done = 0;
    if (!folder_.empty() && fs::exists(folder_ / "cells.jsonl")) {
      const SweepStore store(folder_ / "cells.jsonl");
      for (const SweepCell& cell : cells) done += store.has(cell.id(spec_));
    }
    if (!o_.quiet)
      for (const SweepCell& cell : cells) fmt::print("{}\n", cell.id(spec_));
    const double seconds = estimate_seconds({spec_, o_, folder_}, cells);
    fmt::print("{} cells, {} of them done; about {:.0f} s for all on this device, without references and narrowing\n",
               cells.size(), done, seconds);
    return int(Exit::Ok);
  }

  // --- what it tells
  bool finish(const std::vector<json>& cells, double budget) {
    write_csv(cells);
    ReportData data;
    read_report_input(folder_, data);
    const std::vector<std::string> written = write_report(folder_ / "report.html", data);
    if (!o_.quiet) print_fronts(cells);
    const bool found = budget <= 0 || choose(cells, budget);
    fmt::print("{}\n{}\n{}\n", (folder_ / "cells.jsonl").string(), (folder_ / "summary.csv").string(), written.front());
    return found;
  }

  void write_csv(const std::vector<json>& cells) const {
    std::string text = "cell,place,run,technique,median_ms,mad_ms,technique_ms,technique_mad_ms,noisy";
    for (const image::MetricInfo* metric : spec_.metrics) text += fmt::format(",{}", metric->id);
    text += "\r\n";
    for (const json& cell : cells) {
      for (const char* key : {"id", "place", "run", "technique"}) text += capture::csv_field(cell[key]) + ",";
      const auto number = [](const json& value) {
        return value.is_number() ? fmt::format("{:.6g}", value.get<double>()) : "";
      };
      for (const char* key : {"gpu_ms", "technique_ms"})
        text += number(cell[key]["median"]) + "," + number(cell[key]["mad"]) + ",";
      text += cell["noisy"] ? "1" : "0";
      for (const image::MetricInfo* metric : spec_.metrics)
        text += "," + number(cell["errors"].value(metric->id, json()));
      text += "\r\n";
    }
    image::write_file(folder_ / "summary.csv", text);
  }

  void print_fronts(const std::vector<json>& cells) const {
    if (spec_.metrics.empty()) return;
    const std::string metric = spec_.metrics[0]->id;
    for (const SweepPlace& place : spec_.places) {
      std::vector<const json*> rows;
      std::vector<capture::CostAndError> points;
      size_t noisy = 0;
      for (const json& cell : cells) {
        if (cell["place"] != place.id || !cell["errors"].value(metric, json()).is_number()) continue;
        rows.push_back(&cell);
        const json& ms = cost_of(cell)["median"];
        points.push_back({ms.is_number() ? ms.get<double>() : NAN, cell["errors"][metric]});
        noisy += cell["noisy"].get<bool>();
      }
      fmt::print("{}: {} cells, {} of them noisy; worth having (median {}, {}):\n", place.id, rows.size(), noisy,
                 spec_.cost == "gpu_ms" ? "ms" : "ms of the technique's passes", metric);
      for (const size_t i : capture::pareto_front(points))
        fmt::print("  {:10.3f} {:12.6g}  {}\n", points[i].cost, points[i].error,
                   (*rows[i])["setting"].get<std::string>());
    }
  }

  // The setting of least error under the budget, as a preset; false when there is none.
  bool choose(const std::vector<json>& cells, double budget) const {
    const std::vector<SettingResult> results = setting_results(spec_, cells);
    const SettingResult *best = nullptr, *cheapest = nullptr, *least = nullptr;
    for (const SettingResult& r : results) {
      if (!cheapest || r.ms < cheapest->ms) cheapest = &r;
      if (!least || r.error < least->error) least = &r;
      if (r.ms <= budget && (!best || r.error < best->error)) best = &r;
    }
    const std::string metric = spec_.metrics[0]->id;
    if (!best) {
      log::error("nothing within {} ms: the cheapest is {} at {:.3f} ms; try a smaller size", budget,
                 cheapest ? cheapest->setting : "none", cheapest ? cheapest->ms : 0.0);
      return false;
    }
    const SweepRun& run = spec_.runs[best->run];
    Preset preset;
    preset.technique = run.technique;
    preset.params = best->params;
    if (!run.mode.empty()) preset.mode = run.mode;
    const fs::path file = folder_ / "budget.json";
    write_preset(file, preset);
    fmt::print("within {:.6g} ms: {} takes {:.3f} ms and has {} {:.6g} (means over {} scenes)\n", budget, best->setting,
               best->ms, metric, best->error, spec_.places.size());
    fmt::print("given up: the least error of all is {:.6g}, of {} at {:.3f} ms\n", least->error, least->setting,
               least->ms);
    fmt::print("{}\n", file.string());
    return true;
  }

  SweepOptions& o_;
  SweepSpec spec_;
  fs::path folder_;
  json plan_;
};

constexpr const char* footer = R"(A specification:
  {"schema": "nearfield.sweep/1", "scenes": ["fence.glb", {"scene": "atrium.glb", "cameras": ["atrium.json"]}],
   "size": [160, 90], "reference": {"spp": 256}, "metrics": ["relmse", "flip"],
   "repeats": 3, "warmup": 8, "frames": 20, "group": 4, "narrow": {"rounds": 2, "settings": 8},
   "runs": [{"technique": "*", "base": {"material.lambert": true}, "permute": {"gi.slices": [1, 2], "gi.steps": [4, 8]}}]}
"technique": "*" stands for each there is. "reference" can name a file, with {place}, {scene} or {camera} in it. A cell's
error is that of one frame behind the timed ones, on the final radiance or on "layer". It is held against the time of the
frame, or with "cost": "technique" against that of the passes that a frame without a technique does not have: what the
rest of the frame did meanwhile, on a software or a busy device often more than the technique takes, is not in it. Each
finished cell is a line of DIR/cells.jsonl; Ctrl-C or a crash loses none, and --resume goes on.
Examples:
  nearfield sweep spec.json --dry-run
  nearfield sweep spec.json -o out --resume --budget 20ms
  nearfield sweep spec.json --emit make jobs && make -C jobs
  nearfield sweep spec.json --emit slurm jobs && jobs/submit.sh   # then: nearfield sweep --merge jobs)";

}  // namespace

Command add_sweep(CLI::App& parent) {
  auto state = std::make_shared<SweepOptions>();
  CLI::App* app = parent.add_subcommand("sweep", "Time against error over techniques, parameters and views");
  app->add_option("SPEC", state->spec, "What to measure (.json)");
  app->add_option("-o,--output", state->folder, "Folder of the results")->type_name("DIR");
  app->add_flag("--resume", state->resume, "Go on with a folder's sweep; finished cells stay");
  app->add_flag("--dry-run", state->dry_run, "List the cells and estimate the time; measures a few frames only");
  app->add_option("--budget", state->budget, "Answer with the preset of least error within this time, e.g. 20ms")
      ->type_name("MS");
  app->add_option("--emit", state->emit, "slurm or make: write jobs for other machines into a folder")
      ->type_name("KIND DIR")
      ->expected(2);
  app->add_option("--merge", state->merge, "Join the parts in a folder of --emit")->type_name("DIR");
  app->add_option("--cells", state->cells, "Only these cells of the plan, into DIR/parts; 0:0 makes references only")
      ->type_name("FIRST:END");
  app->add_option("--device", state->device,
                  "Vulkan device: INDEX, part of its NAME, cpu or gpu (default: the fastest)")
      ->envname("NEARFIELD_DEVICE");
  app->add_flag("--validation", state->validation, "Vulkan validation, synchronization included; slow");
  app->add_option("--progress", state->progress, "Progress on stderr")
      ->check(CLI::IsMember({"auto", "bar", "plain", "json", "none"}))
      ->capture_default_str();
  add_log_flags(*app, *state);
  app->footer(footer);
  return {app, [state] {
            start_log(*state);
            watch_interrupt();
            return SweepJob(*state).run();
          }};
}

}  // namespace nf::editor
