// Comparison of two captures.
#include "capture/baseline.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "capture/timing.h"
#include "core/error.h"

namespace nf::capture {

using nlohmann::json;

const char* verdict_name(Verdict verdict) {
  static constexpr const char* names[] = {"same", "faster", "slower", "REGRESSION", "new", "gone"};
  return names[size_t(verdict)];
}

namespace {

struct Row {
  double median = 0, scatter = 0;
};

// How far a median of this capture may lie from that of another: the scatter of single frames shrinks with their
// number, the drift between repeats does not.
Row read_row(const json& gpu, const json& per_repeat) {
  Row row;
  if (gpu["median"].is_null()) return row;
  row.median = gpu["median"];
  const double frames = gpu["mad"].get<double>() / std::sqrt(std::max(gpu["count"].get<double>(), 1.0));
  double drift = 0;
  if (per_repeat.is_array() && per_repeat.size() > 1) {
    const std::vector<double> medians = per_repeat;
    const auto [low, high] = std::minmax_element(medians.begin(), medians.end());
    drift = (*high - *low) / 2;
  }
  row.scatter = std::max({1.4826 * frames, drift, 0.001});
  return row;
}

std::map<std::string, Row> read_rows(const json& run, std::vector<std::string>& order) {
  std::map<std::string, Row> rows;
  for (const json& pass : run["passes"]) {
    rows[pass["path"]] = read_row(pass["gpu_ms"], pass["per_repeat_median"]);
    order.push_back(pass["path"]);
  }
  rows["frame"] = read_row(run["frame"]["gpu_ms"], run["frame"]["per_repeat_median"]);
  order.emplace_back("frame");
  return rows;
}

void require_same(const json& a, const json& b, const json::json_pointer& what, const char* name) {
  const json x = a.contains(what) ? a[what] : json(), y = b.contains(what) ? b[what] : json();
  if (x != y)
    fail(Exit::Input, "cannot compare with the baseline: its {} is {}, this one's {}; make a new baseline", name,
         x.dump(), y.dump());
}

Verdict judge(const Change& change, double frame_ms, double fail_above) {
  const double grown = change.after - change.before;
  if (std::abs(grown) <= change.noise || std::max(change.before, change.after) < compared_share * frame_ms)
    return Verdict::Same;
  if (grown < 0) return Verdict::Faster;
  return grown > fail_above * change.before ? Verdict::Regression : Verdict::Slower;
}

void compare_runs(const json& before, const json& after, double fail_above, std::vector<Change>& changes) {
  for (const auto& [what, name] : {std::pair("/context/device/name", "device"),
                                   {"/settings/size", "size"},
                                   {"/scene/path", "scene"},
                                   {"/scene/camera", "camera"},
                                   {"/method/timing", "timing mode"},
                                   {"/context/app/build", "build type"}})
    require_same(before, after, json::json_pointer(what), name);
  std::vector<std::string> old_order, order;
  const auto old_rows = read_rows(before, old_order), rows = read_rows(after, order);
  const double frame_ms = std::max(old_rows.at("frame").median, rows.at("frame").median);
  for (const std::string& pass : order) {
    const Row& row = rows.at(pass);
    Change change{.run = after["name"], .pass = pass, .after = row.median};
    if (const auto old = old_rows.find(pass); old != old_rows.end()) {
      change.before = old->second.median;
      change.noise = 3 * std::hypot(old->second.scatter, row.scatter);
      change.verdict = judge(change, frame_ms, fail_above);
    } else {
      change.verdict = Verdict::New;
    }
    changes.push_back(change);
  }
  for (const std::string& pass : old_order)
    if (!rows.count(pass)) changes.push_back({after["name"], pass, old_rows.at(pass).median, 0, 0, Verdict::Gone});
}

}  // namespace

std::vector<Change> compare_timings(const json& before, const json& after, double fail_above) {
  std::vector<Change> changes;
  try {
    for (const json& run : after.at("runs"))
      for (const json& old : before.at("runs"))
        if (old.at("name") == run.at("name")) compare_runs(old, run, fail_above, changes);
  } catch (const json::exception& e) {
    fail(Exit::Input, "the baseline is not a nearfield.timing/1 document: {}", e.what());
  }
  if (changes.empty()) fail(Exit::Input, "the baseline has none of these runs; name the same techniques or presets");
  return changes;
}

}  // namespace nf::capture
