#include "app.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <imgui.h>
#include <map>
#include <spdlog/sinks/base_sink.h>
#include <thread>

#include "actions.h"
#include "capture/csv.h"
#include "capture/trace.h"
#include "cli/measure.h"
#include "core/fingerprint.h"
#include "core/log.h"
#include "image/file.h"
#include "layout.h"
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

std::string file_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", &parts);
  return text;
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
  void load_fonts();
  void frame();
  void take_events();
  void take_event(live::Event& event);
  void take_frame(live::Published&& frame);
  void show_scene(live::SceneInfo&& scene);
  void open_file(const std::string& path);
  void ask();
  void serve();
  void capture();
  void on_input(const ui::InputEvent& event);
  void pace(double started);
  double clock() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  image::Image8 window_picture() const;
  std::string new_file(const std::string& name);

  EditOptions& o_;
  Editor e_;
  ui::InputQueue input_;
  std::shared_ptr<LogLines> log_ = std::make_shared<LogLines>();
  std::unique_ptr<Window> window_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<ui::Renderer> pictures_;
  std::unique_ptr<live::Worker> worker_;
  std::unique_ptr<ui::Script> script_;
  std::unique_ptr<Refiner> refiner_;
  std::optional<Preset> pending_preset_;  // for the scene that is being loaded
  Document sent_;
  live::Wanted last_;
  std::span<const std::byte> shown_;
  std::string screenshot_, state_text_, title_;
  double kept_at_ = 0;
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
        o_.ui_script, ui::Script::Host{[this](const std::string& path) { screenshot_ = path; },
                                       [this] {
                                         e_.outbox.push_back({live::CommandKind::LoseDevice, {}, {}, {}});
                                       },
                                       [this] { e_.quit = true; }});
  gpu::DeviceOptions device = device_options(o_);
  if (!o_.offscreen) {
    window_ = std::make_unique<Window>(size, "Nearfield", input_);
    device.window_extensions = window_->extensions();
    e_.display_scale = window_->scale();
    io.SetClipboardTextFn = [](void* user, const char* text) { static_cast<Window*>(user)->set_clipboard(text); };
    io.GetClipboardTextFn = [](void* user) {
      static std::string kept;
      kept = static_cast<Window*>(user)->clipboard();
      return kept.c_str();
    };
    io.ClipboardUserData = window_.get();
  }
  // The scene's device is opened by its own thread, at the same time.
  worker_ = std::make_unique<live::Worker>(live::WorkerOptions{device_options(o_), executor_options(o_)});
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
    if (scene.empty() && preset.scene) scene = *preset.scene;
    if (const scene::View* inside = view_inside(preset); inside && !o_.view_given) lit = *inside;
  }
  if (scene.empty()) scene = e_.bundled_scene;
  if (scene.empty()) fail(Exit::Input, "the bundled scene was not found; name one: nearfield edit scene.glb");
  if (!fs::exists(scene)) fail(Exit::Input, "cannot open the scene '{}': no such file", scene);
  worker_->send({live::CommandKind::LoadScene, scene, o_.view.empty() && !lit ? view_beside(scene) : o_.view, lit});

  device_ = std::make_unique<gpu::Device>(device);
  pictures_ = std::make_unique<ui::Renderer>(*device_);
  if (window_) window_->attach(*device_);
  e_.pictures = pictures_.get();
  e_.input = &input_;
  e_.window = window_ ? window_->size() : size;
  if (const std::string problem = load_settings(e_, o_.reset_settings); !problem.empty()) toast(e_, problem, true);
  if (o_.ui_scale > 0) e_.preferences.ui_scale = o_.ui_scale;
  sent_ = e_.document;
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

// --- from the renderer

void App::show_scene(live::SceneInfo&& scene) {
  e_.scene = std::move(scene);
  e_.scene_ready = true;
  e_.document.lights = e_.scene.lights;
  e_.document.bookmarks = load_bookmarks(e_.scene.path);
  if (pending_preset_) {
    try {
      apply_preset(*pending_preset_, e_.document);
    } catch (const Error& error) {
      toast(e_, error.what(), true);
    }
    pending_preset_.reset();
  }
  go_to(e_, e_.scene.start);
  e_.undo.start(e_.document);
  e_.picking = {};
  e_.wanted.scene = e_.scene.serial;
  ++e_.wanted.lights_revision;
  ++e_.wanted.history;
  ++e_.wanted.revision;
  e_.timings.clear();
}

void App::take_event(live::Event& event) {
  switch (event.kind) {
    case live::EventKind::DeviceOpened:
      e_.device = event.text;
      e_.software = event.software;
      e_.device_context = std::move(event.context);
      if (e_.software && !e_.preferences.scale_chosen) e_.preferences.render_scale = 0.5f;
      if (e_.device_lost) toast(e_, "the renderer was started anew");
      if (e_.device_lost) e_.banner = {};
      e_.device_lost = false;
      break;
    case live::EventKind::SceneLoading:
      toast(e_, "loading " + fs::path(event.text).filename().string());
      break;
    case live::EventKind::SceneLoaded:
      show_scene(std::move(event.scene));
      break;
    case live::EventKind::SceneCopied:
      if (refiner_) refiner_->take_scene(e_, std::move(event.copy));
      break;
    case live::EventKind::EnvironmentLoaded:
      e_.scene.environment = std::move(event.scene.environment);
      e_.scene.own_environment = false;
      toast(e_, "environment " + fs::path(event.text).filename().string());
      break;
    case live::EventKind::Failed:
      log::error("{}", event.text);
      toast(e_, event.text, true);
      e_.banner = {event.text, {}};
      break;
    case live::EventKind::ShaderBroken:
      log::error("{}", event.text);
      e_.banner = {event.text, std::move(event.faults)};
      for (const gpu::ReloadError& fault : e_.banner.faults)
        log::error("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.message);
      break;
    case live::EventKind::ShadersLoaded:
      e_.banner = {};
      e_.green_flash = e_.now;
      e_.flash_text = fmt::format("{} in {:.0f} ms", event.text, event.ms);
      log::info("{}", e_.flash_text);
      break;
    case live::EventKind::Mended:
      e_.banner = {};
      break;
    case live::EventKind::Saved:
      toast(e_, "written: " + event.text);
      break;
    case live::EventKind::DeviceLost:
      log::error("{}", event.text);
      e_.device_lost = true;
      e_.banner = {event.text + "\nNothing of yours is lost.", {}};
      break;
  }
}

void App::take_frame(live::Published&& frame) {
  e_.scene_frames = frame.number;
  e_.frames_since_change = frame.revision == e_.wanted.revision ? frame.settled : 0;
  e_.shown_revision = frame.revision;
  e_.settled = frame.revision == e_.wanted.revision ? frame.settled : 0;
  e_.scene_time = frame.time;
  e_.scene_ms = frame.frame_ms;
  e_.timings.add(frame);
  if (frame.graph) {
    if (!frame.graph->diff.empty()) e_.plan_diff = frame.graph->diff;
    e_.graph = std::move(*frame.graph);
  }
  if (frame.compared && refiner_) refiner_->compare(e_, std::move(*frame.compared));
  if (frame.picked) e_.picking.values = std::move(*frame.picked);
  if (!e_.texture.frozen) {
    e_.texture.error = frame.probe_error;
    if (frame.probe) {
      e_.texture.pixels = std::move(*frame.probe);
      pictures_->set_picture(ui::PictureId::Texture, e_.texture.pixels.size,
                             std::span<const float>(e_.texture.pixels.floats));
    }
  }
  e_.picture = std::move(frame.picture);
  Fingerprint hash;
  hash.add(e_.picture.rgba);
  hash.add(e_.picture.floats);
  e_.picture_hash = hash.value();
  if (!e_.picture.rgba.empty())
    pictures_->set_picture(ui::PictureId::Scene, e_.picture.size, std::span<const uint8_t>(e_.picture.rgba));
  else
    pictures_->set_picture(ui::PictureId::Scene, e_.picture.size, std::span<const float>(e_.picture.floats));
}

void App::take_events() {
  for (std::string& line : log_->take()) {
    e_.log.push_back(std::move(line));
    if (e_.log.size() > 5000) e_.log.pop_front();
  }
  for (live::Event& event : worker_->take_events()) take_event(event);
  if (std::optional<live::Published> frame = worker_->take()) take_frame(std::move(*frame));
}

// --- to the renderer

// What changed since the last frame of the interface goes out as one value.
void App::ask() {
  live::Wanted& w = e_.wanted;
  Document& d = e_.document;
  const bool settings = !same(d.settings, sent_.settings), lights = !same(d.lights, sent_.lights),
             seed = d.seed != sent_.seed;
  if (settings || lights || seed) sent_ = d;
  if (settings || lights || seed || e_.view.moved) e_.last_change = e_.now;
  const Viewport& v = e_.viewport;
  const bool moving = e_.now - e_.last_change < 0.3;
  const float scale =
      moving ? std::min(e_.preferences.moving_scale, e_.preferences.render_scale) : e_.preferences.render_scale;
  const glm::uvec2 size = glm::max(glm::uvec2(glm::round(glm::vec2(v.width, v.height) * scale)), 1u);
  if (settings || lights || seed) ++w.history;
  if (lights) ++w.lights_revision;
  if (settings || lights || seed || e_.view.moved || size != w.size || v.layer != w.layer ||
      e_.texture_asked != w.probe || (e_.reference.on && w.compared != e_.reference.layer))
    ++w.revision;
  e_.view.moved = false;
  if (w.revision != e_.shown_revision) e_.frames_since_change = e_.settled = 0;
  w.settings = d.settings;
  w.lights = d.lights;
  w.seed = d.seed;
  w.camera = e_.view.camera;
  w.size = size;
  w.layer = v.layer;
  w.moving = moving;
  w.settle = uint32_t(e_.preferences.settle);
  w.probe = e_.texture_asked;
  w.compared = e_.reference.on ? std::optional(e_.reference.layer) : std::nullopt;
  if (e_.picking.asked) {
    e_.picking.asked = false;
    e_.picking.values = {};
    w.pick = e_.picking.pixel;
    ++w.pick_serial;
  }
  worker_->want(w);
  for (live::Command& command : e_.outbox) worker_->send(std::move(command));
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
      const bool other = preset.scene && e_.scene_ready && !fs::equivalent(*preset.scene, e_.scene.path);
      if (other) {
        const scene::View* inside = view_inside(preset);
        e_.outbox.push_back({live::CommandKind::LoadScene, *preset.scene, view_name(preset),
                             inside ? std::optional(*inside) : std::nullopt});
        pending_preset_ = std::move(preset);
      } else {
        apply_preset(preset, e_.document);
        if (const scene::View* inside = view_inside(preset)) {
          if (inside->camera) go_to(e_, *inside->camera);
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

// --- files

std::string App::new_file(const std::string& name) {
  fs::create_directories("captures");
  return (fs::path("captures") / name).string();
}

image::Image8 App::window_picture() const {
  image::Image8 out{e_.window.x, e_.window.y, 3, {}};
  for (size_t i = 0; i + 3 < shown_.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) out.pixels.push_back(uint8_t(shown_[i + c]));
  return out;
}

void App::capture() {
  capture::Run& run = e_.timings.run;
  if (run.frames.empty()) return toast(e_, "no frame was timed yet", true);
  const std::string folder = new_file("timing-" + file_time());
  fs::create_directories(folder);
  run.name = run.technique = e_.document.settings.technique->id;
  passes::FrameView view;
  view.size = e_.picture.size;
  view.seed = e_.document.seed;
  run.settings = settings_json({.name = run.name,
                                .settings = e_.document.settings,
                                .mode = is_paper_mode(e_.document.settings) ? "paper" : "radiometric"},
                               view);
  run.scene = {{"path", e_.scene.path}, {"triangles", e_.scene.triangles}};
  run.memory = {{"placed_bytes", e_.graph.placed},
                {"max_live_bytes", e_.graph.max_live},
                {"unaliased_bytes", e_.graph.unaliased}};
  const capture::Summary summary = capture::summarise(run);
  capture::Trust trust = capture::judge(
      run, summary,
      {.load = {}, .software_device = e_.software, .debug_build = build_info().debug, .validation = o_.validation});
  trust.noisy.push_back("captured in the editor: its own frames ran beside these");
  const std::vector<capture::RunResult> results{{&run, summary, trust}};
  json context = e_.device_context;
  context["ui"] = true;
  const json method = {{"timing", "serialize"},
                       {"frames", run.frames.size()},
                       {"warmup_frames", 0},
                       {"settle_frames", 0},
                       {"repeats", 1},
                       {"interleaved", false},
                       {"percentile", "nearest-rank"},
                       {"clock", "gpu-timestamps"},
                       {"frames_in_flight", 1},
                       {"fps", 0},
                       {"path", nullptr}};
  write_atomically(fs::path(folder) / "timing.json",
                   capture::timing_document(context, method, results, true).dump(1) + "\n");
  write_atomically(fs::path(folder) / "summary.csv", capture::summary_csv(results));
  capture::FramesCsv frames(fs::path(folder) / "frames.csv");
  for (const capture::FrameSample& sample : run.frames) frames.add(run, sample);
  capture::Run shifted = run;  // a trace begins near zero
  const int64_t first = run.frames.front().submit_ns;
  for (capture::FrameSample& sample : shifted.frames) sample.submit_ns -= first, sample.gpu_begin_ns = sample.submit_ns;
  write_atomically(fs::path(folder) / "trace.json",
                   capture::trace_document({&shifted}, {{"device", e_.device}}, false).dump() + "\n");
  toast(e_, "written: " + folder);
}

// What the panels and actions asked for and only this can do.
void App::serve() {
  for (const std::string& path : std::exchange(e_.dropped, {})) open_file(path);
  if (std::exchange(e_.keep_a, false) && !e_.picture.rgba.empty()) {
    pictures_->set_picture(ui::PictureId::SlotA, e_.picture.size, std::span<const uint8_t>(e_.picture.rgba));
    toast(e_, "kept as A");
  }
  try {
    if (!e_.save_preset.empty()) {
      const std::string path = std::exchange(e_.save_preset, {});
      write_preset(path, make_preset(e_));
      e_.preset_path = path;
      toast(e_, "saved: " + path);
    }
    const bool window = std::exchange(e_.screenshot_window, false),
               viewport = std::exchange(e_.screenshot_viewport, false);
    if (window || viewport) {
      const std::string path = new_file(fmt::format("{}-{}.png", window ? "window" : "picture", file_time()));
      image::Image8 picture = window_picture();
      if (!window) {
        picture = {e_.picture.size.x, e_.picture.size.y, 3, {}};
        for (size_t i = 0; i + 3 < e_.picture.rgba.size(); i += 4)
          picture.pixels.insert(picture.pixels.end(), &e_.picture.rgba[i], &e_.picture.rgba[i] + 3);
      }
      image::write_png(path, picture);
      write_preset(fs::path(path).replace_extension(".json"), make_preset(e_));
      toast(e_, "written: " + path);
    }
    if (!screenshot_.empty()) image::write_png(std::exchange(screenshot_, {}), window_picture());
    if (std::exchange(e_.save_curve, false)) {
      std::string text = "spp,rmse,noise\n";
      for (const ReferenceView::Point& p : e_.reference.curve)
        text += fmt::format("{},{},{}\n", p.spp, p.rmse, p.floor);
      const std::string path = new_file(fmt::format("convergence-{}.csv", file_time()));
      write_atomically(path, text);
      toast(e_, "written: " + path);
    }
    if (std::exchange(e_.capture_asked, false)) capture();
    if (std::exchange(e_.save_layers, false))
      e_.outbox.push_back({live::CommandKind::SaveLayers, new_file(fmt::format("layers-{}.exr", file_time())), {}, {}});
    if (!e_.save_texture.empty()) {
      const std::string ending = std::exchange(e_.save_texture, {});
      const live::Pixels& p = e_.texture.pixels;
      std::string name = p.name;
      std::replace(name.begin(), name.end(), '/', '_');
      const std::string path = new_file(fmt::format("{}-{}{}", name, file_time(), ending));
      save_pixels(path, p, e_.texture.look);
      toast(e_, "written: " + path);
    }
  } catch (const std::exception& error) {
    toast(e_, error.what(), true);
  }
  if (std::exchange(e_.copy_command, false)) {
    const std::string command = command_for(e_);
    ImGui::SetClipboardText(command.c_str());
    log::info("{}", command);
    toast(e_, "copied: " + command);
  }
  if (std::exchange(e_.fullscreen_asked, false) && window_) window_->toggle_fullscreen();
  if (e_.now - kept_at_ > 5) {
    kept_at_ = e_.now;
    if (const std::string problem = save_settings(e_); !problem.empty()) log::warn("{}", problem);
  }
}

void App::on_input(const ui::InputEvent& event) {
  switch (event.kind) {
    case ui::InputKind::Key:
      run_shortcut(e_, event.code, event.mods,
                   ImGui::GetIO().WantTextInput || input_.held(-1) || ImGui::IsMouseDown(1));
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
  take_events();
  if (!input_.empty()) e_.last_input = e_.now;
  input_.feed([this](const ui::InputEvent& event) { on_input(event); });
  if (!font_ready_ || e_.rebuild_fonts) load_fonts();
  if (window_) e_.window = window_->size();
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(float(std::max(e_.window.x, 1u)), float(std::max(e_.window.y, 1u)));
  io.DeltaTime = std::max(float(e_.now - before), 1e-4f);
  ui::widgets().clear();
  e_.texture_visible = false;
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
  if (e_.scene_ready) e_.undo.watch(e_.document, ImGui::IsAnyItemActive());
  serve();
  if (e_.reference.on && !refiner_) refiner_ = std::make_unique<Refiner>();
  if (refiner_) refiner_->update(e_);
  ask();
  if (window_) {
    const std::string title = fmt::format("Nearfield - {}", fs::path(e_.scene.path).filename().string());
    if (title != title_) window_->set_title(title_ = title);
  }
}

// 60 frames a second after input, 30 while the scene is rendered, 4 when nothing happens.
void App::pace(double started) {
  const double since_input = e_.now - e_.last_input;
  const bool busy = !worker_->idle() || !e_.toasts.empty() || e_.viewport.compare == CompareMode::Blink ||
                    e_.now - e_.green_flash < 2;
  const double period = since_input < 0.5 || script_ ? 1.0 / 60 : busy ? 1.0 / 30 : 0.25;
  const double left = period - (clock() - started);
  if (window_)
    window_->poll(std::max(left, 0.0));
  else if (left > 0)
    std::this_thread::sleep_for(std::chrono::duration<double>(left));
}

int App::run() {
  open();
  uint64_t messages = 0;
  while (!e_.quit && !interrupted()) {
    const double started = clock();
    frame();
    if (script_ || !o_.ui_state.empty()) {
      const json state = make_state(e_, worker_->idle() && e_.settled >= e_.wanted.settle);
      if (!o_.ui_state.empty()) {
        const std::string text = state.dump(1) + "\n";
        if (text != state_text_) write_atomically(o_.ui_state, state_text_ = text);
      }
      if (script_ && script_->step(clock(), state, input_)) {
        if (!script_->failure().empty()) break;
        if (input_.empty()) e_.quit = true;
      }
      serve();
    }
    pace(started);
  }
  if (const std::string problem = save_settings(e_); !problem.empty()) log::warn("{}", problem);
  messages = worker_->messages() + device_->take_messages().size();
  refiner_.reset();
  worker_.reset();
  messages += device_->take_messages().size();
  window_.reset();
  pictures_.reset();
  ImGui::DestroyContext();
  std::erase(spdlog::default_logger()->sinks(), std::shared_ptr<spdlog::sinks::sink>(log_));
  if (script_ && !script_->failure().empty()) fail(Exit::CheckFailed, "{}", script_->failure());
  if (messages) fail(Exit::CheckFailed, "{} validation messages (above)", messages);
  return interrupted() ? int(Exit::Interrupted) : int(Exit::Ok);
}

}  // namespace

void toast(Editor& editor, std::string text, bool bad) {
  editor.toasts.push_back({std::move(text), editor.now + (bad ? 8 : 3.5), bad});
}

int run_editor(EditOptions& options) {
  return App(options).run();
}

}  // namespace nf::editor
