// The editor as one value. Panels are functions that draw a part of it and change it in place (panels/panels.h); once a
// frame what changed is sent to the renderer's thread (app.cpp).
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "capture/host.h"
#include "capture/timing.h"
#include "document.h"
#include "live/published.h"
#include "live_flip.h"
#include "live_reference.h"
#include "live_split.h"
#include "preset.h"
#include "slice_view.h"
#include "ui/input.h"
#include "ui/renderer.h"

namespace nf::editor {

struct Toast {
  std::string text;
  double until = 0;  // seconds of the editor's clock
  bool bad = false;
};

struct Banner {
  std::string text;                      // what failed
  std::vector<gpu::ReloadError> faults;  // and where, of shaders
};

// Times of the last frames, by pass. All of one kind: frames made with other settings, lights or another size begin it
// anew, and frames that are smaller because something moves are left out.
struct TimingHistory {
  static constexpr size_t limit = 1000;
  struct Row {
    std::string name, description;
    std::deque<float> ms;  // NaN where the frame had no such pass
  };
  std::vector<Row> rows;                                    // in the order they run
  std::deque<float> frame_ms, wall_ms, record_ms, left_ms;  // left: the frame less its passes
  capture::Run run;                                         // the same frames, as captures are written
  live::MadeWith made_with;                                 // of the last of them
  capture::LoadWatch load;                                  // since the first of them
  std::map<std::string, float> baseline;                    // medians, by pass; "frame" too
  bool paused = false;
  int window = 1;  // row of timing_windows
  // Whether the frame counts.
  bool add(const live::Published& frame);
  void clear();
};
inline constexpr int timing_windows[] = {60, 300, 1000};

enum class CompareMode : uint8_t { Off, Wipe, Blink, Difference };

// How the difference of two pictures is shown: its lightest colour stands for `white`.
struct DifferenceLook {
  const char* name;
  float white;
  bool relative, flip;
};
inline constexpr DifferenceLook differences[] = {{"x 1", 1, false, false},
                                                 {"x 10", 0.1f, false, false},
                                                 {"x 100", 0.01f, false, false},
                                                 {"relative", 1, true, false},
                                                 {"FLIP", 1, false, true}};
// The same as FLIP sees it, made in the background.
struct FlipView {
  bool has = false, current = false;  // current: of the pictures as they are now
  bool busy = false;
  LiveFlip::Result result;  // without its colours, which are PictureId::Flip
  std::string note;         // why there is none
  double started = -10;     // as Editor::now
  uint64_t asked_test = 0, asked_reference = 0;
};
struct DifferenceNumbers {
  double at = -1;  // when they were taken, as Editor::now
  int look = 0;
  ui::PictureId against = ui::PictureId::SlotA;
  capture::Statistics of;  // pixels; none of pictures of other sizes or kinds
};

// The picture in the middle: what it shows, and how.
struct Viewport {
  std::string layer;
  ui::PictureLook look;
  bool auto_range = true;
  CompareMode compare = CompareMode::Off;
  ui::PictureId against = ui::PictureId::SlotA;
  float wipe = 0.5f, blink_seconds = 0.5f;
  int difference = 0;  // row of differences
  DifferenceNumbers apart;
  std::string label_a;                        // what A was made with
  float x = 0, y = 0, width = 0, height = 0;  // of the picture, window pixels
  bool hovered = false, dragging_wipe = false;
  glm::vec2 cursor{-1};  // 0..1 in the picture
};

struct CameraControl {
  scene::Camera camera;
  glm::vec3 target{0};  // orbited
  float speed = 1;      // metres a second
  bool moved = false;   // in this frame
};

// What stands in the viewport in place of the scene while something is pointed at, or until Esc.
struct Preview {
  std::string title;
  ui::PictureId id = ui::PictureId::Preview;
  ui::PictureLook look;
  std::optional<live::ProbeWanted> probe = {};  // an image of the frame, that has to be fetched first
};

struct TextureView {
  live::ProbeWanted wanted;
  bool frozen = false;
  ui::PictureLook look;
  bool auto_range = true;
  live::Pixels pixels;
  live::ProbeWanted of;  // what they are, while frozen
  live::MadeWith made_with;
  std::string error;
  float zoom = 1;          // 1: all of it
  glm::vec2 centre{0.5f};  // of what is seen, in shares of the picture
};

// The path tracer in the background, and how far the picture is from it.
struct ReferenceView {
  bool on = false;
  int bounces = 4;
  std::string layer;  // that is compared; "" = the final radiance
  LiveReference::Picture picture;
  LiveError error;
  bool has_error = false;
  uint64_t error_revision = 0;  // of the frame that it is of
  LiveError error_a;            // of the picture that was kept as A
  bool has_error_a = false;
  std::string a_missing;  // why A has none
  std::string note;
  struct Point {
    float spp, rmse, floor;
  };
  std::vector<Point> curve;  // of this view
  // The error in its two parts, of one quantity.
  bool split = false, has_parts = false;
  int quantity = 0;  // row of split_quantities()
  LiveSplit::Result parts;
  std::string split_note;
  std::vector<std::string> wanted_layers;  // of the frames, for all this
  bool split_on() const { return on && split; }
};

// A panel that was taken out of its tabs: window pixels.
struct Floating {
  float x = 0, y = 0, width = 0, height = 0;
};

struct Preferences {
  float ui_scale = 1;         // of the user, on top of the display's
  float render_scale = 1;     // of the viewport's pixels
  bool scale_chosen = false;  // by the user; else software devices get half
  float moving_scale = 0.34f;
  int settle = 64;
  int capture_frames = 60;
  bool hints = true, hide_ui = false;
  float left = 0.24f, right = 0.26f, bottom = 0.3f;  // shares of the window
  std::string bottom_tab, right_tab;                 // to be opened with the next frame; then empty
  std::string bottom_open, right_open;               // open now
  std::map<std::string, Floating> floating;          // by the panel's name
};

// Parts of the renderer that stand still, each by itself. Kept with nothing: a new scene and a new start are without.
struct Freeze {
  bool history = false, noise = false, culling = false;
  bool any() const { return history || noise || culling; }
};
// "history, culling"
std::string text_of(const Freeze& freeze);

struct Picking {
  bool asked = false, locked = false;
  glm::vec2 place{0.5f};         // 0..1 in the picture, whose size changes while something moves
  glm::uvec2 pixel{0}, size{1};  // as it was read
  live::Picked values;
  std::string search;
  bool show_go_to = false;
  std::string go_to_text, go_to_fault;
};

struct Editor {
  Document document;
  UndoStack undo;
  CameraControl view;
  Viewport viewport;
  TimingHistory timings;
  TextureView texture;
  SliceView slices;
  Picking picking;
  std::optional<Preview> pointed, shown_preview, locked_preview;  // by this frame's panels; by the last one's; kept
  // The image that was fetched for one.
  struct {
    live::ProbeWanted of;
    live::Pixels pixels;
    std::string error;
    ui::PictureLook look;
  } fetched;
  ReferenceView reference;
  FlipView flip;
  Preferences preferences;
  Freeze freeze;

  // From the renderer.
  live::SceneInfo scene;
  bool scene_ready = false;
  live::GraphInfo graph;
  std::string plan_diff;
  std::string device;
  nlohmann::json device_context;
  bool software = false, device_lost = false;
  live::Pixels picture;                 // of the last frame
  live::MadeWith shown_with;            // and what made it
  std::vector<std::string> not_finite;  // of the last frame, with debug.nan_scan
  uint64_t scene_frames = 0, frames_since_change = 0, shown_revision = 0;
  uint32_t settled = 0;
  double scene_time = 0;
  float scene_ms = 0, ui_ms = 0;
  uint64_t host_bytes = 0;      // that the last frame copied to the host
  uint32_t shared_queues = 0;   // of the device that window and renderer share; 0: each has its own
  uint32_t window_devices = 0;  // that were opened: 1, and one more for each that was lost
  // The interface's own frames: what they cost, and from one to the next, in milliseconds.
  std::deque<float> ui_history, ui_periods;

  // To the renderer.
  live::Wanted wanted;
  std::vector<live::Command> outbox;

  // The window's own.
  std::vector<Toast> toasts;
  Banner banner;
  std::deque<std::string> log;
  std::string search, log_search, action_search, preset_path, prompt;
  int log_level = 0;  // row of what the log panel's box offers
  bool changed_only = false, show_help = false, show_save = false, show_open = false, quit = false;
  bool keep_a = false;                        // keep the picture for comparison
  std::optional<Preset> pending_preset;       // for the scene that is being loaded
  std::optional<Bookmarks> preset_bookmarks;  // of the preset that the window was opened with
  std::vector<std::string> dropped;           // files to open, whatever they are
  std::string preset_folder, bundled_scene;
  std::string save_preset, save_texture;  // a path; an ending
  bool save_curve = false;
  bool texture_visible = false, pixel_visible = false;  // these panels, in this frame
  std::string carried;                                  // the panel that was pulled out and is not let go of yet
  std::optional<live::ProbeWanted> texture_asked;
  bool recording = false;  // frames for a capture
  std::string captured;    // the folder of the last one, until it was read
  bool capture_asked = false, save_layers = false, copy_command = false, fullscreen_asked = false;
  uint64_t picture_hash = 0, hashed_frame = 0;  // made when a script or a state file wants it
  bool rebuild_fonts = false, screenshot_viewport = false, screenshot_window = false;
  double now = 0, last_change = -10, last_input = -10, green_flash = -10;
  std::string flash_text;
  uint64_t ui_frames = 0;
  glm::uvec2 window{1280, 720};
  float display_scale = 1;
  ui::Renderer* pictures = nullptr;
  ui::InputQueue* input = nullptr;

  float scale() const { return preferences.ui_scale * display_scale; }
};

// What stands in the viewport in place of the scene, if anything.
const Preview* preview_of(const Editor& editor);
void toast(Editor& editor, std::string text, bool bad = false);
// The camera stands as this one does.
void go_to(Editor& editor, const scene::Camera& camera);

}  // namespace nf::editor
