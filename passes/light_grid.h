// The frame's lights as a table, and which of them reach which part of the view: a grid of clusters (32 x 32 pixels by
// a range of depths), made on the CPU. Only lights with a range are sorted in; every cluster lists them in the table's
// order, so that the sum over a cluster has the very bytes of the sum over all.
#pragma once

#include <array>
#include <vector>

#include "gpu/frame_ring.h"
#include "gpu/memory.h"
#include "shadow.h"

namespace nf::passes {

#define NF_LIGHT_PARAMS(P)                                                                                       \
  P(Choice, grid, 0, 0, 2, "auto|off|on",                                                                        \
    "Whether lights that have a range are looked up in a grid of clusters; auto: where there are eight or more") \
  P(Bool, specular_aa, 1, 0, 1, "", "Widens highlights by the variance of the normals under a pixel, against flicker")
NF_DECLARE_PARAMS(LightParams, "lights", NF_LIGHT_PARAMS)

// As shaders/common/scene.glsl declares it (scalar layout).
struct LightRow {
  glm::vec3 position;
  float radius;
  glm::vec3 direction;  // of travel, world
  float range;          // 0 = infinite
  glm::vec3 radiance;   // irradiance (directional) or intensity, times colour
  float cone_scale, cone_offset;
  int32_t tile;      // first shadow tile; -1: unshadowed
  float tile_scale;  // 1 / tan of half the angle that a tile sees
  float tile_near;   // m
};

// Rows: suns but the first (which is the block `sun`), lights without a range, lights with one.
struct LightTable {
  std::vector<LightRow> rows;
  uint32_t suns = 0, global = 0;  // rows [0, suns) are directional, [suns, global) have no range
};
LightTable make_light_table(const scene::Scene& scene, const ShadowPlan& shadows);

inline constexpr uint32_t cluster_pixels = 32, cluster_slices = 16;

// Cluster (x, y, s) is row (s * height + y) * width + x; its lights are indices[first[row]] to indices[first[row + 1]].
// Slice s holds the depths z with floor(log2(z) * slice_scale + slice_offset) = s, the first and last everything
// beyond.
struct LightGrid {
  uint32_t width = 0, height = 0;
  float slice_scale = 0, slice_offset = 0;
  std::vector<uint32_t> first, indices;
};
// Empty for a view without pixels. Clusters may list a light that does not reach them, never miss one that does.
LightGrid make_light_grid(const LightTable& lights, const scene::Camera& camera, glm::uvec2 size, glm::vec2 jitter,
                          float far);

// What direct.frag is told about both.
#define NF_LIGHT_VIEW_FIELDS(F) \
  F(Uint, suns)                 \
  F(Uint, global) F(Uint, count) F(Uint, grid_width) F(Uint, grid_height) F(Float, slice_scale) F(Float, slice_offset)
NF_DECLARE_BLOCK(LightViewBlock, "light_view", NF_LIGHT_VIEW_FIELDS)

// Host-visible buffers that are written anew for every frame.
class FrameTable {
 public:
  // `name` must live as long as the table.
  FrameTable(gpu::Device& device, const char* name) : device_(device), name_(name) {}
  ~FrameTable();
  FrameTable(const FrameTable&) = delete;
  FrameTable& operator=(const FrameTable&) = delete;
  const gpu::Buffer& write(std::span<const std::byte> data);

 private:
  gpu::Device& device_;
  const char* name_;
  std::array<gpu::Buffer, gpu::FrameRing::table_sides> buffers_;
  uint32_t next_ = 0;
};

// The frame's lights on the device.
class Lights {
 public:
  explicit Lights(gpu::Device& device)
      : rows_(device, "lights.rows"),
        first_(device, "lights.cluster_first"),
        indices_(device, "lights.cluster_lights") {}
  void update(const scene::Scene& scene, const scene::Camera& camera, glm::uvec2 size, glm::vec2 jitter,
              const ShadowPlan& shadows, const LightParams& params);

  LightViewBlock view;
  bool has_grid = false;
  const gpu::Buffer *rows = nullptr, *cluster_first = nullptr, *cluster_lights = nullptr;

 private:
  FrameTable rows_, first_, indices_;
};

}  // namespace nf::passes
