// ssao, ssdo, raymarch and hbil (shaders/gi/*.glsl) compiled as C++ beside the slice techniques, over the same depth
// beds.
#pragma once

#include <map>

#include "gi/hbil_params.h"
#include "gi/raymarch_params.h"
#include "gi/ssao_params.h"
#include "gi/ssdo_params.h"
#include "slice_twin.h"

namespace twin {

#define MEMBER(type, name, value, low, high, unit, help) type name = value;
struct SsaoParams {
  NF_SSAO_PARAMS(MEMBER)
};
struct SsdoParams {
  NF_SSDO_PARAMS(MEMBER)
};
struct RaymarchParams {
  NF_RAYMARCH_PARAMS(MEMBER)
};
struct HbilParams {
  NF_HBIL_PARAMS(MEMBER)
};
#undef MEMBER
inline SsaoParams ssao;
inline SsdoParams ssdo;
inline RaymarchParams raymarch;
inline HbilParams hbil;

inline glm::vec3 ambient_of(glm::ivec2) {
  return glm::vec3(0);
}
// The mean over the surfaces of a texel of the mips; the last of a row or column has what is left over.
inline glm::vec3 radiance_level(glm::ivec2 texel, int level);
constexpr int RADIANCE_LEVELS = 6;
// A white environment, as hbil.comp has a constant one.
inline glm::vec3 environment_cone(glm::vec3 direction, float cone, float ao);

}  // namespace twin

#define SSAO_KERNEL ssao.kernel
#define SSAO_RANGE ssao.range
#define SSAO_SELF ssao.self
#define SSAO_BLEED ssao.bleed
#define SSAO_SENDER ssao.sender
#define SSAO_SHOW ssao.show
#define SSDO_DIRECTIONS ssdo.directions
#define SSDO_BLOCKER ssdo.blocker
#define SSDO_SENDER ssdo.sender
#define SSDO_BOUNCE ssdo.bounce
#define SSDO_AMBIENT ssdo.ambient
#define RAYMARCH_HIT raymarch.hit
#define RAYMARCH_AMBIENT raymarch.ambient
#define HBIL_SPACE hbil.space
#define HBIL_NORMAL_START hbil.normal_start
#define HBIL_PRINTED_SIGN hbil.printed_sign
#define HBIL_REJECT hbil.reject
#define HBIL_MIPS hbil.mips
#define HBIL_CONE hbil.cone
#define HBIL_FAR hbil.far
NF_GLSL_BEGIN
#include "gi/hbil.glsl"
#include "gi/raymarch.glsl"
#include "gi/ssao.glsl"
#include "gi/ssdo.glsl"
NF_GLSL_END

namespace twin {

inline glm::vec3 environment_cone(glm::vec3, float cone, float ao) {
  return glm::vec3(HBIL_FAR == FAR_SH_CONE ? cone_bands(cone).x : HBIL_FAR == FAR_FACTOR ? energy_factor(ao) : ao);
}

inline glm::vec3 radiance_level(glm::ivec2 texel, int level) {
  const glm::ivec2 size = max(glm::ivec2(frame.size.x >> level, frame.size.y >> level), glm::ivec2(1));
  const glm::ivec2 at = min(glm::ivec2(texel.x >> level, texel.y >> level), size - 1);
  glm::vec3 sum(0);
  int surfaces = 0;
  for (int y = at.y << level; y < (at.y + 1 == size.y ? frame.size.y : (at.y + 1) << level); ++y)
    for (int x = at.x << level; x < (at.x + 1 == size.x ? frame.size.x : (at.x + 1) << level); ++x) {
      if (FETCH_DEPTH(glm::ivec2(x, y)) <= 0) continue;
      sum += unpack_rgb9e5(FETCH_RADIANCE(glm::ivec2(x, y)));
      ++surfaces;
    }
  return surfaces ? sum / float(surfaces) : glm::vec3(0);
}

// The mean over frames of `estimate`.
template <class Estimate>
Gathered mean_gathered(glm::ivec2 pixel, int frames, Estimate estimate) {
  Gathered sum{0, glm::vec3(0), glm::vec3(0), glm::vec3(0)};
  for (int i = 0; i < frames; ++i) {
    frame.frame_index = unsigned(i);
    const auto one = estimate(pixel);
    sum.visibility += one.visibility / float(frames);
    sum.bent += one.bent / float(frames);
    sum.gi += one.gi / float(frames);
    sum.ambient += one.ambient / float(frames);
  }
  return sum;
}

// The bed's texels, cast once.
struct Baked {
  std::vector<bed::Texel> texels;
  glm::ivec2 size;
  explicit Baked(const bed::Bed& bed) : size(bed.camera.size) {
    for (int i = 0; i < size.x * size.y; ++i) texels.push_back(bed.texel({i % size.x, i / size.x}));
    look_through(bed.camera);
  }
  void use() const {
    fetch = [this](glm::ivec2 p) { return texels.at(size_t(p.y * size.x + p.x)); };
  }
};

}  // namespace twin
