#include "settings.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "image/file.h"
#include "image/image.h"
#include "state.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string last_written;
json kept_bookmarks = json::object();  // by scene

fs::path config_folder() {
  if (const char* config = std::getenv("XDG_CONFIG_HOME"); config && *config) return fs::path(config) / "nearfield";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".config" / "nearfield";
  return {};
}

json vec(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}
glm::vec3 vec(const json& v) {
  return {v.at(0).get<float>(), v.at(1).get<float>(), v.at(2).get<float>()};
}

std::string scene_key(const std::string& path) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(path, error);
  return error ? path : whole.string();
}

json to_json(const Bookmarks& bookmarks) {
  json out = json::object();
  for (size_t i = 0; i < bookmarks.size(); ++i)
    if (const auto& c = bookmarks[i])
      out[std::to_string(i)] = {{"position", vec(c->position)},
                                {"forward", vec(c->forward)},
                                {"up", vec(c->up)},
                                {"vfov", c->vfov},
                                {"near", c->near},
                                {"far", c->far}};
  return out;
}

// Every preference by name: read and written from one list.
template <class Visit>
void visit(Preferences& p, const Visit& visit) {
  visit("ui_scale", p.ui_scale, 0.75f, 3.0f);
  visit("render_scale", p.render_scale, 0.25f, 1.0f);
  visit("moving_scale", p.moving_scale, 0.1f, 1.0f);
  visit("left", p.left, 0.08f, 0.6f);
  visit("right", p.right, 0.08f, 0.6f);
  visit("bottom", p.bottom, 0.08f, 0.6f);
}

}  // namespace

std::string load_settings(Editor& editor, bool reset) {
  const fs::path file = config_folder() / "editor.json";
  std::ifstream in(file);
  if (reset || !in) return {};
  try {
    const json settings = json::parse(in);
    if (settings.at("schema") != "nearfield.editor/1") throw std::runtime_error("another schema");
    Preferences p;
    const json& values = settings.at("preferences");
    visit(p, [&](const char* name, float& value, float low, float high) {
      value = std::clamp(values.value(name, value), low, high);
    });
    p.scale_chosen = values.value("scale_chosen", false);
    p.hints = values.value("hints", true);
    p.right_tab = values.value("right_tab", "");
    p.bottom_tab = values.value("bottom_tab", "");
    const json floating = values.value("floating", json::object());
    for (const auto& [name, place] : floating.items())
      p.floating[name] = {place.at(0), place.at(1), place.at(2), place.at(3)};
    p.settle = std::clamp(values.value("settle", p.settle), 1, 1024);
    p.capture_frames = std::clamp(values.value("capture_frames", p.capture_frames), 1, int(TimingHistory::limit));
    kept_bookmarks = settings.value("bookmarks", json::object());
    editor.preferences = p;
    return {};
  } catch (const std::exception& error) {
    std::error_code failed;
    fs::rename(file, file.string() + ".bad", failed);
    return fmt::format("the settings could not be read and are now '{}.bad': {}", file.string(), error.what());
  }
}

std::string save_settings(const Editor& editor) {
  const fs::path folder = config_folder();
  if (folder.empty()) return {};
  json values = json::object();
  Preferences p = editor.preferences;
  visit(p, [&](const char* name, float& value, float, float) { values[name] = value; });
  values["scale_chosen"] = p.scale_chosen;
  values["hints"] = p.hints;
  values["right_tab"] = p.right_open;
  values["bottom_tab"] = p.bottom_open;
  values["settle"] = p.settle;
  values["capture_frames"] = p.capture_frames;
  values["floating"] = json::object();
  for (const auto& [name, place] : p.floating) values["floating"][name] = {place.x, place.y, place.width, place.height};
  if (editor.scene_ready) kept_bookmarks[scene_key(editor.scene.path)] = to_json(editor.document.bookmarks);
  const std::string text =
      json{{"schema", "nearfield.editor/1"}, {"preferences", values}, {"bookmarks", kept_bookmarks}}.dump(1) + "\n";
  if (text == last_written) return {};
  try {
    fs::create_directories(folder);
    write_atomically(folder / "editor.json", text);
    last_written = text;
  } catch (const std::exception& error) {
    last_written = text;  // said once
    return fmt::format("the settings were not kept: {}", error.what());
  }
  return {};
}

Bookmarks load_bookmarks(const std::string& scene) {
  Bookmarks out;
  try {
    const json kept = kept_bookmarks.value(scene_key(scene), json::object());
    for (const auto& [key, c] : kept.items()) {
      scene::Camera camera;
      camera.position = vec(c.at("position"));
      camera.forward = vec(c.at("forward"));
      camera.up = vec(c.at("up"));
      camera.vfov = c.at("vfov");
      camera.near = c.at("near");
      camera.far = c.at("far");
      out.at(size_t(std::stoul(key))) = camera;
    }
  } catch (const std::exception&) {
    return {};  // written by hand, and wrong: as if there were none
  }
  return out;
}

void apply_preset(const Preset& preset, Document& document) {
  passes::FrameSettings settings;
  settings.reconstruct = document.settings.reconstruct;
  settings.technique = preset.technique ? &passes::find_technique(*preset.technique) : document.settings.technique;
  if (preset.mode == "paper") passes::set_paper_mode(settings);
  params::from_json(settings.blocks(), preset.params);
  document.settings = settings;
  if (preset.seed) document.seed = *preset.seed;
  if (preset.bookmarks) document.bookmarks = *preset.bookmarks;
}

std::string view_name(const Preset& preset) {
  const auto* name = preset.view ? std::get_if<std::string>(&*preset.view) : nullptr;
  return name ? *name : std::string();
}
const scene::View* view_inside(const Preset& preset) {
  return preset.view ? std::get_if<scene::View>(&*preset.view) : nullptr;
}

void use_lights(const scene::View& view, live::SceneLights& lights) {
  if (view.directional) lights.directional = *view.directional;
  if (view.point) lights.punctual = *view.point;
  if (view.environment && view.environment->kind == scene::EnvironmentKind::Constant)
    lights.environment = view.environment->color;
}

Preset make_preset(Editor& editor) {
  Document& d = editor.document;
  Preset preset;
  std::error_code error;
  preset.scene = fs::absolute(editor.scene.path, error).string();
  preset.technique = d.settings.technique->id;
  preset.size = fmt::format("{}x{}", editor.picture.size.x, editor.picture.size.y);
  preset.seed = d.seed;
  scene::View view;
  view.camera = editor.view.camera;
  // Lights that are the file's own are left to it.
  if (!same(d.lights, editor.scene.own_lights)) {
    view.directional = d.lights.directional;
    view.point = d.lights.punctual;
  }
  if (!editor.scene.own_environment || d.lights.environment != editor.scene.own_lights.environment) {
    view.environment = editor.scene.environment;
    if (view.environment->kind == scene::EnvironmentKind::Constant) view.environment->color = d.lights.environment;
  }
  preset.view = view;
  preset.params = params::to_json(d.settings.blocks());
  if (std::any_of(d.bookmarks.begin(), d.bookmarks.end(), [](const auto& b) { return b.has_value(); }))
    preset.bookmarks = d.bookmarks;
  return preset;
}

std::string command_for(const Editor& editor, const fs::path& preset) {
  return fmt::format("nearfield render '{}' --preset '{}' -o picture.png --frames {}", editor.scene.path,
                     preset.string(), editor.wanted.settle);
}

}  // namespace nf::editor
