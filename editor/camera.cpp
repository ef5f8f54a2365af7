#include "camera.h"

#include <algorithm>
#include <cmath>

namespace nf::editor {
namespace {

glm::mat3 basis_of(const scene::Camera& camera) {
  const glm::vec3 forward = glm::normalize(camera.forward), right = glm::normalize(glm::cross(forward, camera.up));
  return {right, glm::cross(right, forward), forward};
}

float distance_of(const CameraControl& c) {
  return std::max(glm::length(c.target - c.camera.position), 0.05f);
}

void turn(scene::Camera& camera, float yaw, float pitch) {
  const glm::vec3 axis(0, 1, 0);
  const glm::vec3 f =
      glm::normalize(glm::vec3(glm::mat4_cast(glm::angleAxis(yaw, axis)) * glm::vec4(camera.forward, 0)));
  const float now = std::asin(std::clamp(f.y, -1.0f, 1.0f)), then = std::clamp(now + pitch, -1.55f, 1.55f);
  const glm::vec2 flat = glm::normalize(glm::vec2(f.x, f.z));
  camera.forward = {flat.x * std::cos(then), std::sin(then), flat.y * std::cos(then)};
  camera.up = axis;
}

}  // namespace

void fly(CameraControl& c, const Flight& keys, float seconds) {
  const glm::mat3 basis = basis_of(c.camera);
  const glm::vec3 way = basis[2] * keys.ahead + basis[0] * keys.right + glm::vec3(0, 1, 0) * keys.up;
  if (way == glm::vec3(0)) return;
  const glm::vec3 step = way * (c.speed * (keys.fast ? 4.0f : 1.0f) * (keys.slow ? 0.25f : 1.0f) * seconds);
  c.camera.position += step;
  c.target += step;
  c.moved = true;
}

void look_around(CameraControl& c, float yaw, float pitch) {
  const float distance = distance_of(c);
  turn(c.camera, yaw, pitch);
  c.target = c.camera.position + c.camera.forward * distance;
  c.moved = true;
}

void orbit(CameraControl& c, glm::vec3 pivot, float yaw, float pitch) {
  const glm::mat3 before = basis_of(c.camera);
  turn(c.camera, yaw, pitch);
  const glm::mat3 turned = basis_of(c.camera) * glm::transpose(before);
  c.camera.position = pivot + turned * (c.camera.position - pivot);
  c.target = pivot + turned * (c.target - pivot);
  c.moved = true;
}

void pan(CameraControl& c, glm::vec2 pixels, float height) {
  const glm::mat3 basis = basis_of(c.camera);
  const float meters = 2 * distance_of(c) * std::tan(c.camera.vfov / 2) / std::max(height, 1.0f);
  const glm::vec3 step = (basis[1] * pixels.y - basis[0] * pixels.x) * meters;
  c.camera.position += step;
  c.target += step;
  c.moved = true;
}

glm::vec3 orbit_pivot(const Editor& editor) {
  if (!editor.picking.locked) return editor.view.target;
  const auto value = [&](const char* name, size_t count) -> const float* {
    for (const live::LayerValue& layer : editor.picking.values.layers)
      if (layer.name == name && layer.values.size() >= count) return layer.values.data();
    return nullptr;
  };
  const float *depth = value("depth", 1), *position = value("position", 3);
  if (!depth || !position || !(*depth > 0)) return editor.view.target;  // the sky
  const glm::vec3 at(position[0], position[1], position[2]);
  return std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z) ? at : editor.view.target;
}

}  // namespace nf::editor
