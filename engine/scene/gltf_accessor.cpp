// Checked reading of accessors. Data may be unaligned, interleaved or sparse; everything is copied out byte by byte.
#include "scene/gltf_accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace nf::scene::gltf {

namespace {

struct ComponentInfo {
  unsigned bit;
  size_t size;
  const char* name;
};

ComponentInfo component_info(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return {as_i8, 1, "i8"};
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return {as_u8, 1, "u8"};
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return {as_i16, 2, "i16"};
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return {as_u16, 2, "u16"};
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return {as_u32, 4, "u32"};
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return {as_float, 4, "float"};
    default:
      return {0, 0, "unknown"};
  }
}

// 0 for the small matrices, which nothing we read has.
int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

template <class T>
T load(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

uint32_t load_unsigned(const uint8_t* bytes, int type) {
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *bytes;
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return load<uint16_t>(bytes);
  return load<uint32_t>(bytes);
}

// `count` elements of `size` bytes inside a buffer view; refuses what does not fit.
Elements open_view(const Importer& importer, int view_row, uint64_t offset, uint64_t count, size_t size, bool strided,
                   const std::string& what) {
  const tinygltf::Model& model = importer.model;
  if (view_row < 0 || size_t(view_row) >= model.bufferViews.size()) refuse("{} has no such buffer view", what);
  const tinygltf::BufferView& view = model.bufferViews[size_t(view_row)];
  if (view.buffer < 0 || size_t(view.buffer) >= model.buffers.size()) refuse("{} has no such buffer", what);
  const std::vector<uint8_t>& buffer = model.buffers[size_t(view.buffer)].data;
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    refuse("{} reads a buffer view beyond its buffer", what);
  }
  const size_t stride = strided && view.byteStride != 0 ? view.byteStride : size;
  if (stride < size) refuse("{} has a byteStride of {}, below its element size of {}", what, stride, size);
  // Divides instead of multiplying: a hostile count must not overflow.
  const uint64_t room = offset > view.byteLength ? 0 : view.byteLength - offset;
  const uint64_t fits = room < size ? 0 : (room - size) / stride + 1;
  if (count > fits) {
    refuse("{} needs {} elements of {} bytes, but its buffer view has room for {}", what, count, size, fits);
  }
  return {buffer.data() + view.byteOffset + (count ? offset : 0), stride, size_t(count), 0, 0, false};
}

void apply_sparse(const Importer& importer, const tinygltf::Accessor& accessor, size_t size,
                  std::vector<uint8_t>& bytes, const std::string& what) {
  const auto& sparse = accessor.sparse;
  const ComponentInfo info = component_info(sparse.indices.componentType);
  if ((info.bit & (as_u8 | as_u16 | as_u32)) == 0) refuse("{} has sparse indices of type {}", what, info.name);
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
    refuse("{} has a negative sparse count or offset", what);
  }
  const uint64_t count = uint64_t(sparse.count);
  const Elements indices = open_view(importer, sparse.indices.bufferView, uint64_t(sparse.indices.byteOffset), count,
                                     info.size, false, what + " (sparse indices)");
  const Elements values = open_view(importer, sparse.values.bufferView, uint64_t(sparse.values.byteOffset), count, size,
                                    false, what + " (sparse values)");
  for (size_t i = 0; i < count; ++i) {
    const uint32_t row = load_unsigned(indices.data + i * indices.stride, sparse.indices.componentType);
    if (row >= accessor.count) refuse("{} has the sparse index {}, beyond its {} elements", what, row, accessor.count);
    std::memcpy(bytes.data() + row * size, values.data + i * size, size);
  }
}

// Sparse accessors and those without a buffer view (all zeros), written out once.
const std::vector<uint8_t>& written_out(Importer& importer, int row, size_t size, const std::string& what) {
  const auto known = importer.dense.find(row);
  if (known != importer.dense.end()) return known->second;
  const tinygltf::Accessor& accessor = importer.model.accessors[size_t(row)];
  // count is below 2^53, so the product does not overflow.
  importer.budget.take(uint64_t(accessor.count) * size, "accessors");
  std::vector<uint8_t> bytes(accessor.count * size);
  if (accessor.bufferView >= 0) {
    const Elements base =
        open_view(importer, accessor.bufferView, accessor.byteOffset, accessor.count, size, true, what);
    for (size_t i = 0; i < base.count; ++i) std::memcpy(bytes.data() + i * size, base.data + i * base.stride, size);
  }
  if (accessor.sparse.isSparse) apply_sparse(importer, accessor, size, bytes, what);
  return importer.dense.emplace(row, std::move(bytes)).first->second;
}

}  // namespace

Elements open_accessor(Importer& importer, int row, unsigned allowed, int min_components, int max_components,
                       const std::string& what) {
  if (row < 0 || size_t(row) >= importer.model.accessors.size()) refuse("{} has no such accessor", what);
  const tinygltf::Accessor& accessor = importer.model.accessors[size_t(row)];
  const ComponentInfo info = component_info(accessor.componentType);
  const int components = component_count(accessor.type);
  if ((info.bit & allowed) == 0) refuse("{} has the component type {}, which is not allowed there", what, info.name);
  if (components < min_components || components > max_components) {
    refuse("{} has {} components where {} are expected", what, components, min_components);
  }
  const size_t size = info.size * size_t(components);
  Elements elements;
  if (accessor.sparse.isSparse || accessor.bufferView < 0) {
    elements = {written_out(importer, row, size, what).data(), size, accessor.count, 0, 0, false};
  } else {
    elements = open_view(importer, accessor.bufferView, accessor.byteOffset, accessor.count, size, true, what);
  }
  elements.component_type = accessor.componentType;
  elements.components = components;
  elements.normalized = accessor.normalized;
  return elements;
}

std::vector<uint32_t> read_indices(const Elements& elements) {
  std::vector<uint32_t> indices(elements.count);
  for (size_t i = 0; i < indices.size(); ++i) {
    indices[i] = load_unsigned(elements.data + i * elements.stride, elements.component_type);
  }
  return indices;
}

float read_float(const Elements& elements, size_t row, int component) {
  const uint8_t* bytes = elements.data + row * elements.stride;
  const auto integer = [&]<class T>(T) {
    const float value = float(load<T>(bytes + size_t(component) * sizeof(T)));
    if (!elements.normalized) return value;
    // The most negative integer would fall below -1.
    return std::max(value / float(std::numeric_limits<T>::max()), -1.f);
  };
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return load<float>(bytes + size_t(component) * 4);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return integer(uint16_t());
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return integer(int16_t());
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return integer(int8_t());
    default:
      return integer(uint8_t());
  }
}

vec4 read_float4(const Elements& elements, size_t row) {
  vec4 value(1);
  for (int i = 0; i < elements.components; ++i) value[i] = read_float(elements, row, i);
  return value;
}

glm::u16vec4 read_u16vec4(const Elements& elements, size_t row) {
  const uint8_t* bytes = elements.data + row * elements.stride;
  const size_t size = component_info(elements.component_type).size;
  glm::u16vec4 value(0);
  for (int i = 0; i < elements.components; ++i) {
    value[i] = uint16_t(load_unsigned(bytes + size_t(i) * size, elements.component_type));
  }
  return value;
}

mat4 read_mat4(const Elements& elements, size_t row) {
  mat4 value;
  for (int i = 0; i < 16; ++i) value[i / 4][i % 4] = read_float(elements, row, i);
  return value;
}

}  // namespace nf::scene::gltf
