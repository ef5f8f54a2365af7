#include "incoming.h"

#include "captures.h"
#include "core/log.h"
#include "settings.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;

void show_scene(Editor& e, live::SceneInfo&& scene) {
  e.scene = std::move(scene);
  e.scene_ready = true;
  e.document.lights = e.scene.lights;
  e.document.bookmarks = load_bookmarks(e.scene.path);
  if (e.preset_bookmarks) e.document.bookmarks = *std::exchange(e.preset_bookmarks, std::nullopt);
  if (e.pending_preset) {
    try {
      apply_preset(*e.pending_preset, e.document);
    } catch (const Error& error) {
      toast(e, error.what(), true);
    }
    e.pending_preset.reset();
  }
  go_to(e, e.scene.start);
  e.undo.start(e.document);
  e.picking = {};
  e.freeze = {};
  e.wanted.scene = e.scene.serial;
  ++e.wanted.lights_revision;
  ++e.wanted.history;
  ++e.wanted.revision;
  e.timings.clear();
}

}  // namespace

void take_event(Editor& e, live::Event& event) {
  switch (event.kind) {
    case live::EventKind::DeviceOpened:
      e.device = event.text;
      e.software = event.software;
      e.device_context = std::move(event.context);
      if (e.software && !e.preferences.scale_chosen) e.preferences.render_scale = 0.5f;
      if (e.device_lost) toast(e, "the renderer was started anew");
      if (e.device_lost) e.banner = {};
      e.device_lost = false;
      break;
    case live::EventKind::SceneLoading:
      toast(e, "loading " + fs::path(event.text).filename().string());
      break;
    case live::EventKind::SceneLoaded:
      show_scene(e, std::move(event.scene));
      break;
    case live::EventKind::SceneCopied:
      break;  // the refiner's
    case live::EventKind::EnvironmentLoaded:
      e.scene.environment = std::move(event.scene.environment);
      e.scene.own_environment = false;
      toast(e, "environment " + fs::path(event.text).filename().string());
      break;
    case live::EventKind::Failed:
      log::error("{}", event.text);
      toast(e, event.text, true);
      e.banner = {event.text, {}};
      break;
    case live::EventKind::ShaderBroken:
      log::error("{}", event.text);
      e.banner = {event.text, std::move(event.faults)};
      for (const gpu::ReloadError& fault : e.banner.faults)
        log::error("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.message);
      break;
    case live::EventKind::ShadersLoaded:
      e.banner = {};
      if (!e.timings.paused) e.timings.clear();  // other programs' times
      e.green_flash = e.now;
      e.flash_text = fmt::format("{} in {:.0f} ms", event.text, event.ms);
      log::info("{}", e.flash_text);
      break;
    case live::EventKind::Mended:
      e.banner = {};
      break;
    case live::EventKind::Saved:
      take_saved(e, event.text, event.made_with);
      break;
    case live::EventKind::DeviceLost:
      log::error("{}", event.text);
      e.device_lost = true;
      e.banner = {event.text + "\nNothing of yours is lost.", {}};
      break;
  }
}

void take_frame(Editor& e, live::Published&& frame) {
  e.scene_frames = frame.number;
  e.frames_since_change = frame.revision == e.wanted.revision ? frame.settled : 0;
  e.shown_revision = frame.revision;
  e.settled = frame.revision == e.wanted.revision ? frame.settled : 0;
  e.scene_time = frame.time;
  e.scene_ms = frame.frame_ms;
  if (frame.graph) {
    if (!frame.graph->diff.empty()) e.plan_diff = frame.graph->diff;
    e.graph = std::move(*frame.graph);
  }
  if (e.timings.add(frame))
    e.timings.run.memory = {
        {"placed_bytes", e.graph.placed}, {"max_live_bytes", e.graph.max_live}, {"unaliased_bytes", e.graph.unaliased}};
  if (frame.inspected && e.slices.on && !e.slices.frozen) e.slices.seen = std::move(frame.inspected);
  if (frame.picked) e.picking.values = std::move(*frame.picked);
  const Preview* preview = preview_of(e);
  if (frame.probe_of && preview && preview->probe == frame.probe_of) {
    e.fetched.of = *frame.probe_of;
    e.fetched.error = frame.probe_error;
    e.fetched.pixels = frame.probe ? std::move(*frame.probe) : live::Pixels{};
    if (frame.probe)
      e.pictures->set_picture(ui::PictureId::Preview, e.fetched.pixels.size,
                              std::span<const float>(e.fetched.pixels.floats));
  } else if (!e.texture.frozen && (!frame.probe_of || *frame.probe_of == e.texture.wanted)) {
    e.texture.error = frame.probe_error;
    if (frame.probe) {
      e.texture.pixels = std::move(*frame.probe);
      e.texture.of = frame.probe_of.value_or(e.texture.wanted);
      e.texture.made_with = frame.made_with;
      e.pictures->set_picture(ui::PictureId::Texture, e.texture.pixels.size,
                              std::span<const float>(e.texture.pixels.floats));
    }
  }
  if (frame.not_finite != e.not_finite)
    for (const std::string& image : frame.not_finite) log::warn("{}", image);
  e.not_finite = std::move(frame.not_finite);
  e.picture = std::move(frame.picture);
  e.shown_with = frame.made_with;
  e.host_bytes = frame.host_bytes;
  if (e.picture.image)
    e.pictures->set_picture(ui::PictureId::Scene, *e.picture.image);
  else if (!e.picture.rgba.empty())
    e.pictures->set_picture(ui::PictureId::Scene, e.picture.size, std::span<const uint8_t>(e.picture.rgba));
  else
    e.pictures->set_picture(ui::PictureId::Scene, e.picture.size, std::span<const float>(e.picture.floats),
                            e.picture.channels);
}

}  // namespace nf::editor
