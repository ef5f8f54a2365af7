// The controls of a picture of floats.
#include "look.h"

#include <algorithm>
#include <cmath>
#include <imgui.h>

#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {
namespace {

// On the same line if the next item, so wide, still fits.
void beside(float width) {
  const float edge = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width <= edge) ImGui::SameLine();
}

float button_width(const char* label) {
  return ImGui::CalcTextSize(label).x + 2 * ImGui::GetStyle().FramePadding.x;
}
float box_width(const char* label) {
  return ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize(label).x;
}

// Four letters, lit when they are on.
void draw_channels(const std::string& id, const live::Pixels& pixels, ui::PictureLook& look) {
  const ImVec2 low = ImGui::GetCursorScreenPos();
  for (uint32_t c = 0; c < 4; ++c) {
    const uint8_t bit = uint8_t(1u << c);
    const bool on = look.channels & bit;
    const std::string letter(1, "RGBA"[c]), name = id + "." + std::string(1, "rgba"[c]);
    if (c > 0) ImGui::SameLine(0, 2);
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(on ? ImGuiCol_ButtonActive : ImGuiCol_FrameBg));
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(on ? ImGuiCol_Text : ImGuiCol_TextDisabled));
    if (ImGui::Button((letter + "##" + name).c_str())) look.channels ^= bit;
    ImGui::PopStyleColor(2);
    // Alone, or, when it is already, all colours that there are.
    if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(1)) {
      if (look.channels == bit)
        look.chosen_for = 0, choose_channels(pixels, look);
      else
        look.channels = bit;
    }
    ui::note(name, on ? "true" : "false");
    ui::tooltip(
        c < 3 ? "On or off; right click: this one alone, and all again. One alone is a number in the map's colours"
              : "Alone: as a number; with others: they are multiplied by it. Right click: alone");
  }
  const ImVec2 high = ImGui::GetItemRectMax();
  ui::note_area(id + ".show", low.x, low.y, high.x - low.x, high.y - low.y, channels_text(look));
}

}  // namespace

void draw_look(const std::string& id, const live::Pixels& pixels, ui::PictureLook& look, bool& auto_range) {
  const float line = ImGui::GetFontSize();
  const auto drag = [&](const char* name, float& value, float room) {
    beside(room);
    ImGui::SetNextItemWidth(line * 5);
    const float speed = std::max(std::abs(look.high - look.low) * 0.005f, 1e-6f);
    if (ImGui::DragFloat(fmt::format("##{}{}", id, name).c_str(), &value, speed, 0, 0, "%.4g")) auto_range = false;
    ui::note(id + name, fmt::format("{:g}", value));
  };
  choose_channels(pixels, look);
  draw_channels(id, pixels, look);
  beside(line * 7);
  ImGui::SetNextItemWidth(line * 7);
  int map = int(look.map);
  if (ui::combo(id + ".map", "", map, {std::begin(map_names), std::end(map_names)})) look.map = ui::Map(map);
  ui::tooltip("Colours of one number: the first channel that is on. Grey shows several as colours");
  beside(box_width("log"));
  ui::checkbox(id + ".log", "log", look.logarithmic, "Equal steps of the colours are equal factors");
  drag(".low", look.low, line * 10 + ImGui::GetStyle().ItemSpacing.x);  // the two stay together
  drag(".high", look.high, line * 5);
  beside(button_width("autofit"));
  if (ui::button(id + ".autofit", "autofit", "Range from the smallest to the largest number of this picture")) {
    fit_range(pixels, look);
    auto_range = false;
  }
  beside(box_width("always"));
  ui::checkbox(id + ".auto_range", "always", auto_range, "Autofit with each frame");
  beside(button_width("reset"));
  if (ui::button(id + ".reset", "reset", "0 to 1, linear, grey, all colours")) {
    look = {};
    auto_range = false;
    choose_channels(pixels, look);
  }
  beside(box_width("sRGB"));
  ui::checkbox(id + ".srgb", "sRGB", look.srgb, "Show linear light through the sRGB curve");
  beside(box_width("outside"));
  ui::checkbox(id + ".mark", "outside", look.mark_outside, "Blue below the range, red above it; NaN is magenta always");
}

}  // namespace nf::editor
