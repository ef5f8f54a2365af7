// Fewer pixels for the technique, and more: low-resolution and interleaved GI, and a border outside the picture.
#pragma once

#include "gi/gi_result.h"
#include "lighting.h"
#include "view.h"

namespace nf::passes {

// clang-format off
#define NF_RESOLUTION_PARAMS(P)                                                                                           \
  P(Choice, gi, 0, 0, 5, "full|half|quarter|checkerboard|interleaved2|interleaved4",                                     \
    "Pixels that the technique runs for: all; every 2nd or 4th of a row and column; every other; all, in 2x2 or 4x4 small pictures") \
  P(Choice, upsample, 2, 0, 2, "nearest|bilateral|joint",                                                                \
    "How the others get theirs: from the nearest, weighted by depth, or by depth, normal and plane")                     \
  P(Float, overscan, 0.0f, 0.0f, 50.0f, "%", "Border outside the picture on each side that is rendered too and cut off at the end") \
  P(Float, edge_fade, 0.0f, 0.0f, 50.0f, "%",                                                                            \
    "Band at the border, in percent of the picture's height, over which GI goes over to none; overscan takes it outside")
// clang-format on
NF_DECLARE_PARAMS(ResolutionParams, "resolution", NF_RESOLUTION_PARAMS)

// factor: pixels of the picture per texel of a small one, along a row and a column. layers: small pictures. offset_n:
// which pixel of its factor x factor block small picture n has.
#define NF_GRID_FIELDS(F) F(Int, factor) F(IVec2, offset)
NF_DECLARE_BLOCK(SplitBlock, "split", NF_GRID_FIELDS)
#define NF_UPSAMPLE_FIELDS(F) F(Int, factor) F(Int, layers) F(IVec2, offset0) F(IVec2, offset1)
NF_DECLARE_BLOCK(UpsampleBlock, "grid", NF_UPSAMPLE_FIELDS)
#define NF_CROP_FIELDS(F) F(IVec2, offset)
NF_DECLARE_BLOCK(CropBlock, "crop", NF_CROP_FIELDS)
// band: pixels.
#define NF_EDGE_FADE_FIELDS(F) F(Float, band)
NF_DECLARE_BLOCK(EdgeFadeBlock, "edge_fade", NF_EDGE_FADE_FIELDS)

// Which pixels the technique runs for in a frame.
struct PixelGrid {
  int factor = 1;
  std::vector<glm::ivec2> offsets = {{0, 0}};  // one a small picture
  bool all() const { return int(offsets.size()) == factor * factor; }
};
// `moving`: someone averages the frames, so the grid may be another in each.
PixelGrid make_grid(int resolution, uint32_t frame, bool moving);

// The frame as the small picture sees it: texel q is pixel factor * q + offset. `index`, of `count` small pictures,
// gives each its own noise.
FrameBlock make_small_frame(const FrameBlock& frame, int factor, glm::ivec2 offset, uint32_t index, uint32_t count);

// Runs `technique(small gbuffer, small radiance)`, which returns a GiResult, on each small picture, and puts the
// picture's GI together. The small G-buffer has depth and normal, the small radiance has radiance, nothing else; the
// `frame` block of the technique's passes is the small picture's. Texels are those of real pixels, never averages.
struct SmallInputs {
  GBuffer gbuffer;
  Radiance radiance;
};
SmallInputs add_split(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer, const Radiance& radiance,
                      int factor, glm::ivec2 offset);
// Passes from `first_pass` on read this frame block.
void give_frame(graph::Graph& graph, size_t first_pass, const FrameBlock& frame);
GiResult add_upsample(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer, const PixelGrid& grid,
                      const std::vector<GiResult>& small, const ResolutionParams& params);

template <class F>
GiResult add_at_resolution(graph::Graph& graph, gpu::Pipelines& pipelines, const FrameBlock& frame,
                           const PixelGrid& grid, const GBuffer& gbuffer, const Radiance& radiance,
                           const ResolutionParams& params, F&& technique) {
  if (grid.factor == 1) return technique(gbuffer, radiance);
  std::vector<GiResult> small;
  for (size_t i = 0; i < grid.offsets.size(); ++i) {
    const SmallInputs inputs = add_split(graph, pipelines, gbuffer, radiance, grid.factor, grid.offsets[i]);
    const size_t first_pass = graph.passes.size();
    small.push_back(technique(inputs.gbuffer, inputs.radiance));
    give_frame(graph, first_pass,
               make_small_frame(frame, grid.factor, grid.offsets[i], uint32_t(i), uint32_t(grid.offsets.size())));
  }
  return small[0].any() ? add_upsample(graph, pipelines, gbuffer, grid, small, params) : GiResult{};
}

// Pixels of the border on each side, and the view with it: the same picture in its middle.
glm::ivec2 overscan_border(glm::uvec2 size, float percent);
FrameView with_border(const FrameView& view, glm::ivec2 border);
graph::Tex add_crop(graph::Graph& graph, gpu::Pipelines& pipelines, graph::Tex image, glm::ivec2 border);

// Over `band` pixels at the border of what is rendered, GI goes over to what composition takes where there is none.
GiResult add_edge_fade(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& gbuffer, const GiResult& gi,
                       const EnvironmentMaps& environment, float band);

}  // namespace nf::passes
