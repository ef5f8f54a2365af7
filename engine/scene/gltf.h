// glTF 2.0 import (.gltf, .glb) through tinygltf into the scene tables.
#pragma once

#include <filesystem>

#include "scene/scene.h"

namespace nf::scene {

// Throws nf::Error (Exit::Input) with one line "what: why; what to try" for anything that is wrong with the file:
// missing, truncated, not glTF, an accessor out of bounds, non-finite positions, no triangles, a missing picture, an
// unknown required extension, a URI that leaves the scene's folder, absurd sizes. Never crashes, never hangs.
Scene load_gltf(const std::filesystem::path& path);

}  // namespace nf::scene
