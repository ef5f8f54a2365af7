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
// Runs the action of these keys; false when there is none. Letters without Ctrl or Alt are for text fields while one
// has the focus.
bool run_shortcut(Editor& editor, int key, int mods, bool typing);
// Two actions with the same keys; empty when there are none.
std::string find_conflict();

}  // namespace nf::editor
