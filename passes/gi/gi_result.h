// What a GI technique gives. What it lacks is an invalid handle: marked absent, never faked.
#pragma once

#include "graph/graph.h"

namespace nf::passes {

struct GiResult {
  graph::Tex visibility;  // R16F, cosine-weighted, 1 = open
  graph::Tex bent;        // RGBA16F, mean unoccluded direction, view space
  graph::Tex gi;          // RGBA16F, irradiance / pi of bounced and emitted light
  graph::Tex ambient;     // RGBA16F, irradiance / pi of the environment

  bool any() const { return visibility || bent || gi || ambient; }
};

}  // namespace nf::passes
