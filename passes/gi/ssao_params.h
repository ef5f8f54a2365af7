// Private parameters of ssao. The shader knows the choices by number (shaders/gi/ssao.glsl). gi.radius is the
// hemisphere's; gi.noise turns it; of gi's others none is used.
#pragma once

#include "core/params.h"

#define NF_SSAO_PARAMS(P)                                                                                          \
  P(Int, samples, 16, 1, 64, "", "Points in the hemisphere; above 64 little is gained")                            \
  P(Choice, kernel, 0, 0, 1, "cosine|chapman",                                                                     \
    "Points: by the receiver's cosine, along all of the radius; or Chapman's, from a cube, denser near the pixel") \
  P(Choice, range, 4, 0, 4, "none|constant|linear|quadratic|smoothstep",                                           \
    "Which occluders count, by their difference in depth: all; up to range_limit; that, less with depth or its "   \
    "square; or fading beyond the radius")                                                                         \
  P(Float, range_limit, 1.0f, 0.001f, 100.0f, "m",                                                                 \
    "Greatest difference in depth, for linear and quadratic at range_depth")                                       \
  P(Float, range_depth, 5.0f, 0.01f, 1000.0f, "m", "Depth at which linear and quadratic have range_limit")         \
  P(Choice, self, 0, 0, 1, "plane|bias",                                                                           \
    "Against self-occlusion: what does not rise over the tangent plane, or is "                                    \
    "not `bias` in front of the point, does not occlude")                                                          \
  P(Float, bias, 0.025f, 0.0f, 1.0f, "m", "For self = bias")                                                       \
  P(Bool, bleed, 1, 0, 1, "", "Occluders send their light: colour bleeding")                                       \
  P(Bool, specular, 0, 0, 1, "",                                                                                   \
    "What they send is all direct light as the eye sees it, specular too; else diffuse light alone")               \
  P(Choice, sender, 0, 0, 1, "disc|point",                                                                         \
    "An occluder's size: a disc, its share of the hemisphere's base; or, as printed, sender_area / distance^2")    \
  P(Float, sender_area, 0.05f, 0.0f, 100.0f, "m^2", "For sender = point")                                          \
  P(Float, bleed_strength, 1.0f, 0.0f, 10.0f, "", "Factor of the bleeding; 1 is what the forms give")              \
  P(Float, damping, 0.0f, 0.0f, 10.0f, "W/m^2/sr", "Receivers darker than this show less bleeding; 0: none does")  \
  P(Float, ambient_share, 0.0f, 0.0f, 1.0f, "", "How much of the environment's light takes part in the bleeding")  \
  P(Bool, blur, 0, 0, 1, "", "Average 4 x 4 pixels")                                                               \
  P(Choice, show, 0, 0, 1, "light|tangents",                                                                       \
    "What the layer gi has: light; or, to look at, each pixel's tangent about which the points are turned, from "  \
    "-1..1 to 0..1")

namespace nf::passes {
NF_DECLARE_PARAMS(SsaoParams, "ssao", NF_SSAO_PARAMS)
}
