// The papers' tables: what is measured, and how it is printed next to what is published.
#include "cli/bench_tables.h"

#include <algorithm>
#include <cmath>

#include "cli/paper_spec.h"
#include "core/error.h"

namespace nf::editor {
namespace {

using nlohmann::json;

// What a frame costs: on a software device the CPU time of the process, since its pass times are wall times of threads
// that others interrupt.
double frame_cost(const capture::FrameSample& frame, bool software) {
  return software ? frame.process_ms : frame.gpu_ms;
}

// Median over the frames of one repeat, or of all.
double median_cost(const capture::Run& run, bool software, int64_t repeat = -1) {
  std::vector<double> costs;
  for (const capture::FrameSample& frame : run.frames)
    if (repeat < 0 || frame.repeat == repeat) costs.push_back(frame_cost(frame, software));
  return costs.empty() ? NAN : capture::statistics(costs).median;
}

uint32_t repeats_of(const capture::Run& run) {
  uint32_t repeats = 0;
  for (const capture::FrameSample& frame : run.frames) repeats = std::max(repeats, frame.repeat + 1);
  return repeats;
}

// Both costs over the frame without a technique, `none`. half_range: of the ratios of the single repeats.
struct Ratio {
  double value = NAN, half_range = NAN;
};
Ratio ratio_of(const capture::Run& of, const capture::Run& to, const capture::Run& none, bool software) {
  const auto over = [&](int64_t repeat) {
    const double rest = median_cost(none, software, repeat);
    return (median_cost(of, software, repeat) - rest) / (median_cost(to, software, repeat) - rest);
  };
  Ratio ratio{over(-1), NAN};
  double least = INFINITY, most = -INFINITY;
  for (uint32_t repeat = 0; repeat < repeats_of(of); ++repeat)
    least = std::min(least, over(repeat)), most = std::max(most, over(repeat));
  if (repeats_of(of) > 1) ratio.half_range = 0.5 * (most - least);
  return ratio;
}

// Published milliseconds, from ms or frames a second, less what the frame has without.
double published_ms(const json& value, const json& table) {
  const bool fps = table.value("unit", "ms") == "fps";
  const auto ms = [&](double x) { return fps ? 1000 / x : x; };
  const double without = table.value("published_without", 0.0);
  return ms(value) - (without > 0 ? ms(without) : 0);
}

// The ratio that the paper's own figures have; a text where it prints only that.
json published_ratio(const json& table, const json& row, const std::string& column) {
  const json published = row.value("published", json::object());
  if (!published.contains(column)) return nullptr;
  if (published[column].is_string()) return published[column];
  const json& over = table["over"];
  const json* base = nullptr;
  if (over.contains("column")) {
    if (published.contains(over["column"].get<std::string>())) base = &published[over["column"].get<std::string>()];
  } else {
    for (const json& other : table["rows"])
      if (other["id"] == over["row"] && other.value("published", json::object()).contains(column))
        base = &other["published"][column];
  }
  if (!base) return nullptr;
  return published_ms(published[column], table) / published_ms(*base, table);
}

// The settings of a cell. The row's parameters win: the form is the same in all of them.
passes::FrameSettings cell_settings(const json& table, const json& row, const json& column) {
  json form = column;
  form["params"] = column.value("params", json::object());
  form["params"].update(row.value("params", json::object()));
  return spec_settings(form, table.value("base", json::object()));
}

// All of it before minutes of work: keys, settings, and that what the ratios are over is there.
void check_table(const json& table, const std::string& where) {
  expect_keys(table, where,
              {"id", "title", "kind", "source", "size", "over", "base", "columns", "rows", "notes", "form", "stages",
               "unit", "published_without"});
  if (table.value("kind", "ratios") == "stages") {
    expect_keys(table.at("form"), where + ".form", {"technique", "mode", "params"});
    spec_settings(table["form"], table.value("base", json::object()));
    for (const json& stage : table.at("stages"))
      expect_keys(stage, where + ".stages", {"label", "passes", "published", "beside"});
    return;
  }
  const json& over = table.at("over");
  expect_keys(over, where + ".over", {"column", "row"});
  const char* list = over.contains("column") ? "columns" : "rows";
  const json& wanted = over.begin().value();
  for (const json& column : table.at("columns"))
    expect_keys(column, where + ".columns", {"id", "label", "technique", "mode", "params"});
  for (const json& row : table.at("rows")) {
    expect_keys(row, where + ".rows", {"id", "label", "params", "published"});
    for (const json& column : table["columns"]) cell_settings(table, row, column);
  }
  if (std::none_of(table[list].begin(), table[list].end(), [&](const json& x) { return x.at("id") == wanted; }))
    fail(Exit::Input, "'{}' is over '{}', which is none of its {}", where, wanted.dump(), list);
}

std::string ratio_text(const json& cell) {
  if (cell.is_null() || !cell["ratio"].is_number()) return "–";
  std::string text = fmt::format("{:.2f}", cell["ratio"].get<double>());
  if (cell["half_range"].is_number()) text += fmt::format(" ± {:.2f}", cell["half_range"].get<double>());
  const json& published = cell["published_ratio"];
  if (published.is_number()) text += fmt::format(" ({:.2f})", published.get<double>());
  if (published.is_string()) text += fmt::format(" ({})", published.get<std::string>());
  return text;
}

}  // namespace

PaperTables::PaperTables(const std::filesystem::path& file) : spec_(read_spec(file, "nearfield.paper_tables/1")) {
  try {
    expect_keys(spec_, file.filename().string(), {"schema", "tables", "not_made"});
    for (const json& table : spec_.at("tables")) check_table(table, "tables." + table.at("id").get<std::string>());
  } catch (const Error& e) {
    fail(Exit::Input, "bad tables '{}': {}", file.string(), e.what());
  } catch (const json::exception& e) {
    fail(Exit::Input, "bad tables '{}': {}", file.string(), e.what());
  }
}

bool PaperTables::run(gpu::Device& device, scene::Scene& scene, passes::Renderer& renderer,
                      const passes::FrameView& view, const MeasureOptions& method,
                      const std::function<void(const std::string&)>& notice) {
  software_ = device.facts.software;
  for (json table : spec_["tables"]) {
    passes::FrameView sized = view;
    sized.size = parse_size(table["size"]);
    Meter meter(device, scene, renderer, sized, method);
    const std::string id = table["id"];
    meter.on_progress = [&](uint64_t done, uint64_t total, double) {
      notice(fmt::format("{}: {} of {} frames", id, done, total));
    };
    if (!(table.value("kind", "ratios") == "stages" ? run_stages(table, meter) : run_table(table, meter))) return false;
    results_.push_back(std::move(table));
  }
  return true;
}

bool PaperTables::run_table(json& table, Meter& meter) {
  std::vector<Subject> subjects = {
      {"none", spec_settings({{"technique", "none"}}, table.value("base", json::object())), "radiometric"}};
  for (const json& row : table["rows"])
    for (const json& column : table["columns"]) {
      subjects.push_back({fmt::format("{} {}", row["id"].get<std::string>(), column["id"].get<std::string>()),
                          cell_settings(table, row, column), column.value("mode", "radiometric")});
    }
  const Measured measured = meter.run(subjects);
  if (!measured.complete) return false;
  const capture::Run& none = measured.runs[0];
  const size_t columns = table["columns"].size();
  const auto at = [&](size_t row, size_t column) -> const capture::Run& {
    return measured.runs[1 + row * columns + column];
  };
  const auto index = [&](const char* list, const json& id) {
    size_t i = 0;
    while (table[list][i]["id"] != id) ++i;
    return i;
  };
  const json over = table["over"];
  table["none_ms"] = median_cost(none, software_);
  for (size_t r = 0; r < table["rows"].size(); ++r) {
    json cells = json::object();
    for (size_t c = 0; c < columns; ++c) {
      const std::string id = table["columns"][c]["id"];
      const capture::Run& to =
          over.contains("column") ? at(r, index("columns", over["column"])) : at(index("rows", over["row"]), c);
      const Ratio ratio = ratio_of(at(r, c), to, none, software_);
      cells[id] = {{"ms", median_cost(at(r, c), software_) - median_cost(none, software_)},
                   {"ratio", ratio.value},
                   {"half_range", ratio.half_range},
                   {"published_ratio", published_ratio(table, table["rows"][r], id)}};
    }
    table["rows"][r]["cells"] = cells;
  }
  return true;
}

bool PaperTables::run_stages(json& table, Meter& meter) {
  const std::vector<Subject> subjects = {
      {"stages", spec_settings(table["form"], table.value("base", json::object())), "paper"}};
  const Measured measured = meter.run(subjects);
  if (!measured.complete) return false;
  const capture::Run& run = measured.runs[0];
  double sum = 0, published = 0;
  for (json& stage : table["stages"]) {
    // "resolution.split#3" is the third pass of that name.
    std::vector<bool> counted(run.passes.size());
    for (const json& name : stage["passes"]) {
      bool found = false;
      for (size_t p = 0; p < run.passes.size(); ++p)
        if (run.passes[p].path.substr(0, run.passes[p].path.find('#')) == name) counted[p] = found = true;
      if (!found)
        fail(Exit::Input, "stage '{}': the frame has no pass {}; see `nearfield graph`",
             stage["label"].get<std::string>(), name.dump());
    }
    double least = INFINITY;
    for (const capture::FrameSample& frame : run.frames) {
      double ms = 0;
      for (const capture::PassSample& pass : frame.passes)
        if (counted[pass.pass]) ms += pass.gpu_ms;
      least = std::min(least, ms);
    }
    stage["least_ms"] = least;
    // What is not a part of the paper's sum.
    if (stage.value("beside", false)) continue;
    sum += least;
    published += stage.value("published", 0.0);
  }
  for (json& stage : table["stages"]) {
    stage["share"] = stage["least_ms"].get<double>() / sum;
    if (stage.contains("published")) stage["published_share"] = stage["published"].get<double>() / published;
  }
  return true;
}

json PaperTables::document() const {
  return {{"schema", "nearfield.paper_tables_result/1"},
          {"tables", results_},
          {"not_made", spec_.value("not_made", json::array())}};
}

std::string PaperTables::markdown(const std::string& device, bool software, const std::string& scene,
                                  const MeasureOptions& method) const {
  std::string text = fmt::format(
      "# Tables of the papers, as ratios\n\n`{}`\n\nOn {}, {}; {} repeats of {} frames, blocks of {} in turn. A cost "
      "is "
      "{} of a frame less that of a frame without a technique, the median. Each entry is measured ± half the range "
      "over the repeats, and in brackets the ratio of the published figures.\n",
      command_line(), device, scene, method.repeats, method.frames, method.block,
      software ? "the CPU time (the device is a program: what a GPU's caches and bandwidth do to a ratio is not in it)"
               : "the GPU time");
  for (const json& table : results_) {
    text += fmt::format("\n## {}\n\n{}. Measured at {}.\n\n", table["title"].get<std::string>(),
                        table["source"].get<std::string>(), table["size"].get<std::string>());
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
    if (table.contains("stages")) {
      head = {"stage", "least ms", "share", "published ms", "share"};
      for (const json& stage : table["stages"])
        rows.push_back({stage["label"], fmt::format("{:.2f}", stage["least_ms"].get<double>()),
                        fmt::format("{:.0f} %", 100 * stage["share"].get<double>()),
                        stage.contains("published") ? fmt::format("{:.2f}", stage["published"].get<double>()) : "–",
                        stage.contains("published")
                            ? fmt::format("{:.0f} %", 100 * stage["published_share"].get<double>())
                            : "–"});
    } else {
      head = {fmt::format("over {}", table["over"].begin().value().get<std::string>())};
      for (const json& column : table["columns"]) head.push_back(column["label"]);
      for (const json& row : table["rows"]) {
        std::vector<std::string> cells = {row["label"]};
        for (const json& column : table["columns"]) {
          const json& cell = row["cells"][column["id"].get<std::string>()];
          const bool base = table["over"].contains("column") ? table["over"]["column"] == column["id"]
                                                             : table["over"]["row"] == row["id"];
          cells.push_back(base ? fmt::format("1 = {:.1f} ms", cell["ms"].get<double>()) : ratio_text(cell));
        }
        rows.push_back(cells);
      }
    }
    text += markdown_table(head, rows);
    for (const json& note : table.value("notes", json::array())) text += fmt::format("\n{}\n", note.get<std::string>());
  }
  text += "\n## Not made\n\n";
  for (const json& what : spec_.value("not_made", json::array()))
    text += fmt::format("- {}\n", what.get<std::string>());
  return text;
}

}  // namespace nf::editor
