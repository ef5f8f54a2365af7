// The frame's uniform block.
#include "view.h"

#include "scene/camera.h"

namespace nf::passes {

FrameBlock make_frame_block(const FrameView& view, const scene::Scene& scene, const MaterialParams& material) {
  FrameBlock block;
  const glm::mat4 view_from_world = scene::view_from_world(view.camera);
  const glm::vec2 size(view.size);
  const float ty = std::tan(view.camera.vfov * 0.5f), tx = ty * size.x / size.y;
  block.view_from_world = view_from_world;
  block.world_from_view = glm::inverse(view_from_world);
  block.jittered_clip_from_world = scene::clip_from_view(view.camera, view.size, view.jitter) * view_from_world;
  block.clip_from_world = scene::clip_from_view(view.camera, view.size) * view_from_world;
  block.previous_clip_from_world =
      scene::clip_from_view(view.previous_camera, view.size) * scene::view_from_world(view.previous_camera);
  block.ray_scale = {2 * tx / size.x, -2 * ty / size.y};
  // A jittered picture shows at p what belongs at p - jitter.
  block.ray_offset = glm::vec2(-tx, ty) - view.jitter * block.ray_scale;
  block.pixels_per_tangent = {size.x / (2 * tx), size.y / (2 * ty)};
  block.size = glm::ivec2(view.size);
  block.frame_index = view.frame_index;
  block.seed = view.seed;
  block.near = view.camera.near;
  block.lambert = material.lambert;
  block.texture_lod_bias = material.lod_bias;
  block.albedo_scale = material.albedo_scale;
  block.emissive_scale = material.emissive_scale;
  block.camera_position = view.camera.position;
  block.environment = scene.environment.color;
  return block;
}

}  // namespace nf::passes
