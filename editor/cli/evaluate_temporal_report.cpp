// What happens over time, as JSON and Markdown.
#include <algorithm>

#include "cli/evaluate_temporal.h"
#include "cli/paper_spec.h"

namespace nf::editor {
namespace {

using nlohmann::json;

const json* at(const json& row, std::initializer_list<const char*> path) {
  const json* here = &row;
  for (const char* key : path) {
    const auto found = here->find(key);
    if (found == here->end() || found->is_null()) return nullptr;
    here = &*found;
  }
  return here;
}

std::string percent(const json* value) {
  return value ? fmt::format("{:.1f} %", 100 * value->get<double>()) : "–";
}
std::string plain(const json* value, int digits) {
  return value ? fmt::format("{:.{}f}", value->get<double>(), digits) : "–";
}
// Frames until near, or that it was not within those looked at; with the error after 32 frames, or as many as there
// are.
std::string settled(const json* part) {
  if (!part) return "–";
  const json* error = nullptr;
  for (const json& e : (*part)["errors"])
    if (e["frames"] <= 32) error = &e["median"];
  if (!error || error->is_null()) return "–";
  const json& frames = (*part)["frames"];
  return fmt::format(
      "{} ({:.2f} %)",
      frames.is_null() ? fmt::format("> {}", (*part)["looked_at"].get<int>()) : fmt::format("{}", frames.get<int>()),
      100 * error->get<double>());
}
const json* error_after(const json& row, int frames) {
  const json* errors = at(row, {"jump", "uncovered"});
  if (errors)
    for (const json& e : *errors)
      if (e["frames"] == frames && !e["rmse"].is_null()) return &e["rmse"];
  return nullptr;
}
std::string half_life(const json& row) {
  if (const json* value = at(row, {"jump", "half_life"})) return fmt::format("{:.1f}", value->get<double>());
  const json* shown = at(row, {"jump", "shown_of_change"});
  return shown && shown->get<double>() > 0.25 ? "never" : "–";
}

struct Column {
  const char* part;  // of a row that has it
  const char* head;
  std::string (*cell)(const json& row);
};

constexpr Column columns[] = {
    {"convergence", "noise",
     [](const json& row) { return percent(at(row["convergence"]["own_noise"]["rmse"][0], {"rmse"})); }},
    {"convergence", "slope",
     [](const json& row) {
       return plain(at(row, {"convergence", "own_noise", "slope"}), 2);
     }},
    {"convergence", "slope, stbn",
     [](const json& row) {
       return plain(at(row, {"convergence", "stbn", "slope"}), 2);
     }},
    {"settling", "raw mean",
     [](const json& row) {
       return settled(at(row, {"settling", "raw"}));
     }},
    {"settling", "reconstructed",
     [](const json& row) {
       return settled(at(row, {"settling", "reconstructed"}));
     }},
    {"settling", "to raw mean",
     [](const json& row) {
       return settled(at(row, {"settling", "reconstructed_to_raw"}));
     }},
    {"settling", "picture",
     [](const json& row) {
       return settled(at(row, {"settling", "picture"}));
     }},
    {"settling", "picture to raw",
     [](const json& row) {
       return settled(at(row, {"settling", "picture_to_raw"}));
     }},
    {"jump", "ghost", half_life},
    {"jump", "uncovered 1", [](const json& row) { return percent(error_after(row, 1)); }},
    {"jump", "4", [](const json& row) { return percent(error_after(row, 4)); }},
    {"jump", "16", [](const json& row) { return percent(error_after(row, 16)); }},
    {"pan", "flicker",
     [](const json& row) {
       return percent(at(row, {"pan", "signal"}));
     }},
    {"pan", "of the picture",
     [](const json& row) {
       return percent(at(row, {"pan", "picture"}));
     }},
};

struct Legend {
  const char *part, *text;
};
constexpr Legend legends[] = {
    {"",
     "The signal is `gi`, or `visibility` of techniques that give no light. –: there is nothing to measure. What is "
     "reconstructed goes through the stages as set."},
    {"convergence",
     "noise: RMSE of one raw frame, in % of the mean. slope: exponent of the RMSE of the cumulative mean of raw frames "
     "over their number, from the spread of eight means with seeds of their own (white noise: -0.5), with the noise as "
     "set and with "
     "`gi.noise=stbn`."},
    {"settling",
     "raw mean, reconstructed, picture: frames, from no history on, until the median pixel is within 2 %; in brackets "
     "how far it is after 32. raw mean: the signal's mean over raw frames so far, of their long mean. reconstructed: "
     "the signal, of its own long mean once settled, which leaves noise alone; to raw mean: of the long mean of raw "
     "frames, so that blur counts, too. picture: all light, before the tone curve, in the same two ways. Of surfaces "
     "alone."},
    {"jump",
     "ghost: frames until half of the change is there, on surfaces that stay, after an occluder is gone; below 1: with "
     "the first frame; –: less than a quarter of the change is ever shown. uncovered: RMSE where the occluder was, "
     "against the raw mean without it, after 1, 4 and 16 frames, in % of the mean there."},
    {"pan",
     "flicker: deviation from frame to frame while the camera turns by a tenth of a pixel a frame, in % of the mean, "
     "of the signal and of the picture as shown. Only this has antialiasing, whose jitter moves the signal about."},
};

}  // namespace

json temporal_json(const EvaluateOptions& o, const TemporalLengths& lengths, const std::vector<json>& rows,
                   const gpu::DeviceInfo& device, bool complete) {
  return {{"schema", "nearfield.temporal/1"},
          {"complete", complete},
          {"version", version_line()},
          {"command", command_line()},
          {"device", {{"name", device.name}, {"type", device.type}, {"driver", device.driver}}},
          {"size", {parse_size(o.size).x, parse_size(o.size).y}},
          {"seed", o.seed},
          {"frames",
           {{"own_mean", lengths.own_mean},
            {"convergence", lengths.convergence},
            {"before_jump", lengths.before_jump},
            {"after_jump", lengths.after_jump},
            {"pan", lengths.pan}}},
          {"parts", temporal_parts(o.temporal)},
          {"rows", rows}};
}

std::string temporal_markdown(const json& document) {
  std::string text = fmt::format("# Over time\n\n`{}`\n\n{}x{}, own means of {} frames.\n",
                                 document["command"].get<std::string>(), document["size"][0].get<int>(),
                                 document["size"][1].get<int>(), document["frames"]["own_mean"].get<int>());
  if (!document["complete"].get<bool>()) text += "\n**Interrupted: the table is not complete.**\n";
  const json& parts = document["parts"];
  const auto measured = [&](std::string_view part) {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  };
  for (const Legend& legend : legends)
    if (!*legend.part || measured(legend.part)) text += fmt::format("\n{}\n", legend.text);
  std::vector<std::string> head = {"technique", "signal"};
  for (const Column& column : columns)
    if (measured(column.part)) head.emplace_back(column.head);

  const json& rows = document["rows"];
  for (size_t first = 0; first < rows.size();) {
    const json& place = rows[first]["place"];
    text += fmt::format("\n## {}\n\n", place.get<std::string>());
    if (const json* occluder = at(rows[first], {"jump", "occluder"}))
      text += fmt::format("The occluder is `{}`.\n\n", occluder->get<std::string>());
    std::vector<std::vector<std::string>> table;
    for (; first < rows.size() && rows[first]["place"] == place; ++first) {
      const json& row = rows[first];
      std::vector<std::string>& cells = table.emplace_back(head.size(), "–");
      cells[0] = row["contender"];
      if (row.contains("absent")) continue;
      cells[1] = row["signal"];
      size_t cell = 2;
      for (const Column& column : columns)
        if (measured(column.part)) cells[cell++] = column.cell(row);
    }
    text += markdown_table(head, table);
  }
  return text;
}

}  // namespace nf::editor
