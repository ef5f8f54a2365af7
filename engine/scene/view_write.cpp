// Views as JSON again.
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "scene/view.h"

namespace nf::scene {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Floats with the digits of a float, not of the double that holds it: 0.1, not 0.10000000149.
json number(float value) {
  return json::parse(fmt::format("{}", value));
}
json vector(vec3 v) {
  return {number(v.x), number(v.y), number(v.z)};
}

json write_environment(const Environment& e, const fs::path& folder) {
  if (e.kind == EnvironmentKind::Gradient)
    return {{"zenith", vector(e.zenith)}, {"horizon", vector(e.horizon)}, {"ground", vector(e.ground)}};
  if (e.kind == EnvironmentKind::Constant) return {{"color", vector(e.color)}};
  if (e.file.empty())
    fail(Exit::Output, "cannot write the environment down: its map came from no file; save the map first");
  const fs::path map = fs::absolute(e.file).lexically_normal(),
                 base = fs::absolute(folder.empty() ? "." : folder).lexically_normal();
  const fs::path inside = map.lexically_relative(base);
  const bool within = !inside.empty() && *inside.begin() != "..";
  return {{"hdr", (within ? inside : map).generic_string()},
          {"intensity", number(e.intensity)},
          {"rotation_deg", number(glm::degrees(e.rotation))}};
}

}  // namespace

json to_json(const Camera& camera) {
  // Far enough from the eye that rounding the target does not turn the view.
  const float distance = std::max(glm::length(camera.position), 1.0f);
  return {{"position", vector(camera.position)},
          {"target", vector(camera.position + camera.forward * distance)},
          {"up", vector(camera.up)},
          {"vfov_deg", number(glm::degrees(camera.vfov))},
          {"near", number(camera.near)},
          {"far", number(camera.far)}};
}

json to_json(const View& view, const fs::path& folder) {
  json out = json::object();
  if (view.camera) out["camera"] = to_json(*view.camera);
  if (view.directional) {
    out["directional"] = json::array();
    for (const DirectionalLight& l : *view.directional)
      out["directional"].push_back({{"direction", vector(l.direction)},
                                    {"color", vector(l.color)},
                                    {"irradiance", number(l.irradiance)},
                                    {"angle_deg", number(l.angle_deg)}});
  }
  if (view.point) {
    out["point"] = json::array();
    for (const PunctualLight& l : *view.point) {
      json row = {{"position", vector(l.position)},
                  {"color", vector(l.color)},
                  {"intensity", number(l.intensity)},
                  {"radius", number(l.radius)}};
      if (l.range > 0) row["range"] = number(l.range);
      if (l.outer_cone < 3.14f) {
        row["direction"] = vector(l.direction);
        row["inner_cone_deg"] = number(glm::degrees(l.inner_cone));
        row["outer_cone_deg"] = number(glm::degrees(l.outer_cone));
      }
      out["point"].push_back(std::move(row));
    }
  }
  if (view.environment) out["environment"] = write_environment(*view.environment, folder);
  return out;
}

}  // namespace nf::scene
