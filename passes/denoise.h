// Spatial filter of a technique's result: noise goes, edges of surfaces stay, the mean within a surface is kept.
#pragma once

#include "temporal.h"

namespace nf::passes {

// clang-format off
#define NF_DENOISE_PARAMS(P)                                                                                        \
  P(Choice, method, 2, 0, 2, "off|small|atrous", "Spatial filter of the GI: none, 5x5 pixels, or several passes, wider each time") \
  P(Int, passes, 3, 1, 5, "", "Passes of the a-trous filter; n reach 2^n - 1 pixels")                               \
  P(Float, depth, 0.01f, 0.0001f, 1.0f, "", "Distance from the pixel's plane, as a share of the depth, that weighs 1/e") \
  P(Float, normal, 32.0f, 0.0f, 1000.0f, "", "How fast weights fall with the angle to the pixel's normal")          \
  P(Float, luminance, 4.0f, 0.0f, 100.0f, "",                                                                       \
    "Standard deviations of the light's noise that weigh 1/e, where temporal accumulation knows them; 0 = ignore light")
// clang-format on
NF_DECLARE_PARAMS(DenoiseParams, "denoise", NF_DENOISE_PARAMS)

#define NF_DENOISE_FIELDS(F) F(Int, spacing)
NF_DECLARE_BLOCK(DenoiseBlock, "denoise_step", NF_DENOISE_FIELDS)

// `moments` is add_temporal's, or invalid. Without them NaN, infinities and fireflies are dealt with here, as
// `temporal` says.
GiResult add_denoise(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer, const GiResult& gi,
                     graph::Tex moments, const DenoiseParams& params, const TemporalParams& temporal);

}  // namespace nf::passes
