// The light of one sample of one pixel, split as the README splits it.
#pragma once

#include <array>
#include <vector>

#include "reference/lights.h"
#include "reference/rays.h"

namespace nf::reference {

struct PixelSample {
  bool hit = false;
  Surface surface;
  float depth = 0;  // metres along the view axis
  vec3 direct_diffuse{0}, direct_specular{0};
  vec3 background{0};
  vec3 ambient{0};                     // outgoing
  std::array<vec3, max_bounces> gi{};  // of paths with exactly k + 1 bounces
  vec3 specular{0};                    // over at least one specular bounce, and in no other field
  float visibility = 1;
  vec3 bent{0};                      // the open direction, or 0: their mean is the bent normal
  float weight = 1;                  // of this surface, or the background, in the final radiance
  std::vector<PixelSample> blended;  // surfaces before it, each with its weight; in no other layer
};

// What is asked for; the rest need not be computed.
struct Wanted {
  bool direct = false, gi = false, ambient = false, visibility = false, specular = false;
};

struct Integrator {
  const World& world;
  const Rays& rays;
  const Lights& lights;
  const Settings& settings;
  Wanted wanted;
};

// The camera ray through a point of the picture (pixels, y down); lengths are metres along the view axis.
Ray camera_ray(const Settings& settings, vec2 pixel);

// The first surface, and its direct light where that has no noise.
PixelSample first_hit(const Integrator& it, const Ray& ray, uint64_t& ray_count);
// Everything with noise; `sample` comes from first_hit.
void gather(const Integrator& it, const Ray& ray, Stream& stream, PixelSample& sample, uint64_t& ray_count);

}  // namespace nf::reference
