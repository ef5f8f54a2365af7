// Temporal antialiasing of the composed light, before the tone curve.
#pragma once

#include "reproject.h"

namespace nf::passes {

// clang-format off
#define NF_TAA_PARAMS(P)                                                                                            \
  P(Bool, enabled, 1, 0, 1, "", "Temporal antialiasing: jitters the camera within a pixel and averages the frames") \
  P(Int, frames, 12, 1, 256, "", "Frames that the mean reaches back")                                               \
  P(Float, clip, 1.25f, 0.0f, 10.0f, "",                                                                            \
    "Standard deviations of the 3x3 pixels around that the past may be off; 0 = any, it ghosts")                    \
  P(Float, sharpness, 0.5f, 0.0f, 4.0f, "", "Sharpening afterwards; 0 = none")
// clang-format on
NF_DECLARE_PARAMS(TaaParams, "taa", NF_TAA_PARAMS)

#define NF_TAA_FIELDS(F) F(Uint, previous_valid)
NF_DECLARE_BLOCK(TaaBlock, "taa_state", NF_TAA_FIELDS)

// RGBA16F linear radiance. The frame must have been rendered with reproject.jitter.
graph::Tex add_taa(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer,
                   const ReprojectBlock& reproject, graph::Tex lit, const TaaParams& params);

}  // namespace nf::passes
