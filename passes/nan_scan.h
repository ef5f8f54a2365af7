// Where a frame stops being a picture: counts of NaN and infinite texels, and the first of them, image by image.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "graph/executor.h"

namespace nf::passes {

#define NF_DEBUG_PARAMS(P)       \
  P(Bool, nan_scan, 0, 0, 1, "", \
    "Counts the NaN and infinite texels of what the stages of the frame give, and tells where the first is")
NF_DECLARE_PARAMS(DebugParams, "debug", NF_DEBUG_PARAMS)

#define NF_NAN_SCAN_FIELDS(F) F(Uint, row) F(Uint, rows)
NF_DECLARE_BLOCK(NanScanBlock, "nan_scan", NF_NAN_SCAN_FIELDS)

// Texels, not channels; one that has both counts as NaN. `first` is the first in reading order.
struct NonFiniteTexels {
  const char* image = "";  // the resource's name
  graph::Size size;
  uint32_t nan = 0, inf = 0;
  glm::uvec2 first{0};
  bool any() const { return nan + inf > 0; }
};

struct NanScan {
  graph::Buf found;                     // invalid: nothing was scanned
  std::vector<NonFiniteTexels> images;  // what is scanned; the counts are in the read-back
};
// Scans the first mip and layer of those of the images that hold floats; an image that comes twice is scanned once. To
// be read back; else its passes are culled.
NanScan add_nan_scan(graph::Graph& graph, gpu::Pipelines& pipelines, std::span<const graph::Tex> images);
// `scan.images` with the counts of a finished frame.
std::vector<NonFiniteTexels> read_nan_scan(const NanScan& scan, const graph::Readback& found);

}  // namespace nf::passes
