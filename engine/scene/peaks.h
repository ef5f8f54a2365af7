// How far apart the peaks of a scene's surfaces are.
#pragma once

#include <span>

#include "scene/scene.h"

namespace nf::scene {

// Triangles, three rows of `index` each. A peak is a place that lies higher than all the surface next to it, in one of
// the six directions of the axes; what is level counts once, at its box's middle. The mean, over all peaks, of the
// distance to the nearest other one of the same direction, metres; 0 where no direction has two. Vertices at one place
// are one. The same in any unit: nothing here is metres.
float peak_distance(std::span<const vec3> position, std::span<const uint32_t> index);
// Of all instances as they stand.
float peak_distance(const Scene& scene);

}  // namespace nf::scene
