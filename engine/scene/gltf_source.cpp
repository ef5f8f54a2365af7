// From a path to memory: reads the file, takes a .glb apart, parses the JSON and fetches what its URIs name. Assumes
// nothing about the content.
#include <cstring>
#include <fstream>

#include "scene/gltf_import.h"
#include "scene/gltf_uri.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Bytes = std::vector<uint8_t>;

constexpr uint64_t file_limit = uint64_t(4) << 30;  // what a .glb can hold
constexpr uint64_t picture_file_limit = uint64_t(1) << 30;
constexpr uint64_t json_limit = uint64_t(1) << 30;  // far beyond real files; tinygltf counts in 32 bits
constexpr int json_depth_limit = 64;                // tinygltf recurses

// The first `limit` bytes, or all.
Bytes read_file(const fs::path& path, uint64_t limit) {
  std::error_code error;
  const uint64_t size = std::min<uint64_t>(fs::file_size(path, error), limit);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) refuse_advising("check its access rights", "'{}' cannot be read", one_line(path.string()));
  Bytes bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
  if (uint64_t(stream.gcount()) != size) refuse("'{}' ends while being read", one_line(path.string()));
  return bytes;
}

Bytes read_scene_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) refuse_advising("check the path", "no such file");
  if (!fs::is_regular_file(status)) refuse_advising("give a .gltf or .glb file", "it is not a file");
  const uint64_t size = fs::file_size(path, error);
  if (!error && size > file_limit) refuse("it is larger than 4 GiB");
  if (!error && size == 0) refuse("the file is empty");
  return read_file(path, file_limit);
}

uint32_t word(std::span<const uint8_t> bytes, size_t offset) {
  return uint32_t(bytes[offset]) | uint32_t(bytes[offset + 1]) << 8 | uint32_t(bytes[offset + 2]) << 16 |
         uint32_t(bytes[offset + 3]) << 24;
}

struct Chunks {
  std::span<const uint8_t> text, binary;
};

bool is_glb(std::span<const uint8_t> file) {
  return file.size() >= 4 && std::memcmp(file.data(), "glTF", 4) == 0;
}

Chunks split_glb(std::span<const uint8_t> file) {
  if (file.size() < 20) refuse("the file is truncated: {} bytes are too few for a .glb", file.size());
  if (word(file, 4) != 2) refuse("it is a .glb of version {}; only version 2 is read", word(file, 4));
  const uint64_t length = word(file, 8);
  if (length > file.size()) {
    refuse("the file is truncated: its header says {} bytes, it has {}", length, file.size());
  }
  file = file.first(size_t(length));
  Chunks chunks;
  size_t offset = 12;
  for (int row = 0; offset + 8 <= file.size(); ++row) {
    const uint32_t size = word(file, offset), type = word(file, offset + 4);
    if (size > file.size() - offset - 8) refuse("the file is truncated inside its chunk {}", row);
    const std::span<const uint8_t> content = file.subspan(offset + 8, size);
    if (row == 0 && type == 0x4e4f534a) chunks.text = content;    // "JSON"
    if (row == 1 && type == 0x004e4942) chunks.binary = content;  // "BIN"
    offset += 8 + size_t(size);
  }
  if (chunks.text.empty()) refuse("its first chunk is not JSON");
  return chunks;
}

json parse_json(std::span<const uint8_t> text) {
  if (text.size() > json_limit) refuse("its JSON is larger than {} MiB", json_limit >> 20);
  // .glb pads its JSON with spaces, some writers with zeros.
  while (!text.empty() && (text.back() == 0 || text.back() == ' ')) text = text.first(text.size() - 1);
  const auto limit_depth = [](int depth, json::parse_event_t, json&) {
    if (depth > json_depth_limit) refuse("its JSON is nested deeper than {} levels", json_depth_limit);
    return true;
  };
  try {
    return json::parse(text.begin(), text.end(), limit_depth);
  } catch (const json::parse_error& e) {
    refuse("it is not valid JSON (byte {})", e.byte);
  } catch (const json::exception&) {
    refuse("a number in its JSON is out of range");
  }
}

bool is_fallback(const json& buffer) {
  const json* extension = extension_of(buffer, "EXT_meshopt_compression");
  return extension && extension->value("fallback", false);
}

void fetch_buffers(Source& source, const fs::path& folder, std::span<const uint8_t> binary) {
  json& buffers = source.document["buffers"];
  for (size_t i = 0; i < buffers.size(); ++i) {
    const std::string where = describe("buffer", i, buffers[i].value("name", ""));
    const uint64_t length = buffers[i].at("byteLength").get<uint64_t>();
    Bytes bytes;
    if (!buffers[i].contains("uri") && (i != 0 || binary.empty()) && is_fallback(buffers[i])) {
      // Only compressed views use it; decompress() gives those buffers of their own.
      bytes.assign(1, 0);
      buffers[i]["byteLength"] = 1;
    } else if (!buffers[i].contains("uri")) {
      if (i != 0 || binary.empty()) refuse("{} has no data: neither a URI nor a .glb's binary chunk", where);
      bytes.assign(binary.begin(), binary.begin() + std::ptrdiff_t(std::min<uint64_t>(length, binary.size())));
    } else if (const std::string& uri = buffers[i]["uri"].get_ref<const std::string&>(); is_data_uri(uri)) {
      bytes = decode_data_uri(uri, where);
    } else {
      bytes = read_file(resolve_uri(folder, uri, where), length);
      source.bytes += bytes.size();
    }
    if (bytes.size() < std::min(length, buffers[i]["byteLength"].get<uint64_t>()))
      refuse("{} says it has {} bytes, but there are only {}", where, length, bytes.size());
    bytes.resize(size_t(buffers[i]["byteLength"].get<uint64_t>()));
    source.buffers.push_back(std::move(bytes));
    // tinygltf asks for this name; parse_model hands it the bytes.
    buffers[i]["uri"] = fmt::format("buffer-{}", i);
  }
}

void fetch_images(Source& source, const fs::path& folder) {
  const json& images = source.document["images"];
  std::map<std::string, size_t> first_of;
  for (size_t i = 0; i < images.size(); ++i) {
    ImageSource image;
    image.name = one_line(images[i].value("name", ""));
    std::string origin = fmt::format("image-{}", i);
    const std::string where = describe("image", i, image.name);
    if (images[i].contains("bufferView")) {
      image.buffer_view = images[i]["bufferView"].get<int>();
      origin = fmt::format("view-{}", image.buffer_view);
    } else if (const std::string& uri = images[i]["uri"].get_ref<const std::string&>(); is_data_uri(uri)) {
      image.bytes = decode_data_uri(uri, where);
    } else {
      const fs::path file = resolve_uri(folder, uri, where);
      if (image.name.empty()) image.name = one_line(uri);
      origin = "file-" + file.string();
      if (!first_of.contains(origin)) {
        image.bytes = read_file(file, picture_file_limit);
        source.bytes += image.bytes.size();
      }
    }
    image.same_as = first_of.try_emplace(origin, i).first->second;
    source.images.push_back(std::move(image));
  }
}

}  // namespace

Source load_source(const std::filesystem::path& path) {
  Source source;
  source.path = path.string();
  const Bytes file = read_scene_file(path);
  source.bytes = file.size();
  Chunks chunks{file, {}};
  if (is_glb(file)) chunks = split_glb(file);
  source.document = parse_json(chunks.text);
  check_document(source.document);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  fetch_buffers(source, folder, chunks.binary);
  fetch_images(source, folder);
  source.document.erase("images");
  return source;
}

const nlohmann::json* extension_of(const nlohmann::json& row, const char* name) {
  const auto extensions = row.find("extensions");
  if (extensions == row.end() || !extensions->is_object()) return nullptr;
  const auto extension = extensions->find(name);
  return extension == extensions->end() || !extension->is_object() ? nullptr : &*extension;
}

size_t add_buffer(Source& source, std::vector<uint8_t> bytes) {
  json& buffers = source.document["buffers"];
  json& views = source.document["bufferViews"];
  buffers.push_back({{"byteLength", bytes.size()}, {"uri", fmt::format("buffer-{}", source.buffers.size())}});
  views.push_back({{"buffer", source.buffers.size()}, {"byteLength", bytes.size()}});
  source.buffers.push_back(std::move(bytes));
  return views.size() - 1;
}

namespace {

// Channels that drive nothing we know: tinygltf takes the whole file for broken where one has no node.
void drop_idle_channels(json& document) {
  if (!document.contains("animations")) return;
  for (json& animation : document["animations"]) {
    json kept = json::array();
    for (json& channel : animation["channels"]) {
      if (channel["target"].contains("node")) kept.push_back(std::move(channel));
    }
    animation["channels"] = std::move(kept);
  }
}

void strip_rows(json& value) {
  if (value.is_array()) {
    for (json& element : value) {
      if (element.is_structured()) strip_rows(element);
    }
    return;
  }
  value.erase("extras");
  if (const auto extensions = value.find("extensions"); extensions != value.end()) {
    json kept = json::object();
    for (const auto& [name, extension] : extensions->items()) {
      if (is_supported(name)) kept[name] = extension;
    }
    *extensions = std::move(kept);
  }
  for (json& member : value) {
    if (member.is_structured()) strip_rows(member);
  }
}

}  // namespace

void strip(json& document) {
  drop_idle_channels(document);
  strip_rows(document);
}

}  // namespace nf::scene::gltf
