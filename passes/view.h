// One frame's cameras as the uniform block `frame` that every shader can read.
#pragma once

#include <optional>

#include "core/params.h"
#include "scene/scene.h"

namespace nf::passes {

// Spaces: world is glTF's; view looks down -Z; clip is Vulkan's with reverse-Z. A pixel p (integer + 0.5, y down) at
// linear depth z (metres along the axis) is at z * (p * ray_scale + ray_offset, -1) in view space. clip_from_view has
// the jitter in it, the two clip_from_world have not.
// clang-format off
#define NF_FRAME_FIELDS(F)                                                                                     \
  F(Mat4, view_from_world) F(Mat4, world_from_view) F(Mat4, jittered_clip_from_world) F(Mat4, clip_from_world) \
  F(Mat4, previous_clip_from_world) F(Vec2, ray_scale) F(Vec2, ray_offset)          \
  F(Vec2, pixels_per_tangent) F(IVec2, size) F(Uint, frame_index) F(Uint, seed) F(Float, near)                 \
  F(Uint, lambert) F(Float, texture_lod_bias) F(Float, albedo_scale) F(Float, emissive_scale)                  \
  F(Vec3, camera_position) F(Vec3, environment)
// clang-format on
NF_DECLARE_BLOCK(FrameBlock, "frame", NF_FRAME_FIELDS)

#define NF_MATERIAL_PARAMS(P)                                                                               \
  P(Bool, lambert, 0, 0, 1, "",                                                                             \
    "Every material becomes pure Lambert: diffuse = base colour, no specular, no normal maps")              \
  P(Choice, blend, 0, 0, 1, "over|cutout",                                                                  \
    "Surfaces with alphaMode BLEND: over the finished frame, outside GI, or cut out at alpha 0.5")          \
  P(Float, lod_bias, 0, -16, 8, "",                                                                         \
    "Added to the mip level of every texture: below 0 sharper, and noisier; -16 takes none but the finest") \
  P(Float, albedo_scale, 1, 0, 4, "", "Every base colour times this, at most 1")                            \
  P(Float, emissive_scale, 1, 0, 1000, "", "Every emission times this; what is unlit shows its colour times this")
NF_DECLARE_PARAMS(MaterialParams, "material", NF_MATERIAL_PARAMS)

// What the frame is made for: cameras of this and the last frame, size, clock.
struct FrameView {
  scene::Camera camera, previous_camera;
  glm::uvec2 size{1};
  uint32_t frame_index = 0, seed = 1;
  // Of the frame whose histories are read, where it is not the one before.
  std::optional<uint32_t> previous_frame_index = {};
  glm::vec2 jitter{0}, previous_jitter{0};  // pixels
  // Whether someone averages the frames: else sampling noise is the same in each, unless reconstruction averages them.
  bool averaged = true;
  // Whose samples the technique shall tell, one by one (FrameOutputs::inspection).
  std::optional<glm::uvec2> inspect;
  // What stands outside this camera's view is not drawn, though `camera` may see where it would be.
  std::optional<scene::Camera> culling_camera = {};
};

// A constant environment's radiance comes from the scene.
FrameBlock make_frame_block(const FrameView& view, const scene::Scene& scene, const MaterialParams& material);

}  // namespace nf::passes
