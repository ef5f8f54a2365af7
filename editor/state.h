// What the window shows, as one JSON document: for --ui-state, and for scripts' conditions.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "editor.h"

namespace nf::editor {

// `idle`: nothing is being rendered or waits to be.
nlohmann::json make_state(Editor& editor, bool idle);
// By way of a temporary file, so that a reader sees all of it or nothing.
void write_atomically(const std::filesystem::path& path, const std::string& text);

}  // namespace nf::editor
