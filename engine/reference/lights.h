// The scene's lights for next-event estimation: suns, points and spots one by one; of emissive surfaces a point at a
// time.
#pragma once

#include <vector>

#include "reference/rays.h"
#include "reference/sampler.h"
#include "reference/sky.h"

namespace nf::reference {

// Light that arrives along `to_light` (unit) at a facing surface; shadows are not in it.
struct Arriving {
  vec3 to_light{0}, irradiance{0};
  float distance = 0;
};

struct EmitterPoint {
  vec3 position{0}, ng{0};  // ng on the side that is lit from
  vec3 radiance{0};
  float density = 0;  // per area; 0 = nothing there
  float epsilon = 0;
};

class Lights {
 public:
  explicit Lights(const World& world);

  size_t count() const;                // of suns, points and spots
  bool soft() const { return soft_; }  // whether any has a size, so that its light is noisy
  Arriving arriving(size_t light, const Surface& at, vec2 u) const;

  bool any_emitters() const { return !triangles_.empty(); }
  // A point chosen by area and power; what it emits is towards `receiver`.
  EmitterPoint emitter_point(vec3 receiver, float choice, vec2 u) const;
  // The density, per area, with which that triangle's points are chosen.
  float density(uint32_t instance, uint32_t triangle) const;

  const Sky& sky() const { return sky_; }

 private:
  struct Emitter {
    uint32_t instance, triangle;
    float density;      // per area
    double up_to_here;  // of the total weight
  };
  const World& world_;
  Sky sky_;
  std::vector<Emitter> triangles_;
  std::vector<uint32_t> first_;  // by instance: row of its first triangle in `densities_`, or none
  std::vector<float> densities_;
  bool soft_ = false;
};

}  // namespace nf::reference
