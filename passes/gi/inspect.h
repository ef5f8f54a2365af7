// One pixel of a technique taken apart: every sample that it took and what each added. The technique's own shader
// writes the records (shaders/gi/inspect.glsl), compiled for it; other frames know nothing of it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "core/params.h"
#include "graph/executor.h"

namespace nf::passes {

struct GiSettings;

#define NF_INSPECT_FIELDS(F) F(Int, x) F(Int, y) F(Int, slices) F(Int, samples)
NF_DECLARE_BLOCK(InspectBlock, "inspect", NF_INSPECT_FIELDS)

// What a technique is asked for: the records of one pixel of the picture that it sees, which may be a small one.
struct InspectRequest {
  InspectBlock block;               // the pixel, and rows that fit into the buffer
  glm::ivec2 factor{1}, offset{0};  // texel t is pixel factor * t + offset of the whole picture
  graph::Buf records;               // invalid: this technique gives none
};

enum class InspectReason : int32_t { Counted, Background, OutsideRadius, OffScreen, NothingNew };
const char* inspect_reason_name(InspectReason reason);

// Laid out as the shader writes it.
struct InspectedSample {
  int32_t slice = 0, side = 0, step = 0;  // side 1: against the slice's direction
  InspectReason reason = InspectReason::Counted;
  glm::ivec2 texel{0};
  float depth = 0;
  // Bitmasks: positions in sectors. Horizons: angle from the slice's normal, radians, of the horizon so far and the
  // sample.
  float front = 0, back = 0;
  float weight = 0;                           // how much an occluder so far away counts
  float taken = 0;                            // off the slice's visibility: times the slice's factor, off the pixel's
  glm::vec3 light{0};                         // the same of light
  glm::vec3 towards{0};                       // from the receiver, view space, metres
  std::array<uint32_t, 4> before{}, fresh{};  // bitmasks: covered before it, and newly by it
};

struct InspectedSlice {
  static constexpr int position_count = 33;
  float factor = 0, base = 0;  // the pixel's visibility is the sum of the bases less that of factor * taken
  float weight = 0, total = 0;
  float cos_gamma = 1, sin_gamma = 0;  // of the angle of the view vector from `normal`
  float n_length = 1;
  glm::vec3 direction{0};                         // on the screen
  glm::vec3 tangent{0}, normal{0};                // the slice's axes, view space
  std::array<float, position_count> positions{};  // in sectors, of the angles from -pi/2 to pi/2
};

struct Inspection {
  glm::ivec2 pixel{0};   // of the picture, as the samples' texels are
  int32_t sectors = 0;   // 0: no bitmask
  float visibility = 1;  // as the shader has them
  glm::vec3 gi{0};
  float depth = 0;                    // 0: nothing is seen there, and nothing was sampled
  glm::vec3 ray{0}, v{0}, normal{0};  // position at depth 1; towards the eye; the surface's normal
  float radius = 0;
  glm::vec3 gain{1};  // of all light
  std::vector<InspectedSlice> slices;
  std::vector<InspectedSample> samples;

  // What the records add up to.
  float summed_visibility() const;
  glm::vec3 summed_gi() const;
  size_t count(InspectReason reason) const;
};

// The request for `pixel` of a picture whose small pictures have these factor and offset. Rows for what the settings
// ask for.
InspectRequest make_inspect_request(const GiSettings& settings, glm::ivec2 pixel, glm::ivec2 size, int factor,
                                    glm::ivec2 offset, glm::ivec2 border);
uint64_t inspection_bytes(const InspectBlock& block);
Inspection read_inspection(const InspectRequest& request, const graph::Readback& records);

}  // namespace nf::passes
