// Where the panels stand: four regions with draggable borders, computed each frame from the window's size.
#pragma once

#include "editor.h"

namespace nf::editor {

void draw_layout(Editor& editor);
// Colours and sizes for a scale of 1; fonts are made by the caller.
void apply_theme(float scale);

}  // namespace nf::editor
