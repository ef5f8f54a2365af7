// The same-information marcher on the GPU: the model of reference/same_information.h, by a shader of its own in single
// precision. It shares nothing with the techniques, and of the CPU's marcher only the columns.
#pragma once

#include <memory>

#include "core/params.h"
#include "gpu/device.h"
#include "reference/same_information.h"

namespace nf::passes {

// clang-format off
#define NF_MARCHER_FIELDS(F)                                                                                      \
  F(Mat4, view_from_world) F(Vec2, scale) F(Vec2, offset) F(IVec2, size) F(Float, near) F(Float, radius)          \
  F(Float, falloff) F(Float, thickness) F(Uint, radius_mode) F(Uint, thickness_mode) F(Uint, one_sided)           \
  F(Uint, uniform_directions) F(Uint, independent) F(Uint, key) F(Uint, first) F(Uint, count) F(IVec2, sky_size)  \
  F(Float, sky_rotation)
// clang-format on
NF_DECLARE_BLOCK(MarcherBlock, "marcher", NF_MARCHER_FIELDS)

// As reference::Marcher, with other random numbers.
class GpuMarcher {
 public:
  GpuMarcher(gpu::Device& device, reference::Buffers buffers, const reference::MarchSettings& settings);
  ~GpuMarcher();
  GpuMarcher(const GpuMarcher&) = delete;
  GpuMarcher& operator=(const GpuMarcher&) = delete;

  void sample(uint32_t count);
  uint32_t samples() const;
  std::vector<image::Layer> layers() const;
  std::vector<image::Layer> half(int which) const;
  std::vector<reference::Noise> noise() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nf::passes
