// The noise table: making and uploading.
#include "noise.h"

#include <array>

#include "gpu/upload.h"
#include "image/blue_noise.h"

namespace nf::passes {
namespace {

// Where in the tile each of the three numbers is read.
constexpr std::array<std::array<uint32_t, 2>, 3> places = {{{0, 0}, {23, 37}, {45, 13}}};

}  // namespace

std::vector<uint32_t> make_noise_table() {
  const std::vector<uint32_t> ranks = image::void_and_cluster(noise_side, 1);
  const uint32_t unit = uint32_t(ranks.size()) / 1024;
  std::vector<uint32_t> table;
  for (uint32_t y = 0; y < noise_side; ++y)
    for (uint32_t x = 0; x < noise_side; ++x) {
      uint32_t texel = 0;
      for (uint32_t c = 0; c < 3; ++c)
        texel |= ranks[(y + places[c][1]) % noise_side * noise_side + (x + places[c][0]) % noise_side] / unit << 10 * c;
      table.push_back(texel);
    }
  return table;
}

Noise::~Noise() {
  gpu::destroy(device_, image_);
}

void Noise::feed(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface) {
  if (!interface.find("noise_table")) return;
  if (!image_.handle) {
    const std::vector<uint32_t> table = make_noise_table();
    const gpu::ImagePart part{0, 0, std::as_bytes(std::span(table))};
    image_ = gpu::upload_image(device_, {.extent = {noise_side, noise_side}, .format = VK_FORMAT_R32_UINT}, {&part, 1},
                               "noise.table", gpu::WholeView::Flat);
  }
  pass.in("noise_table", graph.import("noise.table", image_));
}

}  // namespace nf::passes
