// Camera matrices, written out: GLM's own assume a finite far plane or OpenGL's y axis.
#include "scene/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace nf::scene {

mat4 view_from_world(const Camera& camera) {
  return glm::lookAt(camera.position, camera.position + camera.forward, camera.up);
}

mat4 clip_from_view(const Camera& camera, glm::uvec2 size, vec2 jitter) {
  const float width = float(std::max(size.x, 1u)), height = float(std::max(size.y, 1u));
  const float focal = 1 / std::tan(camera.vfov / 2);
  mat4 clip(0);
  clip[0][0] = focal * height / width;
  clip[1][1] = -focal;
  // x and y are divided by w = -view.z, so an offset in NDC is a factor of -view.z.
  clip[2][0] = -2 * jitter.x / width;
  clip[2][1] = -2 * jitter.y / height;
  clip[2][3] = -1;
  clip[3][2] = camera.near;
  return clip;
}

}  // namespace nf::scene
