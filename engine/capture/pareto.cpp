// The Pareto front.
#include "capture/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nf::capture {

std::vector<size_t> pareto_front(std::span<const CostAndError> rows) {
  std::vector<size_t> order;
  for (size_t i = 0; i < rows.size(); ++i)
    if (std::isfinite(rows[i].cost) && std::isfinite(rows[i].error)) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return rows[a].cost != rows[b].cost ? rows[a].cost < rows[b].cost : rows[a].error < rows[b].error;
  });
  double least = std::numeric_limits<double>::infinity();
  std::erase_if(order, [&](size_t i) {
    if (rows[i].error >= least) return true;
    least = rows[i].error;
    return false;
  });
  return order;
}

}  // namespace nf::capture
