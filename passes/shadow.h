// Shadow maps: cascades of the sun in one depth array, and square tiles for spot and point lights in another.
//
// A cascade is an orthographic square over a slice of the camera's view, a tile a perspective square: a spot light has
// one, a point light six. All are reverse-Z: 1 is at the light. Who gets a tile is decided anew for every frame.
#pragma once

#include <array>
#include <vector>

#include "graph/graph.h"
#include "scene_tables.h"

namespace nf::passes {

#define NF_SHADOW_PARAMS(P)                                                                                          \
  P(Bool, enabled, 1, 0, 1, "", "Shadows of the sun (the first directional light) and of spot and point lights")     \
  P(Bool, two_sided, 1, 0, 1, "",                                                                                    \
    "Surfaces cast shadows from behind, too; off is faster, and the same where all solids are closed")               \
  P(Bool, cache, 1, 0, 1, "",                                                                                        \
    "Maps are kept and drawn anew only where what rests in them changes; off: in every frame, for the same picture") \
  P(Int, cascades, 3, 1, 4, "", "Maps of the sun, each over a larger part of the view")                              \
  P(Int, resolution, 2048, 16, 8192, "px", "Side of each of the sun's maps")                                         \
  P(Float, distance, 0.0f, 0.0f, 100000.0f, "m", "How far from the camera the sun casts shadows; 0: everywhere")     \
  P(Float, split, 0.6f, 0.0f, 1.0f, "", "Depths where one cascade follows another: 0 even, 1 logarithmic")           \
  P(Float, blend, 0.1f, 0.0f, 0.5f, "", "Share of a cascade's border in which it fades into the next")               \
  P(Int, tiles, 12, 0, 128, "", "Most maps for spot lights (one each) and point lights (six each)")                  \
  P(Int, tile_resolution, 512, 16, 4096, "px", "Side of each of these")                                              \
  P(Int, samples, 6, 1, 64, "", "Comparisons a pixel and light, each over 2x2 texels")                               \
  P(Int, search_samples, 6, 1, 64, "",                                                                               \
    "Depths that are looked at to find how far away the blocker of a soft shadow is")                                \
  P(Float, least_filter, 0.7f, 0.0f, 8.0f, "texels", "Least radius of the filter")                                   \
  P(Float, most_filter, 24.0f, 1.0f, 128.0f, "texels", "Greatest radius of the filter, of soft shadows")             \
  P(Float, normal_bias, 0.35f, 0.0f, 16.0f, "",                                                                      \
    "How far a receiver is moved along its normal, in texel diagonals times the sine of the light's angle")          \
  P(Float, bias, 0.1f, 0.0f, 16.0f, "texels", "How far a receiver is moved towards the light")                       \
  P(Int, screen_samples, 0, 0, 64, "",                                                                               \
    "Lights without a map are shadowed by the depth buffer: points towards each that are looked up in it; 0: not")   \
  P(Float, screen_length, 1.0f, 0.001f, 10000.0f, "m", "How far towards the light these points go")                  \
  P(Float, screen_thickness, 0.2f, 0.0f, 10000.0f, "m",                                                              \
    "How far behind a surface in view a point is still in it; 0: any point behind, as SSDO prints it")
NF_DECLARE_PARAMS(ShadowParams, "shadow", NF_SHADOW_PARAMS)

inline constexpr uint32_t max_cascades = 4;

// The sun as the uniform block `sun`. Light space: x = dot(right, p), y = dot(down, p), in metres; depth in the map is
// dot(direction, p) * depth_scale + depth_offset. A cascade is (x, y of its centre, 1 / half side); the last one has
// everything that is shadowed at all. cascade_count 0: no shadows.
// clang-format off
#define NF_SUN_FIELDS(F)                                                                                        \
  F(Vec3, direction) F(Uint, cascade_count) F(Vec3, irradiance) F(Float, tan_radius) F(Vec3, right)             \
  F(Float, depth_scale) F(Vec3, down) F(Float, depth_offset) F(Vec3, cascade0) F(Vec3, cascade1) F(Vec3, cascade2) \
  F(Vec3, cascade3)
// clang-format on
NF_DECLARE_BLOCK(SunBlock, "sun", NF_SUN_FIELDS)

// What a map is drawn with.
#define NF_SHADOW_VIEW_FIELDS(F) F(Mat4, clip_from_world) F(Uint, blends)
NF_DECLARE_BLOCK(ShadowViewBlock, "shadow_view", NF_SHADOW_VIEW_FIELDS)

// Unit vectors with cross(right, down) = axis (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). As in
// shaders/common/shadow.glsl.
void map_axes(glm::vec3 axis, glm::vec3& right, glm::vec3& down);

// Cascades of the slices of the camera's view up to the end of the scene or shadow.distance. Their squares have the
// size of the slices' bounding spheres and stand on whole texels of light space, so that neither turning nor moving the
// camera makes edges crawl. Where the spheres grow as large as the scene, the first that is as large as all of the
// scene that is in view is the last, and has just that: its side changes in steps of an eighth of an octave.
SunBlock fit_sun(const scene::Camera& camera, glm::uvec2 size, const scene::Bounds& bounds,
                 const scene::DirectionalLight& light, const ShadowParams& params);
glm::vec3 cascade_of(const SunBlock& sun, uint32_t cascade);
glm::mat4 clip_from_cascade(const SunBlock& sun, uint32_t cascade);

// Looks along `axis` from a spot or point light. `scale` is 1 / tan of half the angle that the tile sees.
struct ShadowTile {
  glm::vec3 position, axis;
  float scale, near;
};
glm::mat4 clip_from_tile(const ShadowTile& tile);

// All maps of a frame.
struct ShadowPlan {
  SunBlock sun;
  std::vector<ShadowTile> tiles;
  std::vector<int32_t> first_tile;      // by punctual light; -1: unshadowed
  bool masked = false, mapped = false;  // the scene has such surfaces (DrawClass; blended ones count as cut out)
  Blending blending = Blending::Over;   // over: what is blended dims the light by its alpha
};
// Tiles go to the lights that give the camera's surroundings most light: intensity / (1 + squared distance), over the
// share of the sphere that a cone is, and none past its range. In order of the scene's lights.
ShadowPlan plan_shadows(const scene::Camera& camera, glm::uvec2 size, const scene::Scene& scene,
                        const ShadowParams& params, Blending blending = Blending::Over);

struct ShadowPass {
  gpu::Pipeline opaque, masked, mapped;
};
ShadowPass create_shadow(gpu::Pipelines& pipelines, const SceneTables& scene);

// D32F arrays; invalid where there is nothing to draw.
struct ShadowMaps {
  graph::Tex sun, tiles;
};
// `draws` gets two lists a map, the cascades' first; it must live, unchanged, until the graph has run.
ShadowMaps add_shadows(graph::Graph& graph, const ShadowPass& pass, const ShadowParams& params, const ShadowPlan& plan,
                       const SceneTables& scene, std::vector<DrawList>& draws, graph::Buf deformed);

}  // namespace nf::passes
