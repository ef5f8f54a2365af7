#include "app.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <imgui.h>
#include <map>
#include <spdlog/sinks/base_sink.h>
#include <thread>

#include "actions.h"
#include "captures.h"
#include "core/log.h"
#include "gpu/reload.h"
#include "incoming.h"
#include "layout.h"
#include "live/handover.h"
#include "live/worker.h"
#include "panels/panels.h"
#include "refine.h"
#include "scene/view.h"
#include "settings.h"
#include "state.h"
#include "ui/script.h"
#include "ui/widgets.h"
#include "window.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// The log's lines for the panel, from whichever thread.
class LogLines : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(lines_, {});
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const auto level = spdlog::level::to_string_view(message.level);
    lines_.push_back(fmt::format("{}: {}", std::string_view(level.data(), level.size()),
                                 std::string_view(message.payload.data(), message.payload.size())));
  }
  void flush_() override {}
  std::vector<std::string> lines_;
};

fs::path content_folder() {
  std::error_code error;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::vector<fs::path> candidates;
  if (const char* data = std::getenv("NEARFIELD_DATA_DIR")) candidates.push_back(fs::path(data) / "content");
  candidates.push_back(binary / "content");
  candidates.push_back(binary / "../share/nearfield/content");
  for (const fs::path& candidate : candidates)
    if (fs::exists(candidate / "atrium.glb")) return fs::canonical(candidate);
  return {};
}

// A scene's own view file, if it has one: the atrium's sky, say.
std::string view_beside(const std::string& scene) {
  const fs::path file = fs::path(scene).replace_extension(".json");
  try {
    if (fs::exists(file) && scene::load_view(file).camera) return file.string();
  } catch (const Error&) {
    // some other JSON file
  }
  return {};
}

// Whether the scene as it stands cannot show what the preset does: another file, camera by name, or environment.
bool needs_load(const Preset& preset, const Editor& e) {
  if (!e.scene_ready) return preset.scene.has_value();
  if (preset.scene && !fs::equivalent(*preset.scene, e.scene.path)) return true;
  if (!view_name(preset).empty()) return true;
  const scene::View* inside = view_inside(preset);
  if (!inside) return false;
  return inside->environment ? !same(*inside->environment, e.scene.environment) : !e.scene.own_environment;
}

std::string lower_extension(const std::string& path) {
  std::string text = fs::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

class App {
 public:
  explicit App(EditOptions& options) : o_(options) {}
  int run();

 private:
  void open();
  void loop();
  void load_fonts();
  void open_device();
  void reopen(const std::string& why);
  void frame();
  void step();
  std::string take_events();
  void take();
  void open_file(const std::string& path);
  void ask();
  void serve();
  void keep_settings();
  void reload_window(const std::vector<std::string>& changed);
  void on_input(const ui::InputEvent& event);
  void pace(double started);
  double clock() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  EditOptions& o_;
  Editor e_;
  ui::InputQueue input_;
  std::shared_ptr<LogLines> log_ = std::make_shared<LogLines>();
  gpu::DeviceOptions device_options_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<live::Handover> handover_;  // when the renderer is the second user of device_
  std::unique_ptr<Window> window_;
  std::unique_ptr<ui::Renderer> pictures_;
  std::unique_ptr<live::Worker> worker_;
  std::unique_ptr<ui::Script> script_;
  std::unique_ptr<Refiner> refiner_;
  std::unique_ptr<LiveFlip> flip_;
  Document sent_;
  live::Wanted last_;
  std::span<const std::byte> shown_;
  std::string screenshot_, state_text_, title_;
  glm::ivec4 screenshot_part_{0};
  double kept_at_ = 0, watched_at_ = 0;
  std::optional<gpu::ShaderWatch> watch_;  // of the window's own programs
  bool window_broken_ = false;             // one of them
  uint64_t messages_ = 0;                  // of devices that are gone
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool font_ready_ = false;
};

void App::open() {
  if (const std::string conflict = find_conflict(); !conflict.empty()) fail(Exit::Internal, "keys: {}", conflict);
  spdlog::default_logger()->sinks().push_back(log_);
  e_.document.settings = make_settings(o_, Reconstruction::Default);
  e_.document.seed = o_.seed;
  const glm::uvec2 size = parse_size(o_.window);
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  ui::map_keys();
  if (!o_.ui_script.empty())
    script_ = std::make_unique<ui::Script>(
        o_.ui_script, ui::Script::Host{[this](const std::string& path, glm::ivec4 part) {
                                         screenshot_ = path;
                                         screenshot_part_ = part;
                                       },
                                       [this](const std::string& whose) {
                                         if (whose == "window")
                                           device_->pretend_lost(gpu::Device::Loss::AtPicture);
                                         else
                                           e_.outbox.push_back({live::CommandKind::LoseDevice, {}, {}, {}});
                                       },
                                       [this] {
                                         e_.outbox.push_back({live::CommandKind::DropBarrier, {}, {}, {}});
                                       },
                                       [this] { e_.quit = true; }});
  // A script's two clicks are a double click however slow the frames are.
  if (script_) io.MouseDoubleClickTime = 1.5f;
  device_options_ = device_options(o_);
  device_options_.second_queue = o_.sharing != "separate";
  if (!o_.offscreen) {
    window_ = std::make_unique<Window>(size, "Nearfield", input_);
    device_options_.window_extensions = window_->extensions();
    e_.display_scale = window_->scale();
    io.SetClipboardTextFn = [](void* user, const char* text) { static_cast<Window*>(user)->set_clipboard(text); };
    io.GetClipboardTextFn = [](void* user) {
      static std::string kept;
      kept = static_cast<Window*>(user)->clipboard();
      return kept.c_str();
    };
    io.ClipboardUserData = window_.get();
  }
  open_device();
  worker_ =
      std::make_unique<live::Worker>(live::WorkerOptions{device_options(o_), executor_options(o_), handover_.get()});
  const fs::path content = content_folder();
  if (!content.empty()) {
    e_.bundled_scene = (content / "atrium.glb").string();
    e_.preset_folder = (content / "presets").string();
  }
  std::string scene = o_.scene;
  std::optional<scene::View> lit;
  if (!o_.preset.empty()) {
    const Preset preset = read_preset(o_.preset);  // its settings are in the document already, beneath the flags
    e_.preset_path = o_.preset;
    e_.preset_bookmarks = preset.bookmarks;
    if (scene.empty() && preset.scene) scene = *preset.scene;
    if (const scene::View* inside = view_inside(preset); inside && !o_.view_given) lit = *inside;
  }
  if (scene.empty()) scene = e_.bundled_scene;
  if (scene.empty()) fail(Exit::Input, "the bundled scene was not found; name one: nearfield edit scene.glb");
  if (!fs::exists(scene)) fail(Exit::Input, "cannot open the scene '{}': no such file", scene);
  worker_->send({live::CommandKind::LoadScene, scene, o_.view.empty() && !lit ? view_beside(scene) : o_.view, lit});

  pictures_ = std::make_unique<ui::Renderer>(*device_);
  if (window_) window_->attach(*device_);
  e_.pictures = pictures_.get();
  e_.input = &input_;
  e_.window = window_ ? window_->size() : size;
  if (const std::string problem = load_settings(e_, o_.reset_settings); !problem.empty()) toast(e_, problem, true);
  if (o_.ui_scale > 0) e_.preferences.ui_scale = o_.ui_scale;
  sent_ = e_.document;
}

void App::open_device() {
  device_ = std::make_unique<gpu::Device>(device_options_);
  const bool shared = o_.sharing == "shared" || (o_.sharing == "auto" && !device_->facts.software);
  if (shared) handover_ = std::make_unique<live::Handover>(*device_);
  ++e_.window_devices;
  e_.shared_queues = shared ? device_->queues : 0;
}

// The window's device is lost, or the one that it shares. Another takes its place with all that is kept in host memory;
// the renderer waits for Restart, as always.
void App::reopen(const std::string& why) {
  const bool shared = handover_ != nullptr;
  if (shared) {
    worker_->release();
    take_events();
    if (!e_.device_lost) {
      live::Event event{.kind = live::EventKind::DeviceLost, .text = why};
      take_event(e_, event);
    }
  }
  if (e_.picture.image) e_.picture.image = nullptr, e_.hashed_frame = 0;
  if (window_) window_->detach();
  handover_.reset();
  messages_ += device_->take_messages().size();
  const std::unique_ptr<gpu::Device> old_device = std::move(device_);
  const std::unique_ptr<ui::Renderer> old_pictures = std::move(pictures_);
  open_device();
  pictures_ = std::make_unique<ui::Renderer>(*device_);
  pictures_->adopt(*old_pictures);
  e_.pictures = pictures_.get();
  if (window_) window_->attach(*device_);
  if (handover_) worker_->lend(*handover_);
  shown_ = {};
  font_ready_ = false;
}

void App::load_fonts() {
  ImGuiIO& io = ImGui::GetIO();
  const float scale = e_.scale();
  io.Fonts->Clear();
  const char* file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  const float pixels = std::round(14 * scale);
  if (!fs::exists(file) || !io.Fonts->AddFontFromFileTTF(file, pixels)) {
    ImFontConfig config;
    config.SizePixels = std::round(13 * scale);
    io.Fonts->AddFontDefault(&config);
  }
  pictures_->set_font(*io.Fonts);
  apply_theme(scale);
  font_ready_ = true;
  e_.rebuild_fonts = false;
}

// What was said of a device that was lost.
std::string App::take_events() {
  std::string lost;
  for (live::Event& event : worker_->take_events()) {
    if (event.kind == live::EventKind::DeviceLost) lost = event.text;
    if (event.copy && refiner_) refiner_->take_scene(e_, std::move(event.copy));
    take_event(e_, event);
  }
  return lost;
}

void App::take() {
  for (std::string& line : log_->take()) {
    e_.log.push_back(std::move(line));
    if (e_.log.size() > 5000) e_.log.pop_front();
  }
  if (const std::string lost = take_events(); !lost.empty() && handover_) reopen(lost);
  if (std::optional<live::Published> frame = worker_->take()) {
    if (refiner_ && !frame->layers.empty()) refiner_->take_layers(e_, *frame);
    take_frame(e_, std::move(*frame));
  }
}

// --- to the renderer

// What changed since the last frame of the interface goes out as one value.
void App::ask() {
  live::Wanted& w = e_.wanted;
  Document& d = e_.document;
  const bool settings = !same(d.settings, sent_.settings) || e_.reference.split_on() != w.bare,
             lights = !same(d.lights, sent_.lights), seed = d.seed != sent_.seed;
  if (settings || lights || seed) sent_ = d;
  if (settings || lights || seed || e_.view.moved) e_.last_change = e_.now;
  const Viewport& v = e_.viewport;
  const bool moving = e_.now - e_.last_change < 0.3;
  // Another size would begin another history.
  const float scale = moving && !e_.freeze.history ? std::min(e_.preferences.moving_scale, e_.preferences.render_scale)
                                                   : e_.preferences.render_scale;
  const glm::uvec2 size = glm::max(glm::uvec2(glm::round(glm::vec2(v.width, v.height) * scale)), 1u);
  SliceView& s = e_.slices;
  if (!s.on) s.seen.reset();
  const std::optional<glm::uvec2> inspect =
      s.on && !s.frozen ? std::optional(glm::min(glm::uvec2(e_.picking.place * glm::vec2(size)), size - 1u))
                        : std::nullopt;
  // What is pointed at goes before the texture panel's.
  const Preview* preview = preview_of(e_);
  const std::optional<live::ProbeWanted> probe = preview && preview->probe ? preview->probe : e_.texture_asked;
  const std::vector<std::string>& layers = e_.reference.wanted_layers;
  const bool more_layers = std::any_of(layers.begin(), layers.end(), [&](const std::string& layer) {
    return std::find(w.layers.begin(), w.layers.end(), layer) == w.layers.end();
  });
  // Halves of frames are averaged for the error's parts: their noise has to differ.
  const bool hold_history = e_.freeze.history && !e_.reference.split_on(),
             hold_noise = e_.freeze.noise && !e_.reference.split_on(),
             hold_culling = e_.freeze.culling != w.culling_camera.has_value();
  const bool frozen = hold_history != w.hold_history || hold_noise != w.hold_noise || hold_culling;
  w.hold_history = hold_history;
  w.hold_noise = hold_noise;
  if (hold_culling) w.culling_camera = e_.freeze.culling ? std::optional(e_.view.camera) : std::nullopt;
  if (frozen && !e_.timings.paused) e_.timings.clear();  // frames of another kind
  if (settings || lights || seed) ++w.history;
  if (lights) ++w.lights_revision;
  if (settings || lights || seed || e_.view.moved || size != w.size || v.layer != w.layer ||
      (probe && probe != w.probe) || inspect != w.inspect || more_layers || frozen)
    ++w.revision;
  e_.view.moved = false;
  if (w.revision != e_.shown_revision) e_.frames_since_change = e_.settled = 0;
  w.settings = d.settings;
  w.bare = e_.reference.split_on();
  if (w.bare) w.settings.switch_off_reconstruction();
  w.lights = d.lights;
  w.seed = d.seed;
  w.camera = e_.view.camera;
  w.size = size;
  w.layer = v.layer;
  w.moving = moving;
  w.reduced = scale < e_.preferences.render_scale;
  const size_t timed = e_.timings.run.frames.size(), wanted = size_t(e_.preferences.capture_frames);
  w.settle = std::max(uint32_t(e_.preferences.settle),
                      e_.recording && timed < wanted ? e_.settled + uint32_t(wanted - timed) : 0);
  w.probe = probe;
  w.inspect = inspect;
  w.layers = layers;
  if (e_.picking.asked) {
    e_.picking.asked = false;
    e_.picking.values = {};
    e_.picking.size = size;
    w.pick = e_.picking.pixel = glm::min(glm::uvec2(e_.picking.place * glm::vec2(size)), size - 1u);
    ++w.pick_serial;
  }
  worker_->want(w);
  for (live::Command& command : e_.outbox) {
    if (command.kind == live::CommandKind::ReloadShaders) reload_window({});
    worker_->send(std::move(command));
  }
  e_.outbox.clear();
}

void App::open_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (!fs::exists(path)) {
    toast(e_, fmt::format("cannot open '{}': no such file", path), true);
  } else if (extension == ".glb" || extension == ".gltf") {
    e_.outbox.push_back({live::CommandKind::LoadScene, path, view_beside(path), {}});
  } else if (extension == ".hdr" || extension == ".exr") {
    e_.outbox.push_back({live::CommandKind::LoadEnvironment, path, {}, {}});
  } else if (extension == ".json") {
    try {
      Preset preset = read_preset(path);
      if (needs_load(preset, e_)) {
        const scene::View* inside = view_inside(preset);
        e_.outbox.push_back({live::CommandKind::LoadScene, preset.scene ? *preset.scene : e_.scene.path,
                             view_name(preset), inside ? std::optional(*inside) : std::nullopt});
        e_.pending_preset = std::move(preset);
      } else {
        apply_preset(preset, e_.document);
        if (const scene::View* inside = view_inside(preset)) {
          if (inside->camera) go_to(e_, *inside->camera);
          e_.document.lights = e_.scene.own_lights;
          use_lights(*inside, e_.document.lights);
        }
      }
      e_.preset_path = path;
      toast(e_, "preset " + fs::path(path).stem().string());
    } catch (const std::exception& error) {
      toast(e_, error.what(), true);
    }
  } else {
    toast(e_,
          fmt::format(
              "'{}' is no file for this window: .glb and .gltf are scenes, .hdr and .exr environments, .json presets",
              fs::path(path).filename().string()),
          true);
  }
}

// What the panels and actions asked for and only this can do.
void App::serve() {
  for (const std::string& path : std::exchange(e_.dropped, {})) open_file(path);
  if (std::exchange(e_.keep_a, false) && pictures_->copy(ui::PictureId::Scene, ui::PictureId::SlotA)) {
    if (refiner_) refiner_->keep_a(e_);
    toast(e_, "kept as A");
  }
  if (!screenshot_.empty()) write_window(std::exchange(screenshot_, {}), e_, shown_, screenshot_part_);
  write_captures(e_, shown_, o_.validation);
  if (std::exchange(e_.fullscreen_asked, false) && window_) window_->toggle_fullscreen();
  if (e_.now - kept_at_ > 5) {
    kept_at_ = e_.now;
    keep_settings();
  }
}

void App::keep_settings() {
  if (const std::string problem = save_settings(e_); !problem.empty()) log::warn("{}", problem);
}

// The window's own programs; the renderer sees to the scene's. What does not compile stays as it was.
void App::reload_window(const std::vector<std::string>& changed) {
  const gpu::Reload result = pictures_->reload(changed);
  if (!result.errors.empty()) {
    e_.banner = {"The window's shaders do not compile; the last good ones stay in use.", result.errors};
    window_broken_ = true;
    for (const gpu::ReloadError& fault : result.errors)
      log::error("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.message);
  } else if (result.recompiled > 0) {
    if (std::exchange(window_broken_, false)) e_.banner = {};
    e_.green_flash = e_.now;
    e_.flash_text = fmt::format("{} programs of the window compiled in {:.0f} ms", result.recompiled, result.ms);
    log::info("{}", e_.flash_text);
  }
}

void App::on_input(const ui::InputEvent& event) {
  switch (event.kind) {
    case ui::InputKind::Key:
      run_shortcut(e_, event.code, event.mods,
                   ImGui::GetIO().WantTextInput ? Focus::Text
                   : ImGui::IsMouseDown(1)      ? Focus::Flight
                   : ImGui::GetIO().NavVisible  ? Focus::Widget
                                                : Focus::Nothing);
      break;
    case ui::InputKind::Drop:
      e_.dropped.push_back(event.text);
      break;
    case ui::InputKind::Resize:
      e_.window = {uint32_t(std::max(event.x, 0.0f)), uint32_t(std::max(event.y, 0.0f))};
      if (window_ && window_->size() != e_.window && e_.window.x > 0) window_->set_size(e_.window);
      break;
    case ui::InputKind::Scale:
      e_.display_scale = event.x;
      e_.rebuild_fonts = true;
      break;
    case ui::InputKind::Close:
      e_.quit = true;
      break;
    default:
      break;
  }
}

// --- the loop

void App::frame() {
  const double started = clock(), before = e_.now;
  e_.now = started;
  take();
  if (!input_.empty()) e_.last_input = e_.now;
  input_.feed([this](const ui::InputEvent& event) { on_input(event); });
  if (e_.now - watched_at_ > 0.2) {
    watched_at_ = e_.now;
    if (!watch_) watch_.emplace(gpu::find_shader_folder());
    if (const std::vector<std::string> changed = watch_->changed(); !changed.empty()) reload_window(changed);
  }
  if (!flip_ && shows_flip(e_)) flip_ = std::make_unique<LiveFlip>();
  if (flip_) update_flip(e_, *flip_);
  if (!font_ready_ || e_.rebuild_fonts) load_fonts();
  if (window_) e_.window = window_->size();
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(float(std::max(e_.window.x, 1u)), float(std::max(e_.window.y, 1u)));
  io.DeltaTime = std::max(float(e_.now - before), 1e-4f);
  ui::widgets().clear();
  e_.texture_visible = e_.pixel_visible = false;
  e_.shown_preview = std::exchange(e_.pointed, std::nullopt);
  ImGui::NewFrame();
  draw_layout(e_);
  ImGui::Render();
  e_.texture_asked = e_.texture_visible && !e_.texture.frozen && !e_.texture.wanted.resource.empty()
                         ? std::optional(e_.texture.wanted)
                         : std::nullopt;
  if (e_.window.x > 0 && e_.window.y > 0) {
    shown_ = pictures_->draw(*ImGui::GetDrawData(), e_.window);
    if (window_) window_->present(e_.window, shown_);
  }
  ++e_.ui_frames;
  e_.ui_ms = float((clock() - started) * 1e3);
  e_.ui_history.push_back(e_.ui_ms);
  e_.ui_periods.push_back(io.DeltaTime * 1e3f);
  for (std::deque<float>* times : {&e_.ui_history, &e_.ui_periods})
    if (times->size() > TimingHistory::limit) times->pop_front();
  if (e_.scene_ready) e_.undo.watch(e_.document, ImGui::IsAnyItemActive());
  serve();
  if (e_.reference.on && !refiner_) {
    refiner_ = std::make_unique<Refiner>();
    refiner_->keep_a(e_);
  }
  if (refiner_) refiner_->update(e_);
  ask();
  if (window_) {
    const std::string title = fmt::format("Nearfield - {}", fs::path(e_.scene.path).filename().string());
    if (title != title_) window_->set_title(title_ = title);
  }
}

// 60 frames a second after input, 4 when nothing happens. While the scene is rendered 30; when nobody has touched the
// window for two seconds down to 20, where the processor draws it: half of the time is the scene's then.
void App::pace(double started) {
  const double since_input = e_.now - e_.last_input;
  const bool busy = !worker_->idle() || !e_.toasts.empty() || e_.viewport.compare == CompareMode::Blink ||
                    e_.slices.playing || e_.flip.busy || e_.now - e_.green_flash < 2;
  const double unwatched = std::clamp(2e-3 * double(e_.ui_ms), 1.0 / 30, 1.0 / 20);
  const double period = since_input < 0.5 ? 1.0 / 60 : !busy ? 0.25 : since_input < 2 ? 1.0 / 30 : unwatched;
  const double left = period - (clock() - started);
  if (window_)
    window_->poll(std::max(left, 0.0));
  else if (left > 0)
    std::this_thread::sleep_for(std::chrono::duration<double>(left));
}

// A frame, and what a script and a state file make of it.
void App::step() {
  frame();
  if (!script_ && o_.ui_state.empty()) return;
  json state = make_state(e_, worker_->idle() && e_.settled >= e_.wanted.settle);
  if (!o_.ui_state.empty()) {
    const std::string text = state.dump(1) + "\n";
    if (text != state_text_) write_atomically(o_.ui_state, state_text_ = text);
  }
  state["seconds"] = clock();
  if (script_ && script_->step(clock(), state, input_)) {
    if (!script_->failure().empty() || input_.empty()) e_.quit = true;
  }
  serve();
}

void App::loop() {
  for (int lost_in_a_row = 0; !e_.quit && !interrupted();) {
    const double started = clock();
    try {
      step();
      lost_in_a_row = 0;
    } catch (const Error& error) {
      if (error.exit() != Exit::Gpu || ++lost_in_a_row > 3) throw;
      log::error("{}", error.what());
      reopen(error.what());
    }
    pace(started);
  }
}

int App::run() {
  open();
  try {
    loop();
  } catch (...) {
    keep_settings();  // whatever it was, nothing of the user's is lost
    throw;
  }
  keep_settings();
  uint64_t messages = messages_ + worker_->messages();
  refiner_.reset();
  flip_.reset();
  worker_.reset();
  window_.reset();
  pictures_.reset();
  handover_.reset();
  messages += device_->take_messages().size();
  ImGui::DestroyContext();
  std::erase(spdlog::default_logger()->sinks(), std::shared_ptr<spdlog::sinks::sink>(log_));
  if (script_ && !script_->failure().empty()) fail(Exit::CheckFailed, "{}", script_->failure());
  if (messages) fail(Exit::CheckFailed, "{} validation messages (above)", messages);
  return interrupted() ? int(Exit::Interrupted) : int(Exit::Ok);
}

}  // namespace

const Preview* preview_of(const Editor& editor) {
  const std::optional<Preview>& preview = editor.shown_preview ? editor.shown_preview : editor.locked_preview;
  return preview ? &*preview : nullptr;
}

std::string text_of(const Freeze& freeze) {
  std::string text;
  for (const auto& [on, name] :
       {std::pair(freeze.history, "history"), std::pair(freeze.noise, "noise"), std::pair(freeze.culling, "culling")})
    if (on) text += fmt::format("{}{}", text.empty() ? "" : ", ", name);
  return text;
}

void toast(Editor& editor, std::string text, bool bad) {
  editor.toasts.push_back({std::move(text), editor.now + (bad ? 8 : 3.5), bad});
}

int run_editor(EditOptions& options) {
  return App(options).run();
}

}  // namespace nf::editor
