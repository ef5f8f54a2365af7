// Reading a sweep's specification. Strict: a mistyped key would otherwise measure something else for hours.
#include <algorithm>

#include "image/file.h"
#include "sweep/sweep.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Reader {
 public:
  Reader(const json& value, std::string path, const std::string& file)
      : value_(value), path_(std::move(path)), file_(file) {}

  template <class... Args>
  [[noreturn]] void bad(fmt::format_string<Args...> format, Args&&... args) const {
    fail(Exit::Input, "bad sweep '{}': {}", file_, fmt::format(format, std::forward<Args>(args)...));
  }
  std::string at(const char* key) const { return path_.empty() ? key : path_ + "." + key; }
  const json& value() const { return value_; }
  bool has(const char* key) const { return value_.contains(key); }
  Reader child(const char* key) const { return Reader(value_.at(key), at(key), file_); }
  std::vector<Reader> list(const char* key) const {
    if (!value_.at(key).is_array() || value_.at(key).empty()) bad("'{}' must be a list with something in it", at(key));
    std::vector<Reader> rows;
    for (size_t i = 0; i < value_.at(key).size(); ++i)
      rows.emplace_back(value_.at(key)[i], fmt::format("{}[{}]", at(key), i), file_);
    return rows;
  }
  void expect(std::initializer_list<const char*> keys) const {
    if (!value_.is_object()) bad("{} must be an object", path_.empty() ? "the file" : "'" + path_ + "'");
    for (const auto& [key, member] : value_.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        bad("unknown key '{}'; there are {}", at(key.c_str()), fmt::join(keys, ", "));
  }
  std::string text(const char* key, const std::string& fallback = {}) const {
    if (!has(key)) return fallback;
    if (!value_.at(key).is_string()) bad("'{}' must be a text", at(key));
    return value_.at(key);
  }
  std::string as_text() const {
    if (value_.is_number_unsigned()) return value_.dump();
    if (!value_.is_string()) bad("'{}' must be a text", path_);
    return value_;
  }
  uint32_t count(const char* key, uint32_t fallback, uint32_t least, uint32_t most = 1000000) const {
    if (!has(key)) return fallback;
    const json& v = value_.at(key);
    if (!v.is_number_unsigned() || v.get<uint64_t>() < least || v.get<uint64_t>() > most)
      bad("'{}' must be a whole number, {} to {}", at(key), least, most);
    return v.get<uint32_t>();
  }
  double number(const char* key, double fallback) const {
    if (!has(key)) return fallback;
    if (!value_.at(key).is_number() || value_.at(key).get<double>() < 0)
      bad("'{}' must be a number from 0 on", at(key));
    return value_.at(key);
  }

 private:
  const json& value_;
  std::string path_;
  const std::string& file_;
};

std::string absolute(const std::string& path, const fs::path& folder) {
  return fs::absolute(folder / path).lexically_normal().string();
}

void read_places(const Reader& reader, const fs::path& folder, SweepSpec& spec) {
  const auto add = [&](const std::string& scene, const std::string& view) {
    const std::string camera = fs::path(view).extension() == ".json" ? fs::path(view).stem().string() : view;
    std::string id = fs::path(scene).stem().string() + (view.empty() ? "" : "@" + camera);
    std::replace(id.begin(), id.end(), '/', '_');
    for (const SweepPlace& place : spec.places)
      if (place.id == id) reader.bad("two scenes are called '{}': give their files or views different names", id);
    spec.places.push_back(
        {id, absolute(scene, folder), fs::path(view).extension() == ".json" ? absolute(view, folder) : view});
  };
  const auto add_scene = [&](const Reader& at, const std::string& scene) {
    if (!at.has("cameras")) return add(scene, "");
    for (const Reader& camera : at.list("cameras")) add(scene, camera.as_text());
  };
  if (reader.has("scene") == reader.has("scenes")) reader.bad("one of 'scene' and 'scenes' is needed");
  if (reader.has("scene")) return add_scene(reader, reader.text("scene"));
  if (reader.has("cameras")) reader.bad("'cameras' belongs to each of 'scenes'");
  for (const Reader& row : reader.list("scenes")) {
    if (row.value().is_string()) {
      add(row.as_text(), "");
      continue;
    }
    row.expect({"scene", "cameras"});
    if (!row.has("scene")) row.bad("'{}' is missing", row.at("scene"));
    add_scene(row, row.text("scene"));
  }
}

void read_run(const Reader& row, SweepSpec& spec) {
  row.expect({"name", "technique", "mode", "base", "permute"});
  if (!row.has("technique")) row.bad("'{}' is missing", row.at("technique"));
  SweepRun run{.name = row.text("name"), .technique = row.text("technique"), .mode = row.text("mode")};
  if (!run.mode.empty() && run.mode != "paper" && run.mode != "radiometric")
    row.bad("'{}' must be paper or radiometric", row.at("mode"));
  if (row.has("base")) run.base = row.child("base").value();
  if (!run.base.is_object()) row.bad("'{}' must be an object", row.at("base"));
  if (row.has("permute"))
    for (const auto& [id, values] : row.child("permute").value().items()) {
      if (!values.is_array() || values.empty()) row.bad("'{}.{}' must be a list of values", row.at("permute"), id);
      run.permute.emplace_back(id, values.get<std::vector<json>>());
    }
  // "*": one run for each technique there is. Without screen-space GI its parameters mean nothing.
  for (const passes::Technique& technique : passes::techniques()) {
    if (run.technique != "*" && run.technique != technique.id) continue;
    SweepRun one = run;
    one.technique = technique.id;
    if (run.technique == "*" || one.name.empty()) one.name = technique.id;
    if (run.technique == "*" && one.technique == "none") one.permute.clear();
    spec.runs.push_back(one);
  }
  if (run.technique != "*") passes::find_technique(run.technique);
}

void read_reference(const Reader& reader, const fs::path& folder, SweepSpec& spec) {
  if (!reader.has("reference")) return;
  SweepReference reference;
  if (reader.child("reference").value().is_string()) {
    reference.file = absolute(reader.text("reference"), folder);
  } else {
    const Reader row = reader.child("reference");
    row.expect({"spp", "bounces"});
    reference.spp = row.count("spp", 256, 2);
    reference.bounces = row.count("bounces", 1, 1, 16);
  }
  spec.reference = reference;
  std::vector<std::string> ids = {"relmse", "flip"};
  if (reader.has("metrics")) {
    ids.clear();
    for (const Reader& row : reader.list("metrics")) ids.push_back(row.as_text());
  }
  for (const std::string& id : ids) {
    spec.metrics.push_back(image::find_metric(id));
    if (!spec.metrics.back() || spec.metrics.back()->more_is_better)
      reader.bad("'metrics' has '{}': there are mae, mse, rmse, relmse, flip", id);
  }
}

}  // namespace

SweepSpec parse_sweep(const json& document, const fs::path& folder, const std::string& name) {
  const Reader reader(document, "", name);
  reader.expect({"schema", "scene", "scenes", "cameras", "size", "seed", "time", "layer", "reference", "metrics",
                 "repeats", "warmup", "frames", "block", "group", "timing", "cost", "runs", "narrow"});
  if (reader.text("schema") != "nearfield.sweep/1") reader.bad("'schema' must be \"nearfield.sweep/1\"");
  SweepSpec spec;
  read_places(reader, folder, spec);
  if (reader.has("size")) {
    const json& size = document["size"];
    if (!size.is_array() || size.size() != 2 || !size[0].is_number_unsigned() || !size[1].is_number_unsigned())
      reader.bad("'size' must be [width, height]");
    spec.size = parse_size(fmt::format("{}x{}", size[0].get<uint32_t>(), size[1].get<uint32_t>()));
  }
  spec.seed = reader.count("seed", 1, 0, 4294967295u);
  spec.group = reader.count("group", 4, 1);
  spec.layer = reader.text("layer");
  passes::find_aov(spec.layer);
  spec.measure.fps = 0;  // the references show the scene at rest
  spec.measure.time = reader.number("time", 0);
  spec.measure.repeats = reader.count("repeats", 3, 1);
  spec.measure.warmup = reader.count("warmup", 8, 0);
  spec.measure.frames = reader.count("frames", 20, 1);
  spec.measure.block = reader.count("block", 10, 1);
  const std::string timing = reader.text("timing", "serialize");
  if (timing != "serialize" && timing != "overlap") reader.bad("'timing' must be serialize or overlap");
  spec.measure.timing = parse_timing(timing);
  const std::string cost = reader.text("cost", "frame");
  if (cost != "frame" && cost != "technique") reader.bad("'cost' must be frame or technique");
  if (cost == "technique") spec.cost = "technique_ms";
  if (reader.has("narrow")) {
    const Reader row = reader.child("narrow");
    row.expect({"rounds", "settings"});
    spec.narrow_rounds = row.count("rounds", 2, 0, 100);
    spec.narrow_settings = row.count("settings", 8, 1);
  }
  read_reference(reader, folder, spec);
  if (spec.narrow_rounds && !spec.reference) reader.bad("'narrow' needs a 'reference'");
  if (!reader.has("runs")) reader.bad("'runs' is missing");
  for (const Reader& row : reader.list("runs")) read_run(row, spec);
  for (size_t i = 0; i < spec.runs.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (spec.runs[i].name == spec.runs[k].name) reader.bad("two runs are called '{}'", spec.runs[i].name);
  // Every parameter is known and in range before hours of work begin.
  for (const SweepCell& cell : plan_cells(spec)) subject_of(spec, cell);

  spec.source = document;
  if (spec.source.contains("scene")) spec.source["scene"] = spec.places[0].scene;
  const auto resolve = [&](json& cameras) {
    for (json& camera : cameras)
      if (camera.is_string() && fs::path(camera.get<std::string>()).extension() == ".json")
        camera = absolute(camera, folder);
  };
  if (spec.source.contains("cameras")) resolve(spec.source["cameras"]);
  if (spec.source.contains("scenes"))
    for (json& scene : spec.source["scenes"]) {
      if (scene.is_string()) {
        scene = absolute(scene, folder);
      } else {
        scene["scene"] = absolute(scene["scene"], folder);
        if (scene.contains("cameras")) resolve(scene["cameras"]);
      }
    }
  if (spec.reference && !spec.reference->file.empty()) spec.source["reference"] = spec.reference->file;
  return spec;
}

SweepSpec read_sweep(const fs::path& file) {
  const json document = json::parse(image::read_file(file), nullptr, false);
  if (document.is_discarded()) fail(Exit::Input, "bad sweep '{}': it is not JSON", file.string());
  return parse_sweep(document, fs::absolute(file).parent_path(), file.string());
}

std::string SweepCell::setting(const SweepSpec& spec) const {
  std::string text = spec.runs[run].name;
  char before = '/';
  for (const auto& [id, values] : spec.runs[run].permute) {
    text +=
        fmt::format("{}{}={}", before, id, params[id].is_string() ? params[id].get<std::string>() : params[id].dump());
    before = ',';
  }
  return text;
}
std::string SweepCell::id(const SweepSpec& spec) const {
  return spec.places[place].id + "/" + setting(spec);
}

std::vector<SweepCell> plan_cells(const SweepSpec& spec) {
  std::vector<SweepCell> cells;
  std::set<std::string> ids;
  for (size_t place = 0; place < spec.places.size(); ++place)
    for (size_t r = 0; r < spec.runs.size(); ++r) {
      std::vector<json> settings = {spec.runs[r].base};
      for (const auto& [id, values] : spec.runs[r].permute) {
        std::vector<json> more;
        for (const json& setting : settings)
          for (const json& value : values) {
            more.push_back(setting);
            more.back()[id] = value;
          }
        settings = std::move(more);
      }
      for (const json& setting : settings) {
        const SweepCell cell{place, r, setting};
        if (ids.insert(cell.id(spec)).second) cells.push_back(cell);
      }
    }
  return cells;
}

Subject subject_of(const SweepSpec& spec, const SweepCell& cell) {
  CommonOptions options;
  options.technique = spec.runs[cell.run].technique;
  options.mode = spec.runs[cell.run].mode;
  for (const auto& [id, value] : cell.params.items())
    options.sets.push_back(id + "=" + (value.is_string() ? value.get<std::string>() : value.dump()));
  const passes::FrameSettings settings = make_settings(options, Reconstruction::Default);
  return {cell.id(spec), settings, options.mode.empty() ? "radiometric" : options.mode};
}

}  // namespace nf::editor
