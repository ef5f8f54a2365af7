// The error's parts for the view that is shown: when they begin anew, and the pictures of them.
#include <algorithm>

#include "cli/reference_options.h"
#include "refine.h"

namespace nf::editor {
namespace {

std::string text_of(const scene::Camera& c) {
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {}", c.position.x, c.position.y, c.position.z, c.forward.x,
                     c.forward.y, c.forward.z, c.up.x, c.up.y, c.up.z, c.vfov, c.near);
}

reference::Settings split_tracer(Editor& editor, const reference::MarchSettings& march) {
  reference::Settings s;
  s.camera = editor.view.camera;
  s.size = editor.wanted.size;
  s.bounces = 1;
  s.radius = march.radius;
  s.radius_mode = march.radius_mode;
  s.falloff = march.falloff;
  s.bound_gi = true;
  apply_materials(editor.document.settings.material, s);
  s.threads = std::max(std::thread::hardware_concurrency() / 2, 1u);
  return s;
}

}  // namespace

std::span<const SplitQuantity> split_quantities() {
  static constexpr SplitQuantity rows[] = {{"visibility", "visibility", "visibility", "visibility"},
                                           {"gi, 1 bounce", "gi_raw", "gi", "gi"}};
  return rows;
}

void Refiner::update_split(Editor& editor) {
  ReferenceView& r = editor.reference;
  if (!r.split_on() || !editor.scene_ready) {
    if (splitting_) split_.stop();
    splitting_ = r.has_parts = false;
    for (std::string* known : {&split_truth_, &split_view_, &split_has_}) known->clear();
    split_scene_.reset();
    return;
  }
  splitting_ = true;
  const SplitQuantity& q = split_quantities()[size_t(r.quantity)];
  for (const char* name : {"depth", "normal", "radiance", q.test})
    if (std::find(r.wanted_layers.begin(), r.wanted_layers.end(), name) == r.wanted_layers.end())
      r.wanted_layers.emplace_back(name);
  r.split_note = split_.error();
  if (r.split_note.empty()) r.split_note = march_note(editor.document.settings);
  if (split_.poll(r.parts)) {
    r.has_parts = true;
    show_split(editor);
  }
}

// A frame of the view as it is: the estimators' input, if they have another, and one more of the technique's.
void Refiner::take_layers(Editor& editor, live::Published& frame) {
  ReferenceView& r = editor.reference;
  const auto find = [&](std::string_view name) { return image::find_layer(frame.layers, name); };
  const live::Wanted& wanted = editor.wanted;
  const SplitQuantity& q = split_quantities()[size_t(r.quantity)];
  const auto test = find(q.test), depth = find("depth"), normal = find("normal"), radiance = find("radiance");
  const bool current =
      frame.revision == wanted.revision && !frame.moving && !wanted.playing && wanted.bare && r.split_on();
  if (current && !test) r.split_note = fmt::format("{} gives no {}", editor.document.settings.technique->id, q.name);
  if (current && test && radiance && test->image.width == wanted.size.x && test->image.height == wanted.size.y) {
    passes::FrameSettings shown = editor.document.settings;
    if (passes::finds_radius(shown) && peak_distance_ > 0) shown.gi.shared.radius = peak_distance_;
    const reference::MarchSettings march = march_settings(shown, editor.view.camera);
    const reference::Settings tracer = split_tracer(editor, march);
    const std::string scene = scene_key(editor);
    const std::string truth =
        fmt::format("{} {}x{} {} {} {} {} {} {} {} {}", scene, wanted.size.x, wanted.size.y,
                    text_of(editor.view.camera), march.radius, int(march.radius_mode), march.falloff, tracer.lambert,
                    tracer.albedo_scale, tracer.emissive_scale, int(tracer.blending));
    const std::string view = fmt::format("{} {} {}", truth, wanted.history, r.quantity);
    const bool known = scene == split_has_, copied = split_scene_ && scene == split_copied_;
    if (view != split_view_ && (known || copied)) {
      SplitSettings settings{.test = q.test, .truth = q.truth, .same = q.same, .buffers = {*depth, *normal, *radiance}};
      settings.march = march;
      settings.march.threads = tracer.threads;
      if (truth != split_truth_) {
        settings.tracer = tracer;
        if (!known) settings.scene = std::move(*split_scene_);
        split_scene_.reset();
        split_has_ = scene;
      }
      split_.start(std::move(settings));
      split_truth_ = truth;
      split_view_ = view;
      r.has_parts = false;
    } else if (view != split_view_ && !split_asked_) {
      editor.outbox.push_back({live::CommandKind::CopyScene, {}, {}, {}});
      split_asked_ = true;
      split_copied_ = scene;
    }
    if (view == split_view_) split_.add(test->image, wanted.history);
  }
  compared_frame_ = frame.number;
  compared_revision_ = frame.revision;
  for (image::Layer& layer : frame.layers)
    if (layer.name == r.layer) compare(editor, std::move(layer));
}

void Refiner::show_split(Editor& editor) {
  const LiveSplit::Result& p = editor.reference.parts;
  const ui::PictureId ids[] = {ui::PictureId::SplitTotal, ui::PictureId::SplitEstimator, ui::PictureId::SplitMissing};
  for (size_t part = 0; part < 3; ++part) {
    std::vector<float> floats(p.maps[part].size() * 4, 0);
    for (size_t i = 0; i < p.maps[part].size(); ++i) floats[i * 4] = p.maps[part][i];
    editor.pictures->set_picture(ids[part], p.size, std::span<const float>(floats));
  }
}

}  // namespace nf::editor
