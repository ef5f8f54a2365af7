// Checked reading of accessors.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/gltf_import.h"

namespace nf::scene::gltf {

// A window onto an accessor's elements, known to lie inside its buffer: element i starts at data + i * stride,
// unaligned.
struct Elements {
  const uint8_t* data = nullptr;
  size_t stride = 0, count = 0;
  int component_type = 0, components = 0;
  bool normalized = false;
};

// Allowed component types, as bits.
enum Components : unsigned { as_float = 1, as_u8 = 2, as_u16 = 4, as_u32 = 8, as_i8 = 16, as_i16 = 32 };

// `what` names the use in errors ("meshes[0].primitives[1] POSITION"); refuses an accessor of another type.
Elements open_accessor(Importer& importer, int accessor, unsigned allowed, int min_components, int max_components,
                       const std::string& what);

std::vector<uint32_t> read_indices(const Elements& elements);

// Component `component` of element `row`; integers are scaled to 0..1 or -1..1 where the accessor is normalized.
float read_float(const Elements& elements, size_t row, int component);
// Element `row`, of at most four components; missing ones are 1 (the alpha of a colour).
vec4 read_float4(const Elements& elements, size_t row);
glm::u16vec4 read_u16vec4(const Elements& elements, size_t row);
mat4 read_mat4(const Elements& elements, size_t row);

}  // namespace nf::scene::gltf
