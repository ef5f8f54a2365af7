// `nearfield info`: devices, techniques, parameters, scenes.
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "gi/param_sources.h"
#include "scene/gltf.h"
#include "scene/peaks.h"

namespace nf::editor {
namespace {

using nlohmann::json;

const char* type_text(ParamType type) {
  switch (type) {
    case ParamType::Float:
      return "float";
    case ParamType::Int:
      return "int";
    case ParamType::Bool:
      return "bool";
    case ParamType::Choice:
      return "choice";
    default:
      return "";
  }
}

json devices_json() {
  json out = json::array();
  for (const gpu::DeviceInfo& d : gpu::list_devices())
    out.push_back({{"index", d.index},
                   {"name", d.name},
                   {"type", d.type},
                   {"driver", d.driver},
                   {"driver_info", d.driver_info},
                   {"api", d.api},
                   {"usable", d.missing.empty()},
                   {"missing", d.missing}});
  return out;
}

json techniques_json() {
  json out = json::array();
  for (const passes::Technique& t : passes::techniques())
    out.push_back({{"id", t.id},
                   {"name", t.name},
                   {"paper", t.paper},
                   {"outputs", t.outputs},
                   {"modes", !t.paper_mode.empty() ? json({"radiometric", "paper"}) : json({"radiometric"})}});
  return out;
}

// All tables, or the shared ones and one technique's.
json params_json(const std::string& technique) {
  passes::FrameSettings settings;
  json out = json::array();
  for (const ParamBlock& block : settings.blocks()) {
    bool wanted = technique.empty();
    if (!wanted) {
      const passes::Technique& t = passes::find_technique(technique);
      bool of_other = false;
      for (const passes::Technique& other : passes::techniques())
        of_other |= &other != &t && other.params(settings.gi).table == block.table;
      wanted = !of_other;
    }
    if (!wanted) continue;
    for (const Param& p : block.table->params) {
      json row = {{"id", fmt::format("{}.{}", block.table->prefix, p.name)},
                  {"type", type_text(p.type)},
                  {"default", params::format(p, p.default_value)},
                  {"help", p.help}};
      if (const std::string_view source = passes::param_source(block.table->prefix, p.name); !source.empty())
        row["source"] = source;
      if (p.type == ParamType::Choice)
        row["choices"] = p.unit;
      else if (p.type != ParamType::Bool)
        row["min"] = p.min, row["max"] = p.max, row["unit"] = p.unit;
      out.push_back(row);
    }
  }
  return out;
}

json scene_json(const std::string& path) {
  const scene::Scene s = scene::load_gltf(path);
  json cameras = json::array();
  for (const scene::Camera& c : s.cameras) cameras.push_back(c.name);
  uint64_t drawn = 0;
  for (const uint32_t p : s.instances.primitive) drawn += s.primitives[p].index_count / 3;
  const auto vec = [](const glm::vec3& v) { return json({v.x, v.y, v.z}); };
  return {{"path", path},
          {"nodes", s.nodes.size()},
          {"primitives", s.primitives.size()},
          {"instances", s.instances.size()},
          {"triangles", s.triangles()},
          {"drawn_triangles", drawn},
          {"vertices", s.geometry.position.size()},
          {"materials", s.materials.size()},
          {"pictures", s.pictures.size()},
          {"textures", s.textures.size()},
          {"variants", s.variants},
          {"cameras", cameras},
          {"directional_lights", s.directional.size()},
          {"punctual_lights", s.punctual.size()},
          {"peak_distance", scene::peak_distance(s)},
          {"bounds", {{"min", vec(s.bounds.min)}, {"max", vec(s.bounds.max)}}}};
}

void print_text(const json& info) {
  if (info.contains("devices"))
    for (const json& d : info["devices"])
      fmt::print("device {}: {} ({}), Vulkan {}, {} {}{}\n", d["index"].get<int>(), d["name"].get<std::string>(),
                 d["type"].get<std::string>(), d["api"].get<std::string>(), d["driver"].get<std::string>(),
                 d["driver_info"].get<std::string>(),
                 d["usable"].get<bool>() ? "" : "; unusable, lacks " + d["missing"].get<std::string>());
  if (info.contains("techniques"))
    for (const json& t : info["techniques"])
      fmt::print("{:6} {:28} outputs: {:16} {}\n", t["id"].get<std::string>(), t["name"].get<std::string>(),
                 t["outputs"].get<std::string>(), t["paper"].get<std::string>());
  if (info.contains("params"))
    for (const json& p : info["params"]) {
      const std::string range = p.contains("choices") ? p["choices"].get<std::string>()
                                : p.contains("min")   ? fmt::format("{} to {} {}", p["min"].get<double>(),
                                                                    p["max"].get<double>(), p["unit"].get<std::string>())
                                                      : "true|false";
      const std::string source = p.contains("source") ? fmt::format("  ({})", p["source"].get<std::string>()) : "";
      fmt::print("{:26} = {:10} [{}]  {}{}\n", p["id"].get<std::string>(), p["default"].get<std::string>(), range,
                 p["help"].get<std::string>(), source);
    }
  if (info.contains("scene"))
    for (const auto& [key, value] : info["scene"].items())
      fmt::print("{:20} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
}

}  // namespace

Command add_info(CLI::App& parent) {
  struct State : CommonOptions {
    bool techniques = false, devices = false, as_json = false;
    std::string params_of, scene;
  };
  auto state = std::make_shared<State>();
  CLI::App* app = parent.add_subcommand("info", "Print devices, techniques, parameters, or what is in a scene");
  app->add_flag("--techniques", state->techniques, "GI techniques");
  CLI::Option* params_flag = app->add_option("--params", state->params_of,
                                             "Parameters with range, default and help; of one technique when named")
                                 ->type_name("[T]")
                                 ->expected(0, 1);
  app->add_flag("--devices", state->devices, "Vulkan devices, and what unusable ones lack");
  app->add_option("--scene", state->scene, "Contents of a glTF scene")->type_name("FILE");
  app->add_flag("--json", state->as_json, "One JSON document on stdout");
  add_log_flags(*app, *state);
  app->footer("Examples:\n  nearfield info --params vbgi\n  nearfield info --scene scene.glb --json");
  return {app, [state, params_flag] {
            start_log(*state);
            const bool params = params_flag->count() > 0;
            const bool all = !params && !state->techniques && !state->devices && state->scene.empty();
            json info = {{"schema", "nearfield.info/1"}, {"version", version_line()}};
            if (state->devices || all) info["devices"] = devices_json();
            if (state->techniques || all) info["techniques"] = techniques_json();
            if (params) info["params"] = params_json(state->params_of == "true" ? "" : state->params_of);
            if (!state->scene.empty()) info["scene"] = scene_json(state->scene);
            if (state->as_json)
              fmt::print("{}\n", info.dump(1));
            else
              print_text(info);
            return int(Exit::Ok);
          }};
}

}  // namespace nf::editor
