// Parameters that the techniques share, under `gi.`: a swap of the technique keeps their meaning.
#pragma once

#include "core/params.h"

#define NF_GI_PARAMS(P)                                                                                          \
  P(Float, radius, 4.0f, 0.01f, 100.0f, "m",                                                                     \
    "Radius of the disc around the pixel, facing the screen, that is searched")                                  \
  P(Int, slices, 1, 1, 64, "", "Slices per pixel and frame, at equal angles")                                    \
  P(Int, steps, 16, 1, 512, "", "Samples on each side of a slice")                                               \
  P(Float, step_exponent, 2.0f, 1.0f, 4.0f, "",                                                                  \
    "Distribution of the samples: 1 uniform, above 1 denser near the pixel")                                     \
  P(Bool, step_jitter, 1, 0, 1, "", "Jitter the samples along the slice, else take the middle of each interval") \
  P(Float, thickness, 0.2f, 0.0f, 100.0f, "m", "Assumed depth of what is seen, along the view ray through it")   \
  P(Bool, infinite_thickness, 0, 0, 1, "", "Whatever is seen reaches down to the tangent plane, as in GTAO")

namespace nf::passes {
NF_DECLARE_PARAMS(GiParams, "gi", NF_GI_PARAMS)
}
