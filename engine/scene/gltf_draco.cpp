// KHR_draco_mesh_compression: a primitive's compressed mesh becomes buffers, and its accessors name them.
#include <cstring>
#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <limits>

#include "scene/gltf_import.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

using nlohmann::json;

std::span<const uint8_t> view_bytes(const Source& source, size_t row, const std::string& where) {
  const json& view = source.document["bufferViews"][row];
  const std::vector<uint8_t>& buffer = source.buffers.at(view["buffer"].get<size_t>());
  const uint64_t offset = view.value("byteOffset", uint64_t(0)), length = view["byteLength"].get<uint64_t>();
  if (offset > buffer.size() || length > buffer.size() - offset) refuse("{} lies beyond its buffer", where);
  return std::span(buffer).subspan(size_t(offset), size_t(length));
}

// Reads LEB128 numbers, as Draco's bitstream has them; 0 beyond the end.
struct Varints {
  std::span<const uint8_t> bytes;
  size_t at;
  uint64_t next() {
    uint64_t value = 0;
    for (int shift = 0; at < bytes.size() && shift < 35; shift += 7) {
      const uint8_t byte = bytes[at++];
      value |= uint64_t(byte & 0x7f) << shift;
      if ((byte & 0x80) == 0) break;
    }
    return value;
  }
};

// The decoder allocates for the numbers of the header before it finds that the data is too short for them, so those
// are held against what the glTF says (Draco bitstream specification, sections 5 and 6).
void check_header(std::span<const uint8_t> bytes, uint64_t vertices, uint64_t indices, const std::string& where) {
  if (bytes.size() < 12 || std::memcmp(bytes.data(), "DRACO", 5) != 0) refuse("{} is not Draco data", where);
  const unsigned version = bytes[5] * 256u + bytes[6];
  const uint8_t type = bytes[7], method = bytes[8];
  const bool metadata = (bytes[10] & 0x80) != 0;
  if (type != 1 || method > 1) refuse("{} holds no Draco mesh", where);
  if (version < 0x0202) refuse("{} is of the Draco version {}.{}; 2.2 is read", where, bytes[5], bytes[6]);
  if (metadata) refuse("{} has Draco metadata, which glTF does not use", where);
  Varints numbers{bytes, 11};
  uint64_t faces = 0, points = 0;
  if (method == 0) {
    faces = numbers.next();
    points = numbers.next();
  } else {
    ++numbers.at;  // the kind of traversal
    points = numbers.next();
    faces = numbers.next();
  }
  if (faces * 3 != indices) refuse("{} has {} triangles, its accessor says {} indices", where, faces, indices);
  if (points > vertices) refuse("{} has {} vertices, its accessors only {}", where, points, vertices);
}

template <class T>
bool copy_attribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int components,
                    std::vector<uint8_t>& bytes) {
  const size_t size = sizeof(T) * size_t(components);
  bytes.resize(mesh.num_points() * size);
  std::vector<T> value;
  value.resize(size_t(components));
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex row = attribute.mapped_index(point);
    if (row.value() >= attribute.size()) return false;
    if (!attribute.ConvertValue<T>(row, int8_t(components), value.data())) return false;
    std::memcpy(bytes.data() + point.value() * size, value.data(), size);
  }
  return true;
}

int component_count(const std::string& type) {
  return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
}

std::vector<uint8_t> attribute_bytes(const draco::Mesh& mesh, uint32_t id, const json& accessor,
                                     const std::string& where) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
  if (!attribute) refuse("{} has no attribute {}", where, id);
  const int components = component_count(accessor["type"].get_ref<const std::string&>());
  if (components == 0) refuse("{} has an attribute of type {}", where, accessor["type"].get<std::string>());
  std::vector<uint8_t> bytes;
  const auto copy = [&](int type) {
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return copy_attribute<int8_t>(mesh, *attribute, components, bytes);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return copy_attribute<uint8_t>(mesh, *attribute, components, bytes);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return copy_attribute<int16_t>(mesh, *attribute, components, bytes);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return copy_attribute<uint16_t>(mesh, *attribute, components, bytes);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return copy_attribute<uint32_t>(mesh, *attribute, components, bytes);
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return copy_attribute<float>(mesh, *attribute, components, bytes);
      default:
        return false;
    }
  };
  if (!copy(accessor["componentType"].get<int>())) refuse("{} has an attribute that cannot be converted", where);
  return bytes;
}

std::vector<uint8_t> index_bytes(const draco::Mesh& mesh) {
  std::vector<uint8_t> bytes(size_t(mesh.num_faces()) * 12);
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (int corner = 0; corner < 3; ++corner) {
      const uint32_t index = mesh.face(face)[size_t(corner)].value();
      std::memcpy(bytes.data() + (size_t(face.value()) * 3 + size_t(corner)) * 4, &index, 4);
    }
  }
  return bytes;
}

void set_accessor(Source& source, size_t row, std::vector<uint8_t> bytes, size_t count) {
  const size_t view = add_buffer(source, std::move(bytes));
  json& accessor = source.document["accessors"][row];
  accessor["bufferView"] = view;
  accessor["byteOffset"] = 0;
  accessor["count"] = count;
}

void decode_primitive(Source& source, Budget& budget, const json& primitive, const json& extension,
                      const std::string& where) {
  const json& accessors = source.document["accessors"];
  const size_t view = extension["bufferView"].get<size_t>();
  const auto position = primitive["attributes"].find("POSITION");
  if (!primitive.contains("indices") || position == primitive["attributes"].end()) {
    refuse("{} lacks indices or POSITION", where);
  }
  const size_t index_row = primitive["indices"].get<size_t>();
  const uint64_t vertices = accessors[position->get<size_t>()]["count"].get<uint64_t>();
  const uint64_t indices = accessors[index_row]["count"].get<uint64_t>();
  const std::span<const uint8_t> bytes = view_bytes(source, view, where);
  if (vertices > std::numeric_limits<int32_t>::max() || indices > std::numeric_limits<int32_t>::max()) {
    refuse("{} says it has {} vertices and {} indices", where, vertices, indices);
  }
  check_header(bytes, vertices, indices, where);
  // The decoder's own tables for connectivity, and its attributes, beside what comes out.
  budget.take(indices * 24 + vertices * (32 + 48 * extension["attributes"].size()), "compressed meshes");

  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) refuse("{} cannot be decoded ({})", where, one_line(decoded.status().error_msg_string(), 80));
  const draco::Mesh& mesh = *decoded.value();
  std::map<size_t, uint32_t> rows;  // accessor -> the attribute it shows
  for (const auto& [name, id] : extension["attributes"].items()) {
    const auto accessor = primitive["attributes"].find(name);
    if (accessor != primitive["attributes"].end()) rows[accessor->get<size_t>()] = id.get<uint32_t>();
  }
  for (const auto& [row, id] : rows) {
    const json accessor = source.document["accessors"][row];
    set_accessor(source, row, attribute_bytes(mesh, id, accessor, where), mesh.num_points());
  }
  set_accessor(source, index_row, index_bytes(mesh), size_t(mesh.num_faces()) * 3);
  source.document["accessors"][index_row]["componentType"] = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace

void decompress_draco(Source& source, Budget& budget) {
  if (!source.document.contains("meshes")) return;
  // Primitives that differ only in their material may share the data and the accessors; the second finds them done.
  std::set<std::pair<size_t, size_t>> done;
  for (size_t m = 0; m < source.document["meshes"].size(); ++m) {
    const json primitives = source.document["meshes"][m]["primitives"];
    for (size_t p = 0; p < primitives.size(); ++p) {
      const json* extension = extension_of(primitives[p], "KHR_draco_mesh_compression");
      if (!extension) continue;
      const std::string where = fmt::format("meshes[{}].primitives[{}] (KHR_draco_mesh_compression)", m, p);
      const size_t view = (*extension)["bufferView"].get<size_t>();
      const size_t indices = primitives[p].value("indices", size_t(0));
      if (done.insert({view, indices}).second) decode_primitive(source, budget, primitives[p], *extension, where);
      // Strips were turned into triangles by the encoder.
      source.document["meshes"][m]["primitives"][p]["mode"] = TINYGLTF_MODE_TRIANGLES;
    }
  }
}

}  // namespace nf::scene::gltf
