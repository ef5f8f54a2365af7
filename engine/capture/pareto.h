// Which of many pairs (cost, error) are worth having.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace nf::capture {

struct CostAndError {
  double cost = 0, error = 0;
};

// Rows that no other row beats: none costs no more and errs no more, with one of the two less. In order of cost. Of
// equal rows the first. Rows that are not finite are never in it.
std::vector<size_t> pareto_front(std::span<const CostAndError> rows);

}  // namespace nf::capture
