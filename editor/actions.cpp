#include "actions.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <algorithm>
#include <utility>

#include "scene/view.h"

namespace nf::editor {
namespace {

void step_technique(Editor& e, int step) {
  const auto all = passes::techniques();
  const int now = int(e.document.settings.technique - all.data()), count = int(all.size());
  e.document.settings.technique = &all[size_t((now + step + count) % count)];
}

void toggle(Editor& e, CompareMode mode) {
  e.viewport.compare = e.viewport.compare == mode ? CompareMode::Off : mode;
}

// False when the pixel panel is not open: then the arrow keys are the slice inspector's.
bool move_pick(Editor& e, glm::ivec2 by) {
  if (!e.pixel_visible || !e.picking.locked || e.picking.size.x == 0) return false;
  const glm::ivec2 limit = glm::ivec2(e.picking.size) - 1;
  e.picking.place = (glm::vec2(glm::clamp(glm::ivec2(e.picking.pixel) + by, glm::ivec2(0), limit)) + 0.5f) /
                    glm::vec2(e.picking.size);
  e.picking.asked = true;
  return true;
}

void open_dialog(Editor& e, bool save) {
  if (e.show_save || e.show_open) return;  // one after the other: its text field would keep the other's text
  e.show_save = save;
  e.show_open = !save;
  e.prompt = save ? (e.preset_path.empty() ? "preset.json" : e.preset_path) : std::string();
}

void set_scale(Editor& e, float scale) {
  e.preferences.ui_scale = std::clamp(scale, 0.75f, 3.0f);
  e.rebuild_fonts = true;
}

const Action table[] = {
    {"file.open", "File", "Open ...", "ctrl+o", "A scene, an environment or a preset",
     [](Editor& e) { open_dialog(e, false); }},
    {"file.save", "File", "Save preset ...", "ctrl+s", "Technique, changed parameters, camera, lights and seed as JSON",
     [](Editor& e) { open_dialog(e, true); }},
    {"file.bundled", "File", "Open the bundled scene", "", "The atrium",
     [](Editor& e) { e.dropped.push_back(e.bundled_scene); }},
    {"file.screenshot", "File", "Screenshot of the picture", "f9", "PNG, and the preset beside it",
     [](Editor& e) { e.screenshot_viewport = true; }},
    {"file.screenshot_window", "File", "Screenshot of the window", "shift+f9", "PNG with the user interface",
     [](Editor& e) { e.screenshot_window = true; }},
    {"file.screenshot_layers", "File", "Save all layers", "ctrl+f9",
     "Linear EXR with every layer that the technique gives", [](Editor& e) { e.save_layers = true; }},
    {"file.quit", "File", "Quit", "ctrl+q", "", [](Editor& e) { e.quit = true; }},
    {"edit.undo", "Edit", "Undo", "ctrl+z", "Parameters, technique, lights, bookmarks",
     [](Editor& e) {
       if (!e.undo.undo(e.document)) toast(e, "nothing to undo");
     }},
    {"edit.redo", "Edit", "Redo", "ctrl+y", "",
     [](Editor& e) {
       if (!e.undo.redo(e.document)) toast(e, "nothing to redo");
     }},
    {"edit.redo2", "", "Redo", "ctrl+shift+z", "",
     [](Editor& e) {
       if (!e.undo.redo(e.document)) toast(e, "nothing to redo");
     }},
    {"technique.next", "Technique", "Next technique", "n", "", [](Editor& e) { step_technique(e, 1); }},
    {"technique.previous", "Technique", "Previous technique", "shift+n", "", [](Editor& e) { step_technique(e, -1); }},
    {"technique.mode", "Technique", "Paper or radiometric form", "m", "As printed, or with the errata mended",
     [](Editor& e) { set_mode(e.document.settings, !is_paper_mode(e.document.settings)); }},
    {"technique.reset", "Technique", "Reset parameters", "", "The technique's and the shared ones",
     [](Editor& e) { reset_params(e.document.settings); }},
    {"shaders.reload", "Technique", "Reload shaders", "f5",
     "Compiles all shaders anew; saving one does it for what depends on it",
     [](Editor& e) {
       e.outbox.push_back({live::CommandKind::ReloadShaders, {}, {}, {}});
     }},
    {"view.help", "Help", "Help", "f1", "This list", [](Editor& e) { e.show_help = !e.show_help; }},
    {"view.hide", "View", "Hide the interface", "f2", "Only the picture",
     [](Editor& e) {
       e.preferences.hide_ui = !e.preferences.hide_ui;
       if (e.preferences.hide_ui) toast(e, "F2 brings the interface back");
     }},
    {"view.fullscreen", "View", "Full screen", "f11", "", [](Editor& e) { e.fullscreen_asked = true; }},
    {"view.bigger", "View", "Larger interface", "ctrl+=", "",
     [](Editor& e) { set_scale(e, e.preferences.ui_scale + 0.25f); }},
    {"view.smaller", "View", "Smaller interface", "ctrl+-", "",
     [](Editor& e) { set_scale(e, e.preferences.ui_scale - 0.25f); }},
    {"view.normal", "View", "Interface at its own size", "ctrl+0", "", [](Editor& e) { set_scale(e, 1); }},
    {"view.reset_layout", "View", "Reset the layout", "ctrl+shift+l", "",
     [](Editor& e) {
       const Preferences d;
       e.preferences.floating.clear();
       e.preferences.left = d.left;
       e.preferences.right = d.right;
       e.preferences.bottom = d.bottom;
     }},
    {"view.wipe", "View", "Wipe", "x", "The picture against A or the reference, either side of a line",
     [](Editor& e) { toggle(e, CompareMode::Wipe); }},
    {"view.blink", "View", "Blink", "b", "The picture and A in turns",
     [](Editor& e) { toggle(e, CompareMode::Blink); }},
    {"view.difference", "View", "Difference", "h",
     "How far the picture is from A: as it is, x 10, x 100, relative, FLIP, off",
     [](Editor& e) {
       Viewport& v = e.viewport;
       const bool on = v.compare == CompareMode::Difference, last = v.difference + 1 == int(std::size(differences));
       v.difference = on && !last ? v.difference + 1 : 0;
       v.compare = on && last ? CompareMode::Off : CompareMode::Difference;
     }},
    {"view.keep", "View", "Keep as A", "k", "The picture as it is, to compare with", [](Editor& e) { keep_as_a(e); }},
    {"view.keep2", "", "Keep as A", "ctrl+b", "The picture as it is, to compare with", [](Editor& e) { keep_as_a(e); }},
    {"view.reference", "View", "Reference", "r", "The path tracer refines this view in the background",
     [](Editor& e) {
       e.reference.on = !e.reference.on;
       e.preferences.right_tab = "Reference";
     }},
    {"view.pick", "View", "Pixel values", "p", "The pixel under the cursor in every layer and image",
     [](Editor& e) {
       if (e.viewport.cursor.x < 0 || e.picture.size.x == 0) return;
       e.picking.place = e.viewport.cursor;
       e.picking.asked = e.picking.locked = true;
       e.preferences.right_tab = "Pixel";
     }},
    {"view.go_to_pixel", "View", "Go to pixel ...", "ctrl+g", "Picks the pixel whose numbers are typed",
     [](Editor& e) { e.picking.show_go_to = e.picture.size.x > 0; }},
    {"view.inspect", "View", "Slice inspector", "i", "The picked pixel's samples, slices and sectors, one by one",
     [](Editor& e) {
       e.slices.on = !e.slices.on;
       if (e.slices.on) e.preferences.right_tab = "Slices";
     }},
    {"slices.next", "", "Next slice", "right", "Of the slice inspector; else the pixel beside the picked one",
     [](Editor& e) {
       if (!move_pick(e, {1, 0})) step_slice(e, 1);
     }},
    {"slices.previous", "", "Previous slice", "left", "Of the slice inspector; else the pixel beside the picked one",
     [](Editor& e) {
       if (!move_pick(e, {-1, 0})) step_slice(e, -1);
     }},
    {"slices.more", "", "One more sample", "up", "Of the slice inspector; else the pixel beside the picked one",
     [](Editor& e) {
       if (!move_pick(e, {0, -1})) step_sample(e, 1);
     }},
    {"slices.fewer", "", "One sample less", "down", "Of the slice inspector; else the pixel beside the picked one",
     [](Editor& e) {
       if (!move_pick(e, {0, 1})) step_sample(e, -1);
     }},
    {"view.graph", "View", "Frame graph", "g", "Passes against resources",
     [](Editor& e) { e.preferences.bottom_tab = "Graph"; }},
    {"view.frame", "View", "Frame the scene", "f", "The camera sees all of it",
     [](Editor& e) {
       scene::Camera c = scene::frame_bounds(e.scene.bounds);
       c.near = e.view.camera.near;
       go_to(e, c);
     }},
    {"view.cancel", "", "Cancel", "escape", "Closes help, lets go of the pixel and of the pass that is previewed",
     [](Editor& e) {
       e.show_help = false;
       if (std::exchange(e.picking.show_go_to, false)) return;
       e.locked_preview.reset();
       e.picking.locked = false;
     }},
    {"clock.play", "View", "Play or pause the clock", "space", "",
     [](Editor& e) { e.wanted.playing = !e.wanted.playing; }},
    {"clock.step", "View", "Step the clock", ".", "", [](Editor& e) { ++e.wanted.steps; }},
    {"renderer.freeze", "View", "Freeze the renderer", "ctrl+space", "The picture stays",
     [](Editor& e) { e.wanted.paused = !e.wanted.paused; }},
    {"freeze.history", "View", "Freeze the history", "",
     "What frames accumulate stays as it is now; new frames read it only",
     [](Editor& e) { e.freeze.history = !e.freeze.history; }},
    {"freeze.noise", "View", "Freeze noise and jitter", "", "Every frame takes the samples that the last one took",
     [](Editor& e) { e.freeze.noise = !e.freeze.noise; }},
    {"freeze.culling", "View", "Freeze the culling", "",
     "What this camera does not see is not drawn, wherever one looks from",
     [](Editor& e) { e.freeze.culling = !e.freeze.culling; }},
    {"renderer.restart", "View", "Restart the renderer", "", "With a new device; nothing else is lost",
     [](Editor& e) {
       e.outbox.push_back({live::CommandKind::Restart, {}, {}, {}});
     }},
    {"capture.timings", "Capture", "Capture timings", "ctrl+t",
     "JSON, CSV and a trace of as many frames as the timings panel says; once more: of what there is",
     [](Editor& e) { e.capture_asked = true; }},
    {"capture.cli", "Capture", "Copy as command", "", "The command line that renders this picture",
     [](Editor& e) { e.copy_command = true; }},
};

}  // namespace

std::span<const Action> actions() {
  return table;
}

const Action* find_action(std::string_view id) {
  for (const Action& action : table)
    if (action.id == id) return &action;
  return nullptr;
}

void keep_as_a(Editor& editor) {
  editor.keep_a = true;
  editor.viewport.against = ui::PictureId::SlotA;
  editor.viewport.label_a = picture_label(editor);
}

std::string picture_label(const Editor& editor) {
  if (!editor.shown_with.settings.technique) return {};
  const std::deque<float>& ms = editor.timings.frame_ms;
  const double frame = ms.empty() ? double(editor.scene_ms) : capture::statistics({ms.begin(), ms.end()}).median;
  return fmt::format("{}  {:.1f} ms", editor.shown_with.settings.technique->id, frame);
}

bool run_shortcut(Editor& editor, int key, int mods, Focus focus) {
  const bool plain = (mods & (ui::mod_ctrl | ui::mod_alt)) == 0;
  const bool function = key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12;
  const bool help =
      key == GLFW_KEY_ESCAPE && (editor.show_help || editor.picking.show_go_to);  // each has a text field of its own
  if ((focus == Focus::Text || focus == Focus::Flight) && plain && !function && !help) return false;
  for (const int steers : {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E})
    if (focus == Focus::Flight && key == steers) return false;
  // What text fields do themselves: undo, redo, select all, copy, paste, cut, words.
  for (const int own : {GLFW_KEY_Z, GLFW_KEY_Y, GLFW_KEY_A, GLFW_KEY_C, GLFW_KEY_V, GLFW_KEY_X, GLFW_KEY_LEFT,
                        GLFW_KEY_RIGHT, GLFW_KEY_BACKSPACE, GLFW_KEY_DELETE})
    if (focus == Focus::Text && key == own) return false;
  if (focus == Focus::Widget && key == GLFW_KEY_SPACE && mods == 0) return false;  // presses it
  if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9 && !(mods & ui::mod_alt)) {
    std::optional<scene::Camera>& bookmark = editor.document.bookmarks[size_t(key - GLFW_KEY_1)];
    const int number = key - GLFW_KEY_1 + 1;
    if (mods & ui::mod_ctrl) {
      bookmark = editor.view.camera;
      toast(editor, fmt::format("camera kept as {}", number));
    } else if (bookmark) {
      go_to(editor, *bookmark);
    } else {
      toast(editor, fmt::format("no camera {}: Ctrl+{} keeps this one", number, number));
    }
    return true;
  }
  for (const Action& action : table) {
    if (!*action.keys) continue;
    const ui::Chord chord = ui::parse_chord(action.keys);
    if (chord.key != key || chord.mods != (mods & (ui::mod_ctrl | ui::mod_alt | ui::mod_shift))) continue;
    action.run(editor);
    return true;
  }
  return false;
}

std::string find_conflict() {
  for (const Action& a : table)
    for (const Action& b : table)
      if (&a < &b && *a.keys && *b.keys && ui::parse_chord(a.keys) == ui::parse_chord(b.keys))
        return fmt::format("{} and {} both have {}", a.id, b.id, a.keys);
  return {};
}

}  // namespace nf::editor
