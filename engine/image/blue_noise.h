// Blue noise: numbers whose neighbours differ as much as they can.
#pragma once

#include <cstdint>
#include <vector>

namespace nf::image {

// Ranks 0 .. n-1, each once, of an array of side x side x slices that wraps around (n = its size), by void and cluster
// (Ulichney 1993); index (slice * side + y) * side + x. With several slices the array is blue within each slice and
// along time at each pixel, but not across both (Wolfe et al. 2022, "Spatiotemporal Blue Noise Masks"): rank / n is its
// value. Integers only: the same on every machine. side >= 8. 64 x 64 x 16 takes 0.3 s.
std::vector<uint32_t> void_and_cluster(uint32_t side, uint32_t slices, uint32_t seed);

}  // namespace nf::image
