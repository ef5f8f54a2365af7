// Blue noise: numbers whose neighbours differ as much as they can.
#pragma once

#include <cstdint>
#include <vector>

namespace nf::image {

// Ranks 0 .. n-1, each once, of an array of side x side that wraps around (n = its size), by void and cluster (Ulichney
// 1993); index y * side + x: rank / n is its value. Integers only: the same on every machine. side >= 8.
std::vector<uint32_t> void_and_cluster(uint32_t side, uint32_t seed);

}  // namespace nf::image
