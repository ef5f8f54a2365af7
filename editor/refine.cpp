#include "refine.h"

#include <algorithm>
#include <cmath>

#include "scene/peaks.h"

namespace nf::editor {
namespace {

// What the tracer has that the window can show.
const std::vector<std::string> layers = {"",           "direct", "indirect", "gi",   "ambient",
                                         "visibility", "albedo", "normal",   "depth"};

reference::Settings tracer_settings(Editor& editor, float peak_distance) {
  const passes::FrameSettings& s = editor.document.settings;
  const passes::GiParams& gi = s.gi.shared;
  reference::Settings out;
  out.camera = editor.view.camera;
  out.size = editor.wanted.size;
  out.bounces = uint32_t(editor.reference.bounces);
  out.radius = passes::finds_radius(s) && peak_distance > 0 ? peak_distance : gi.radius;
  out.radius_mode = gi.radius_mode == 0   ? reference::RadiusMode::Disc
                    : gi.radius_mode == 1 ? reference::RadiusMode::Ball
                                          : reference::RadiusMode::BallFalloff;
  if (s.technique->in_ball) out.radius_mode = reference::RadiusMode::Ball;
  out.falloff = gi.falloff;
  out.lambert = s.material.lambert;
  out.albedo_scale = s.material.albedo_scale;
  out.emissive_scale = s.material.emissive_scale;
  out.blending = s.material.blend == 0 ? reference::Blending::Over : reference::Blending::CutOut;
  out.include_ambient = s.feedback.include_ambient;
  return out;
}

std::string settings_text(const reference::Settings& s) {
  return fmt::format("{} {} {} {} {} {} {} {} {}", s.bounces, s.radius, int(s.radius_mode), s.falloff, s.lambert,
                     s.albedo_scale, s.emissive_scale, int(s.blending), s.include_ambient);
}

// As shaders/tonemap.frag.
uint8_t tone_map(float x, const passes::TonemapParams& tonemap) {
  x *= std::exp2(tonemap.exposure_ev);
  if (tonemap.curve == 0) x = x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
  return uint8_t(std::lround(image::srgb_from_linear(std::clamp(x, 0.0f, 1.0f)) * 255));
}

}  // namespace

std::string scene_key(const Editor& editor) {
  const scene::Environment& e = editor.scene.environment;
  return fmt::format("{} {} {} {} {} {} {}", editor.wanted.scene, editor.wanted.lights_revision, editor.scene_time,
                     int(e.kind), e.file, e.intensity, e.rotation);
}

void Refiner::take_scene(Editor& editor, std::unique_ptr<scene::Scene> scene) {
  if (scene) peak_distance_ = scene::peak_distance(*scene);
  // Each has a copy of its own; the tracer asked first where both did.
  if (!asked_ && split_asked_) {
    split_asked_ = false;
    split_scene_ = std::move(scene);
    ++editor.wanted.revision;  // the frames that it waits for may all have been rendered
    return;
  }
  asked_ = false;
  if (!editor.reference.on || !scene) return;
  LiveSettings settings{.tracer = tracer_settings(editor, peak_distance_), .layers = layers};
  settings.tracer.threads = std::max(std::thread::hardware_concurrency() / 2, 1u);
  camera_ = settings.tracer.camera;
  size_ = settings.tracer.size;
  settings_ = settings_text(settings.tracer);
  scene_ = asked_scene_;
  editor.reference.curve.clear();
  editor.reference.picture = {};
  editor.reference.has_error = editor.reference.has_error_a = false;
  tracer_.start(std::move(*scene), std::move(settings));
  running_ = true;
}

void Refiner::update(Editor& editor) {
  ReferenceView& r = editor.reference;
  r.wanted_layers.clear();
  if (!r.on || !editor.scene_ready) {
    if (running_) tracer_.stop();
    running_ = false;
    r.picture = {};
    update_split(editor);
    return;
  }
  const bool known = std::find(layers.begin(), layers.end(), editor.viewport.layer) != layers.end();
  r.layer = known ? editor.viewport.layer : "";
  r.note = tracer_.error();
  r.wanted_layers.push_back(r.layer);
  update_split(editor);
  if (editor.wanted.playing) {
    r.note = "The clock runs: the picture as it was when it was stopped last.";
    r.has_error = r.has_error_a = false;
  } else if (!editor.wanted.moving && !asked_) {
    const std::string scene = scene_key(editor);
    const bool other =
        !running_ || scene_ != scene || settings_ != settings_text(tracer_settings(editor, peak_distance_));
    if (other) {
      editor.outbox.push_back({live::CommandKind::CopyScene, {}, {}, {}});
      asked_ = true;
      asked_scene_ = scene;
    } else if (!same(camera_, editor.view.camera) || size_ != editor.wanted.size) {
      camera_ = editor.view.camera;
      size_ = editor.wanted.size;
      r.curve.clear();
      r.picture = {};
      r.has_error = r.has_error_a = false;
      tracer_.look(camera_, size_);
    }
  }
  if (running_ && tracer_.poll(r.picture)) show(editor);
}

void Refiner::compare(Editor& editor, image::Layer&& layer) {
  compared_ = std::move(layer.image);
  compared_name_ = layer.name;
  if (editor.reference.picture.spp > 0) show(editor);
}

// The reference as a picture of the same kind as the scene's, and the error of the newest frame.
void Refiner::show(Editor& editor) {
  ReferenceView& r = editor.reference;
  const LiveReference::Layer* layer = r.picture.layer(r.layer);
  if (!layer) return;
  const image::Image& mean = layer->mean;
  const glm::uvec2 size(mean.width, mean.height);
  const size_t count = size_t(size.x) * size.y;
  if (r.layer.empty()) {
    std::vector<uint8_t> bytes(count * 4, 255);
    for (size_t i = 0; i < count; ++i)
      for (size_t c = 0; c < 3; ++c)
        bytes[i * 4 + c] = tone_map(mean.pixels[i * mean.channels + c], editor.document.settings.tonemap);
    editor.pictures->set_picture(ui::PictureId::Reference, size, std::span<const uint8_t>(bytes));
  } else {
    std::vector<float> floats(count * 4, 0);
    for (size_t i = 0; i < count; ++i)
      for (uint32_t c = 0; c < std::min(mean.channels, 4u); ++c) floats[i * 4 + c] = mean.pixels[i * mean.channels + c];
    editor.pictures->set_picture(ui::PictureId::Reference, size, std::span<const float>(floats), mean.channels);
  }
  judge_a(editor);
  if (compared_.width != size.x || compared_.height != size.y || compared_name_ != r.layer) return;
  r.error = error_against(compared_, r.picture, r.layer, {}, false);
  r.has_error = true;
  r.error_revision = compared_revision_;
  if (r.curve.empty() || r.curve.back().spp < float(r.picture.spp))
    r.curve.push_back({float(r.picture.spp), float(r.error.rmse), float(layer->noise)});
}

void Refiner::keep_a(Editor& editor) {
  kept_ = {};
  // The layer is of the frame that is shown, or of none.
  if (compared_frame_ == editor.scene_frames && compared_name_ == editor.viewport.layer)
    kept_ = {compared_, compared_name_, scene_key(editor), editor.shown_with.camera};
  judge_a(editor);
}

// The error of A against the reference as it is now: of the same view and layer, or there is none.
void Refiner::judge_a(Editor& editor) {
  ReferenceView& r = editor.reference;
  r.has_error_a = false;
  const LiveReference::Layer* layer = r.picture.layer(r.layer);
  r.a_missing = kept_.image.pixels.empty()     ? "A was kept without a reference; K keeps it anew"
                : kept_.layer != r.layer       ? "A is another layer"
                : kept_.scene != scene_        ? "A is of another scene, light or time"
                : !same(kept_.camera, camera_) ? "A is of another view"
                : layer && (kept_.image.width != layer->mean.width || kept_.image.height != layer->mean.height)
                    ? "A is of another size"
                    : "";
  if (!r.a_missing.empty() || !layer) return;
  r.error_a = error_against(kept_.image, r.picture, r.layer, {}, false);
  r.has_error_a = true;
}

}  // namespace nf::editor
