// What the parts of the glTF importer share; private to engine/scene. Any part refuses a file by throwing a Problem,
// which load_gltf turns into the one-line nf::Error.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <tiny_gltf.h>
#include <tuple>
#include <vector>

#include "scene/gltf.h"
#include "scene/scene.h"

namespace nf::scene::gltf {

struct Problem {
  std::string what, advice;
};

inline constexpr const char* advice_reexport = "re-export the scene, or look at it with the glTF validator";

template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw Problem{fmt::format(format, std::forward<Args>(args)...), advice_reexport};
}
template <class... Args>
[[noreturn]] void refuse_advising(const char* advice, fmt::format_string<Args...> format, Args&&... args) {
  throw Problem{fmt::format(format, std::forward<Args>(args)...), advice};
}

// An encoded picture: a buffer view, or bytes of its own (data URI, external file). `same_as` is the first image with
// the same origin, so that pictures listed twice are decoded once.
struct ImageSource {
  std::string name;
  int buffer_view = -1;
  std::vector<uint8_t> bytes;
  size_t same_as = 0;
};

// The file taken apart: everything that touches the disk or a URI is done here, tinygltf sees only memory.
struct Source {
  std::string path;
  nlohmann::json document;  // checked by check_document
  std::vector<std::vector<uint8_t>> buffers;
  std::vector<ImageSource> images;
  uint64_t bytes = 0;  // of all files read
};

// Bounds what a file may make us allocate: in all a multiple of its own size, at once a small one.
struct Budget {
  uint64_t limit = 0, at_once = 0, used = 0;
  explicit Budget(uint64_t file_bytes)
      : limit((uint64_t(64) << 20) + 128 * file_bytes), at_once((uint64_t(256) << 20) + 4 * file_bytes) {}
  void take(uint64_t bytes, const char* what) {
    const uint64_t most = std::min(limit - used, at_once);
    if (bytes > most) refuse("its {} need more than {} MiB, far more than its size explains", what, most >> 20);
    used += bytes;
  }
};

// A texture's whole content: picture, then the sampler's members.
using TextureKey = std::tuple<uint32_t, Filter, Filter, Filter, bool, Wrap, Wrap>;

// One import in progress.
struct Importer {
  const tinygltf::Model& model;
  const Source& source;
  Scene& scene;
  Budget budget;
  std::set<std::string> warned{};
  std::map<int, std::vector<uint8_t>> dense{};                 // sparse accessors, written out
  std::map<std::pair<size_t, bool>, uint32_t> picture_rows{};  // (image, srgb) -> row of Scene::pictures
  std::map<TextureKey, uint32_t> texture_rows{};
  std::vector<uint32_t> node_rows{};  // by the file's node: row of Scene::nodes, or none
  std::vector<uint32_t> skin_rows{};  // by the file's skin: row of Scene::skins, or none
  bool quantized = false;             // KHR_mesh_quantization is in use

  void warn_once(const std::string& message);
};

Source load_source(const std::filesystem::path& path);
// Types, required members, ranges and every index of the document; names the first offence by its JSON path.
void check_document(const nlohmann::json& document);
bool is_supported(const std::string& extension);
// EXT_meshopt_compression and KHR_draco_mesh_compression: what they hold becomes plain buffers, views and accessors of
// the document.
void decompress(Source& source, Budget& budget);
void decompress_draco(Source& source, Budget& budget);
// Appends a buffer and a view of all of it to the document; returns the view.
size_t add_buffer(Source& source, std::vector<uint8_t> bytes);
// Removes from the document what nobody reads after decompression.
void strip(nlohmann::json& document);
tinygltf::Model parse_model(Source& source);

// The extension object of a row of the document, or null.
const nlohmann::json* extension_of(const nlohmann::json& row, const char* name);

// "node 3 'lamp'", for messages.
std::string describe(const char* section, size_t row, const std::string& name);

void import_materials(Importer& importer);
// Decodes every picture in picture_rows into Scene::pictures.
void import_pictures(Importer& importer, const PictureProgress& progress);

struct PrimitiveRange {
  uint32_t first = 0, count = 0;  // rows of Scene::primitives
};
PrimitiveRange import_mesh(Importer& importer, size_t mesh);

// Nodes of the chosen scene and the instances of their meshes; returns the file's node of each row.
std::vector<uint32_t> import_nodes(Importer& importer);
// Fills skin_rows for the skins that the nodes of `order` (the file's) use; needs node_rows.
void import_skins(Importer& importer, std::span<const uint32_t> order);
void import_animations(Importer& importer);
// Both read the nodes' world matrices.
void import_cameras(Importer& importer, std::span<const uint32_t> file_node);
void import_lights(Importer& importer, std::span<const uint32_t> file_node);

}  // namespace nf::scene::gltf
