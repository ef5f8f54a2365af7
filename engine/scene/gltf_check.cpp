// The structure of a glTF document, checked before tinygltf sees it: tinygltf takes a default for what has the wrong
// type and drops what it cannot parse, silently. After this, every index is a row and every number is finite.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/log.h"
#include "scene/gltf_import.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

using nlohmann::json;

constexpr int64_t no_limit = int64_t(1) << 53;  // beyond it JSON numbers lose whole values

// A JSON object with its path in the document.
struct At {
  const json& value;
  std::string path;

  std::string key(const char* name) const { return path.empty() ? name : path + "." + name; }
  bool has(const char* name) const { return value.contains(name); }

  void require(const char* name) const {
    if (!has(name)) refuse("{} is missing", key(name));
  }

  void integer(const char* name, int64_t least, int64_t most) const {
    if (has(name)) check_integer(value[name], key(name), least, most);
  }
  static void check_integer(const json& number, const std::string& where, int64_t least, int64_t most) {
    if (!number.is_number_integer()) refuse("{} is not a whole number", where);
    const bool huge = number.is_number_unsigned() && number.get<uint64_t>() > uint64_t(no_limit);
    if (huge || number.get<int64_t>() < least || number.get<int64_t>() > most) {
      refuse("{} is {}, which is out of range", where, number.dump());
    }
  }

  // A row of a section of the document.
  void index(const char* name, const char* section, size_t rows) const {
    if (has(name)) check_index(value[name], key(name), section, rows);
  }
  static void check_index(const json& number, const std::string& where, const char* section, size_t rows) {
    if (!number.is_number_integer()) refuse("{} is not a whole number", where);
    const bool inside = number.is_number_unsigned() && number.get<uint64_t>() < rows;
    if (!inside) refuse("{} is {}, but the file has {} {}", where, number.dump(), rows, section);
  }

  void number(const char* name) const {
    if (has(name)) check_number(value[name], key(name));
  }
  static void check_number(const json& number, const std::string& where) {
    if (!number.is_number()) refuse("{} is not a number", where);
    if (!(std::abs(number.get<double>()) <= double(std::numeric_limits<float>::max()))) {
      refuse("{} is not a finite number", where);
    }
  }

  void numbers(const char* name, size_t count) const {
    if (!has(name)) return;
    const json& list = value[name];
    if (!list.is_array() || list.size() != count) refuse("{} is not a list of {} numbers", key(name), count);
    for (const json& element : list) check_number(element, key(name));
  }

  void text(const char* name) const {
    if (has(name) && !value[name].is_string()) refuse("{} is not a text", key(name));
  }
  void flag(const char* name) const {
    if (has(name) && !value[name].is_boolean()) refuse("{} is neither true nor false", key(name));
  }

  // Calls `check` with the member, which must be an object, when it is there.
  template <class Check>
  void object(const char* name, const Check& check) const {
    if (!has(name)) return;
    if (!value[name].is_object()) refuse("{} is not an object", key(name));
    check(At{value[name], key(name)});
  }
  template <class Check>
  void objects(const char* name, const Check& check) const {
    if (!has(name)) return;
    if (!value[name].is_array()) refuse("{} is not a list", key(name));
    for (size_t i = 0; i < value[name].size(); ++i) {
      const json& element = value[name][i];
      std::string where = fmt::format("{}[{}]", key(name), i);
      if (!element.is_object()) refuse("{} is not an object", where);
      check(At{element, std::move(where)});
    }
  }

  size_t rows(const char* name) const { return has(name) && value[name].is_array() ? value[name].size() : 0; }
};

void check_asset(const At& root) {
  if (!root.value.is_object() || !root.has("asset") || !root.value["asset"].is_object()) {
    refuse("it is JSON, but not glTF: there is no 'asset'");
  }
  const At asset{root.value["asset"], "asset"};
  asset.require("version");
  asset.text("version");
  const std::string& version = asset.value["version"].get_ref<const std::string&>();
  if (!version.starts_with("2.")) refuse("it is glTF {}; only 2.0 is read", one_line(version, 20));
  asset.text("minVersion");
  if (asset.has("minVersion") && asset.value["minVersion"] != "2.0") {
    refuse("it needs glTF {}; only 2.0 is read", one_line(asset.value["minVersion"].get_ref<const std::string&>(), 20));
  }
}

void check_extensions(const At& root) {
  for (const char* list : {"extensionsRequired", "extensionsUsed"}) {
    if (!root.has(list)) continue;
    if (!root.value[list].is_array()) refuse("{} is not a list", list);
    for (const json& entry : root.value[list]) {
      if (!entry.is_string()) refuse("{} holds something that is not a text", list);
      const std::string& name = entry.get_ref<const std::string&>();
      if (name == "KHR_lights_punctual" || name == "KHR_materials_emissive_strength") continue;
      if (list == std::string_view("extensionsRequired")) {
        refuse_advising("export it again without that extension",
                        "it requires the extension {}, which is not supported", one_line(name));
      }
      log::debug("the extension {} is ignored", one_line(name));
    }
  }
}

void check_data(const At& root) {
  root.objects("buffers", [](const At& buffer) {
    buffer.text("name");
    buffer.text("uri");
    buffer.require("byteLength");
    buffer.integer("byteLength", 1, no_limit);
  });
  root.objects("bufferViews", [&](const At& view) {
    view.require("buffer");
    view.index("buffer", "buffers", root.rows("buffers"));
    view.require("byteLength");
    view.integer("byteLength", 1, no_limit);
    view.integer("byteOffset", 0, no_limit);
    view.integer("byteStride", 4, 252);
    const json& buffer = root.value["buffers"][view.value["buffer"].get<size_t>()];
    const uint64_t end = view.value.value("byteOffset", uint64_t(0)) + view.value["byteLength"].get<uint64_t>();
    if (end > buffer["byteLength"].get<uint64_t>()) {
      refuse("{} ends at byte {} of a buffer of {}", view.path, end, buffer["byteLength"].get<uint64_t>());
    }
  });
  static constexpr std::string_view types[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
  root.objects("accessors", [&](const At& accessor) {
    accessor.index("bufferView", "bufferViews", root.rows("bufferViews"));
    accessor.integer("byteOffset", 0, no_limit);
    accessor.require("componentType");
    accessor.integer("componentType", 5120, 5126);
    accessor.require("count");
    accessor.integer("count", 0, no_limit);
    accessor.require("type");
    accessor.text("type");
    const std::string& type = accessor.value["type"].get_ref<const std::string&>();
    if (std::find(std::begin(types), std::end(types), type) == std::end(types)) {
      refuse("{} is '{}'", accessor.key("type"), one_line(type, 20));
    }
    accessor.flag("normalized");
    accessor.object("sparse", [&](const At& sparse) {
      sparse.require("count");
      sparse.integer("count", 0, std::numeric_limits<int32_t>::max());
      for (const char* part : {"indices", "values"}) {
        sparse.require(part);
        sparse.object(part, [&](const At& table) {
          table.require("bufferView");
          table.index("bufferView", "bufferViews", root.rows("bufferViews"));
          table.integer("byteOffset", 0, std::numeric_limits<int32_t>::max());
          table.integer("componentType", 5120, 5126);
        });
      }
    });
  });
}

void check_meshes(const At& root) {
  root.objects("meshes", [&](const At& mesh) {
    mesh.text("name");
    mesh.require("primitives");
    mesh.objects("primitives", [&](const At& primitive) {
      primitive.integer("mode", 0, 6);
      primitive.index("indices", "accessors", root.rows("accessors"));
      primitive.index("material", "materials", root.rows("materials"));
      primitive.require("attributes");
      primitive.object("attributes", [&](const At& attributes) {
        for (const auto& [name, accessor] : attributes.value.items()) {
          At::check_index(accessor, attributes.key(one_line(name).c_str()), "accessors", root.rows("accessors"));
        }
      });
    });
  });
}

void check_nodes(const At& root) {
  root.objects("nodes", [&](const At& node) {
    node.text("name");
    node.index("mesh", "meshes", root.rows("meshes"));
    node.index("camera", "cameras", root.rows("cameras"));
    node.numbers("matrix", 16);
    node.numbers("translation", 3);
    node.numbers("rotation", 4);
    node.numbers("scale", 3);
    if (node.has("children") && !node.value["children"].is_array()) refuse("{} is not a list", node.key("children"));
    if (node.has("children")) {
      for (const json& child : node.value["children"]) {
        At::check_index(child, node.key("children"), "nodes", root.rows("nodes"));
      }
    }
  });
  root.objects("scenes", [&](const At& scene) {
    if (!scene.has("nodes")) return;
    if (!scene.value["nodes"].is_array()) refuse("{} is not a list", scene.key("nodes"));
    for (const json& node : scene.value["nodes"]) {
      At::check_index(node, scene.key("nodes"), "nodes", root.rows("nodes"));
    }
  });
  root.index("scene", "scenes", root.rows("scenes"));
}

void check_materials(const At& root) {
  const auto texture = [&](const At& info) {
    info.require("index");
    info.index("index", "textures", root.rows("textures"));
    info.integer("texCoord", 0, 1000);
    info.number("scale");
    info.number("strength");
  };
  root.objects("materials", [&](const At& material) {
    material.text("name");
    material.object("pbrMetallicRoughness", [&](const At& pbr) {
      pbr.numbers("baseColorFactor", 4);
      pbr.number("metallicFactor");
      pbr.number("roughnessFactor");
      pbr.object("baseColorTexture", texture);
      pbr.object("metallicRoughnessTexture", texture);
    });
    for (const char* name : {"normalTexture", "occlusionTexture", "emissiveTexture"}) material.object(name, texture);
    material.numbers("emissiveFactor", 3);
    material.text("alphaMode");
    material.number("alphaCutoff");
    material.flag("doubleSided");
    material.object("extensions", [](const At& extensions) {
      extensions.object("KHR_materials_emissive_strength",
                        [](const At& strength) { strength.number("emissiveStrength"); });
    });
  });
  root.objects("textures", [&](const At& row) {
    row.index("source", "images", root.rows("images"));
    row.index("sampler", "samplers", root.rows("samplers"));
  });
  root.objects("images", [&](const At& image) {
    image.text("name");
    image.text("uri");
    image.index("bufferView", "bufferViews", root.rows("bufferViews"));
    if (image.has("uri") == image.has("bufferView")) refuse("{} needs either a uri or a bufferView", image.path);
  });
  root.objects("samplers", [](const At& sampler) {
    for (const char* name : {"magFilter", "minFilter", "wrapS", "wrapT"}) sampler.integer(name, 0, 65535);
  });
}

void check_cameras_and_lights(const At& root) {
  root.objects("cameras", [](const At& camera) {
    camera.text("name");
    camera.require("type");
    camera.text("type");
    camera.object("perspective", [](const At& perspective) {
      for (const char* name : {"yfov", "znear", "zfar", "aspectRatio"}) perspective.number(name);
    });
  });
  size_t light_count = 0;
  root.object("extensions", [&](const At& extensions) {
    extensions.object("KHR_lights_punctual", [&](const At& extension) {
      light_count = extension.rows("lights");
      extension.objects("lights", [](const At& light) {
        light.text("name");
        light.require("type");
        light.text("type");
        light.numbers("color", 3);
        light.number("intensity");
        light.number("range");
        light.object("spot", [](const At& spot) {
          spot.number("innerConeAngle");
          spot.number("outerConeAngle");
        });
      });
    });
  });
  root.objects("nodes", [&](const At& node) {
    node.object("extensions", [&](const At& extensions) {
      extensions.object("KHR_lights_punctual", [&](const At& use) {
        use.require("light");
        use.index("light", "lights", light_count);
      });
    });
  });
}

}  // namespace

void check_document(const json& document) {
  const At root{document, ""};
  check_asset(root);
  check_extensions(root);
  check_data(root);
  check_meshes(root);
  check_nodes(root);
  check_materials(root);
  check_cameras_and_lights(root);
}

}  // namespace nf::scene::gltf
