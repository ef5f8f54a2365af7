// The table behind the blue kinds of noise (shaders/common/noise.glsl), made when a shader first asks for it.
#pragma once

#include <cstdint>
#include <vector>

#include "graph/graph.h"

namespace nf::passes {

constexpr uint32_t noise_side = 64;

// noise_side x noise_side texels of blue noise, three numbers of 10 bits each: the same array read at three places far
// apart. Always the same.
std::vector<uint32_t> make_noise_table();

class Noise {
 public:
  explicit Noise(gpu::Device& device) : device_(device) {}
  ~Noise();
  Noise(const Noise&) = delete;
  Noise& operator=(const Noise&) = delete;

  // Feeds the slot `noise_table` (R32UI) where the pass's shader has it.
  void feed(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface);

 private:
  gpu::Device& device_;
  gpu::Image image_;
};

}  // namespace nf::passes
