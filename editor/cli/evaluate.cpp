// `nearfield evaluate`: how far every technique is from the truth, and why, in one table.
#include "cli/evaluate.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>

#include "cli/evaluate_temporal.h"
#include "cli/paper_spec.h"
#include "cli/progress.h"
#include "core/log.h"
#include "image/file.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail(Exit::Output, "cannot make the folder '{}': {}", folder.string(), error.message());
}

// Finished cells, one JSON line each, written as they finish: a killed run loses none.
class CellFile {
 public:
  CellFile(fs::path path, bool resume) : path_(std::move(path)) {
    std::ifstream in(path_);
    for (std::string line; resume && std::getline(in, line);) {
      const json row = json::parse(line, nullptr, false);  // a line cut short by a kill is no row
      if (row.is_object() && row.contains("key") && row.contains("row")) known_[row["key"]] = row["row"];
    }
    in.close();
    // What was read is written back whole: a half line must not spoil the next one.
    std::string text;
    for (const auto& [key, row] : known_) text += json({{"key", key}, {"row", row}}).dump() + "\n";
    image::write_file(path_, text);
  }
  const json* find(const std::string& key) const {
    const auto found = known_.find(key);
    return found == known_.end() ? nullptr : &found->second;
  }
  void add(const std::string& key, const json& row) {
    std::ofstream out(path_, std::ios::app);
    out << json({{"key", key}, {"row", row}}).dump() << std::endl;
    if (!out) fail(Exit::Output, "cannot write '{}': is the disk full?", path_.string());
  }

 private:
  fs::path path_;
  std::map<std::string, json> known_;
};

class EvaluateJob {
 public:
  explicit EvaluateJob(EvaluateOptions& options) : o_(options), folder_(options.folder) {}

  int run() {
    if (!o_.technique.empty() || !o_.mode.empty() || !o_.preset.empty())
      fail(Exit::Usage, "evaluate takes lists: --techniques vbgi,gtao:paper and --presets FILE,FILE");
    parse_size(o_.size);
    if (const fs::path file = figures_file(); !file.empty()) return run_figures(file);
    const std::vector<Place> places = parse_places(o_);
    if (!o_.temporal.empty()) return run_temporal(places);
    // Errors of diffuse light are what is measured; --set material.lambert=false asks for the scene's own materials.
    o_.sets.insert(o_.sets.begin(), "material.lambert=true");
    const std::vector<Contender> contenders = parse_contenders(o_);
    const fs::path references = o_.references.empty() ? folder_ / "references" : fs::path(o_.references);
    make_folder(folder_);
    make_folder(references);
    if (o_.pictures) make_folder(folder_ / "pictures");
    gpu::Device device(device_options(o_));
    if (device.facts.software) log::warn("{} is a software device: times are CPU times", device.info.name);
    CellFile cells(folder_ / "cells.jsonl", o_.resume);
    std::vector<json> rows;
    bool complete = true;
    uint32_t taken = 0;
    {
      const size_t total = places.size() * contenders.size();
      Progress progress("evaluate", total, o_);
      std::string where;
      const Notice notice = [&](const std::string& what) { progress.update(rows.size(), where + ", " + what); };
      TruthStore store(references, o_, device, notice);
      for (const Place& place : places) {
        if (!complete) break;
        where = place.label;
        Stage stage(device, o_, place);
        for (const Contender& contender : contenders) {
          where = fmt::format("{}, {}", place.label, contender.label);
          const std::string key = fmt::format("{:016x}", stage.key(contender));
          json row;
          if (const json* known = cells.find(key)) {
            row = *known;
            ++taken;
          } else {
            row = stage.measure(contender, store, folder_ / "pictures");
            if (!row.is_object()) {
              complete = false;
              break;
            }
            cells.add(key, row);
          }
          rows.push_back(row);
          progress.update(rows.size(), where);
        }
      }
      log::info("{} of {} cells, {} of them from an earlier run; {} references made, {} from disk", rows.size(), total,
                taken, store.made, store.found);
    }
    report(rows, device.info, complete);
    if (const size_t messages = device.take_messages().size())
      fail(Exit::CheckFailed, "{} validation messages (above)", messages);
    if (!complete) log::warn("interrupted: the same command with --resume goes on after the finished cells");
    return int(complete ? Exit::Ok : Exit::Interrupted);
  }

 private:
  // --presets NAME, where that is a folder with figures.json, of content/presets or any other.
  fs::path figures_file() const {
    const fs::path file = preset_folder(o_.presets, "figures.json") / "figures.json";
    return !o_.presets.empty() && fs::exists(file) ? file : fs::path();
  }

  int run_figures(const fs::path& file) {
    if (o_.scenes.size() != 1 || !fs::is_directory(o_.scenes[0]))
      fail(Exit::Usage, "--presets {} has scenes of its own: give the folder they are in, e.g. build/release/content",
           o_.presets);
    if (!o_.sets.empty() || o_.techniques != "all" || !o_.resolutions.empty())
      fail(Exit::Usage, "--presets {} has its own settings: leave --techniques, --resolutions and --set away",
           o_.presets);
    const fs::path page = o_.markdown.empty() ? folder_ / "figures.md" : fs::path(o_.markdown),
                   pictures = page.parent_path() / "pictures" / "figures",
                   references = o_.references.empty() ? folder_ / "references" : fs::path(o_.references);
    for (const fs::path& folder : {folder_, references, pictures}) make_folder(folder);
    Figures figures(file, o_.scenes[0]);
    gpu::Device device(device_options(o_));
    bool complete = false;
    {
      Progress progress("evaluate", figures.cells(), o_);
      TruthStore store(references, o_, device, [](const std::string&) {});
      complete = figures.run(device, o_, store, pictures,
                             [&](size_t done, const std::string& what) { progress.update(done, what); });
    }
    if (!complete) return int(Exit::Interrupted);
    image::write_file(folder_ / "figures.json", figures.document().dump(1) + "\n");
    image::write_file(page, figures.markdown(o_, "pictures/figures"));
    for (const fs::path& name : {folder_ / "figures.json", page}) fmt::print("{}\n", name.string());
    if (const size_t messages = device.take_messages().size())
      fail(Exit::CheckFailed, "{} validation messages (above)", messages);
    return int(Exit::Ok);
  }

  int run_temporal(const std::vector<Place>& places) {
    if (!o_.resolutions.empty())
      fail(Exit::Usage, "--resolutions is of errors; with --temporal choose one by --set resolution.gi={}",
           o_.resolutions.substr(0, o_.resolutions.find(',')));
    temporal_parts(o_.temporal);
    const std::vector<Contender> contenders = parse_contenders(o_);
    const TemporalLengths lengths = temporal_lengths(o_);
    make_folder(folder_);
    gpu::Device device(device_options(o_));
    std::vector<json> rows;
    bool complete = true;
    {
      Progress progress("evaluate", places.size() * contenders.size(), o_);
      std::string where;
      const Notice notice = [&](const std::string& what) { progress.update(rows.size(), where + ", " + what); };
      for (const Place& place : places) {
        if (!complete) break;
        TemporalStage stage(device, o_, lengths, place, notice);
        for (const Contender& contender : contenders) {
          where = fmt::format("{}, {}", place.label, contender.label);
          const json row = stage.measure(contender);
          if (!row.is_object()) {
            complete = false;
            break;
          }
          rows.push_back(row);
          progress.update(rows.size(), where);
        }
      }
    }
    const json document = temporal_json(o_, lengths, rows, device.info, complete);
    const std::string markdown = temporal_markdown(document);
    image::write_file(folder_ / "temporal.json", document.dump(1) + "\n");
    image::write_file(folder_ / "temporal.md", markdown);
    if (!o_.markdown.empty()) image::write_file(o_.markdown, markdown);
    if (!o_.quiet) fmt::print("{}\n", markdown);
    for (const char* name : {"temporal.json", "temporal.md"}) fmt::print("{}\n", (folder_ / name).string());
    if (const size_t messages = device.take_messages().size())
      fail(Exit::CheckFailed, "{} validation messages (above)", messages);
    return int(complete ? Exit::Ok : Exit::Interrupted);
  }

  void report(const std::vector<json>& rows, const gpu::DeviceInfo& device, bool complete) {
    const json document = evaluation_json(o_, rows, device, complete);
    const std::string markdown = evaluation_markdown(document);
    image::write_file(folder_ / "evaluation.json", document.dump(1) + "\n");
    image::write_file(folder_ / "evaluation.md", markdown);
    image::write_file(folder_ / "evaluation.html", evaluation_html(document));
    if (!o_.markdown.empty()) image::write_file(o_.markdown, markdown);
    if (!o_.quiet) fmt::print("{}\n", markdown);
    for (const char* name : {"evaluation.json", "evaluation.md", "evaluation.html"})
      fmt::print("{}\n", (folder_ / name).string());
  }

  EvaluateOptions& o_;
  fs::path folder_;
};

}  // namespace

Command add_evaluate(CLI::App& parent) {
  auto state = std::make_shared<EvaluateOptions>();
  state->size = "320x180";
  CLI::App* app = parent.add_subcommand("evaluate", "Measure how far techniques are from the truth, in one table");
  add_render_flags(*app, *state);
  for (const char* of_one : {"--technique", "--mode", "--preset"})
    app->get_option(of_one)->envname("")->group("");  // there are lists of them here
  app->add_option("SCENE", state->scenes, "glTF scenes; FILE@VIEW chooses a view as --view does")->required();
  app->add_option("--techniques", state->techniques,
                  "all, or ids such as vbgi,gtao:paper; all takes every technique in every form it has")
      ->type_name("LIST")
      ->capture_default_str();
  app->add_option(
         "--presets", state->presets,
         "Preset files, sets of them (a folder, of content/presets or any other) and `default`; a preset that names a "
         "technique is taken with that only. figures: the papers' figures as numbers, of the scenes in the folder "
         "SCENE")
      ->type_name("LIST");
  app->add_option("--resolutions", state->resolutions,
                  "Measure each technique at these: all, or modes of resolution.gi such as full,half; each with its "
                  "upsampling and no other stage of the reconstruction")
      ->type_name("LIST");
  app->add_option("-o,--output", state->folder, "Folder for tables, pictures and references")
      ->type_name("DIR")
      ->capture_default_str();
  app->add_option("--markdown", state->markdown, "Also write the Markdown table here")->type_name("FILE");
  app->add_option("--references", state->references, "Folder where references are kept (default: DIR/references)")
      ->type_name("DIR");
  app->add_flag("--resume", state->resume, "Keep the cells that an earlier run finished with the same program");
  app->add_option("--frames", state->frames, "Frames in the mean that is a technique's expected value")
      ->check(CLI::Range(2u, 65536u))
      ->capture_default_str();
  app->add_flag(
      "--temporal{all}", state->temporal,
      "What techniques do over time instead: how fast means settle, ghosts, flicker; --temporal=LIST of convergence, "
      "settling, jump and pan measures these alone. --frames is the length of a technique's own mean then");
  app->add_option("--occluder", state->occluder,
                  "With --temporal: the node that is gone from one frame to the next; the first of these that there is")
      ->type_name("LIST")
      ->capture_default_str();
  app->add_option("--timed", state->timed, "Frames that are timed")
      ->check(CLI::Range(1u, 10000u))
      ->capture_default_str();
  app->add_option("--spp", state->spp, "Samples a pixel of the references")
      ->check(CLI::Range(2u, 1u << 24))
      ->capture_default_str();
  app->add_option("--bounces", state->bounces, "Bounces of the references of `gi, N bounces`; below 2: no such column")
      ->check(CLI::Range(0u, reference::max_bounces))
      ->capture_default_str();
  app->add_option("--threads", state->threads, "Threads of the references (0: all)")->check(CLI::Range(0u, 256u));
  app->add_flag("!--no-pictures", state->pictures, "No heat maps");
  app->footer(
      "Errors are total = estimator + missing: the technique's own, against a perfect estimator that has the same\n"
      "information, and what the screen does not show, that estimator against the path tracer.\n"
      "Materials are pure Lambert unless --set material.lambert=false; reconstruction is off, but for --resolutions.\n"
      "Examples:\n"
      "  nearfield evaluate cornell.glb sponza.glb@nave.json -o table --size 240x135\n"
      "  nearfield evaluate cornell.glb --techniques vbgi,none --presets default,wide.json -o table --resume\n"
      "  nearfield evaluate fence.glb --techniques vbao --resolutions full,half,quarter -o table\n"
      "  nearfield evaluate atrium.glb@atrium.json --temporal --frames 4096 --size 160x90 -o time\n"
      "  nearfield evaluate atrium.glb@atrium.json --temporal=settling --techniques vbgi --presets default,stillness");
  return {app, [state] {
            start_log(*state);
            watch_interrupt();
            return EvaluateJob(*state).run();
          }};
}

}  // namespace nf::editor
