// Two captures of the same thing, before and after: what became slower, beyond the noise of both?
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace nf::capture {

enum class Verdict { Same, Faster, Slower, Regression, New, Gone };
const char* verdict_name(Verdict verdict);

struct Change {
  std::string run, pass;         // pass "frame": all of it
  double before = 0, after = 0;  // medians, ms
  double noise = 0;              // differences below are noise: three times what the medians scatter
  Verdict verdict = Verdict::Same;
  double percent() const { return before > 0 ? 100 * (after - before) / before : 0; }
};

// Both are documents nearfield.timing/1. A pass or frame is a regression when its median grew by more than the noise
// and by more than `fail_above` (0.05 = 5 %); passes below 1 % of their frame are never. Throws nf::Error (Exit::Input)
// when they cannot be compared: another device, size, scene or timing mode, or not one run in common.
std::vector<Change> compare_timings(const nlohmann::json& before, const nlohmann::json& after, double fail_above);

}  // namespace nf::capture
