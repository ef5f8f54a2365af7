// Percentiles and deviations.
#include "capture/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace nf::capture {

double nearest_rank(const std::vector<double>& sorted, double percent) {
  NF_CHECK(!sorted.empty() && percent >= 0 && percent <= 100, "{} samples, {} %", sorted.size(), percent);
  // The product first: whole percentages of whole counts are then exact.
  const double rank = std::ceil(percent * double(sorted.size()) / 100);
  return sorted[size_t(std::max(rank, 1.0)) - 1];
}

Statistics statistics(std::vector<double> samples) {
  Statistics s;
  s.count = samples.size();
  if (samples.empty()) return s;
  std::sort(samples.begin(), samples.end());
  s.min = samples.front();
  s.max = samples.back();
  s.median = nearest_rank(samples, 50);
  s.p95 = nearest_rank(samples, 95);
  s.p99 = nearest_rank(samples, 99);
  s.mean = std::accumulate(samples.begin(), samples.end(), 0.0) / double(samples.size());
  double squares = 0;
  std::vector<double> deviations;
  for (const double x : samples) {
    squares += (x - s.mean) * (x - s.mean);
    deviations.push_back(std::abs(x - s.median));
  }
  s.stddev = samples.size() > 1 ? std::sqrt(squares / double(samples.size() - 1)) : 0;
  std::sort(deviations.begin(), deviations.end());
  s.mad = nearest_rank(deviations, 50);
  return s;
}

}  // namespace nf::capture
