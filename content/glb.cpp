// The builder's tables as a GLB file: one JSON chunk, one binary chunk, a buffer view an accessor or picture.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "builder.h"
#include "core/error.h"

namespace nf::content {

using Json = nlohmann::ordered_json;

namespace {

// glTF's numbers for what WebGL calls them.
constexpr int component_float = 5126, component_uint32 = 5125, component_uint16 = 5123, target_vertices = 34962,
              target_indices = 34963;

constexpr size_t none = ~size_t(0);

// The shortest text that reads back as this float, instead of the longer one of the double it converts to.
double number(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  double result = 0;
  std::from_chars(text, end, result);
  return result;
}
Json numbers(vec3 v) {
  return {number(v.x), number(v.y), number(v.z)};
}

void append_word(std::vector<uint8_t>& to, size_t word) {
  for (int shift = 0; shift < 32; shift += 8) to.push_back(uint8_t(word >> shift));
}

void append_chunk(std::vector<uint8_t>& to, const char* type, const uint8_t* data, size_t size, uint8_t padding) {
  append_word(to, (size + 3) / 4 * 4);
  to.insert(to.end(), type, type + 4);
  to.insert(to.end(), data, data + size);
  while (to.size() % 4 != 0) to.push_back(padding);
}

}  // namespace

class Writer {
 public:
  explicit Writer(const Builder& builder) : builder_(builder) {}

  std::vector<uint8_t> write() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "nearfield_content"}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({Json::object()});
    add_pictures();
    for (const Material& material : builder_.materials_) json_["materials"].push_back(material_json(material));
    add_objects();
    add_cameras();
    add_lights();
    add_parents();
    add_skins();
    add_tracks();
    if (json_["nodes"].empty()) json_.erase("nodes");
    if (!extensions_.empty()) json_["extensionsUsed"] = extensions_;
    if (!binary_.empty()) json_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});

    const std::string text = json_.dump();
    std::vector<uint8_t> body;
    append_chunk(body, "JSON", reinterpret_cast<const uint8_t*>(text.data()), text.size(), ' ');
    if (!binary_.empty()) append_chunk(body, "BIN\0", binary_.data(), binary_.size(), 0);
    std::vector<uint8_t> file{'g', 'l', 'T', 'F'};
    append_word(file, 2);
    append_word(file, 12 + body.size());
    file.insert(file.end(), body.begin(), body.end());
    return file;
  }

 private:
  size_t view(const void* data, size_t size, int target) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    Json row{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}};
    if (target != 0) row["target"] = target;
    const auto* bytes = static_cast<const uint8_t*>(data);
    binary_.insert(binary_.end(), bytes, bytes + size);
    json_["bufferViews"].push_back(row);
    return json_["bufferViews"].size() - 1;
  }

  template <class T>
  size_t accessor(const std::vector<T>& values, int component, const char* type, int target) {
    const size_t buffer_view = view(values.data(), values.size() * sizeof(T), target);
    json_["accessors"].push_back(
        {{"bufferView", buffer_view}, {"componentType", component}, {"count", values.size()}, {"type", type}});
    return json_["accessors"].size() - 1;
  }

  void use_extension(const char* name) {
    if (std::ranges::find(extensions_, name) == extensions_.end()) extensions_.emplace_back(name);
  }

  void add_pictures() {
    for (const auto& picture : builder_.pictures_) {
      const size_t buffer_view = view(picture.png.data(), picture.png.size(), 0);
      json_["images"].push_back({{"name", picture.name}, {"bufferView", buffer_view}, {"mimeType", "image/png"}});
      json_["textures"].push_back({{"source", json_["images"].size() - 1}, {"sampler", 0}});
    }
    // Linear, linear with mips, repeated both ways.
    if (!builder_.pictures_.empty())
      json_["samplers"] = Json::array({{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 10497}, {"wrapT", 10497}}});
  }

  Json material_json(const Material& m) {
    Json pbr{{"baseColorFactor", numbers(m.base_color)},
             {"metallicFactor", number(m.metallic)},
             {"roughnessFactor", number(m.roughness)}};
    pbr["baseColorFactor"].push_back(number(m.alpha));
    if (m.base_color_picture) pbr["baseColorTexture"] = {{"index", m.base_color_picture.id}};
    if (m.metallic_roughness_picture) pbr["metallicRoughnessTexture"] = {{"index", m.metallic_roughness_picture.id}};
    Json row{{"name", m.name}, {"pbrMetallicRoughness", pbr}};
    if (m.normal_picture) row["normalTexture"] = {{"index", m.normal_picture.id}, {"scale", number(m.normal_scale)}};
    if (m.emissive_picture) row["emissiveTexture"] = {{"index", m.emissive_picture.id}};
    // The factor may not exceed 1; the strength has no limit.
    const float strength = std::max({m.emissive.x, m.emissive.y, m.emissive.z});
    if (strength > 1) {
      use_extension("KHR_materials_emissive_strength");
      row["emissiveFactor"] = numbers(m.emissive / strength);
      row["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = number(strength);
    } else if (strength > 0) {
      row["emissiveFactor"] = numbers(m.emissive);
    }
    if (m.alpha_cutoff > 0) {
      row["alphaMode"] = "MASK";
      row["alphaCutoff"] = number(m.alpha_cutoff);
    }
    if (m.double_sided) row["doubleSided"] = true;
    return row;
  }

  Json& add_node(const Placement& placement, const std::string& name) {
    Json node{{"name", name}};
    const quat& q = placement.rotation;
    if (placement.translation != vec3(0)) node["translation"] = numbers(placement.translation);
    if (q != quat(1, 0, 0, 0)) node["rotation"] = {number(q.x), number(q.y), number(q.z), number(q.w)};
    if (placement.scale != vec3(1)) node["scale"] = numbers(placement.scale);
    return json_["nodes"].emplace_back(std::move(node));
  }

  Json primitive_json(const Primitive& primitive, const Builder::Skin* skin) {
    const size_t position = accessor(primitive.position, component_float, "VEC3", target_vertices);
    vec3 low = primitive.position[0], high = low;
    for (const vec3& p : primitive.position) low = glm::min(low, p), high = glm::max(high, p);
    json_["accessors"][position]["min"] = numbers(low);
    json_["accessors"][position]["max"] = numbers(high);
    Json attributes{{"POSITION", position},
                    {"NORMAL", accessor(primitive.normal, component_float, "VEC3", target_vertices)},
                    {"TEXCOORD_0", accessor(primitive.uv, component_float, "VEC2", target_vertices)}};
    if (builder_.materials_[primitive.material.id].normal_picture)
      attributes["TANGENT"] = accessor(primitive.tangent, component_float, "VEC4", target_vertices);
    if (skin) {
      std::vector<std::array<uint16_t, 4>> joints;
      std::vector<vec4> weights;
      for (const vec3& p : primitive.position) {
        const JointPair pair = skin->pair(p);
        joints.push_back({uint16_t(pair.first), uint16_t(pair.blend > 0 ? pair.second : 0), 0, 0});
        weights.emplace_back(1 - pair.blend, pair.blend, 0, 0);
      }
      attributes["JOINTS_0"] = accessor(joints, component_uint16, "VEC4", target_vertices);
      attributes["WEIGHTS_0"] = accessor(weights, component_float, "VEC4", target_vertices);
    }
    return {{"attributes", attributes},
            {"indices", accessor(primitive.index, component_uint32, "SCALAR", target_indices)},
            {"material", primitive.material.id}};
  }

  void add_objects() {
    std::vector<size_t> mesh_rows(builder_.objects_.size(), none);
    for (size_t i = 0; i < builder_.objects_.size(); ++i) {
      const Builder::Object& object = builder_.objects_[i];
      Json& node = add_node(object.placement, object.name);
      if (object.mesh_of) {
        if (mesh_rows[object.mesh_of.id] != none) node["mesh"] = mesh_rows[object.mesh_of.id];
        continue;
      }
      if (object.primitives.empty()) continue;
      const auto skin = std::ranges::find(builder_.skins_, ObjectId{uint16_t(i)}, &Builder::Skin::object);
      Json primitives = Json::array();
      for (const Primitive& primitive : object.primitives) {
        primitives.push_back(primitive_json(primitive, skin == builder_.skins_.end() ? nullptr : &*skin));
      }
      json_["meshes"].push_back({{"name", object.name}, {"primitives", primitives}});
      node["mesh"] = mesh_rows[i] = json_["meshes"].size() - 1;
    }
  }

  // Objects come first among the nodes, so an object's row is its node. Cameras and lights have no children.
  void add_parents() {
    std::vector<size_t> parent(json_["nodes"].size(), none);
    for (size_t i = 0; i < builder_.objects_.size(); ++i) {
      if (builder_.objects_[i].parent) parent[i] = builder_.objects_[i].parent.id;
    }
    const size_t first_light = json_["nodes"].size() - builder_.lights_.size();
    for (size_t i = 0; i < builder_.lights_.size(); ++i) {
      if (builder_.lights_[i].parent) parent[first_light + i] = builder_.lights_[i].parent.id;
    }
    for (size_t i = 0; i < parent.size(); ++i) {
      Json& list = parent[i] == none ? json_["scenes"][0]["nodes"] : json_["nodes"][parent[i]]["children"];
      list.push_back(i);
    }
  }

  glm::mat4 world_of(size_t object) const {
    glm::mat4 world(1);
    for (ObjectId at{uint16_t(object)}; at; at = builder_.objects_[at.id].parent) {
      const Placement& p = builder_.objects_[at.id].placement;
      const glm::mat4 local = glm::translate(glm::mat4(1), p.translation) * glm::mat4_cast(p.rotation);
      world = glm::scale(local, p.scale) * world;
    }
    return world;
  }

  void add_skins() {
    for (const Builder::Skin& skin : builder_.skins_) {
      std::vector<glm::mat4> inverse;
      Json joints = Json::array();
      for (const ObjectId joint : skin.joints) {
        inverse.push_back(glm::inverse(world_of(joint.id)));
        // Inverting leaves rounding in the row that has to be exact.
        for (int column = 0; column < 4; ++column) inverse.back()[column][3] = column == 3 ? 1.0f : 0.0f;
        joints.push_back(joint.id);
      }
      const size_t matrices = accessor(inverse, component_float, "MAT4", 0);
      json_["skins"].push_back({{"inverseBindMatrices", matrices}, {"joints", joints}});
      json_["nodes"][skin.object.id]["skin"] = json_["skins"].size() - 1;
    }
  }

  // All tracks make one clip.
  void add_tracks() {
    if (builder_.tracks_.empty()) return;
    Json channels = Json::array(), samplers = Json::array();
    for (const Builder::Track& track : builder_.tracks_) {
      const size_t input = accessor(track.times, component_float, "SCALAR", 0);
      json_["accessors"][input]["min"] = Json::array({number(track.times.front())});
      json_["accessors"][input]["max"] = Json::array({number(track.times.back())});
      const size_t output = accessor(track.values, component_float, track.rotation ? "VEC4" : "VEC3", 0);
      json_["accessors"][output]["count"] = track.times.size();
      channels.push_back(
          {{"sampler", samplers.size()},
           {"target", {{"node", track.object.id}, {"path", track.rotation ? "rotation" : "translation"}}}});
      samplers.push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
    }
    json_["animations"] = Json::array({{{"name", "all"}, {"channels", channels}, {"samplers", samplers}}});
  }

  void add_cameras() {
    for (const auto& camera : builder_.cameras_) {
      json_["cameras"].push_back(
          {{"name", camera.name},
           {"type", "perspective"},
           {"perspective",
            {{"yfov", number(camera.vfov)}, {"znear", number(camera.near)}, {"zfar", number(camera.far)}}}});
      add_node(camera.placement, camera.name)["camera"] = json_["cameras"].size() - 1;
    }
  }

  void add_lights() {
    static constexpr const char* extension = "KHR_lights_punctual";
    static constexpr const char* kinds[] = {"directional", "point", "spot"};
    for (const auto& light : builder_.lights_) {
      use_extension(extension);
      Json& rows = json_["extensions"][extension]["lights"];
      const std::string kind = kinds[size_t(light.kind)];
      const std::string name = fmt::format("{}{}", kind, rows.size());
      Json row{{"name", name}, {"type", kind}, {"color", numbers(light.color)}, {"intensity", number(light.intensity)}};
      if (light.kind == Builder::LightKind::Spot)
        row["spot"] = {{"innerConeAngle", number(light.inner)}, {"outerConeAngle", number(light.outer)}};
      const size_t index = rows.size();
      rows.push_back(row);
      add_node(light.placement, name)["extensions"][extension]["light"] = index;
    }
  }

  const Builder& builder_;
  Json json_;
  std::vector<std::string> extensions_;
  std::vector<uint8_t> binary_;
};

std::vector<uint8_t> Builder::glb() const {
  return Writer(*this).write();
}

}  // namespace nf::content
