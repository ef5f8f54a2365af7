// Presets: settings in a file, so that a picture can be made again. {"schema": "nearfield.preset/1", ...}; all other
// keys may be left out.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>

#include "scene/view.h"

namespace nf::editor {

// Cameras to go back to; the first is called 1.
using Bookmarks = std::array<std::optional<scene::Camera>, 9>;

struct Preset {
  std::optional<std::string> scene;  // path; commands take theirs from the command line
  std::optional<std::string> technique, mode, size;
  std::optional<uint32_t> seed;
  // As --view has it; or the view itself, as in a view file.
  std::optional<std::variant<std::string, scene::View>> view;
  nlohmann::json params = nlohmann::json::object();  // {"gi.radius": 2}, as params::from_json takes it
  std::optional<Bookmarks> bookmarks;                // the editor's; commands have no use for them
  nlohmann::json made;  // beside a picture: an object that says what made it; nobody reads it back
};

// Throws nf::Error (Exit::Input): no such file, not JSON, an unknown key or a wrong type, named by its path. Whether
// there is such a technique, size or parameter is for its user to find out.
Preset read_preset(const std::filesystem::path& path);
// Whole or not at all. Throws nf::Error (Exit::Output).
void write_preset(const std::filesystem::path& path, const Preset& preset);

}  // namespace nf::editor
