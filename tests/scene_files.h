// Small glTF files made in memory, and a folder that vanishes with the test, for the scene tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <span>
#include <stb/stb_image_write.h>
#include <string>
#include <unistd.h>
#include <vector>

#include "core/error.h"
#include "scene/gltf.h"

namespace nf::test {

using nlohmann::json;
using Bytes = std::vector<uint8_t>;

class Folder {
 public:
  Folder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("nf_scene_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, std::span<const uint8_t> bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return file;
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    return write(name, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
  }

 private:
  std::filesystem::path path_;
};

template <class T>
Bytes bytes_of(const std::vector<T>& values) {
  Bytes bytes(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

inline std::string base64(std::span<const uint8_t> bytes) {
  static const char* const alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = uint32_t(bytes[i]) << 16;
    if (i + 1 < bytes.size()) bits |= uint32_t(bytes[i + 1]) << 8;
    if (i + 2 < bytes.size()) bits |= uint32_t(bytes[i + 2]);
    text += alphabet[bits >> 18];
    text += alphabet[bits >> 12 & 63];
    text += i + 1 < bytes.size() ? alphabet[bits >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? alphabet[bits & 63] : '=';
  }
  return text;
}

inline std::string data_uri(std::span<const uint8_t> bytes, const std::string& mime = "application/octet-stream") {
  return "data:" + mime + ";base64," + base64(bytes);
}

inline void append_to(void* context, void* data, int size) {
  const uint8_t* first = static_cast<const uint8_t*>(data);
  static_cast<Bytes*>(context)->insert(static_cast<Bytes*>(context)->end(), first, first + size);
}
// A picture of one colour.
inline Bytes make_png(int width, int height, glm::u8vec4 color) {
  Bytes file;
  const std::vector<glm::u8vec4> pixels(size_t(width) * size_t(height), color);
  stbi_write_png_to_func(append_to, &file, width, height, 4, pixels.data(), width * 4);
  return file;
}
inline Bytes make_jpeg(int width, int height, glm::u8vec4 color) {
  Bytes file;
  const std::vector<glm::u8vec4> pixels(size_t(width) * size_t(height), color);
  stbi_write_jpg_to_func(append_to, &file, width, height, 4, pixels.data(), 95);
  return file;
}

enum : int { u8 = 5121, u16 = 5123, u32 = 5125, f32 = 5126 };

// A document with one binary buffer that grows as data is added.
struct Gltf {
  json doc = {{"asset", {{"version", "2.0"}}}};
  Bytes bin;

  int add(const char* section, json row) {
    doc[section].push_back(std::move(row));
    return int(doc[section].size()) - 1;
  }
  int view(const Bytes& data, int stride = 0) {
    bin.resize((bin.size() + 3) / 4 * 4);
    json row = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", data.size()}};
    if (stride) row["byteStride"] = stride;
    bin.insert(bin.end(), data.begin(), data.end());
    return add("bufferViews", row);
  }
  int accessor(int view_row, int component, const char* type, size_t count, size_t offset = 0) {
    json row = {{"componentType", component}, {"type", type}, {"count", count}, {"byteOffset", offset}};
    if (view_row >= 0) row["bufferView"] = view_row;
    if (component != f32) row["normalized"] = true;
    return add("accessors", row);
  }
  template <class T>
  int attribute(const std::vector<T>& values, int component, const char* type, size_t count) {
    return accessor(view(bytes_of(values)), component, type, count);
  }
  int positions(const std::vector<glm::vec3>& values) { return attribute(values, f32, "VEC3", values.size()); }
  int indices(const std::vector<uint32_t>& values) { return attribute(values, u32, "SCALAR", values.size()); }

  // A node that shows a mesh of one primitive.
  int show(json primitive, json node = json::object()) {
    node["mesh"] = add("meshes", {{"primitives", json::array({std::move(primitive)})}});
    return add_root(std::move(node));
  }
  int add_root(json node) {
    const int row = add("nodes", std::move(node));
    if (!doc.contains("scenes")) doc["scenes"] = json::array({{{"nodes", json::array()}}});
    doc["scenes"][0]["nodes"].push_back(row);
    return row;
  }

  std::string text() {
    if (!bin.empty() && !doc.contains("buffers")) {
      json copy = doc;
      copy["buffers"] = json::array({{{"byteLength", bin.size()}, {"uri", data_uri(bin)}}});
      return copy.dump();
    }
    return doc.dump();
  }
  Bytes glb() {
    if (!doc.contains("buffers")) doc["buffers"] = json::array({{{"byteLength", bin.size()}}});
    std::string chunk = doc.dump();
    chunk.resize((chunk.size() + 3) / 4 * 4, ' ');
    Bytes padded = bin;
    padded.resize((padded.size() + 3) / 4 * 4);
    Bytes file;
    const auto word = [&](size_t value) {
      for (int shift = 0; shift < 32; shift += 8) file.push_back(uint8_t(value >> shift));
    };
    word(0x46546c67), word(2), word(28 + chunk.size() + padded.size());
    word(chunk.size()), word(0x4e4f534a);
    file.insert(file.end(), chunk.begin(), chunk.end());
    word(padded.size()), word(0x004e4942);
    file.insert(file.end(), padded.begin(), padded.end());
    return file;
  }
};

inline const std::vector<glm::vec3> quad_positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
inline const std::vector<uint32_t> quad_indices = {0, 1, 2, 0, 2, 3};
// glTF's v points down the picture: an upright picture on the quad.
inline const std::vector<glm::vec2> quad_uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};

// A unit square in the xy plane, facing +z.
inline Gltf make_quad() {
  Gltf file;
  const int positions = file.positions(quad_positions), indices = file.indices(quad_indices);
  file.show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return file;
}
inline json& quad_primitive(Gltf& file) {
  return file.doc["meshes"][0]["primitives"][0];
}

// Normals in the file keep its vertices as they are; without them triangles are drawn apart.
inline void add_normals(Gltf& file, int row = 0) {
  json& attributes = file.doc["meshes"][size_t(row)]["primitives"][0]["attributes"];
  const size_t count = file.doc["accessors"][attributes["POSITION"].get<size_t>()]["count"];
  attributes["NORMAL"] = file.positions(std::vector<glm::vec3>(count, {0, 0, 1}));
}

// Makes an image the base colour of the quad.
inline void add_picture(Gltf& file, const json& image) {
  quad_primitive(file)["material"] = 0;
  file.add("images", image);
  file.add("textures", {{"source", 0}});
  file.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
}
// Through a file of its own: text with its buffer inside, or binary.
inline scene::Scene load(Gltf file) {
  const Folder folder;
  return scene::load_gltf(folder.write("scene.gltf", file.text()));
}
inline scene::Scene load_binary(Gltf file) {
  const Folder folder;
  return scene::load_gltf(folder.write("scene.glb", file.glb()));
}

// What loading `file` says; empty when it loads. Checks the form every message has.
inline std::string load_error(const std::filesystem::path& file) {
  try {
    nf::scene::load_gltf(file);
    return {};
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_EQ(error.exit(), Exit::Input) << text;
    EXPECT_TRUE(text.starts_with("cannot load '" + file.string() + "': ")) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_NE(text.find("; "), std::string::npos) << text;
    EXPECT_LT(text.size(), 900u) << text;
    return text;
  }
}

// The files of shared/scenes, where that folder is.
inline std::vector<std::filesystem::path> shared_files(const char* extension) {
  std::vector<std::filesystem::path> files;
  const std::filesystem::path folder = std::filesystem::path(NF_SOURCE_DIR) / "../shared/scenes";
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  return files;
}

}  // namespace nf::test
