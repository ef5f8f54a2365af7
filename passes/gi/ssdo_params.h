// Private parameters of ssdo. The shader knows the choices by number (shaders/gi/ssdo.glsl). gi.radius is the
// hemisphere's, or auto_radius finds it; gi.noise is used, and with blocker = within_thickness gi.thickness_mode; of
// gi's others none.
#pragma once

#include "core/params.h"

#define NF_SSDO_PARAMS(P)                                                                                            \
  P(Int, samples, 16, 1, 64, "", "Directions, each with one point at a random distance")                             \
  P(Bool, auto_radius, 0, 0, 1, "",                                                                                  \
    "The radius is not gi.radius but the mean distance between neighbouring peaks of the scene, where it has any")   \
  P(Choice, directions, 0, 0, 1, "cosine|uniform", "Directions by the receiver's cosine, or uniform and weighted")   \
  P(Choice, blocker, 0, 0, 1, "all_behind|within_thickness",                                                         \
    "A point is blocked by any surface in front of it; or within that surface's thickness only, which one point "    \
    "a direction seldom finds")                                                                                      \
  P(Float, fade, 0.0f, 0.0f, 1.0f, "",                                                                               \
    "Share of the radius, next to the hemisphere's border, over which blockers fade")                                \
  P(Bool, bounce, 1, 0, 1, "", "Blockers send their light")                                                          \
  P(Choice, sender, 0, 0, 2, "disc|solid_angle|clamped",                                                             \
    "A blocker's size: a disc, its share of the hemisphere's base; its direction's share of the hemisphere; or, as " \
    "printed, the disc's area over a distance of at least 1 m, squared")                                             \
  P(Float, strength, 1.0f, 0.0f, 10.0f, "", "Factor of the discs' area")                                             \
  P(Bool, ambient, 1, 0, 1, "", "Gather the environment by direction")                                               \
  P(Choice, ambient_source, 1, 0, 1, "sh|cube",                                                                      \
    "Environment maps by direction: the radiance's spherical harmonics, or the prefiltered cube")                    \
  P(Bool, blur, 0, 0, 1, "", "Average 4 x 4 pixels, of the same surface only")

namespace nf::passes {
NF_DECLARE_PARAMS(SsdoParams, "ssdo", NF_SSDO_PARAMS)
}
