// Camera paths: keys on frame numbers, smooth between them.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/scene.h"

namespace nf::scene {

struct PathKey {
  double frame = 0;
  Camera camera;
};
using CameraPath = std::vector<PathKey>;  // by frame, at least two

// {"schema": "nearfield.path/1", "keys": [{"frame": 0, "camera": {...}}, ...]}; a camera is as in a view file. Throws
// nf::Error (Exit::Input) as load_view does.
CameraPath load_path(const std::filesystem::path& path);

// Position, direction, up and angle of view are cubic Hermite curves (Catmull and Rom's tangents, for uneven keys) that
// go through every key. Before the first and behind the last key the camera rests there.
Camera camera_at(const CameraPath& path, double frame);

}  // namespace nf::scene
