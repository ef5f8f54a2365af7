// The timing document.
#include <cmath>

#include "capture/timing.h"

namespace nf::capture {

using nlohmann::json;

json to_json(const Statistics& s) {
  // Nothing was counted: JSON has no NaN, and 0 would be a lie.
  const auto number = [&](double value) { return s.count && std::isfinite(value) ? json(value) : json(nullptr); };
  return {{"count", s.count},       {"min", number(s.min)},       {"median", number(s.median)},
          {"p95", number(s.p95)},   {"p99", number(s.p99)},       {"max", number(s.max)},
          {"mean", number(s.mean)}, {"stddev", number(s.stddev)}, {"mad", number(s.mad)}};
}

namespace {

json run_json(const RunResult& result) {
  const Run& run = *result.run;
  const Summary& summary = result.summary;
  json passes = json::array();
  for (size_t p = 0; p < run.passes.size(); ++p) {
    const PassInfo& info = run.passes[p];
    json row = {{"path", info.path},
                {"kind", info.kind},
                {"description", info.description},
                {"gpu_ms", to_json(summary.passes[p].gpu)},
                {"cpu_record_ms", to_json(summary.passes[p].record)},
                {"per_repeat_median", summary.passes[p].per_repeat}};
    if (!info.counts.is_null()) row["counts"] = info.counts;
    passes.push_back(row);
  }
  json warnings = result.trust.warnings;
  for (const std::string& reason : result.trust.noisy) warnings.push_back(reason);
  json out = {{"name", run.name},
              {"technique", run.technique},
              {"scene", run.scene},
              {"settings", run.settings},
              {"passes", passes},
              {"frame",
               {{"gpu_ms", to_json(summary.frame.gpu)},
                {"cpu_ms", to_json(summary.frame.record)},
                {"wall_ms", to_json(summary.wall)},
                {"unattributed_ms", to_json(summary.unattributed)},
                {"per_repeat_median", summary.frame.per_repeat}}},
              {"memory", run.memory},
              {"warnings", warnings},
              {"noisy", !result.trust.noisy.empty()},
              {"noisy_reasons", result.trust.noisy}};
  if (!run.picture.empty()) out["picture"] = run.picture;
  return out;
}

}  // namespace

json timing_document(const json& context, const json& method, const std::vector<RunResult>& results, bool complete) {
  json runs = json::array();
  for (const RunResult& result : results) {
    json run = run_json(result);
    run["context"] = context;
    run["method"] = method;
    runs.push_back(run);
  }
  return {{"schema", "nearfield.timing/1"}, {"complete", complete}, {"runs", runs}};
}

}  // namespace nf::capture
