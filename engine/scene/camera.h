// Camera matrices. View space looks down -Z; clip space is Vulkan's (y down, depth 0..1) with reverse-Z and an infinite
// far plane: depth = near / distance.
#pragma once

#include "scene/scene.h"

namespace nf::scene {

mat4 view_from_world(const Camera& camera);

// `jitter` shifts the picture, in pixels (x right, y down).
mat4 clip_from_view(const Camera& camera, glm::uvec2 size, vec2 jitter = vec2(0));

}  // namespace nf::scene
