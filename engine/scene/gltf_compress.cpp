// EXT_meshopt_compression: every compressed buffer view becomes a plain one over a buffer of its own.
#include <meshoptimizer.h>

#include "scene/gltf_import.h"

namespace nf::scene::gltf {

namespace {

using nlohmann::json;

struct Packed {
  std::span<const uint8_t> bytes;
  size_t count, stride;
  std::string mode, filter;
};

Packed packed_view(const Source& source, const json& extension, const std::string& where) {
  Packed packed;
  const std::vector<uint8_t>& buffer = source.buffers.at(extension["buffer"].get<size_t>());
  const uint64_t offset = extension.value("byteOffset", uint64_t(0)), length = extension["byteLength"].get<uint64_t>();
  if (offset > buffer.size() || length > buffer.size() - offset) refuse("{} lies beyond its buffer", where);
  packed.bytes = std::span(buffer).subspan(size_t(offset), size_t(length));
  packed.count = extension["count"].get<size_t>();
  packed.stride = extension["byteStride"].get<size_t>();
  packed.mode = extension["mode"].get<std::string>();
  packed.filter = extension.value("filter", "NONE");
  return packed;
}

// What the decoder takes for granted.
void check_shape(const Packed& packed, const std::string& where) {
  const size_t stride = packed.stride;
  if (packed.mode == "ATTRIBUTES") {
    if (stride % 4 != 0) refuse("{} has a byteStride of {}, which is no multiple of 4", where, stride);
    const bool fits =
        packed.filter == "OCTAHEDRAL" ? stride == 4 || stride == 8 : packed.filter != "QUATERNION" || stride == 8;
    if (!fits) refuse("{} has a byteStride of {}, which its filter does not allow", where, stride);
    return;
  }
  if (stride != 2 && stride != 4) refuse("{} has indices of {} bytes", where, stride);
  if (packed.filter != "NONE") refuse("{} has a filter on indices", where);
  if (packed.mode == "TRIANGLES" && packed.count % 3 != 0) {
    refuse("{} has {} indices, which is no whole number of triangles", where, packed.count);
  }
}

int decode(const Packed& packed, std::vector<uint8_t>& bytes) {
  const size_t count = packed.count, stride = packed.stride, size = packed.bytes.size();
  const uint8_t* data = packed.bytes.data();
  if (packed.mode == "TRIANGLES") return meshopt_decodeIndexBuffer(bytes.data(), count, stride, data, size);
  if (packed.mode == "INDICES") return meshopt_decodeIndexSequence(bytes.data(), count, stride, data, size);
  const int result = meshopt_decodeVertexBuffer(bytes.data(), count, stride, data, size);
  if (result != 0) return result;
  if (packed.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), count, stride);
  if (packed.filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), count, stride);
  if (packed.filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), count, stride);
  return 0;
}

}  // namespace

void decompress(Source& source, Budget& budget) {
  json& document = source.document;
  const size_t views = document.contains("bufferViews") ? document["bufferViews"].size() : 0;
  for (size_t i = 0; i < views; ++i) {
    const json* extension = extension_of(document["bufferViews"][i], "EXT_meshopt_compression");
    if (!extension) continue;
    const std::string where = fmt::format("bufferViews[{}] (EXT_meshopt_compression)", i);
    const Packed packed = packed_view(source, *extension, where);
    check_shape(packed, where);
    // count is below 2^32 and the stride at most 256, so the product does not overflow.
    budget.take(uint64_t(packed.count) * packed.stride, "compressed buffer views");
    std::vector<uint8_t> bytes(packed.count * packed.stride);
    if (decode(packed, bytes) != 0) refuse("{} cannot be decoded: it is damaged or truncated", where);
    const size_t buffer = source.buffers.size(), length = bytes.size();
    add_buffer(source, std::move(bytes));
    json& view = document["bufferViews"][i];
    view["buffer"] = buffer;
    view["byteOffset"] = 0;
    view["byteLength"] = length;
    view.erase("extensions");
  }
}

}  // namespace nf::scene::gltf
