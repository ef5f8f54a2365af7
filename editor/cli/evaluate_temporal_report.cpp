// What happens over time, as JSON and Markdown.
#include "cli/evaluate_temporal.h"

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
// Frames until near, or that it was not within those looked at, with the error that was left.
std::string settled(const json* part) {
  if (!part) return "–";
  const json& last = (*part)["errors"].back();
  if (!(*part)["frames"].is_null()) return fmt::format("{}", (*part)["frames"].get<int>());
  if (last["median"].is_null()) return "–";
  return fmt::format("> {} ({:.1f} %)", last["frames"].get<int>(), 100 * last["median"].get<double>());
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

constexpr const char* legend =
    "The signal is `gi`, or `visibility` of techniques that give no light. noise: RMSE of one raw frame, in % of the "
    "mean. slope: exponent of the RMSE of the cumulative mean of raw frames over their number, from two means with "
    "seeds "
    "of their own (white noise: -0.5), with the noise as set and with `gi.noise=stbn`. to 2 %: frames until the median "
    "pixel is within 2 % of the technique's own mean: the cumulative mean of raw frames of their long mean, "
    "reconstructed frames, from no history on, of their mean once settled; in brackets what is left at the end. The "
    "rest "
    "is reconstructed, by the default stages. ghost: frames until half of the change is there, on surfaces that stay, "
    "after an occluder is gone; below 1: with the first frame; –: less than a quarter of the change is ever shown. "
    "uncovered: RMSE where the occluder was, against the raw "
    "mean without it, after 1, 4 and 16 frames, in % of the mean there. flicker: deviation from frame to frame while "
    "the camera turns by a tenth of a pixel a frame, in % of the mean, of the signal and of the picture as shown. Only "
    "flicker has antialiasing, whose jitter moves the signal about. –: there is nothing to measure.";

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
            {"reconstructed", lengths.reconstructed},
            {"before_jump", lengths.before_jump},
            {"after_jump", lengths.after_jump},
            {"pan", lengths.pan}}},
          {"rows", rows}};
}

std::string temporal_markdown(const json& document) {
  std::string text = fmt::format("# Over time\n\n`{}`\n\n{}x{}, own means of {} frames.\n",
                                 document["command"].get<std::string>(), document["size"][0].get<int>(),
                                 document["size"][1].get<int>(), document["frames"]["own_mean"].get<int>());
  if (!document["complete"].get<bool>()) text += "\n**Interrupted: the table is not complete.**\n";
  text += fmt::format("\n{}\n", legend);
  std::string place;
  for (const json& row : document["rows"]) {
    if (row["place"] != place) {
      place = row["place"];
      const json* occluder = at(row, {"jump", "occluder"});
      text += fmt::format("\n## {}\n\n", place);
      if (occluder) text += fmt::format("The occluder is `{}`.\n\n", occluder->get<std::string>());
      text +=
          "| technique | signal | noise | slope | slope, stbn | to 2 %, raw | to 2 %, reconstructed | ghost | "
          "uncovered 1 "
          "| 4 | 16 | flicker | picture |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    }
    if (row.contains("absent")) {
      text +=
          fmt::format("| {} | – | – | – | – | – | – | – | – | – | – | – | – |\n", row["contender"].get<std::string>());
      continue;
    }
    const json& first = row["convergence"]["own_noise"]["rmse"][0];
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                        row["contender"].get<std::string>(), row["signal"].get<std::string>(),
                        percent(at(first, {"rmse"})), plain(at(row, {"convergence", "own_noise", "slope"}), 2),
                        plain(at(row, {"convergence", "stbn", "slope"}), 2), settled(at(row, {"settling", "raw"})),
                        settled(at(row, {"settling", "reconstructed"})), half_life(row), percent(error_after(row, 1)),
                        percent(error_after(row, 4)), percent(error_after(row, 16)),
                        percent(at(row, {"pan", "signal"})), percent(at(row, {"pan", "picture"})));
  }
  return text;
}

}  // namespace nf::editor
