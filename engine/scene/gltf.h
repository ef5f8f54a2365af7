// glTF 2.0 import (.gltf, .glb) through tinygltf into the scene tables.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "scene/scene.h"

namespace nf::scene {

// Throws nf::Error (Exit::Input) with one line "what: why; what to try" for anything that is wrong with the file:
// missing, truncated, not glTF, an accessor out of bounds, non-finite positions, no triangles, a missing picture, an
// unknown required extension, a URI that leaves the scene's folder, absurd sizes. Never crashes, never hangs.
// `progress` is called on this thread as pictures are decoded on all cores, first with done = 0, last with done =
// total.
using PictureProgress = std::function<void(size_t done, size_t total)>;
Scene load_gltf(const std::filesystem::path& path, const PictureProgress& progress = {});

}  // namespace nf::scene
