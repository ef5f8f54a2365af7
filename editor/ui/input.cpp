#include "ui/input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <algorithm>
#include <imgui.h>
#include <utility>

#include "core/error.h"

namespace nf::editor::ui {
namespace {

constexpr std::pair<const char*, int> named_keys[] = {{"space", GLFW_KEY_SPACE},
                                                      {"enter", GLFW_KEY_ENTER},
                                                      {"escape", GLFW_KEY_ESCAPE},
                                                      {"tab", GLFW_KEY_TAB},
                                                      {"backspace", GLFW_KEY_BACKSPACE},
                                                      {"delete", GLFW_KEY_DELETE},
                                                      {"insert", GLFW_KEY_INSERT},
                                                      {"left", GLFW_KEY_LEFT},
                                                      {"right", GLFW_KEY_RIGHT},
                                                      {"up", GLFW_KEY_UP},
                                                      {"down", GLFW_KEY_DOWN},
                                                      {"home", GLFW_KEY_HOME},
                                                      {"end", GLFW_KEY_END},
                                                      {"pageup", GLFW_KEY_PAGE_UP},
                                                      {"pagedown", GLFW_KEY_PAGE_DOWN},
                                                      {"=", GLFW_KEY_EQUAL},
                                                      {"-", GLFW_KEY_MINUS},
                                                      {".", GLFW_KEY_PERIOD},
                                                      {",", GLFW_KEY_COMMA}};

}  // namespace

void map_keys() {
  ImGuiIO& io = ImGui::GetIO();
  io.KeyMap[ImGuiKey_Tab] = GLFW_KEY_TAB;
  io.KeyMap[ImGuiKey_LeftArrow] = GLFW_KEY_LEFT;
  io.KeyMap[ImGuiKey_RightArrow] = GLFW_KEY_RIGHT;
  io.KeyMap[ImGuiKey_UpArrow] = GLFW_KEY_UP;
  io.KeyMap[ImGuiKey_DownArrow] = GLFW_KEY_DOWN;
  io.KeyMap[ImGuiKey_PageUp] = GLFW_KEY_PAGE_UP;
  io.KeyMap[ImGuiKey_PageDown] = GLFW_KEY_PAGE_DOWN;
  io.KeyMap[ImGuiKey_Home] = GLFW_KEY_HOME;
  io.KeyMap[ImGuiKey_End] = GLFW_KEY_END;
  io.KeyMap[ImGuiKey_Insert] = GLFW_KEY_INSERT;
  io.KeyMap[ImGuiKey_Delete] = GLFW_KEY_DELETE;
  io.KeyMap[ImGuiKey_Backspace] = GLFW_KEY_BACKSPACE;
  io.KeyMap[ImGuiKey_Space] = GLFW_KEY_SPACE;
  io.KeyMap[ImGuiKey_Enter] = GLFW_KEY_ENTER;
  io.KeyMap[ImGuiKey_Escape] = GLFW_KEY_ESCAPE;
  io.KeyMap[ImGuiKey_KeyPadEnter] = GLFW_KEY_KP_ENTER;
  io.KeyMap[ImGuiKey_A] = GLFW_KEY_A;
  io.KeyMap[ImGuiKey_C] = GLFW_KEY_C;
  io.KeyMap[ImGuiKey_V] = GLFW_KEY_V;
  io.KeyMap[ImGuiKey_X] = GLFW_KEY_X;
  io.KeyMap[ImGuiKey_Y] = GLFW_KEY_Y;
  io.KeyMap[ImGuiKey_Z] = GLFW_KEY_Z;
}

void InputQueue::feed(const std::function<void(const InputEvent&)>& other) {
  ImGuiIO& io = ImGui::GetIO();
  bool transition = false, moved_after = false;
  while (!events_.empty()) {
    const InputEvent& e = events_.front();
    const bool is_transition = e.kind == InputKind::Button || e.kind == InputKind::Key;
    // Characters follow their key at once; a move after a press belongs to the next frame, or a drag would start late.
    if (transition && (is_transition || e.kind == InputKind::Move || e.kind == InputKind::Wheel)) break;
    if (is_transition && moved_after && e.kind == InputKind::Button) break;  // hover first, then press
    switch (e.kind) {
      case InputKind::Move:
        moved_after = moved_after || io.MousePos.x != e.x || io.MousePos.y != e.y;
        io.MousePos = ImVec2(e.x, e.y);
        break;
      case InputKind::Button:
        if (e.code >= 0 && e.code < 5) io.MouseDown[e.code] = e.down;
        break;
      case InputKind::Wheel:
        io.MouseWheelH += e.x;
        io.MouseWheel += e.y;
        break;
      case InputKind::Key:
        if (e.code >= 0 && e.code < 512) io.KeysDown[e.code] = held_[e.code] = e.down;
        io.KeyCtrl = held_[GLFW_KEY_LEFT_CONTROL] || held_[GLFW_KEY_RIGHT_CONTROL] || (e.down && (e.mods & mod_ctrl));
        io.KeyShift = held_[GLFW_KEY_LEFT_SHIFT] || held_[GLFW_KEY_RIGHT_SHIFT] || (e.down && (e.mods & mod_shift));
        io.KeyAlt = held_[GLFW_KEY_LEFT_ALT] || held_[GLFW_KEY_RIGHT_ALT] || (e.down && (e.mods & mod_alt));
        if (e.down) other(e);
        break;
      case InputKind::Char:
        io.AddInputCharacter(unsigned(e.code));
        break;
      case InputKind::Focus:
        if (!e.down) {
          std::fill(std::begin(held_), std::end(held_), false);
          std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
          io.KeyCtrl = io.KeyShift = io.KeyAlt = false;
        }
        break;
      default:
        other(e);
    }
    transition |= is_transition;
    events_.pop_front();
  }
}

Chord parse_chord(const std::string& text) {
  Chord chord;
  size_t at = 0;
  for (const auto& [name, bit] : {std::pair{"ctrl+", mod_ctrl}, std::pair{"shift+", mod_shift},
                                  std::pair{"alt+", mod_alt}, std::pair{"ctrl+", mod_ctrl}})
    if (text.compare(at, std::string_view(name).size(), name) == 0)
      chord.mods |= bit, at += std::string_view(name).size();
  const std::string key = text.substr(at);
  if (key.size() == 1 && key[0] >= 'a' && key[0] <= 'z') chord.key = GLFW_KEY_A + key[0] - 'a';
  if (key.size() == 1 && key[0] >= '0' && key[0] <= '9') chord.key = GLFW_KEY_0 + key[0] - '0';
  if (key.size() >= 2 && key[0] == 'f') {
    const int number = std::atoi(key.c_str() + 1);
    if (number >= 1 && number <= 12) chord.key = GLFW_KEY_F1 + number - 1;
  }
  for (const auto& [name, code] : named_keys)
    if (key == name) chord.key = code;
  if (!chord.key) fail(Exit::Input, "'{}' is no key; write e.g. ctrl+shift+z, f5, space", text);
  return chord;
}

std::string chord_name(const Chord& chord) {
  if (!chord.key) return {};
  std::string text = fmt::format("{}{}{}", chord.mods & mod_ctrl ? "Ctrl+" : "", chord.mods & mod_alt ? "Alt+" : "",
                                 chord.mods & mod_shift ? "Shift+" : "");
  if (chord.key >= GLFW_KEY_A && chord.key <= GLFW_KEY_Z) return text + char('A' + chord.key - GLFW_KEY_A);
  if (chord.key >= GLFW_KEY_0 && chord.key <= GLFW_KEY_9) return text + char('0' + chord.key - GLFW_KEY_0);
  if (chord.key >= GLFW_KEY_F1 && chord.key <= GLFW_KEY_F12)
    return text + fmt::format("F{}", chord.key - GLFW_KEY_F1 + 1);
  for (const auto& [name, code] : named_keys)
    if (chord.key == code) {
      std::string word = name;
      word[0] = char(std::toupper(word[0]));
      return text + word;
    }
  return text + "?";
}

}  // namespace nf::editor::ui
