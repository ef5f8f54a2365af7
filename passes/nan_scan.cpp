// One dispatch an image into a table of counts; additions and minima of integers, so that their order does not matter.
#include "nan_scan.h"

#include <algorithm>
#include <cstring>

namespace nf::passes {
namespace {

constexpr uint32_t row_words = 3;  // as shaders/nan_scan.comp has them: NaN, infinite, number of the first texel

bool holds_floats(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R16_SFLOAT:
    case VK_FORMAT_R16G16_SFLOAT:
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_R32G32_SFLOAT:
    case VK_FORMAT_R32G32B32A32_SFLOAT:
    case VK_FORMAT_B10G11R11_UFLOAT_PACK32:
      return true;
    default:
      return false;
  }
}

}  // namespace

NanScan add_nan_scan(graph::Graph& graph, gpu::Pipelines& pipelines, std::span<const graph::Tex> images) {
  NanScan scan;
  std::vector<graph::Tex> scanned;
  for (const graph::Tex tex : images) {
    if (!tex || !holds_floats(graph.desc(tex).format)) continue;
    if (std::find(scanned.begin(), scanned.end(), tex) != scanned.end()) continue;
    scanned.push_back(tex);
    scan.images.push_back({.image = graph.resources[tex.id].name, .size = graph.desc(tex).size});
  }
  if (scanned.empty()) return scan;
  const uint32_t rows = uint32_t(scanned.size());
  scan.found = graph.optional(graph.buffer("nan_scan.found", rows * row_words * sizeof(uint32_t)));
  graph.compute("nan_scan.begin", pipelines.compute("nan_scan.comp", {{"BEGIN", "1"}}), "Nothing found yet")
      .out("found", scan.found)
      .params(NanScanBlock{.row = 0, .rows = rows})
      .over(rows);
  const gpu::Pipeline pipeline = pipelines.compute("nan_scan.comp");
  for (uint32_t row = 0; row < rows; ++row) {
    const graph::TexPart part = graph::layer(graph::mip(scanned[row], 0), 0);
    graph.compute("nan_scan", pipeline, "Counts NaN and infinite texels")
        .in("source", part)
        .inout("found", scan.found)
        .params(NanScanBlock{.row = row, .rows = rows})
        .over(part);
  }
  return scan;
}

std::vector<NonFiniteTexels> read_nan_scan(const NanScan& scan, const graph::Readback& found) {
  std::vector<NonFiniteTexels> images = scan.images;
  NF_CHECK(found.texels.size() == images.size() * row_words * sizeof(uint32_t), "{} bytes of {} images",
           found.texels.size(), images.size());
  for (size_t i = 0; i < images.size(); ++i) {
    uint32_t row[row_words];
    std::memcpy(row, found.texels.data() + i * sizeof row, sizeof row);
    images[i].nan = row[0];
    images[i].inf = row[1];
    if (images[i].any()) images[i].first = {row[2] % images[i].size.width, row[2] / images[i].size.width};
  }
  return images;
}

}  // namespace nf::passes
