// The scene that a command works on.
#pragma once

#include <string>

#include "cli/options.h"
#include "scene/scene.h"

namespace nf::editor {

// Loads with progress on stderr, and gives the primitives the materials of --variant. Throws nf::Error (Exit::Input),
// naming the variants there are where that one is not among them.
scene::Scene open_scene(const std::string& path, const CommonOptions& options);

// --view, or the preset's own view: its lights become the scene's.
scene::Camera choose_view(const CommonOptions& options, scene::Scene& scene);

}  // namespace nf::editor
