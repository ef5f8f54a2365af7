// Private parameters of the horizon techniques, gtao and hbao. The shader knows the choices by number
// (shaders/gi/horizon.glsl).
#pragma once

#include "core/params.h"

#define NF_HORIZON_PARAMS(P)                                                                                   \
  P(Choice, falloff, 0, 0, 1, "shared|quadratic", "An occluder's weight: by gi.radius_mode, or 1 - (d / r)^2") \
  P(Float, thin_occluder, 0.0f, 0.0f, 1.0f, "",                                                                \
    "How far a sample below the horizon lowers it: what is seen behind a thin thing is open again")            \
  P(Float, bias, 0.0f, 0.0f, 60.0f, "deg", "Occluders lower than this over the tangent plane are left out")    \
  P(Bool, bent, 1, 0, 1, "", "Give the bent normal, too")

#define NF_MULTI_BOUNCE_PARAMS(P)    \
  P(Bool, multi_bounce, 0, 0, 1, "", \
    "Brighten by what bounces between surfaces as bright as this one: a fitted curve of visibility and albedo")

#define NF_GTAO_PARAMS(P) NF_HORIZON_PARAMS(P) NF_MULTI_BOUNCE_PARAMS(P)

namespace nf::passes {
NF_DECLARE_PARAMS(GtaoParams, "gtao", NF_GTAO_PARAMS)
NF_DECLARE_PARAMS(HbaoParams, "hbao", NF_HORIZON_PARAMS)
}  // namespace nf::passes
