// How the camera of the viewport moves. Values in, values out; who holds which key is the viewport's to know.
#pragma once

#include "editor.h"

namespace nf::editor {

// -1, 0 or 1 each.
struct Flight {
  float ahead = 0, right = 0, up = 0;
  bool fast = false, slow = false;  // four times as fast, a fourth
};
void fly(CameraControl& control, const Flight& keys, float seconds);

// Turns the view on the spot; radians. The camera stands upright afterwards.
void look_around(CameraControl& control, float yaw, float pitch);
// Camera and target go round `pivot`, which keeps its place in the picture.
void orbit(CameraControl& control, glm::vec3 pivot, float yaw, float pitch);
// By pixels of a picture of that height: what is at the target's distance follows the pointer.
void pan(CameraControl& control, glm::vec2 pixels, float height);

// What is orbited: the surface at the picked pixel, else the camera's target.
glm::vec3 orbit_pivot(const Editor& editor);

}  // namespace nf::editor
