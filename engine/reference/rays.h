// Rays through the world, by Embree. This and rays.cpp are the only files that know it.
#pragma once

#include <memory>

#include "reference/world.h"

namespace nf::reference {

struct Ray {
  vec3 origin{0}, direction{0, 0, -1};  // distances are in units of the direction's length
  float near = 0, far = 0;
};

class Rays {
 public:
  // Cut-outs let rays through their holes. Surfaces are solid from both sides but for camera rays, which pass through
  // the backs of single-sided ones as a rasteriser does.
  explicit Rays(const World& world);
  ~Rays();
  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  Hit closest(const Ray& ray) const;
  Hit closest_seen(const Ray& ray) const;  // a camera ray
  bool blocked(const Ray& ray) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nf::reference
