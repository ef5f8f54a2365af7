// Sums of the samples by layer: two half-buffers a pixel, in double precision, so that the order of rounds leaves no
// trace.
#pragma once

#include <string>
#include <vector>

#include "reference/paths.h"

namespace nf::reference {

// One layer of the film. `bounces` counts for gi and indirect.
struct Slot {
  const LayerInfo* info;
  std::string name;
  uint32_t bounces = 0, channels = 0, offset = 0;
};

struct Film {
  std::vector<Slot> slots;
  uint32_t channels = 0;  // of all slots together
  glm::uvec2 size{0};
  uint32_t samples = 0;      // of each half
  std::vector<double> sums;  // [pixel][half][channel]
  double* at(size_t pixel, int half) { return sums.data() + (pixel * 2 + size_t(half)) * channels; }
  const double* at(size_t pixel, int half) const { return sums.data() + (pixel * 2 + size_t(half)) * channels; }
};

// Throws nf::Error (Exit::Input) for an unknown name.
Film make_film(const std::vector<std::string>& layers, glm::uvec2 size, uint32_t bounces);
Wanted wanted_by(const Film& film);
void add_sample(const Film& film, const PixelSample& sample, double* sums);
// The mean of one half (0, 1) or of both (-1) as layers.
std::vector<image::Layer> resolve(const Film& film, int half);
std::vector<Noise> noise_of(const Film& film);

}  // namespace nf::reference
