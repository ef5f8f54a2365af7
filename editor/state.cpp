#include "state.h"

#include <fstream>
#include <imgui.h>
#include <imgui_internal.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/fingerprint.h"
#include "ui/widgets.h"

namespace nf::editor {

using nlohmann::json;

namespace {

json percentiles(const std::deque<float>& ms) {
  const capture::Statistics s = capture::statistics({ms.begin(), ms.end()});
  return {{"count", s.count}, {"median", s.median}, {"p95", s.p95}, {"max", s.max}};
}

void hash_picture(Editor& e) {
  if (e.hashed_frame == e.scene_frames) return;
  Fingerprint hash;
  hash.add(e.picture.image ? e.pictures->texels(ui::PictureId::Scene) : e.picture.rgba);
  hash.add(e.picture.floats);
  e.picture_hash = hash.value();
  e.hashed_frame = e.scene_frames;
}

}  // namespace

json make_state(Editor& e, bool idle) {
  hash_picture(e);
  json widgets = json::object();
  for (const auto& [id, w] : ui::widgets())
    widgets[id] = {
        {"rect", {w.x, w.y, w.width, w.height}}, {"value", w.value}, {"enabled", w.enabled}, {"visible", w.visible}};
  json toasts = json::array();
  for (const Toast& t : e.toasts) toasts.push_back(t.text);
  json faults = json::array();
  for (const gpu::ReloadError& f : e.banner.faults)
    faults.push_back({{"file", f.file}, {"line", f.line}, {"column", f.column}, {"message", f.message}});
  const std::vector<ParamBlock> blocks = e.document.settings.blocks();
  const scene::Camera& camera = e.view.camera;
  return {{"schema", "nearfield.ui/1"},
          {"ui_frame", e.ui_frames},
          {"window", {e.window.x, e.window.y}},
          {"scale", e.scale()},
          {"scene", e.scene_ready ? e.scene.path : ""},
          {"environment", e.scene.environment.file},
          {"preset", e.preset_path},
          {"scene_frames", e.scene_frames},
          {"scene_frames_since_change", e.frames_since_change},
          {"settled", e.settled},
          {"settle", e.wanted.settle},
          {"idle", idle},
          {"technique", e.document.settings.technique->id},
          {"mode", is_paper_mode(e.document.settings) ? "paper" : "radiometric"},
          {"params", params::to_json(blocks, true)},
          {"changed", params::to_json(blocks)},
          {"layer", e.viewport.layer},
          {"picture_size", {e.picture.size.x, e.picture.size.y}},
          {"picture_hash", e.picture_hash},
          {"picture_kind", e.picture.image            ? "image"
                           : e.picture.floats.empty() ? "bytes"
                                                      : "floats"},
          {"host_bytes", e.host_bytes},
          {"shared_queues", e.shared_queues},
          {"window_devices", e.window_devices},
          {"camera",
           {{"position", {camera.position.x, camera.position.y, camera.position.z}},
            {"forward", {camera.forward.x, camera.forward.y, camera.forward.z}}}},
          {"lights", {{"suns", e.document.lights.directional.size()}, {"lamps", e.document.lights.punctual.size()}}},
          {"undo", e.undo.undos()},
          {"redo", e.undo.redos()},
          {"popup", ImGui::GetCurrentContext()->OpenPopupStack.empty() ? "" : "open"},
          {"toasts", toasts},
          {"banner", e.banner.text},
          {"not_finite", e.not_finite},
          {"faults", faults},
          {"device", e.device},
          {"device_lost", e.device_lost},
          {"scene_ms", e.scene_ms},
          {"ui_ms", e.ui_ms},
          {"ui_frames_ms", percentiles(e.ui_history)},
          {"ui_periods_ms", percentiles(e.ui_periods)},
          {"playing", e.wanted.playing},
          {"steps", e.wanted.steps},
          {"paused", e.wanted.paused},
          {"frozen", text_of(e.freeze)},
          {"scene_time", e.scene_time},
          {"widgets", widgets}};
}

void write_atomically(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path temporary = path.string() + fmt::format(".{}.tmp", ::getpid());
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(temporary, path, error);
  if (!out || error) {
    std::filesystem::remove(temporary, error);
    fail(Exit::Output, "cannot write '{}': is the folder there, and may you write into it?", path.string());
  }
}

}  // namespace nf::editor
