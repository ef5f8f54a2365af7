// Input as a queue of events, whether they come from a window or from a script. Each frame of the user interface is
// given at most one press or release, so that a click that began and ended between two frames still counts.
#pragma once

#include <deque>
#include <functional>
#include <string>

namespace nf::editor::ui {

enum class InputKind : uint8_t { Move, Button, Wheel, Key, Char, Drop, Resize, Scale, Close, Focus };

struct InputEvent {
  InputKind kind = InputKind::Move;
  float x = 0, y = 0;  // Move: window pixels; Wheel: steps; Resize: pixels; Scale: x = pixels per 96th of an inch
  int code = 0;        // Button: 0 left, 1 right, 2 middle; Key: GLFW's number; Char: code point
  bool down = false;   // Button, Key, Focus
  int mods = 0;        // Key: GLFW's bits
  std::string text;    // Drop: a path
};

// Bits as GLFW has them.
inline constexpr int mod_shift = 1, mod_ctrl = 2, mod_alt = 4;

class InputQueue {
 public:
  void push(InputEvent event) { events_.push_back(std::move(event)); }
  bool empty() const { return events_.empty(); }
  // Before ImGui::NewFrame(). `other` is given what is not Dear ImGui's: dropped files, sizes, closing; and each key
  // press, for shortcuts.
  void feed(const std::function<void(const InputEvent&)>& other);
  // A key held down right now, by GLFW's number.
  bool held(int key) const { return key >= 0 && key < 512 && held_[key]; }

 private:
  std::deque<InputEvent> events_;
  bool held_[512] = {};
};

// Tells Dear ImGui which of GLFW's key numbers mean what to it.
void map_keys();
// "ctrl+shift+z" to a key and modifiers, and back. Throws nf::Error (Exit::Input) for what is no key.
struct Chord {
  int key = 0, mods = 0;
  bool operator==(const Chord&) const = default;
};
Chord parse_chord(const std::string& text);
std::string chord_name(const Chord& chord);

}  // namespace nf::editor::ui
