// Private parameters of the visibility-bitmask techniques, vbao and vbgi. The shader knows the choices by number
// (shaders/gi/bitmask.glsl).
#pragma once

#include "core/params.h"

#define NF_BITMASK_PARAMS(P)                                                                                       \
  P(Choice, sectors, 3, 0, 5, "4|8|16|32|64|128", "Sectors of a slice; few show bands")                            \
  P(Choice, sector_rule, 0, 0, 4, "jitter|centre|ceil|round|floor",                                                \
    "A sample's sectors: end points moved by one random offset, or to the nearest; or the width rounded")          \
  P(Choice, sector_measure, 0, 0, 4, "cosine|uniform_angle|solid_angle|sine|four_masks",                           \
    "What sectors are equal parts of: projected solid angle, angle, solid angle, sine; or angles in four weights") \
  P(Choice, span, 0, 0, 1, "interval|point",                                                                       \
    "What a sample stands for: its surface over the whole of its step, or the texel alone")                        \
  P(Bool, fast_acos, 1, 0, 1, "", "Angles from a polynomial within 0.009 rad, for uniform_angle and four_masks")   \
  P(Bool, ambient, 1, 0, 1, "", "Gather the environment by direction, and the bent normal")                        \
  P(Choice, ambient_source, 1, 0, 1, "sh|cube",                                                                    \
    "Environment maps by direction: the radiance's spherical harmonics, or the prefiltered cube")                  \
  P(Int, regions, 4, 1, 16, "", "Regions of a slice, of each one direction, for `ambient`")

#define NF_EMITTER_PARAMS(P)                                                                                      \
  P(Choice, emitter, 3, 0, 3, "one_sided|none|cosine|half_space",                                                 \
    "Emitters shine if the texel is seen from its front; to all sides; by their cosine, as printed; or into the " \
    "directions in front of their plane")

#define NF_VBGI_PARAMS(P) NF_EMITTER_PARAMS(P) NF_BITMASK_PARAMS(P)

namespace nf::passes {
NF_DECLARE_PARAMS(VbaoParams, "vbao", NF_BITMASK_PARAMS)
NF_DECLARE_PARAMS(VbgiParams, "vbgi", NF_VBGI_PARAMS)
}  // namespace nf::passes
