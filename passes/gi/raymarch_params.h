// Private parameters of raymarch. The shader knows the choices by number (shaders/gi/raymarch.glsl). gi.radius is the
// rays' length; gi.steps, the steps' distribution, gi.thickness_mode and gi.noise are used.
#pragma once

#include "core/params.h"

#define NF_RAYMARCH_PARAMS(P)                                                                                       \
  P(Int, rays, 2, 1, 256, "", "Rays per pixel and frame, each of gi.steps steps")                                   \
  P(Choice, hit, 0, 0, 1, "crossing|inside",                                                                        \
    "A ray ends when a step has passed a surface's front, however deep; or only when it ends within its thickness") \
  P(Bool, ambient, 1, 0, 1, "", "Gather the environment by direction")                                              \
  P(Choice, ambient_source, 1, 0, 1, "sh|cube",                                                                     \
    "Environment maps by direction: the radiance's spherical harmonics, or the prefiltered cube")

namespace nf::passes {
NF_DECLARE_PARAMS(RaymarchParams, "raymarch", NF_RAYMARCH_PARAMS)
}
