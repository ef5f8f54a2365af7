// The slice techniques (shaders/gi/bitmask.glsl, horizon.glsl) compiled as C++ in namespace `twin`, fed by an analytic
// depth buffer; shared by the tests that run the whole pass.
#pragma once

#include <cmath>
#include <functional>

#include "depth_bed.h"
#include "gi/bitmask_params.h"
#include "gi/gi_params.h"
#include "gi/horizon_params.h"
#include "glsl_twin.h"

namespace twin {

// What the GPU side provides: the two uniform blocks and the texels.
struct Frame {
  glm::vec2 ray_scale, ray_offset, pixels_per_tangent;
  glm::ivec2 size;
  unsigned frame_index = 0, seed = 0;
};
inline Frame frame;

using Float = float;
using Int = int;
using Bool = unsigned;
using Choice = int;
#define MEMBER(type, name, value, low, high, unit, help) type name = value;
// Every technique's parameters in one: shared, of the bitmasks, of the horizons.
struct Params {
  NF_GI_PARAMS(MEMBER)
  NF_VBGI_PARAMS(MEMBER)
};
struct HorizonParams {
  NF_HORIZON_PARAMS(MEMBER)
  int uniform = 0;
};
#undef MEMBER
// One object under the two block names of the shader.
inline Params bitmask;
inline Params& gi = bitmask;
inline HorizonParams horizon;

inline std::function<bed::Texel(glm::ivec2)> fetch;
inline std::function<glm::vec3(glm::vec3)> environment_from = [](glm::vec3) { return glm::vec3(1); },
                                           environment_over = environment_from;

}  // namespace twin

#define FETCH_DEPTH(p) fetch(p).depth
#define FETCH_NORMAL(p) pack_normal(fetch(p).normal)
#define FETCH_RADIANCE(p) pack_rgb9e5(fetch(p).radiance)
// What the GPU compiles in is chosen at run time here.
#define GI_SLICE_MEASURE gi.slice_measure
#define GI_PROJECTION gi.projection
#define GI_RADIUS_MODE gi.radius_mode
#define GI_STEP_JITTER gi.step_jitter
#define GI_THICKNESS_MODE gi.thickness_mode
#define GI_BACK_ALONG gi.back_along
#define BITMASK_SECTORS bitmask.sectors
#define BITMASK_SECTOR_RULE bitmask.sector_rule
#define BITMASK_SECTOR_MEASURE bitmask.sector_measure
#define BITMASK_FAST_ACOS bitmask.fast_acos
#define BITMASK_EMITTER bitmask.emitter
#define BITMASK_SPAN bitmask.span
#define BITMASK_LIGHT 1
#define BITMASK_AMBIENT 1
#define MASK_WORDS 4
#define HORIZON_UNIFORM horizon.uniform
#define HORIZON_FALLOFF horizon.falloff
#define HORIZON_BENT 1
NF_GLSL_BEGIN
#include "gi/bitmask.glsl"
#include "gi/horizon.glsl"
NF_GLSL_END

namespace twin {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;

inline void look_through(const bed::Camera& camera) {
  glm::vec2 t(camera.tangents()), size(camera.size);
  frame.ray_scale = glm::vec2(2, -2) * t / size;
  frame.ray_offset = glm::vec2(-t.x, t.y);
  frame.pixels_per_tangent = size / (2.0f * t);
  frame.size = camera.size;
}

inline void use(const bed::Bed& bed) {
  look_through(bed.camera);
  fetch = [&bed](glm::ivec2 p) { return bed.texel(p); };
}

// Defaults, but many samples and unlimited radius and thickness.
inline Params thorough(int slices = 64, int steps = 256) {
  Params params;
  params.radius = 1000;
  params.slices = slices;
  params.steps = steps;
  params.thickness_mode = THICKNESS_INFINITE;
  return params;
}

// Mean of an estimator over frames, as --accumulate does.
inline Gathered mean(glm::ivec2 pixel, const Params& params, int frames) {
  bitmask = params;
  Gathered sum{0, glm::vec3(0), glm::vec3(0), glm::vec3(0)};
  for (int i = 0; i < frames; ++i) {
    frame.frame_index = unsigned(i);
    const Gathered one = estimate_bitmask(pixel);
    sum.visibility += one.visibility / float(frames);
    sum.bent += one.bent / float(frames);
    sum.gi += one.gi / float(frames);
    sum.ambient += one.ambient / float(frames);
  }
  return sum;
}

inline Openness mean_horizons(glm::ivec2 pixel, const Params& params, const HorizonParams& own, int frames) {
  bitmask = params;
  horizon = own;
  Openness sum{0, glm::vec3(0)};
  for (int i = 0; i < frames; ++i) {
    frame.frame_index = unsigned(i);
    const Openness one = estimate_horizons(pixel);
    sum.visibility += one.visibility / float(frames);
    sum.bent += one.bent / float(frames);
  }
  return sum;
}

inline bed::Quad floor_quad(glm::vec3 radiance = glm::vec3(0)) {
  return {{-500, 0, 500}, {1000, 0, 0}, {0, 0, -1000}, radiance};
}

template <class Visit>
void for_grid(glm::ivec2 size, Visit visit) {
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x) visit(glm::ivec2((size.x - 1) * x / 8, (size.y - 1) * y / 8));
}

}  // namespace twin
