// What a perfect estimator would make of the data that the screen-space techniques have: random rays in three
// dimensions, marched through the depth buffer texel by texel. The difference from the path tracer is the information
// that the screen lacks; the difference of a technique from this is the technique's own error. Shares no code with the
// techniques.
//
// The model: a texel is a column along its view ray. Its front is a plane over the texel, with the slope of the depths
// beside it (the smaller of both differences in each direction, in 1/z, so that planes stay planes); it is solid from
// there to `thickness` metres further along the view ray. A ray that enters a column is stopped, and sees the texel's
// radiance if the texel's normal is turned towards it. What leaves the picture, or meets no column, is open.
#pragma once

#include <memory>
#include <vector>

#include "reference/reference.h"

namespace nf::reference {

// Rows of texels, row 0 at the top. Depth in metres along the view axis, 0 = background; normals in world space;
// albedo, the diffuse reflectance of Lambert materials, may be empty.
struct Buffers {
  glm::uvec2 size{0};
  std::vector<float> depth;
  std::vector<glm::vec3> normal, radiance, albedo;
};

// Throws nf::Error (Exit::Input) when a layer is missing: depth, normal, radiance of `render --aov`. albedo is taken
// where there is one.
Buffers buffers_from(const std::vector<image::Layer>& layers);

// How far behind its front a column is solid, along the view ray.
enum class ThicknessMode : uint8_t { Constant, Linear, Infinite };

struct MarchSettings {
  scene::Camera camera;
  float radius = 4;
  RadiusMode radius_mode = RadiusMode::Disc;
  float falloff = 0.615f;
  ThicknessMode thickness_mode = ThicknessMode::Constant;
  float thickness = 0.2f;  // metres, Linear: metres a metre of depth
  bool one_sided = true;   // only texels whose normal is turned towards the ray give light
  bool uniform = false;    // directions uniform over the hemisphere, else by the cosine
  // With it and with albedo there is a layer `ambient`: its light from the open directions, as a Lambert surface
  // reflects it. Must live as long as the marcher.
  const scene::Environment* environment = nullptr;
  SamplerKind sampler = SamplerKind::Sobol;
  uint32_t seed = 1, threads = 0;
};

// The layers of a marcher: gi (irradiance / pi), visibility, bent, and with an environment and albedo ambient.
std::vector<std::string> march_layers(const Buffers& buffers, const MarchSettings& settings);

class Marcher {
 public:
  Marcher(Buffers buffers, const MarchSettings& settings);
  ~Marcher();
  Marcher(const Marcher&) = delete;
  Marcher& operator=(const Marcher&) = delete;

  // As Tracer: rounded up to an even number, two independent halves, the same bytes however it is divided.
  void sample(uint32_t count);
  uint32_t samples() const;
  std::vector<image::Layer> layers() const;
  std::vector<image::Layer> half(int which) const;
  std::vector<Noise> noise() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nf::reference
