// Temporal accumulation of a technique's result, before composition and TAA.
#pragma once

#include "gi/gi_result.h"
#include "reproject.h"

namespace nf::passes {

// clang-format off
#define NF_TEMPORAL_PARAMS(P)                                                                                         \
  P(Bool, enabled, 1, 0, 1, "", "Average the GI over frames, following what moves")                                   \
  P(Int, frames, 32, 1, 1024, "", "Frames that the mean reaches back")                                                \
  P(Float, depth, 0.02f, 0.0f, 1.0f, "",                                                                              \
    "Same surface as in the last frame: distance from its plane, as a share of the depth")                            \
  P(Float, normal, 0.8f, -1.0f, 1.0f, "", "Same surface: least cosine between the normals")                           \
  P(Float, antilag, 4.0f, 0.0f, 100.0f, "",                                                                           \
    "Start anew where the mean of the last 4 frames is this many standard deviations off; 0 = never")                 \
  P(Float, motion, 4.0f, 0.0f, 100.0f, "",                                                                            \
    "Shorter means around what moves, appears or goes: 1 / this times the share of what is seen there that has; 0 = no") \
  P(Float, firefly_clamp, 0.0f, 0.0f, 1000.0f, "",                                                                   \
    "A sample may be this many times brighter than its past and its neighbours; takes light away; 0 = no limit")
// clang-format on
NF_DECLARE_PARAMS(TemporalParams, "temporal", NF_TEMPORAL_PARAMS)

#define NF_TEMPORAL_FIELDS(F)     \
  F(Uint, previous_moments_valid) \
  F(Uint, previous_light_valid) F(Uint, previous_ambient_valid) F(Uint, previous_bent_valid)
NF_DECLARE_BLOCK(TemporalBlock, "temporal_state", NF_TEMPORAL_FIELDS)

// moments: RGBA16F (visibility, variance of one frame's brightness, short mean - long mean, frames of the mean);
// brightness is gi's luminance, or visibility where there is no gi. gi.gi's alpha is the luminance that the clamp
// removed from this frame's sample. A visibility is moments' first channel.
struct Temporal {
  GiResult gi;
  graph::Tex moments;
};
Temporal add_temporal(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer,
                      const PreviousSurface& previous, const ReprojectBlock& reproject, const GiResult& gi,
                      const TemporalParams& params);

// HAS_GI and so on, for what the result has; GI_AT and so on, the locations of their outputs, from 1.
gpu::Defines result_defines(const GiResult& gi);
// Feeds the slots gi, visibility, ambient, bent with what there is.
void feed_result(graph::PassBuilder& builder, const GiResult& gi);

}  // namespace nf::passes
