// View files and the choice of a camera. Reading is strict: a mistyped key would otherwise silently render something
// else.
#include "scene/view.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "image/file.h"
#include "scene/path.h"
#include "scene/text.h"

namespace nf::scene {

namespace {

using nlohmann::json;

// An object of the view file with its JSON path. All reading goes through here, so every error names file and path.
class Reader {
 public:
  Reader(const std::string& file, const json& value, std::string path)
      : file_(file), value_(value), path_(std::move(path)) {}

  template <class... Args>
  [[noreturn]] void bad(fmt::format_string<Args...> format, Args&&... args) const {
    fail(Exit::Input, "cannot read view '{}': {}; see \"View files\" in the README", file_,
         fmt::format(format, std::forward<Args>(args)...));
  }

  std::string key_path(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  }
  const std::string& path() const { return path_; }

  void expect_object(std::initializer_list<const char*> keys) const {
    if (!value_.is_object()) bad("{} must be an object", path_.empty() ? "the file" : "'" + path_ + "'");
    for (const auto& [key, member] : value_.items()) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      std::string known;
      for (const char* name : keys) known += (known.empty() ? "" : ", ") + std::string(name);
      bad("unknown key '{}' (known here: {})", one_line(key_path(key)), known);
    }
  }

  bool has(const char* key) const { return value_.contains(key); }
  Reader child(const char* key) const { return Reader(file_, value_.at(key), key_path(key)); }

  std::vector<Reader> list(const char* key) const {
    const json& array = value_.at(key);
    if (!array.is_array()) bad("'{}' must be a list", key_path(key));
    std::vector<Reader> rows;
    for (size_t i = 0; i < array.size(); ++i) {
      rows.emplace_back(file_, array[i], fmt::format("{}[{}]", key_path(key), i));
    }
    return rows;
  }

  float number(const char* key, float fallback) const {
    return has(key) ? to_float(value_.at(key), key_path(key)) : fallback;
  }
  float number_at_least(const char* key, float fallback, float least) const {
    const float value = number(key, fallback);
    if (value < least) bad("'{}' must not be below {}", key_path(key), least);
    return value;
  }

  std::string text(const char* key) const {
    const json& value = value_.at(key);
    if (!value.is_string() || value.get_ref<const std::string&>().empty()) bad("'{}' must be a text", key_path(key));
    return value.get<std::string>();
  }

  vec3 vector(const char* key) const {
    if (!has(key)) bad("'{}' is missing", key_path(key));
    const json& array = value_.at(key);
    if (!array.is_array() || array.size() != 3) bad("'{}' must be a list of three numbers", key_path(key));
    vec3 result;
    for (int i = 0; i < 3; ++i) result[i] = to_float(array[size_t(i)], fmt::format("{}[{}]", key_path(key), i));
    return result;
  }
  vec3 vector(const char* key, vec3 fallback) const { return has(key) ? vector(key) : fallback; }

  vec3 direction(const char* key) const {
    const glm::dvec3 wide(vector(key));
    const double length = glm::length(wide);
    if (!(length > 1e-12)) bad("'{}' must not be zero", key_path(key));
    return vec3(wide / length);
  }
  vec3 color(const char* key, vec3 fallback) const {
    const vec3 result = vector(key, fallback);
    if (glm::any(glm::lessThan(result, vec3(0)))) bad("'{}' must not be negative", key_path(key));
    return result;
  }

 private:
  float to_float(const json& value, const std::string& path) const {
    if (!value.is_number()) bad("'{}' must be a number", path);
    const double wide = value.get<double>();
    if (!std::isfinite(wide) || std::abs(wide) > 1e30) bad("'{}' is not a finite number of sensible size", path);
    return float(wide);
  }

  const std::string& file_;
  const json& value_;
  std::string path_;
};

Camera read_camera(const Reader& reader) {
  reader.expect_object({"position", "target", "up", "vfov_deg", "near", "far"});
  Camera camera;
  camera.name = "view";
  camera.position = reader.vector("position");
  const glm::dvec3 ahead = glm::dvec3(reader.vector("target")) - glm::dvec3(camera.position);
  const double distance = glm::length(ahead);
  if (!(distance > 1e-12)) reader.bad("'{0}.target' is where '{0}.position' is", reader.path());
  camera.forward = vec3(ahead / distance);
  camera.up = reader.has("up") ? reader.direction("up") : vec3(0, 1, 0);
  if (glm::length(glm::cross(camera.forward, camera.up)) < 1e-4f) {
    reader.bad("'{}.up' is parallel to the viewing direction", reader.path());
  }
  const float vfov_deg = reader.number("vfov_deg", 60);
  if (!(vfov_deg > 0.01f && vfov_deg < 179.9f)) reader.bad("'{}.vfov_deg' must lie between 0 and 180", reader.path());
  camera.vfov = glm::radians(vfov_deg);
  camera.near = reader.number("near", camera.near);
  if (!(camera.near > 0)) reader.bad("'{}.near' must be above 0", reader.path());
  camera.far = reader.number("far", std::max(camera.far, 2 * camera.near));
  if (!(camera.far > camera.near)) reader.bad("'{0}.far' must be above '{0}.near'", reader.path());
  return camera;
}

DirectionalLight read_directional(const Reader& reader) {
  reader.expect_object({"direction", "color", "irradiance", "angle_deg"});
  DirectionalLight light;
  light.direction = reader.direction("direction");
  light.color = reader.color("color", light.color);
  light.irradiance = reader.number_at_least("irradiance", light.irradiance, 0);
  light.angle_deg = reader.number_at_least("angle_deg", light.angle_deg, 0);
  if (light.angle_deg > 180) reader.bad("'{}.angle_deg' must not be above 180", reader.path());
  return light;
}

PunctualLight read_point(const Reader& reader) {
  reader.expect_object(
      {"position", "color", "intensity", "radius", "range", "direction", "inner_cone_deg", "outer_cone_deg"});
  PunctualLight light;
  light.position = reader.vector("position");
  light.color = reader.color("color", light.color);
  light.intensity = reader.number_at_least("intensity", light.intensity, 0);
  light.radius = reader.number_at_least("radius", light.radius, 0);
  light.range = reader.number_at_least("range", light.range, 0);
  const bool spot = reader.has("outer_cone_deg");
  if (!spot) {
    for (const char* key : {"direction", "inner_cone_deg"})
      if (reader.has(key))
        reader.bad("'{}' belongs to a spot light, which has an outer_cone_deg", reader.key_path(key));
    return light;
  }
  light.direction = reader.direction("direction");
  const float outer = reader.number("outer_cone_deg", 45), inner = reader.number_at_least("inner_cone_deg", 0, 0);
  if (!(outer > 0 && outer <= 90)) reader.bad("'{}.outer_cone_deg' must be above 0 and not above 90", reader.path());
  if (!(inner < outer)) reader.bad("'{0}.inner_cone_deg' must be below '{0}.outer_cone_deg'", reader.path());
  light.outer_cone = glm::radians(outer);
  light.inner_cone = glm::radians(inner);
  return light;
}

// `folder` is the view file's: a map's path is relative to it.
Environment read_environment(const Reader& reader, const std::filesystem::path& folder) {
  reader.expect_object({"color", "intensity", "zenith", "horizon", "ground", "hdr", "rotation_deg"});
  const bool gradient = reader.has("zenith") || reader.has("horizon") || reader.has("ground");
  if (reader.has("hdr") && reader.has("color")) reader.bad("'{}' has both color and hdr", reader.path());
  if (gradient && (reader.has("hdr") || reader.has("color"))) {
    reader.bad("'{}' has a gradient (zenith, horizon, ground) beside {}", reader.path(),
               reader.has("hdr") ? "hdr" : "color");
  }
  const float intensity = reader.number_at_least("intensity", 1, 0);
  if (reader.has("hdr")) {
    const std::filesystem::path map = folder / reader.text("hdr");
    const float rotation_deg = reader.number("rotation_deg", 0);
    try {
      return load_environment_map(map, intensity, rotation_deg);
    } catch (const Error& e) {
      reader.bad("'{}': {}", reader.key_path("hdr"), one_line(e.what(), 500));
    }
  }
  if (reader.has("rotation_deg")) reader.bad("'{}.rotation_deg' belongs to an hdr environment", reader.path());
  const auto color = [&](const char* key) {
    if (!reader.has(key)) reader.bad("'{}' is missing", reader.key_path(key));
    const vec3 value = reader.color(key, vec3(0)) * intensity;
    if (!glm::all(glm::lessThan(value, vec3(1e30f)))) {
      reader.bad("'{}': {} times intensity is too large", reader.path(), key);
    }
    return value;
  };
  Environment environment;
  if (gradient) {
    environment.kind = EnvironmentKind::Gradient;
    environment.zenith = color("zenith");
    environment.horizon = color("horizon");
    environment.ground = color("ground");
  } else {
    environment.color = color("color");
  }
  return environment;
}

json read_json(const std::string& file) {
  const std::vector<uint8_t> text = image::read_file(file);
  // Nesting beyond any real view file would only serve to exhaust the stack.
  const auto depth_limit = [&](int depth, json::parse_event_t, json&) {
    if (depth > 16) fail(Exit::Input, "cannot read view '{}': nested too deeply; see \"View files\"", file);
    return true;
  };
  try {
    return json::parse(text, depth_limit);
  } catch (const json::parse_error& e) {
    fail(Exit::Input, "cannot read view '{}': not valid JSON at byte {}; check commas, quotes and brackets there", file,
         e.byte);
  } catch (const json::exception&) {
    fail(Exit::Input, "cannot read view '{}': a number is out of range; use finite numbers", file);
  }
}

std::string camera_list(const Scene& scene) {
  if (scene.cameras.empty()) return "the scene has no cameras, give a view file (.json)";
  std::string list;
  for (size_t i = 0; i < std::min<size_t>(scene.cameras.size(), 20); ++i) {
    list += fmt::format("{}{} '{}'", i ? ", " : "", i, scene.cameras[i].name);
  }
  if (scene.cameras.size() > 20) list += ", ...";
  return "the scene has " + list;
}

Camera default_camera(const Scene& scene) {
  return scene.cameras.empty() ? frame_bounds(scene.bounds) : scene.cameras.front();
}

}  // namespace

View parse_view(const json& value, const std::string& file, const std::filesystem::path& folder,
                const std::string& at) {
  const Reader reader(file, value, at);
  reader.expect_object({"camera", "directional", "point", "environment"});
  View view;
  if (reader.has("camera")) view.camera = read_camera(reader.child("camera"));
  if (reader.has("directional")) {
    view.directional.emplace();
    for (const Reader& row : reader.list("directional")) view.directional->push_back(read_directional(row));
  }
  if (reader.has("point")) {
    view.point.emplace();
    for (const Reader& row : reader.list("point")) view.point->push_back(read_point(row));
  }
  if (reader.has("environment")) view.environment = read_environment(reader.child("environment"), folder);
  return view;
}

Camera parse_camera(const json& value, const std::string& file, const std::string& at) {
  return read_camera(Reader(file, value, at));
}

View load_view(const std::filesystem::path& path) {
  return parse_view(read_json(path.string()), path.string(), path.parent_path());
}

CameraPath load_path(const std::filesystem::path& path) {
  const std::string file = path.string();
  const json document = read_json(file);
  const Reader reader(file, document, "");
  reader.expect_object({"schema", "keys"});
  if (!reader.has("schema") || reader.text("schema") != "nearfield.path/1")
    reader.bad("'schema' must be \"nearfield.path/1\"");
  if (!reader.has("keys")) reader.bad("'keys' is missing");
  CameraPath keys;
  for (const Reader& row : reader.list("keys")) {
    row.expect_object({"frame", "camera"});
    if (!row.has("frame") || !row.has("camera")) row.bad("'{}' needs frame and camera", row.path());
    const double frame = row.number("frame", 0);
    if (!keys.empty() && frame <= keys.back().frame)
      row.bad("'{}.frame' must be above that of the key before", row.path());
    keys.push_back({frame, read_camera(row.child("camera"))});
  }
  if (keys.size() < 2) reader.bad("'keys' needs two keys at least");
  return keys;
}

void apply_view(const View& view, Scene& scene) {
  if (view.directional) scene.directional = *view.directional;
  if (view.point) scene.punctual = *view.point;
  if (view.environment) scene.environment = *view.environment;
}

Camera select_view(const std::string& view, Scene& scene) {
  if (view.empty()) return default_camera(scene);
  if (std::filesystem::path(view).extension() == ".json") {
    const View loaded = load_view(view);
    apply_view(loaded, scene);
    return loaded.camera ? *loaded.camera : default_camera(scene);
  }
  for (const Camera& camera : scene.cameras) {
    if (camera.name == view) return camera;
  }
  const bool number =
      view.size() <= 9 && std::all_of(view.begin(), view.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (number && size_t(std::stoul(view)) < scene.cameras.size()) return scene.cameras[std::stoul(view)];
  fail(Exit::Input, "no view '{}': not a .json file, nor a camera's name or number; {}", one_line(view),
       camera_list(scene));
}

Camera frame_bounds(const Bounds& bounds) {
  const vec3 center = (bounds.min + bounds.max) * 0.5f;
  const float radius = std::max(glm::length(bounds.max - bounds.min) * 0.5f, 1e-3f);
  Camera camera;
  camera.name = "framing";
  camera.forward = -glm::normalize(vec3(1, 0.6f, 1.2f));
  // The sphere around the box just fits the vertical angle; 10 % of air.
  const float distance = 1.1f * radius / std::sin(camera.vfov / 2);
  camera.position = center - camera.forward * distance;
  camera.near = 0.01f * radius;
  camera.far = distance + 2 * radius;
  return camera;
}

}  // namespace nf::scene
