// Boxes against planes. The boxes come as arrays of vec3; each block is spread into one array a component first, so
// that the plane loop is straight-line arithmetic over contiguous floats, which the compiler vectorises.
#include "scene/culling.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace nf::scene {

namespace {

constexpr size_t block_size = 256;

struct Block {
  alignas(64) float center[3][block_size];
  alignas(64) float extent[3][block_size];
  alignas(64) uint32_t outside[block_size];
};

void load_block(std::span<const vec3> center, std::span<const vec3> extent, Block& block) {
  for (size_t i = 0; i < center.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      block.center[axis][i] = center[i][axis];
      block.extent[axis][i] = extent[i][axis];
    }
    block.outside[i] = 0;
  }
}

void test_plane(const vec4& plane, size_t count, Block& block) {
  const float ax = std::abs(plane.x), ay = std::abs(plane.y), az = std::abs(plane.z);
  for (size_t i = 0; i < count; ++i) {
    const float px = plane.x * block.center[0][i], py = plane.y * block.center[1][i], pz = plane.z * block.center[2][i];
    const float reach = ax * block.extent[0][i] + ay * block.extent[1][i] + az * block.extent[2][i];
    // Room for rounding, so that a box which only touches is kept.
    const float slack = 1e-6f * (std::abs(px) + std::abs(py) + std::abs(pz) + std::abs(plane.w) + reach);
    block.outside[i] |= uint32_t(px + py + pz + plane.w + reach + slack < 0);
  }
}

}  // namespace

// Gribb and Hartmann 2001: the planes of -w <= x,y <= w and 0 <= z <= w are sums and differences of the matrix's rows.
Frustum frustum_from_clip(const mat4& clip_from_world) {
  const mat4 rows = glm::transpose(clip_from_world);
  const std::array<vec4, 6> candidates = {rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1],
                                          rows[3] - rows[1], rows[2],           rows[3] - rows[2]};
  Frustum frustum;
  for (const vec4& plane : candidates) {
    const float length = glm::length(vec3(plane));
    // With an infinite far plane z >= 0 has no direction: it always holds.
    if (length > 1e-12f) frustum.plane[frustum.count++] = plane / length;
  }
  return frustum;
}

void cull(const Frustum& frustum, std::span<const vec3> center, std::span<const vec3> extent,
          std::vector<uint32_t>& visible) {
  NF_CHECK(center.size() == extent.size(), "{} centres, {} extents", center.size(), extent.size());
  Block block;
  for (size_t first = 0; first < center.size(); first += block_size) {
    const size_t count = std::min(block_size, center.size() - first);
    load_block(center.subspan(first, count), extent.subspan(first, count), block);
    for (uint32_t p = 0; p < frustum.count; ++p) test_plane(frustum.plane[p], count, block);
    for (size_t i = 0; i < count; ++i) {
      if (!block.outside[i]) visible.push_back(uint32_t(first + i));
    }
  }
}

}  // namespace nf::scene
