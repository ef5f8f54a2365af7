// What the finished cells say: which settings are worth having, and where to look for more of them.
#include <algorithm>
#include <cmath>
#include <map>

#include "capture/pareto.h"
#include "sweep/sweep.h"

namespace nf::editor {

using nlohmann::json;

const json& cost_of(const json& cell) {
  return cell.at(cell.at("cost").get<std::string>());
}

std::vector<SettingResult> setting_results(const SweepSpec& spec, const std::vector<json>& cells) {
  struct Sum {
    SettingResult result;
    size_t places = 0;
  };
  std::map<std::string, Sum> sums;
  for (const json& cell : cells) {
    if (spec.metrics.empty()) break;
    const json error = cell["errors"].value(spec.metrics[0]->id, json()), ms = cost_of(cell)["median"];
    if (!error.is_number() || !ms.is_number()) continue;
    Sum& sum = sums[cell["setting"]];
    sum.result.setting = cell["setting"];
    sum.result.params = cell["params"];
    for (size_t r = 0; r < spec.runs.size(); ++r)
      if (spec.runs[r].name == cell["run"]) sum.result.run = r;
    sum.result.ms += ms.get<double>() / double(spec.places.size());
    sum.result.error += error.get<double>() / double(spec.places.size());
    ++sum.places;
  }
  std::vector<SettingResult> results;
  for (const auto& [setting, sum] : sums)
    if (sum.places == spec.places.size()) results.push_back(sum.result);
  return results;
}

namespace {

// Half way to the nearest values below and above; whole numbers stay whole.
std::vector<json> between(const json& value, const std::vector<json>& sampled) {
  const bool whole = std::all_of(sampled.begin(), sampled.end(), [](const json& v) { return v.is_number_integer(); });
  std::vector<double> values;
  for (const json& v : sampled) values.push_back(v.get<double>());
  std::sort(values.begin(), values.end());
  const double own = value.get<double>();
  std::vector<json> out;
  for (const bool above : {false, true}) {
    const auto at = above ? std::upper_bound(values.begin(), values.end(), own)
                          : std::lower_bound(values.begin(), values.end(), own);
    if (above ? at == values.end() : at == values.begin()) continue;
    const double other = above ? *at : *(at - 1), middle = (own + other) / 2;
    if (!whole) {
      out.emplace_back(middle);
    } else if (std::abs(own - other) > 1) {
      out.emplace_back(int64_t(std::floor(middle)));
    }
  }
  return out;
}

}  // namespace

std::vector<SweepCell> narrow(const SweepSpec& spec, const std::vector<json>& cells,
                              const std::vector<SweepCell>& known) {
  const std::vector<SettingResult> results = setting_results(spec, cells);
  std::vector<capture::CostAndError> points;
  for (const SettingResult& r : results) points.push_back({r.ms, r.error});
  std::set<std::string> ids;
  std::map<std::pair<size_t, std::string>, std::vector<json>> sampled;  // by run and parameter
  for (const SweepCell& cell : known) {
    ids.insert(cell.id(spec));
    for (const auto& [id, values] : spec.runs[cell.run].permute)
      if (cell.params[id].is_number()) sampled[{cell.run, id}].push_back(cell.params[id]);
  }
  std::vector<SweepCell> more;
  size_t settings = 0;
  for (const size_t row : capture::pareto_front(points))
    for (const auto& [id, values] : spec.runs[results[row].run].permute) {
      if (!results[row].params[id].is_number()) continue;
      for (const json& value : between(results[row].params[id], sampled[{results[row].run, id}])) {
        if (settings == spec.narrow_settings) return more;
        SweepCell cell{0, results[row].run, results[row].params};
        cell.params[id] = value;
        if (!ids.insert(cell.id(spec)).second) continue;
        ++settings;
        for (cell.place = 0; cell.place < spec.places.size(); ++cell.place) more.push_back(cell);
      }
    }
  return more;
}

}  // namespace nf::editor
