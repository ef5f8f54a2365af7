// The window's loop: input, panels, what is asked of the renderer and what came from it.
#pragma once

#include <string>

#include "cli/options.h"

namespace nf::editor {

struct EditOptions : CommonOptions {
  std::string scene, ui_script, ui_state;
  std::string window = "1440x900";
  float ui_scale = 0;  // 0: as kept
  bool reset_settings = false, offscreen = false;
  std::string sharing = "auto";  // of the device: auto, shared, separate
};

// Until the user quits; the exit code. Throws nf::Error as commands do.
int run_editor(EditOptions& options);

}  // namespace nf::editor
