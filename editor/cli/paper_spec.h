// What the pages about the papers' tables and figures share: strict reading of their data files, and settings in them.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "frame.h"

namespace nf::editor {

// The folder NAME of content/presets, if it has `file`; else the path `name`.
std::filesystem::path preset_folder(const std::string& name, const char* file = "");

// Every preset of such a folder, sorted. Throws nf::Error (Exit::Input) where there are none.
std::vector<std::filesystem::path> find_presets(const std::string& name);

// Throws nf::Error (Exit::Input), with the file's name, where it is missing, no JSON, or of another schema.
nlohmann::json read_spec(const std::filesystem::path& file, const std::string& schema);
// The same for a key that is none of these. `where` is the object's place in the file.
void expect_keys(const nlohmann::json& object, const std::string& where, std::initializer_list<const char*> keys);
// {"technique": ID, "mode": "paper", "params": {...}} over `base`, parameters that all have. Stages of the
// reconstruction are off that neither switches on.
passes::FrameSettings spec_settings(const nlohmann::json& form, const nlohmann::json& base);

// A table as rows of cells, in Markdown; the first column is text.
std::string markdown_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);

}  // namespace nf::editor
