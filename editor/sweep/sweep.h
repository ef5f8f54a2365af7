// A sweep: techniques x parameters x views, each a cell with its time and its error. spec.cpp reads what is asked for,
// store.cpp keeps what is done, work.cpp measures, search.cpp looks for more cells and for the best one, emit.cpp hands
// the work to other programs.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli/measure.h"
#include "image/metrics.h"

namespace nf::editor {

// A scene seen by a camera.
struct SweepPlace {
  std::string id, scene, view;
};
struct SweepRun {
  std::string name, technique, mode;
  nlohmann::json base = nlohmann::json::object();  // parameter id -> value
  std::vector<std::pair<std::string, std::vector<nlohmann::json>>> permute;
};
// Where the truth comes from: a file with {place} in its name, or so many samples of the path tracer.
struct SweepReference {
  std::string file;
  uint32_t spp = 0, bounces = 1;
};
struct SweepSpec {
  nlohmann::json source;  // as read, with absolute paths
  std::vector<SweepPlace> places;
  std::vector<SweepRun> runs;
  std::optional<SweepReference> reference;
  std::vector<const image::MetricInfo*> metrics;
  std::string layer;  // what errors are measured on; "" is the final radiance
  glm::uvec2 size{1280, 720};
  uint32_t seed = 1, group = 4;  // cells measured interleaved
  uint32_t narrow_rounds = 0, narrow_settings = 8;
  MeasureOptions measure;
  // What is held against the error, a key of the cells' JSON: gpu_ms, the whole frame, or technique_ms, the passes that
  // a frame without a technique does not have.
  std::string cost = "gpu_ms";
};
// Throws nf::Error (Exit::Input) naming the JSON path of what is wrong. Paths in it are relative to the file.
SweepSpec read_sweep(const std::filesystem::path& file);
SweepSpec parse_sweep(const nlohmann::json& document, const std::filesystem::path& folder, const std::string& name);

struct SweepCell {
  size_t place = 0, run = 0;  // rows of the spec
  nlohmann::json params;      // base and permuted
  std::string id(const SweepSpec& spec) const;
  std::string setting(const SweepSpec& spec) const;  // the id without the place
};
// Places first, so that a scene is loaded once; no two of one id.
std::vector<SweepCell> plan_cells(const SweepSpec& spec);
Subject subject_of(const SweepSpec& spec, const SweepCell& cell);

// The time that the sweep is about: statistics as in nearfield.timing/1.
const nlohmann::json& cost_of(const nlohmann::json& cell);

// What is done: a line of JSON for each cell, appended when it is finished.
class SweepStore {
 public:
  // `file` is cells.jsonl, or a part of it. What a crash left of a line is cut off.
  explicit SweepStore(std::filesystem::path file);
  const std::vector<nlohmann::json>& cells() const { return cells_; }
  bool has(const std::string& id) const { return ids_.count(id) > 0; }
  // On disk when it returns.
  void add(const nlohmann::json& cell);

 private:
  std::filesystem::path file_;
  std::vector<nlohmann::json> cells_;
  std::set<std::string> ids_;
};
// Joins parts/*.jsonl and cells.jsonl of a folder, in the order of the plan; returns the ids of cells that are missing.
std::vector<std::string> merge_parts(const std::filesystem::path& folder, const SweepSpec& spec);

// Measures cells that the store does not have. False when interrupted.
struct SweepWork {
  const SweepSpec& spec;
  const CommonOptions& options;
  std::filesystem::path folder;
};
bool run_cells(const SweepWork& work, const std::vector<SweepCell>& cells, SweepStore& store);
// Makes the references that are not there yet. False when interrupted.
bool make_references(const SweepWork& work);
// Seconds that these cells will take, from a few frames of each run.
double estimate_seconds(const SweepWork& work, const std::vector<SweepCell>& cells);

// --- search
// A setting over all places: means of time and of the first metric.
struct SettingResult {
  size_t run = 0;
  std::string setting;
  nlohmann::json params;
  double ms = 0, error = 0;
};
// Those measured at every place.
std::vector<SettingResult> setting_results(const SweepSpec& spec, const std::vector<nlohmann::json>& cells);
// Cells between the settings on the front and their neighbours, that are not known yet.
std::vector<SweepCell> narrow(const SweepSpec& spec, const std::vector<nlohmann::json>& cells,
                              const std::vector<SweepCell>& known);

// Writes the files for `slurm` or `make` into the folder; returns their paths.
std::vector<std::string> emit_jobs(const std::string& kind, const std::filesystem::path& folder, const SweepSpec& spec,
                                   const CommonOptions& options);

}  // namespace nf::editor
