// Statistics of repeated measurements.
#pragma once

#include <cstdint>
#include <vector>

namespace nf::capture {

// Of a list of milliseconds. Percentiles by nearest rank; mad = median absolute deviation.
struct Statistics {
  uint64_t count = 0;
  double min = 0, median = 0, p95 = 0, p99 = 0, max = 0, mean = 0, stddev = 0, mad = 0;
};
Statistics statistics(std::vector<double> samples);

// The smallest value that at least `percent` % of the samples do not exceed. `sorted` must not be empty.
double nearest_rank(const std::vector<double>& sorted, double percent);

}  // namespace nf::capture
