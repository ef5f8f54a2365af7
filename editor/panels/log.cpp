// The log with search, the help made from the action table, and the dialogs that ask for a file.
#include <algorithm>
#include <imgui.h>

#include "actions.h"
#include "panels/panels.h"
#include "ui/widgets.h"

namespace nf::editor {

namespace {

bool contains(const std::string& text, const std::string& part) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return part.empty() || std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

// 2: an error, 1: a warning, 0: anything else.
int level_of(const std::string& line) {
  return line.starts_with("error") || line.starts_with("critical") ? 2 : line.starts_with("warning") ? 1 : 0;
}

}  // namespace

void draw_log_panel(Editor& editor) {
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 9);
  ui::combo("log.level", "", editor.log_level, {"all", "warnings, errors", "errors"});
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 14);
  ui::text_input("log.search", "search", editor.log_search);
  std::vector<const std::string*> shown;
  for (const std::string& line : editor.log)
    if (level_of(line) >= editor.log_level && contains(line, editor.log_search)) shown.push_back(&line);
  ImGui::SameLine();
  if (ui::button("log.copy", "copy", "The lines that are shown")) {
    std::string text;
    for (const std::string* line : shown) text += *line + "\n";
    ImGui::SetClipboardText(text.c_str());
    toast(editor, fmt::format("{} of {} lines copied", shown.size(), editor.log.size()));
  }
  ImGui::SameLine();
  if (ui::button("log.clear", "clear")) editor.log.clear(), shown.clear();
  ImGui::BeginChild("lines", ImVec2(0, 0), true);
  ui::note("log.lines", fmt::format("{}", editor.log.size()));
  ui::note("log.shown", fmt::format("{}", shown.size()));
  ui::note("log.last", shown.empty() ? "" : *shown.back());
  for (const std::string* line : shown) {
    const int level = level_of(*line);
    if (level) ImGui::PushStyleColor(ImGuiCol_Text, level == 2 ? ImVec4(1, 0.5f, 0.5f, 1) : ImVec4(1, 0.85f, 0.5f, 1));
    ImGui::TextUnformatted(line->c_str());
    if (level) ImGui::PopStyleColor();
  }
  if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY()) ImGui::SetScrollHereY(1);
  ImGui::EndChild();
}

void draw_help(Editor& editor) {
  if (!editor.show_help) return;
  const float line = ImGui::GetFontSize();
  ImGui::SetNextWindowSize(
      ImVec2(std::min(line * 36, float(editor.window.x) * 0.9f), std::min(line * 30, float(editor.window.y) * 0.85f)),
      ImGuiCond_Appearing);
  ImGui::SetNextWindowPos(ImVec2(float(editor.window.x) / 2, float(editor.window.y) / 2), ImGuiCond_Appearing,
                          ImVec2(0.5f, 0.5f));
  if (ImGui::Begin("Help", &editor.show_help, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-FLT_MIN);
    ui::text_input("help.search", "search actions", editor.action_search);
    if (ImGui::BeginTable("actions", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY)) {
      ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed, line * 8);
      ImGui::TableSetupColumn("action", ImGuiTableColumnFlags_WidthFixed, line * 13);
      ImGui::TableSetupColumn("what it does");
      for (const Action& action : actions()) {
        const std::string all = fmt::format("{} {} {}", action.name, action.help, action.keys);
        if (!contains(all, editor.action_search)) continue;
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(*action.keys ? ui::chord_name(ui::parse_chord(action.keys)).c_str() : "");
        ImGui::TableNextColumn();
        if (ImGui::Selectable(fmt::format("{}##{}", action.name, action.id).c_str())) action.run(editor);
        ui::note(std::string("help.") + action.id);
        ImGui::TableNextColumn();
        ImGui::TextWrapped("%s", action.help);
      }
      for (const auto& [keys, name, help] :
           {std::tuple{"right drag", "look",
                       "and W A S D Q E to fly, wheel for the speed, Shift four times as fast, Ctrl a fourth"},
            std::tuple{"Alt+left drag", "orbit", "about the picked point, else what the camera is aimed at"},
            std::tuple{"middle drag", "pan", ""}, std::tuple{"wheel", "dolly", "towards what the camera is aimed at"},
            std::tuple{"left click", "pick", "a pixel's values in every layer"},
            std::tuple{"right click", "reset", "a parameter to its default"},
            std::tuple{"drop a file", "open", ".glb .gltf scene, .hdr .exr environment, .json preset"}}) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(keys);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(name);
        ImGui::TableNextColumn();
        ImGui::TextWrapped("%s", help);
      }
      ImGui::EndTable();
    }
  }
  ImGui::End();
}

void draw_dialogs(Editor& editor) {
  const bool save = editor.show_save;
  if (!save && !editor.show_open) return;
  ImGui::OpenPopup("file");
  ImGui::SetNextWindowPos(ImVec2(float(editor.window.x) / 2, float(editor.window.y) * 0.3f), ImGuiCond_Always,
                          ImVec2(0.5f, 0));
  ImGui::SetNextWindowSize(ImVec2(std::min(ImGui::GetFontSize() * 36, float(editor.window.x) * 0.9f), 0));
  if (!ImGui::BeginPopupModal(
          "file", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings))
    return;
  ImGui::TextUnformatted(save ? "Save a preset (.json)"
                              : "Open a scene (.glb, .gltf), an environment (.hdr, .exr) or a preset (.json)");
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-FLT_MIN);
  ui::text_input("file.path", "path", editor.prompt);
  const bool enter = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter)),
             escape = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  bool close = escape;
  bool pressed = false;
  {
    const ui::Disabled unnamed(editor.prompt.empty());
    pressed = ui::button("file.ok", save ? "Save" : "Open");
  }
  if (pressed || (enter && !editor.prompt.empty())) {
    if (save)
      editor.save_preset = editor.prompt;
    else
      editor.dropped.push_back(editor.prompt);
    close = true;
  }
  ImGui::SameLine();
  close |= ui::button("file.cancel", "Cancel");
  if (close) {
    editor.show_save = editor.show_open = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace nf::editor
