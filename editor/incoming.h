// What comes from the renderer's thread, into the editor.
#pragma once

#include "editor.h"

namespace nf::editor {

void take_event(Editor& editor, live::Event& event);
void take_frame(Editor& editor, live::Published&& frame);

}  // namespace nf::editor
