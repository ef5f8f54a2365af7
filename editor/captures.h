// Files that the user asked for: screenshots, timings, layers, textures, presets. All go to ./captures.
#pragma once

#include <span>

#include "editor.h"

namespace nf::editor {

// Carries out what panels and actions have asked of files. `window` holds the RGBA8 texels of the whole window.
void write_captures(Editor& editor, std::span<const std::byte> window, bool validation);
// `part`: x, y, width, height; what of it lies outside is left out.
void write_window(const std::string& path, const Editor& editor, std::span<const std::byte> window, glm::ivec4 part);

// The renderer has written layers there: says so, and puts beside them what made them.
void take_saved(Editor& editor, const std::string& path, const live::MadeWith& made_with);

}  // namespace nf::editor
