// Private parameters of hbil. The shader knows the choices by number (shaders/gi/hbil.glsl). Of gi's parameters radius,
// slices, slice_measure, steps and their distribution, and noise are used; what is seen is always solid down to the
// tangent plane.
#pragma once

#include "core/params.h"

#define NF_HBIL_PARAMS(P)                                                                                            \
  P(Choice, space, 0, 0, 1, "shared|local",                                                                          \
    "Slices and angles as the other slice techniques have them; or the paper's local camera space, marched along "   \
    "its axes' directions on the screen")                                                                            \
  P(Bool, normal_start, 1, 0, 1, "",                                                                                 \
    "Horizons start at the tangent plane; off (local space only): at 90 degrees "                                    \
    "from the view vector")                                                                                          \
  P(Bool, printed_sign, 0, 0, 1, "", "Local space: equations 5 and 11 with the sign as printed")                     \
  P(Choice, reject, 0, 0, 3, "one_sided|running|none|code",                                                          \
    "Light of surfaces turned away: none; the last facing sample's, blended by reject_from and reject_to; as if it " \
    "faced; as the author's code does it, more tolerant straight above, and none beyond what is turned away")        \
  P(Float, reject_from, -0.4f, -1.0f, 1.0f, "", "Cosine from which on a sample's light counts, for `running`")       \
  P(Float, reject_to, 0.0f, -1.0f, 1.0f, "", "Cosine from which on it counts fully, for `running`")                  \
  P(Bool, mips, 0, 0, 1, "",                                                                                         \
    "A sample's light is the mean over surfaces in view about as wide as its step: less noise, and halos")           \
  P(Choice, cone, 0, 0, 2, "cosine|printed|uniform",                                                                 \
    "The bent cone's aperture: asin sqrt(AO) of cosine-weighted AO; as printed acos(1 - AO) of it; that of uniform " \
    "AO")                                                                                                            \
  P(Choice, far, 0, 0, 2, "sh_cone|factor|plain",                                                                    \
    "The environment: spherical harmonics within the cone; irradiance at the bent normal times the energy factor; "  \
    "times AO")

namespace nf::passes {
NF_DECLARE_PARAMS(HbilParams, "hbil", NF_HBIL_PARAMS)
}
