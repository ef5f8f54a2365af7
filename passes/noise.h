// The table behind the blue kinds of noise (shaders/common/noise.glsl), made when a shader first asks for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "graph/graph.h"

namespace nf::passes {

constexpr uint32_t noise_side = 64, noise_frames = 16;

// Texels of noise_side x (noise_side * (1 + noise_frames)): blue noise, then the frames of spatio-temporal blue noise.
// A texel holds three numbers of 10 bits, the same array read at three places far apart. Always the same; takes 0.3 s.
std::vector<uint32_t> make_noise_table();
// The same from a file in `cache`, which is written if need be. An empty `cache` keeps nothing.
std::vector<uint32_t> load_noise_table(const std::filesystem::path& cache);

class Noise {
 public:
  Noise(gpu::Device& device, std::filesystem::path cache) : device_(device), cache_(std::move(cache)) {}
  ~Noise();
  Noise(const Noise&) = delete;
  Noise& operator=(const Noise&) = delete;

  // Feeds the slot `noise_table` (R32UI) where the pass's shader has it.
  void feed(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface);

 private:
  gpu::Device& device_;
  std::filesystem::path cache_;
  gpu::Image image_;
};

}  // namespace nf::passes
