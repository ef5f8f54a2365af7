// Positions on a camera path. Reading one is in view.cpp, beside the cameras of view files.
#include "scene/path.h"

#include <algorithm>

namespace nf::scene {
namespace {

// The curve's value at u in [0, 1] between two keys; tangents are per frame.
template <class T>
T hermite(const T& a, const T& b, const T& slope_a, const T& slope_b, float width, float u) {
  const float u2 = u * u, u3 = u2 * u;
  return a * (2 * u3 - 3 * u2 + 1) + slope_a * (width * (u3 - 2 * u2 + u)) + b * (3 * u2 - 2 * u3) +
         slope_b * (width * (u3 - u2));
}

template <class T>
T interpolate(const CameraPath& path, size_t i, float u, T Camera::*member) {
  const auto slope = [&](size_t k) {
    const size_t from = k > 0 ? k - 1 : k, to = std::min(k + 1, path.size() - 1);
    return (path[to].camera.*member - path[from].camera.*member) / float(path[to].frame - path[from].frame);
  };
  return hermite<T>(path[i].camera.*member, path[i + 1].camera.*member, slope(i), slope(i + 1),
                    float(path[i + 1].frame - path[i].frame), u);
}

}  // namespace

Camera camera_at(const CameraPath& path, double frame) {
  if (frame <= path.front().frame) return path.front().camera;
  if (frame >= path.back().frame) return path.back().camera;
  size_t i = 0;
  while (path[i + 1].frame <= frame) ++i;
  const float u = float((frame - path[i].frame) / (path[i + 1].frame - path[i].frame));
  Camera camera = path[i].camera;
  camera.position = interpolate(path, i, u, &Camera::position);
  camera.forward = glm::normalize(interpolate(path, i, u, &Camera::forward));
  camera.up = glm::normalize(interpolate(path, i, u, &Camera::up));
  camera.vfov = interpolate(path, i, u, &Camera::vfov);
  return camera;
}

}  // namespace nf::scene
