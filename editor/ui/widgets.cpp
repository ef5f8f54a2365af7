#include "ui/widgets.h"

#include <algorithm>
#include <cfloat>
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

namespace nf::editor::ui {
namespace {

int disabled_depth = 0;

std::string hidden(const std::string& id) {
  return "##" + id;
}
std::string labelled(const std::string& label, const std::string& id) {
  return label + "##" + id;
}

}  // namespace

std::map<std::string, Widget>& widgets() {
  static std::map<std::string, Widget> all;
  return all;
}

void note(const std::string& id, const std::string& value) {
  const ImVec2 low = ImGui::GetItemRectMin(), size = ImGui::GetItemRectSize();
  // Its middle is what is clicked.
  const ImVec2 middle(low.x + size.x / 2, low.y + size.y / 2);
  const bool visible = ImGui::IsRectVisible(ImVec2(middle.x - 1, middle.y - 1), ImVec2(middle.x + 1, middle.y + 1));
  widgets()[id] = {low.x, low.y, size.x, size.y, value, disabled_depth == 0, visible};
}

void note_area(const std::string& id, float x, float y, float width, float height, const std::string& value) {
  widgets()[id] = {x, y, width, height, value, true, true};
}

Disabled::Disabled(bool disabled) : disabled_(disabled) {
  if (!disabled_) return;
  ImGui::BeginDisabled();
  ++disabled_depth;
}
Disabled::~Disabled() {
  if (!disabled_) return;
  ImGui::EndDisabled();
  --disabled_depth;
}

bool wants_tooltip() {
  // At once would hide what is pointed at.
  constexpr float delay = 0.5f;
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    return ImGui::GetCurrentContext()->HoveredIdTimer > delay;
  return ImGui::IsItemFocused() && ImGui::GetIO().NavVisible;
}

void tooltip(const std::string& text) {
  if (text.empty() || !wants_tooltip()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 28);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

bool button(const std::string& id, const std::string& label, const char* tip, bool wide) {
  const bool pressed = ImGui::Button(labelled(label, id).c_str(), ImVec2(wide ? -FLT_MIN : 0, 0));
  note(id, label);
  if (tip) tooltip(tip);
  return pressed;
}

bool checkbox(const std::string& id, const std::string& label, bool& value, const char* tip) {
  const bool changed = ImGui::Checkbox(labelled(label, id).c_str(), &value);
  note(id, value ? "true" : "false");
  if (tip) tooltip(tip);
  return changed;
}

bool slider(const std::string& id, const std::string& label, float& value, float low, float high, const char* format,
            bool logarithmic) {
  const ImGuiSliderFlags flags =
      ImGuiSliderFlags_AlwaysClamp | (logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
  const bool changed = ImGui::SliderFloat(labelled(label, id).c_str(), &value, low, high, format, flags);
  note(id, fmt::format("{:g}", value));
  return changed;
}

bool slider_int(const std::string& id, const std::string& label, int& value, int low, int high) {
  const bool changed =
      ImGui::SliderInt(labelled(label, id).c_str(), &value, low, high, "%d", ImGuiSliderFlags_AlwaysClamp);
  note(id, fmt::format("{}", value));
  return changed;
}

bool combo(const std::string& id, const std::string& label, int& index, const std::vector<std::string>& names) {
  bool changed = false;
  const std::string shown = index >= 0 && size_t(index) < names.size() ? names[size_t(index)] : "";
  const bool open = ImGui::BeginCombo(labelled(label, id).c_str(), shown.c_str(), ImGuiComboFlags_HeightLarge);
  note(id, shown);  // of the box, not of the list that it opens
  if (!open) return false;
  for (size_t i = 0; i < names.size(); ++i) {
    if (ImGui::Selectable(labelled(names[i], fmt::format("{}/{}", id, i)).c_str(), int(i) == index)) {
      changed = int(i) != index;
      index = int(i);
    }
    note(id + "/" + names[i]);
    if (int(i) == index) ImGui::SetItemDefaultFocus();
  }
  ImGui::EndCombo();
  return changed;
}

bool text_input(const std::string& id, const char* hint, std::string& text) {
  const bool changed = ImGui::InputTextWithHint(hidden(id).c_str(), hint, &text);
  note(id, text);
  return changed;
}

bool color(const std::string& id, const std::string& label, float rgb[3]) {
  const bool changed =
      ImGui::ColorEdit3(labelled(label, id).c_str(), rgb, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
  note(id, fmt::format("{:g} {:g} {:g}", rgb[0], rgb[1], rgb[2]));
  return changed;
}

void chip(const std::string& id, const std::string& text, unsigned color) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float pad = ImGui::GetFontSize() * 0.35f;
  // On the line of text that frames beside it have.
  ImVec2 at = ImGui::GetCursorScreenPos();
  at.y += ImGui::GetCurrentWindow()->DC.CurrLineTextBaseOffset;
  const ImVec2 extent(size.x + 2 * pad, size.y);
  ImGui::ItemSize(extent, 0);
  ImGui::ItemAdd(ImRect(at, ImVec2(at.x + extent.x, at.y + extent.y)), 0);
  note(id, text);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, ImVec2(at.x + size.x + 2 * pad, at.y + size.y), color, pad);
  list->AddText(ImVec2(at.x + pad, at.y), IM_COL32(20, 20, 20, 255), text.c_str());
}

bool is_changed(const ParamBlock& block, const Param& row) {
  return params::format(row, params::get(*block.table, block.data, row)) != params::format(row, row.default_value);
}

bool param(const ParamBlock& block, const Param& row, std::string_view source) {
  const std::string id = fmt::format("{}.{}", block.table->prefix, row.name);
  const double before = params::get(*block.table, block.data, row);
  double now = before;
  const bool changed_from_default = is_changed(block, row);
  const float width = ImGui::GetContentRegionAvail().x, line = ImGui::GetFontSize();

  ImGui::PushID(id.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (changed_from_default)
    ImGui::GetWindowDrawList()->AddCircleFilled(ImVec2(at.x + line * 0.25f, at.y + ImGui::GetFrameHeight() * 0.5f),
                                                line * 0.18f, ImGui::GetColorU32(ImGuiCol_CheckMark));
  ImGui::Dummy(ImVec2(line * 0.5f, 1));
  ImGui::SameLine();
  std::string name = row.name;
  std::replace(name.begin(), name.end(), '_', ' ');
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(name.c_str());
  const bool name_hovered = ImGui::IsItemHovered();
  const float column = width * 0.46f;
  if (ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x <= at.x + column)
    ImGui::SameLine(column);
  else
    ImGui::SetCursorScreenPos(ImVec2(at.x + column, ImGui::GetCursorScreenPos().y));  // below a long name
  ImGui::SetNextItemWidth(row.type == ParamType::Choice || !*row.unit ? -FLT_MIN : -line * 2.6f);
  switch (row.type) {
    case ParamType::Bool: {
      bool on = before != 0;
      if (ImGui::Checkbox("##value", &on)) now = on ? 1 : 0;
      note(id, on ? "true" : "false");
      break;
    }
    case ParamType::Choice: {
      int index = int(before);
      std::vector<std::string> names;
      for (int i = 0; i <= int(row.max); ++i) names.push_back(params::choice_name(row, i));
      if (combo(id, "", index, names)) now = index;
      break;
    }
    case ParamType::Int:
    case ParamType::Uint: {
      int value = int(before);
      if (ImGui::SliderInt("##value", &value, int(row.min), int(row.max), "%d", ImGuiSliderFlags_AlwaysClamp))
        now = value;
      note(id, params::format(row, now));
      break;
    }
    default: {
      float value = float(before);
      const bool wide = row.max - row.min > 20 && row.min >= 0;
      if (ImGui::SliderFloat("##value", &value, float(row.min), float(row.max), "%.3f",
                             ImGuiSliderFlags_AlwaysClamp | (wide ? ImGuiSliderFlags_Logarithmic : 0)))
        now = double(value);
      note(id, params::format(row, now));
    }
  }
  const bool hovered = wants_tooltip();
  if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(1)) now = row.default_value;
  if (row.type != ParamType::Choice && *row.unit) {
    ImGui::SameLine();
    ImGui::TextDisabled("%s", row.unit);
  }
  if (hovered || name_hovered) {
    const std::string range =
        row.type == ParamType::Bool || row.type == ParamType::Choice
            ? std::string()
            : fmt::format("{} to {}, ", params::format(row, row.min), params::format(row, row.max));
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(line * 28);
    ImGui::Text("%s", id.c_str());
    ImGui::TextDisabled("%sdefault %s; right click resets", range.c_str(),
                        params::format(row, row.default_value).c_str());
    ImGui::TextUnformatted(row.help);
    if (!source.empty()) ImGui::TextDisabled("%s", std::string(source).c_str());
    ImGui::PopTextWrapPos();
    const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    note_area("tooltip.param", low.x, low.y, size.x, size.y, fmt::format("{} {}", id, source));
    ImGui::EndTooltip();
  }
  ImGui::PopID();
  if (now == before) return false;
  params::set(*block.table, block.data, row, now);
  return params::get(*block.table, block.data, row) != before;
}

}  // namespace nf::editor::ui
