// Parameters that the techniques share, under `gi.`: a swap of the technique keeps their meaning. The shaders know the
// choices by number (shaders/gi/march.glsl).
#pragma once

#include "core/params.h"

#define NF_GI_PARAMS(P)                                                                                               \
  P(Float, radius, 4.0f, 0.01f, 100.0f, "m", "How far an occluder or emitter may be")                                 \
  P(Choice, radius_mode, 0, 0, 2, "disc|ball|ball_falloff",                                                           \
    "Distance on the screen only (disc), or in space (ball), with the weight falling towards the radius")             \
  P(Float, falloff, 0.615f, 0.0f, 1.0f, "", "ball_falloff: the share of the radius over which the weight falls to 0") \
  P(Int, slices, 1, 1, 64, "", "Slices per pixel and frame, at equal angles")                                         \
  P(Choice, slice_measure, 1, 0, 2, "screen|screen_j|view",                                                           \
    "Slice directions: uniform on the screen, the same with the azimuth weight J, or uniform about the view vector")  \
  P(Choice, projection, 0, 0, 1, "oblique|view_cosine",                                                               \
    "A sample's angle in the slice: by its height above the tangent plane, or by its angle from the view vector")     \
  P(Int, steps, 16, 1, 512, "", "Samples on each side of a slice")                                                    \
  P(Float, step_exponent, 2.0f, 1.0f, 4.0f, "",                                                                       \
    "Distribution of the samples: 1 uniform, above 1 denser near the pixel")                                          \
  P(Bool, step_jitter, 1, 0, 1, "", "Jitter the samples along the slice, else take the middle of each interval")      \
  P(Choice, noise, 0, 0, 5, "hilbert_r2|ign|4x4|blue|stbn|white",                                                     \
    "Sampling noise (shaders/common/noise.glsl): a Kronecker sequence along a Hilbert curve, interleaved gradient, "  \
    "ordered, blue, blue with Sobol's sequence in time, none of these")                                               \
  P(Choice, thickness_mode, 0, 0, 3, "constant|linear|angular|infinite",                                              \
    "What is behind a sample: thickness metres; so many for each metre of its depth; thickness_angle; all there is")  \
  P(Float, thickness, 0.2f, 0.0f, 100.0f, "m", "Assumed depth of what is seen")                                       \
  P(Float, thickness_angle, 5.0f, 0.0f, 90.0f, "deg", "Assumed width in angle, for thickness_mode angular")           \
  P(Choice, back_along, 0, 0, 1, "sample_ray|receiver_v",                                                             \
    "The thickness is measured along the sample's own view ray, or along the receiver's")

namespace nf::passes {
NF_DECLARE_PARAMS(GiParams, "gi", NF_GI_PARAMS)
}
