// Every action of the editor in one table: menus, shortcuts and the help are made from it.
#pragma once

#include <span>

#include "editor.h"

namespace nf::editor {

struct Action {
  const char* id;
  const char* menu;  // where it stands; "" = only by key
  const char* name;
  const char* keys;  // as ui::parse_chord() reads them; "" = none
  const char* help;
  void (*run)(Editor&);
};

std::span<const Action> actions();
const Action* find_action(std::string_view id);
// What has the keyboard: a text field takes letters and what edits text, a widget that was reached with the arrow keys
// takes Space; a flight takes letters, and Ctrl with those that steer it.
enum class Focus : uint8_t { Nothing, Widget, Text, Flight };
// Runs the action of these keys; false when there is none, or they are the focus's own.
bool run_shortcut(Editor& editor, int key, int mods, Focus focus);
// The picture that is shown is A from now on.
void keep_as_a(Editor& editor);
// Its technique and what its frames take.
std::string picture_label(const Editor& editor);
// Two actions with the same keys; empty when there are none.
std::string find_conflict();

}  // namespace nf::editor
