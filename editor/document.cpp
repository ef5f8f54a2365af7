#include "document.h"

#include <algorithm>
#include <cstring>

namespace nf::editor {

bool same(passes::FrameSettings& a, passes::FrameSettings& b) {
  if (a.technique != b.technique || a.reconstruct != b.reconstruct) return false;
  const std::vector<ParamBlock> one = a.blocks(), two = b.blocks();
  for (size_t i = 0; i < one.size(); ++i)
    if (std::memcmp(one[i].data, two[i].data, one[i].table->size) != 0) return false;
  return true;
}

bool same(const live::SceneLights& a, const live::SceneLights& b) {
  const auto sun = [](const scene::DirectionalLight& x, const scene::DirectionalLight& y) {
    return x.direction == y.direction && x.color == y.color && x.irradiance == y.irradiance &&
           x.angle_deg == y.angle_deg;
  };
  const auto lamp = [](const scene::PunctualLight& x, const scene::PunctualLight& y) {
    return x.position == y.position && x.direction == y.direction && x.color == y.color && x.intensity == y.intensity &&
           x.range == y.range && x.radius == y.radius && x.inner_cone == y.inner_cone && x.outer_cone == y.outer_cone;
  };
  return a.environment == b.environment &&
         std::equal(a.directional.begin(), a.directional.end(), b.directional.begin(), b.directional.end(), sun) &&
         std::equal(a.punctual.begin(), a.punctual.end(), b.punctual.begin(), b.punctual.end(), lamp);
}

bool same(const scene::Camera& a, const scene::Camera& b) {
  return a.position == b.position && a.forward == b.forward && a.up == b.up && a.vfov == b.vfov && a.near == b.near;
}

bool same(const scene::Environment& a, const scene::Environment& b) {
  return a.kind == b.kind && a.zenith == b.zenith && a.horizon == b.horizon && a.ground == b.ground &&
         a.intensity == b.intensity && a.rotation == b.rotation && a.file == b.file;
}

bool same(Document& a, Document& b) {
  for (size_t i = 0; i < a.bookmarks.size(); ++i)
    if (a.bookmarks[i].has_value() != b.bookmarks[i].has_value() ||
        (a.bookmarks[i] && !same(*a.bookmarks[i], *b.bookmarks[i])))
      return false;
  return a.seed == b.seed && same(a.settings, b.settings) && same(a.lights, b.lights);
}

bool is_paper_mode(passes::FrameSettings& settings) {
  if (settings.technique->paper_mode.empty()) return false;
  passes::FrameSettings paper = settings;
  passes::set_paper_mode(paper);
  return same(settings, paper);
}

void set_mode(passes::FrameSettings& settings, bool paper) {
  if (settings.technique->paper_mode.empty()) return;
  if (paper) {
    passes::set_paper_mode(settings);
    return;
  }
  const std::vector<ParamBlock> blocks = settings.blocks();
  for (const std::string_view assignment : settings.technique->paper_mode) {
    const std::string_view id = assignment.substr(0, assignment.find('='));
    for (const ParamBlock& block : blocks)
      for (const Param& row : block.table->params)
        if (id == fmt::format("{}.{}", block.table->prefix, row.name))
          params::set(*block.table, block.data, row, row.default_value);
  }
}

void reset_params(passes::FrameSettings& settings) {
  params::reset({&passes::GiParams::table(), &settings.gi.shared});
  if (const ParamBlock block = settings.technique->params(settings.gi); block.table) params::reset(block);
}

void UndoStack::start(const Document& now) {
  last_ = now;
  before_.clear();
  after_.clear();
}

void UndoStack::watch(Document& now, bool gesture_going_on) {
  if (gesture_going_on || same(now, last_)) return;
  before_.push_back(last_);
  if (before_.size() > limit) before_.pop_front();
  after_.clear();
  last_ = now;
}

bool UndoStack::undo(Document& now) {
  if (before_.empty()) return false;
  after_.push_back(now);
  now = last_ = before_.back();
  before_.pop_back();
  return true;
}

bool UndoStack::redo(Document& now) {
  if (after_.empty()) return false;
  before_.push_back(now);
  now = last_ = after_.back();
  after_.pop_back();
  return true;
}

}  // namespace nf::editor
