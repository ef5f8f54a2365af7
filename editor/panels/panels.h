// The panels: each draws one part of the editor into the current Dear ImGui window, and changes it in place.
#pragma once

#include "editor.h"

namespace nf::editor {

void draw_technique_panel(Editor& editor);
void draw_viewport(Editor& editor);
void draw_timings_panel(Editor& editor);
void draw_graph_panel(Editor& editor);
void draw_memory_panel(Editor& editor);
void draw_log_panel(Editor& editor);
void draw_pixel_panel(Editor& editor);
void draw_texture_panel(Editor& editor);
void draw_scene_panel(Editor& editor);
void draw_reference_panel(Editor& editor);
void draw_slices_panel(Editor& editor);
void draw_help(Editor& editor);
void draw_dialogs(Editor& editor);
// A small field for a pixel's numbers, while it is asked for.
void draw_go_to_pixel(Editor& editor);

// The inspected pixel's samples and slices over the picture, which has these window pixels.
void draw_samples(Editor& editor, float x, float y, float width, float height);

// The picture in its place, which has these window pixels, and what it is compared with; the choice of that.
void draw_compared(Editor& editor, float x, float y, float width, float height, void* scene,
                   const ui::PictureLook& look);
void draw_compare_tools(Editor& editor);

// The controls of a picture of floats: channels, range, colours.
void draw_look(const std::string& id, const live::Pixels& pixels, ui::PictureLook& look, bool& auto_range);

// An image as it is after a pass, for the viewport: `resource`, or what the pass writes first. None: there is none.
std::optional<Preview> preview_after(const Editor& editor, const std::string& pass, const std::string& resource = {});
// Shows it while it is hovered; a click keeps it, or lets it go.
void point_at(Editor& editor, std::optional<Preview> preview, bool hovered, bool clicked);

}  // namespace nf::editor
