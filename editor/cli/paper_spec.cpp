// Reading what the papers' pages are made of.
#include "cli/paper_spec.h"

#include <algorithm>
#include <fmt/ranges.h>

#include "core/error.h"
#include "image/file.h"

namespace nf::editor {

using nlohmann::json;

std::filesystem::path preset_folder(const std::string& name, const char* file) {
  const std::filesystem::path bundled = gpu::find_shader_folder().parent_path() / "content" / "presets" / name;
  return std::filesystem::exists(bundled / file) ? bundled : std::filesystem::path(name);
}

std::vector<std::filesystem::path> find_presets(const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path folder = preset_folder(name);
  std::vector<fs::path> presets;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".json") presets.push_back(entry.path());
  if (presets.empty())
    fail(Exit::Input, "no presets '{}': neither '{}' nor '{}' is a folder with .json files", name,
         (gpu::find_shader_folder().parent_path() / "content" / "presets" / name).string(), name);
  std::sort(presets.begin(), presets.end());
  return presets;
}

json read_spec(const std::filesystem::path& file, const std::string& schema) {
  const std::vector<uint8_t> bytes = image::read_file(file);
  json document = json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (!document.is_object() || document.value("schema", json()) != schema)
    fail(Exit::Input, "cannot read '{}': it is no JSON with \"schema\": \"{}\"", file.string(), schema);
  return document;
}

void expect_keys(const json& object, const std::string& where, std::initializer_list<const char*> keys) {
  if (!object.is_object()) fail(Exit::Input, "'{}' must be an object", where);
  for (const auto& [key, value] : object.items())
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      fail(Exit::Input, "unknown key '{}' in '{}'; there are {}", key, where, fmt::join(keys, ", "));
}

passes::FrameSettings spec_settings(const json& form, const json& base) {
  passes::FrameSettings settings;
  settings.reconstruct = true;
  settings.switch_off_reconstruction();
  settings.technique = &passes::find_technique(form.at("technique").get<std::string>());
  const std::string mode = form.value("mode", "radiometric");
  if (mode == "paper")
    passes::set_paper_mode(settings);
  else if (mode != "radiometric")
    fail(Exit::Input, "bad mode '{}' of '{}': paper or radiometric", mode, settings.technique->id);
  params::from_json(settings.blocks(), base);
  params::from_json(settings.blocks(), form.value("params", json::object()));
  return settings;
}

std::string markdown_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string text = fmt::format("| {} |\n|---|", fmt::join(head, " | "));
  for (size_t i = 1; i < head.size(); ++i) text += "---:|";
  text += "\n";
  for (const auto& row : rows) text += fmt::format("| {} |\n", fmt::join(row, " | "));
  return text;
}

}  // namespace nf::editor
