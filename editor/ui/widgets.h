// Widgets with a name: thin wrappers over Dear ImGui that also note where each widget is and what it shows, so that a
// script can find it by id (ui/script.h) and tests need no coordinates.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/params.h"

namespace nf::editor::ui {

struct Widget {
  float x = 0, y = 0, width = 0, height = 0;  // window pixels
  std::string value;
  bool enabled = true, visible = true;
};

// All widgets of the frame that is being built. One window a process, as Dear ImGui has one context.
std::map<std::string, Widget>& widgets();
// Notes the last item under this id.
void note(const std::string& id, const std::string& value = {});
// Notes a rectangle of the window that is not an item.
void note_area(const std::string& id, float x, float y, float width, float height, const std::string& value = {});

// From here to the end of the scope widgets are grey and take no input.
struct Disabled {
  explicit Disabled(bool disabled);
  ~Disabled();
  Disabled(const Disabled&) = delete;
  Disabled& operator=(const Disabled&) = delete;

 private:
  bool disabled_;
};

// `label` may be empty. Each returns whether the user changed something.
bool button(const std::string& id, const std::string& label, const char* tooltip = nullptr, bool wide = false);
bool checkbox(const std::string& id, const std::string& label, bool& value, const char* tooltip = nullptr);
bool slider(const std::string& id, const std::string& label, float& value, float low, float high,
            const char* format = "%.3f", bool logarithmic = false);
bool slider_int(const std::string& id, const std::string& label, int& value, int low, int high);
bool combo(const std::string& id, const std::string& label, int& index, const std::vector<std::string>& names);
bool text_input(const std::string& id, const char* hint, std::string& text);
bool color(const std::string& id, const std::string& label, float rgb[3]);
// A small rounded label, e.g. for what is out of the ordinary.
void chip(const std::string& id, const std::string& text, unsigned color);
// What a hovered or focused item is; wrapped to a readable width.
void tooltip(const std::string& text);
// Whether the last item was pointed at long enough, or has the keyboard.
bool wants_tooltip();

// One parameter's row: name, a dot when it is not at its default, widget, unit; right click resets; the tooltip has id,
// range, default, help and where the parameter comes from, if anywhere. Returns whether the value changed.
bool param(const ParamBlock& block, const Param& row, std::string_view source = {});
bool is_changed(const ParamBlock& block, const Param& row);

}  // namespace nf::editor::ui
