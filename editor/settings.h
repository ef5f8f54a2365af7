// What outlives the window: the user's settings and bookmarks, and presets of what is shown.
#pragma once

#include "editor.h"
#include "preset.h"

namespace nf::editor {

// $XDG_CONFIG_HOME/nearfield/editor.json. A file that cannot be read is renamed to .bad and said so in what comes back;
// empty: all is well. `reset`: the file is not read, and written anew.
std::string load_settings(Editor& editor, bool reset);
// Written only when it changed. What went wrong comes back.
std::string save_settings(const Editor& editor);
Bookmarks load_bookmarks(const std::string& scene);

// Technique, mode, parameters and seed; parameters that the preset does not name get their defaults. Throws nf::Error,
// and then nothing has changed.
void apply_preset(const Preset& preset, Document& document);
// A preset's camera, by name or number; empty: none.
std::string view_name(const Preset& preset);
const scene::View* view_inside(const Preset& preset);
void use_lights(const scene::View& view, live::SceneLights& lights);
Preset make_preset(Editor& editor);
// The command line that renders this picture, of a preset of it.
std::string command_for(const Editor& editor, const std::filesystem::path& preset);

}  // namespace nf::editor
