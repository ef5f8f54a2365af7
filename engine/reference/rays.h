// Rays through the world, by Embree. This and rays.cpp are the only files that know it.
#pragma once

#include <memory>
#include <vector>

#include "reference/world.h"

namespace nf::reference {

struct Ray {
  vec3 origin{0}, direction{0, 0, -1};  // distances are in units of the direction's length
  float near = 0, far = 0;
};

class Rays {
 public:
  // Cut-outs let rays through their holes, blended surfaces those that a hash of the ray chooses, as many as their
  // alpha says. Surfaces are solid from both sides but for camera rays, which pass through the backs of single-sided
  // ones as a rasteriser does.
  // Throws Cancelled when `cancel` becomes true while the structure is built.
  explicit Rays(const World& world, const std::atomic<bool>* cancel = nullptr);
  ~Rays();
  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  Hit closest(const Ray& ray) const;
  // A camera ray: it passes through blended surfaces; `blended` gets those before the hit, from near to far.
  Hit closest_seen(const Ray& ray, std::vector<Hit>* blended = nullptr) const;
  // The share of light that arrives: 0 behind something opaque, else the product of 1 - alpha.
  float open(const Ray& ray) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nf::reference
