// Where a point of this frame was in the last frame's picture: what temporal accumulation, feedback and TAA share.
#pragma once

#include "gbuffer.h"
#include "view.h"

namespace nf::passes {

// view_from_previous_view: this frame's view space from the last one's. previous_ray_*: the last picture's, its jitter
// included, as in FrameBlock. jitter: this picture's, in pixels.
#define NF_REPROJECT_FIELDS(F)     \
  F(Mat4, view_from_previous_view) \
  F(Vec2, previous_ray_scale)      \
  F(Vec2, previous_ray_offset) F(Vec2, jitter) F(Uint, previous_depth_valid) F(Uint, previous_normal_valid)
NF_DECLARE_BLOCK(ReprojectBlock, "reproject", NF_REPROJECT_FIELDS)
ReprojectBlock make_reproject_block(const FrameView& view);

// Offset of frame n's samples from the pixel's centre: Halton (2, 3), in pixels, within +-0.5; it repeats after 16
// frames.
glm::vec2 halton_jitter(uint32_t frame);

// Depth and normals of the last frame.
struct PreviousSurface {
  graph::History depth, normal;
};
// Keeps this frame's for the next one. Once a frame.
PreviousSurface keep_surface(graph::Graph& graph, const GBuffer& gbuffer);

}  // namespace nf::passes
