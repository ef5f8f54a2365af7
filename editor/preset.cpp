// Reading is strict, as everywhere: a mistyped key would silently give another picture.
#include "preset.h"

#include <limits>

#include "core/error.h"
#include "image/file.h"

namespace nf::editor {

using nlohmann::json;

namespace {

// {"1": camera, "9": camera}, a camera being written as in a view file.
Bookmarks read_bookmarks(const json& value, const std::string& file) {
  if (!value.is_object())
    fail(Exit::Input, "bad preset '{}': 'bookmarks' must be an object of cameras by their number", file);
  Bookmarks out;
  for (const auto& [key, camera] : value.items()) {
    if (key.size() != 1 || key[0] < '1' || key[0] > '9')
      fail(Exit::Input, "bad preset '{}': unknown key 'bookmarks.{}'; there are 1 to 9", file, key);
    out[size_t(key[0] - '1')] = scene::parse_camera(camera, file, "bookmarks." + key);
  }
  return out;
}

}  // namespace

Preset read_preset(const std::filesystem::path& path) {
  const std::string file = path.string();
  json document;
  try {
    document = json::parse(image::read_file(path));
  } catch (const json::exception& e) {
    fail(Exit::Input, "cannot read the preset '{}': it is not JSON: {}", file, e.what());
  }
  if (!document.is_object() || document.value("schema", json()) != "nearfield.preset/1")
    fail(Exit::Input, "cannot read the preset '{}': its \"schema\" must be \"nearfield.preset/1\"", file);
  Preset preset;
  for (const auto& [key, value] : document.items()) {
    const auto text = [&, name = key, &held = value] {
      if (!held.is_string()) fail(Exit::Input, "bad preset '{}': '{}' must be a string", file, name);
      return held.get<std::string>();
    };
    if (key == "schema") continue;
    if (key == "scene") {
      preset.scene = text();
    } else if (key == "technique") {
      preset.technique = text();
    } else if (key == "mode") {
      preset.mode = text();
      if (preset.mode != "paper" && preset.mode != "radiometric")
        fail(Exit::Input, "bad preset '{}': 'mode' must be \"paper\" or \"radiometric\"", file);
    } else if (key == "view") {
      if (value.is_object())
        preset.view = scene::parse_view(value, file, path.parent_path(), "view");
      else if (value.is_string())
        preset.view = value.get<std::string>();
      else
        fail(Exit::Input, "bad preset '{}': 'view' must be a string, or an object as in a view file", file);
    } else if (key == "size") {
      preset.size = text();
    } else if (key == "seed") {
      if (!value.is_number_unsigned() || value.get<uint64_t>() > std::numeric_limits<uint32_t>::max())
        fail(Exit::Input, "bad preset '{}': 'seed' must be a whole number, 0 to 4294967295", file);
      preset.seed = value.get<uint32_t>();
    } else if (key == "params") {
      preset.params = value;
    } else if (key == "bookmarks") {
      preset.bookmarks = read_bookmarks(value, file);
    } else if (key == "made") {
      if (!value.is_object()) fail(Exit::Input, "bad preset '{}': 'made' must be an object", file);
      preset.made = value;
    } else {
      fail(Exit::Input,
           "bad preset '{}': unknown key '{}'; there are schema, scene, technique, mode, view, size, seed, params, "
           "bookmarks, "
           "made",
           file, key);
    }
  }
  return preset;
}

void write_preset(const std::filesystem::path& path, const Preset& preset) {
  json document = {{"schema", "nearfield.preset/1"}};
  const auto put = [&](const char* key, const std::optional<std::string>& value) {
    if (value) document[key] = *value;
  };
  put("scene", preset.scene);
  put("technique", preset.technique);
  put("mode", preset.mode);
  put("size", preset.size);
  if (preset.seed) document["seed"] = *preset.seed;
  if (preset.view) {
    if (const auto* name = std::get_if<std::string>(&*preset.view))
      document["view"] = *name;
    else
      document["view"] = scene::to_json(std::get<scene::View>(*preset.view), path.parent_path());
  }
  if (!preset.params.empty()) document["params"] = preset.params;
  if (preset.bookmarks) {
    document["bookmarks"] = json::object();
    for (size_t i = 0; i < preset.bookmarks->size(); ++i)
      if (const auto& camera = (*preset.bookmarks)[i])
        document["bookmarks"][std::to_string(i + 1)] = scene::to_json(*camera);
  }
  if (!preset.made.is_null()) document["made"] = preset.made;
  const std::string text = document.dump(1) + "\n";
  image::write_file(path, text);
}

}  // namespace nf::editor
