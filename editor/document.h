// What the user makes: everything that undo brings back, and a preset keeps; the bookmarks stand in the settings, too,
// by scene. A plain value; the window edits it in place.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>

#include "live/wanted.h"
#include "preset.h"

namespace nf::editor {

struct Document {
  passes::FrameSettings settings;
  live::SceneLights lights;
  Bookmarks bookmarks;
  uint32_t seed = 1;
};

// Whether all values are the same.
bool same(passes::FrameSettings& a, passes::FrameSettings& b);
bool same(const live::SceneLights& a, const live::SceneLights& b);
bool same(const scene::Camera& a, const scene::Camera& b);
// Maps by their file. The colour is not looked at: it is one of the lights.
bool same(const scene::Environment& a, const scene::Environment& b);
bool same(Document& a, Document& b);

// Whether the technique's settings are those that its paper prints, now.
bool is_paper_mode(passes::FrameSettings& settings);
// The paper's form, or the defaults of what that sets. Nothing for a technique without a paper form.
void set_mode(passes::FrameSettings& settings, bool paper);
// Every parameter of the technique and of what all techniques share at its default.
void reset_params(passes::FrameSettings& settings);

// Documents before and after now. A gesture (a drag of a slider) is one step.
class UndoStack {
 public:
  static constexpr size_t limit = 500;
  // Forgets everything; `now` is what the next change starts from.
  void start(const Document& now);
  // Each frame. Keeps the document as it was before the change once the gesture is over.
  void watch(Document& now, bool gesture_going_on);
  bool undo(Document& now);
  bool redo(Document& now);
  size_t undos() const { return before_.size(); }
  size_t redos() const { return after_.size(); }

 private:
  Document last_;
  std::deque<Document> before_, after_;
};

}  // namespace nf::editor
