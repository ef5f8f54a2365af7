// More bounces: what the last frame's surfaces reflected joins what the technique gathers in this one. Two ways to find
// it again, then push-pull for the holes, and two limits that keep the loop from growing.
#pragma once

#include "lighting.h"
#include "temporal.h"

namespace nf::passes {

// clang-format off
#define NF_FEEDBACK_PARAMS(P)                                                                                       \
  P(Choice, reprojection, 0, 0, 2, "off|gather|scatter",                                                            \
    "More bounces, one a frame: off, or the last frame's light, fetched along the motion or sent to where it is seen now") \
  P(Bool, emissive, 1, 0, 1, "", "Whether surfaces' own emission is gathered")                                      \
  P(Bool, include_ambient, 0, 0, 1, "", "Whether light of the environment bounces too")                             \
  P(Float, albedo_limit, 0.9f, 0.0f, 1.0f, "", "Most that a surface reflects in a bounce")                          \
  P(Float, gain_limit, 0.95f, 0.0f, 0.999f, "", "Most that a bounce has of the light before it, over the whole picture")
// clang-format on
NF_DECLARE_PARAMS(FeedbackParams, "feedback", NF_FEEDBACK_PARAMS)

#define NF_FEEDBACK_FIELDS(F) F(Uint, previous_reflected_valid)
NF_DECLARE_BLOCK(FeedbackBlock, "feedback_state", NF_FEEDBACK_FIELDS)
#define NF_FEEDBACK_MERGE_FIELDS(F) F(Uint, previous_energy_valid)
NF_DECLARE_BLOCK(FeedbackMergeBlock, "feedback_merging", NF_FEEDBACK_MERGE_FIELDS)

// fed: RGBA16F, the last frame's reflected light at this frame's pixels. radiance: R32UI RGB9E5, what the technique
// gathers. reflected, energy: histories of this frame's, written by add_feedback_keep.
struct Feedback {
  graph::Tex fed, radiance;
  graph::History reflected, energy;
};
Feedback add_feedback(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer,
                      const PreviousSurface& previous, const ReprojectBlock& reproject, const Radiance& direct,
                      const FeedbackParams& params, const TemporalParams& same_surface);

// After the technique and its reconstruction. Returns the frame's energies, 1x1 RGBA32F: x, luminance of all that is
// fed back; y, of all that was gathered from. x / y is the loop's gain.
graph::Tex add_feedback_keep(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer,
                             const Feedback& feedback, const GiResult& gi, const EnvironmentMaps& environment,
                             const FeedbackParams& params);

}  // namespace nf::passes
