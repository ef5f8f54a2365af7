// The structure of a glTF document, checked before tinygltf sees it: tinygltf takes a default for what has the wrong
// type and drops what it cannot parse, silently. After this, every index is a row and every number is finite.
#include "scene/gltf_check.h"

#include <algorithm>
#include <string_view>

namespace nf::scene::gltf {

namespace {

using nlohmann::json;

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

constexpr std::string_view supported[] = {
    "KHR_lights_punctual",     "KHR_materials_emissive_strength", "KHR_materials_ior",     "KHR_materials_specular",
    "KHR_materials_unlit",     "KHR_materials_variants",          "KHR_mesh_quantization", "KHR_texture_transform",
    "EXT_meshopt_compression", "KHR_draco_mesh_compression"};

void check_extensions(const At& root) {
  for (const char* list : {"extensionsRequired", "extensionsUsed"}) {
    if (!root.has(list)) continue;
    if (!root.value[list].is_array()) refuse("{} is not a list", list);
    for (const json& entry : root.value[list]) {
      if (!entry.is_string()) refuse("{} holds something that is not a text", list);
      const std::string& name = entry.get_ref<const std::string&>();
      if (list == std::string_view("extensionsRequired") && !is_supported(name)) {
        refuse_advising("export it again without that extension",
                        "it requires the extension {}, which is not supported", one_line(name));
      }
    }
  }
}

// A range of bytes must end inside its buffer.
void check_end(const At& root, const At& range) {
  const json& buffer = root.value["buffers"][range.value["buffer"].get<size_t>()];
  const uint64_t end = range.value.value("byteOffset", uint64_t(0)) + range.value["byteLength"].get<uint64_t>();
  if (end > buffer["byteLength"].get<uint64_t>()) {
    refuse("{} ends at byte {} of a buffer of {}", range.path, end, buffer["byteLength"].get<uint64_t>());
  }
}

void check_buffers(const At& root) {
  root.objects("buffers", [](const At& buffer) {
    buffer.text("name");
    buffer.text("uri");
    buffer.require("byteLength");
    buffer.integer("byteLength", 1, no_limit);
    buffer.extension("EXT_meshopt_compression", [](const At& extension) { extension.flag("fallback"); });
  });
  root.objects("bufferViews", [&](const At& view) {
    view.require("buffer");
    view.index("buffer", "buffers", root.rows("buffers"));
    view.require("byteLength");
    view.integer("byteLength", 1, no_limit);
    view.integer("byteOffset", 0, no_limit);
    view.integer("byteStride", 4, 252);
    check_end(root, view);
    view.extension("EXT_meshopt_compression", [&](const At& packed) {
      for (const char* name : {"buffer", "byteLength", "byteStride", "count", "mode"}) packed.require(name);
      packed.index("buffer", "buffers", root.rows("buffers"));
      packed.integer("byteLength", 1, no_limit);
      packed.integer("byteOffset", 0, no_limit);
      packed.integer("byteStride", 1, 256);
      packed.integer("count", 1, std::numeric_limits<uint32_t>::max());
      packed.word("mode", {"ATTRIBUTES", "TRIANGLES", "INDICES"});
      packed.word("filter", {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"});
      check_end(root, packed);
    });
  });
}

void check_accessors(const At& root) {
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

void check_attributes(const At& root, const At& attributes) {
  for (const auto& [name, accessor] : attributes.value.items()) {
    At::check_index(accessor, attributes.key(one_line(name).c_str()), "accessors", root.rows("accessors"));
  }
}

void check_primitive(const At& root, const At& primitive, size_t variants) {
  primitive.integer("mode", 0, 6);
  primitive.index("indices", "accessors", root.rows("accessors"));
  primitive.index("material", "materials", root.rows("materials"));
  primitive.require("attributes");
  primitive.object("attributes", [&](const At& attributes) { check_attributes(root, attributes); });
  primitive.objects("targets", [&](const At& target) { check_attributes(root, target); });
  primitive.extension("KHR_draco_mesh_compression", [&](const At& draco) {
    draco.require("bufferView");
    draco.index("bufferView", "bufferViews", root.rows("bufferViews"));
    draco.require("attributes");
    draco.object("attributes", [&](const At& attributes) {
      for (const auto& [name, id] : attributes.value.items()) {
        At::check_integer(id, attributes.key(one_line(name).c_str()), 0, no_limit);
      }
    });
  });
  primitive.extension("KHR_materials_variants", [&](const At& extension) {
    extension.require("mappings");
    extension.objects("mappings", [&](const At& mapping) {
      mapping.require("material");
      mapping.index("material", "materials", root.rows("materials"));
      mapping.require("variants");
      mapping.indices("variants", "variants", variants);
    });
  });
}

void check_meshes(const At& root) {
  size_t variants = 0;
  root.extension("KHR_materials_variants", [&](const At& extension) {
    variants = extension.rows("variants");
    extension.objects("variants", [](const At& variant) { variant.text("name"); });
  });
  root.objects("meshes", [&](const At& mesh) {
    mesh.text("name");
    mesh.number_list("weights");
    mesh.require("primitives");
    mesh.objects("primitives", [&](const At& primitive) { check_primitive(root, primitive, variants); });
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
    node.number_list("weights");
    node.index("skin", "skins", root.rows("skins"));
    node.indices("children", "nodes", root.rows("nodes"));
  });
  root.objects("scenes", [&](const At& scene) { scene.indices("nodes", "nodes", root.rows("nodes")); });
  root.index("scene", "scenes", root.rows("scenes"));
}

}  // namespace

bool is_supported(const std::string& extension) {
  return std::find(std::begin(supported), std::end(supported), extension) != std::end(supported);
}

void check_document(const json& document) {
  const At root{document, ""};
  check_asset(root);
  check_extensions(root);
  check_buffers(root);
  check_accessors(root);
  check_meshes(root);
  check_nodes(root);
  check_materials(root);
  check_cameras_and_lights(root);
  check_skins_and_animations(root);
}

}  // namespace nf::scene::gltf
