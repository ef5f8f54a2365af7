// Light rows and the sorting of lights into clusters.
#include "light_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "scene/camera.h"

namespace nf::passes {
namespace {

using glm::vec2;
using glm::vec3;

LightRow row_of(const scene::PunctualLight& l, const ShadowPlan& shadows, size_t index) {
  // KHR_lights_punctual: smooth between the cones as clamp(cos * scale + offset)^2.
  const bool spot = l.outer_cone < 3.14f;
  const float outer = std::cos(l.outer_cone);
  const float scale = spot ? 1.0f / std::max(0.001f, std::cos(l.inner_cone) - outer) : 0.0f;
  LightRow row{.position = l.position,
               .radius = l.radius,
               .direction = l.direction,
               .range = l.range,
               .radiance = l.color * l.intensity,
               .cone_scale = scale,
               .cone_offset = spot ? -outer * scale : 1.0f,
               .tile = -1,
               .tile_scale = 0,
               .tile_near = 0};
  if (index < shadows.first_tile.size() && shadows.first_tile[index] >= 0) {
    const ShadowTile& tile = shadows.tiles[size_t(shadows.first_tile[index])];
    row.tile = shadows.first_tile[index];
    row.tile_scale = tile.scale;
    row.tile_near = tile.near;
  }
  return row;
}

struct Ball {
  vec3 center;  // view space
  float radius;
};

// What the light can reach: its range, or the part of it that the cone cuts out.
Ball reach_of(const LightRow& light, const glm::mat4& view_from_world) {
  Ball ball{light.position, light.range};
  if (light.cone_scale > 0) {
    const float cosine = -light.cone_offset / light.cone_scale;
    if (cosine > std::sqrt(0.5f))
      ball = {light.position + light.direction * (light.range / (2 * cosine)), light.range / (2 * cosine)};
    else if (cosine > 0)
      ball = {light.position + light.direction * (light.range * cosine), light.range * std::sqrt(1 - cosine * cosine)};
  }
  // Room for rounding here and in the shader.
  return {vec3(view_from_world * glm::vec4(ball.center, 1)), ball.radius * 1.001f + 1e-4f};
}

struct Span {
  int begin, end;
};

// Tiles that contain the picture of [low, high] on one axis, seen at depths from z0 to z1. `focal` in pixels.
Span tiles_of(float low, float high, float z0, float z1, float focal, float middle, uint32_t tiles) {
  const float first = middle + focal * (low < 0 ? low / z0 : low / z1);
  const float last = middle + focal * (high > 0 ? high / z0 : high / z1);
  const float scale = 1.0f / float(cluster_pixels), count = float(tiles);
  // A pixel of slack, for rounding.
  return {int(std::clamp(std::floor((first - 1) * scale), 0.0f, count)),
          int(std::clamp(std::floor((last + 1) * scale) + 1, 0.0f, count))};
}

// Calls visit(first row, count) for each run of clusters that the ball may touch.
template <class Visit>
void for_clusters(const LightGrid& grid, const Ball& ball, vec2 focal, vec2 middle, const Visit& visit) {
  const float z = -ball.center.z, r = ball.radius;
  if (z + r <= 0) return;
  const auto slice_of = [&](float depth) {
    const float s = std::log2(std::max(depth, 1e-6f)) * grid.slice_scale + grid.slice_offset;
    return int(std::clamp(std::floor(s), 0.0f, float(cluster_slices - 1)));
  };
  const int last = slice_of((z + r) * 1.001f);
  for (int s = slice_of(std::max(z - r, 0.0f) * 0.999f); s <= last; ++s) {
    const auto bound = [&](int slice) { return std::exp2((float(slice) - grid.slice_offset) / grid.slice_scale); };
    const float low = s == 0 ? 0.0f : bound(s) * 0.999f;
    const float high = s + 1 == int(cluster_slices) ? z + r : bound(s + 1) * 1.001f;
    const float z0 = std::max({low, z - r, 1e-4f}), z1 = std::max(std::min(high, z + r), z0);
    const float away = std::max({z0 - z, z - z1, 0.0f});
    const float half = std::sqrt(std::max(r * r - away * away, 0.0f));
    const Span x = tiles_of(ball.center.x - half, ball.center.x + half, z0, z1, focal.x, middle.x, grid.width);
    const Span y = tiles_of(-ball.center.y - half, -ball.center.y + half, z0, z1, focal.y, middle.y, grid.height);
    if (x.begin >= x.end) continue;
    for (int row = y.begin; row < y.end; ++row)
      visit((uint32_t(s) * grid.height + uint32_t(row)) * grid.width + uint32_t(x.begin), uint32_t(x.end - x.begin));
  }
}

}  // namespace

LightTable make_light_table(const scene::Scene& scene, const ShadowPlan& shadows) {
  LightTable table;
  for (size_t i = 1; i < scene.directional.size(); ++i) {
    const scene::DirectionalLight& l = scene.directional[i];
    table.rows.push_back({.position = {},
                          .radius = 0,
                          .direction = l.direction,
                          .range = 0,
                          .radiance = l.color * l.irradiance,
                          .cone_scale = 0,
                          .cone_offset = 1,
                          .tile = -1,
                          .tile_scale = 0,
                          .tile_near = 0});
  }
  table.suns = uint32_t(table.rows.size());
  for (const bool ranged : {false, true}) {
    for (size_t i = 0; i < scene.punctual.size(); ++i)
      if ((scene.punctual[i].range > 0) == ranged) table.rows.push_back(row_of(scene.punctual[i], shadows, i));
    if (!ranged) table.global = uint32_t(table.rows.size());
  }
  return table;
}

LightGrid make_light_grid(const LightTable& lights, const scene::Camera& camera, glm::uvec2 size, vec2 jitter,
                          float far) {
  LightGrid grid;
  grid.width = (size.x + cluster_pixels - 1) / cluster_pixels;
  grid.height = (size.y + cluster_pixels - 1) / cluster_pixels;
  const float near = std::max(camera.near, far / 256);
  grid.slice_scale = float(cluster_slices) / std::log2(std::max(far / near, 2.0f));
  grid.slice_offset = -std::log2(near) * grid.slice_scale;
  const float focal = 0.5f * float(size.y) / std::tan(camera.vfov * 0.5f);
  const vec2 middle = vec2(size) * 0.5f + jitter;
  const glm::mat4 view_from_world = scene::view_from_world(camera);

  std::vector<Ball> balls;
  for (size_t i = lights.global; i < lights.rows.size(); ++i)
    balls.push_back(reach_of(lights.rows[i], view_from_world));
  grid.first.assign(size_t(grid.width) * grid.height * cluster_slices + 1, 0);
  for (const Ball& ball : balls)
    for_clusters(grid, ball, vec2(focal), middle, [&](uint32_t row, uint32_t count) {
      for (uint32_t i = 0; i < count; ++i) ++grid.first[row + i + 1];
    });
  for (size_t i = 1; i < grid.first.size(); ++i) grid.first[i] += grid.first[i - 1];
  grid.indices.resize(grid.first.back());
  std::vector<uint32_t> next = grid.first;
  for (size_t b = 0; b < balls.size(); ++b)
    for_clusters(grid, balls[b], vec2(focal), middle, [&](uint32_t row, uint32_t count) {
      for (uint32_t i = 0; i < count; ++i) grid.indices[next[row + i]++] = lights.global + uint32_t(b);
    });
  return grid;
}

FrameTable::~FrameTable() {
  for (gpu::Buffer& buffer : buffers_) destroy(device_, buffer);
}

const gpu::Buffer& FrameTable::write(std::span<const std::byte> data) {
  next_ = (next_ + 1) % uint32_t(buffers_.size());
  gpu::Buffer& buffer = buffers_[next_];
  if (!buffer.handle || buffer.size < data.size()) {
    // The frame that last read this one is done.
    destroy(device_, buffer);
    buffer = gpu::create_buffer(device_, std::max<VkDeviceSize>(data.size() * 3 / 2, 256),
                                VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Where::Host, name_);
  }
  if (!data.empty()) std::memcpy(buffer.mapped, data.data(), data.size());
  return buffer;
}

void Lights::update(const scene::Scene& scene, const scene::Camera& camera, glm::uvec2 size, vec2 jitter,
                    const ShadowPlan& shadows, const LightParams& params) {
  const LightTable table = make_light_table(scene, shadows);
  view = {};
  view.suns = table.suns, view.global = table.global, view.count = uint32_t(table.rows.size());
  rows = &rows_.write(std::as_bytes(std::span(table.rows)));
  has_grid = params.grid == 2 || (params.grid == 0 && view.count - view.global >= 8);
  if (!has_grid) return;
  const float far = 2 * glm::length(scene.bounds.max - scene.bounds.min);
  const LightGrid grid = make_light_grid(table, camera, size, jitter, far);
  view.grid_width = grid.width, view.grid_height = grid.height;
  view.slice_scale = grid.slice_scale, view.slice_offset = grid.slice_offset;
  cluster_first = &first_.write(std::as_bytes(std::span(grid.first)));
  cluster_lights = &indices_.write(std::as_bytes(std::span(grid.indices)));
}

}  // namespace nf::passes
