// Reconstruction's arithmetic: the shaders' text compiled as C++.
#include <cstring>
#include <gtest/gtest.h>

#include "glsl_twin.h"
#include "reproject.h"

namespace twin {
inline unsigned floatBitsToUint(float x) {
  unsigned bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
inline float uintBitsToFloat(unsigned bits) {
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
}  // namespace twin
using uint = unsigned;
NF_GLSL_BEGIN
#include "common/color.glsl"
#include "common/denoise.glsl"
#include "common/taa.glsl"
NF_GLSL_END

namespace nf::test {
namespace {

using glm::vec3;

TEST(Reconstruction, ColourSpacesGoBack) {
  for (const vec3 c : {vec3(0), vec3(1, 0.5f, 0.25f), vec3(0, 0, 3), vec3(100, 1, 7)}) {
    const vec3 back = twin::rgb_from_ycocg(twin::ycocg_from_rgb(c));
    const vec3 expanded = twin::expand(twin::compress(c));
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(back[i], c[i], 1e-5f * (1 + c[i]));
      EXPECT_NEAR(expanded[i], c[i], 1e-4f * (1 + c[i]));
    }
  }
}

TEST(Reconstruction, NumbersAreTold) {
  EXPECT_TRUE(twin::is_number(0.0f));
  EXPECT_TRUE(twin::is_number(-65504.0f));
  EXPECT_FALSE(twin::is_number(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_FALSE(twin::is_number(-std::numeric_limits<float>::infinity()));
}

TEST(Reconstruction, StateSurvivesPacking) {
  for (float v = -0.99f; v < 2.99f; v += 0.0137f)
    for (const float variance : {0.0f, 1e-6f, 0.3f, 1e4f, twin::NO_VARIANCE}) {
      const unsigned bits = twin::pack_state(v, variance);
      EXPECT_NEAR(twin::unpack_visibility(bits), v, 0.5f / 16384 + 1e-6f);
      EXPECT_NEAR(twin::unpack_variance(bits), variance, variance / 128);
    }
}

TEST(Reconstruction, CatmullRomInterpolates) {
  for (float f = 0; f < 1; f += 0.01f) {
    const glm::vec4 w = twin::catmull_rom(f);
    EXPECT_NEAR(w.x + w.y + w.z + w.w, 1, 1e-6f);
    EXPECT_NEAR(-w.x + w.z + 2 * w.w, f, 1e-6f) << "a ramp stays a ramp";
    EXPECT_NEAR(w.x + w.z + 4 * w.w, f * f, 1e-6f) << "a parabola too";
  }
}

TEST(Reconstruction, ClippingKeepsTheWayToTheMean) {
  const vec3 mean(1, 0.2f, -0.1f), reach(0.5f, 0.1f, 0.2f);
  const vec3 inside(1.4f, 0.25f, 0);
  EXPECT_EQ(twin::clip_to_box(inside, mean, reach), inside);
  const vec3 outside(4, 0.5f, 0), clipped = twin::clip_to_box(outside, mean, reach);
  EXPECT_NEAR(clipped.x, 1.5f, 1e-5f);
  EXPECT_NEAR((clipped.y - mean.y) / (outside.y - mean.y), 1 / 6.0f, 1e-5f);
}

// A step of 20 tolerances is an edge; the plane's own slope is none.
TEST(Reconstruction, WeightsFallAcrossEdges) {
  const twin::Edges edges = twin::make_edges(4, 0.01f, 32);
  const auto weight = [&](float away, float cosine, float brighter, float variance = 0.01f, float tolerance = 4) {
    return twin::edge_weight(edges, away, cosine, brighter, variance, tolerance);
  };
  EXPECT_EQ(weight(0, 1, 0), 1);
  EXPECT_NEAR(weight(0.04f, 1, 0), std::exp(-1.0f), 1e-5f);
  EXPECT_LT(weight(-0.8f, 1, 0), 1e-6f);
  EXPECT_LT(weight(0, 0.5f, 0), 1e-6f);
  EXPECT_NEAR(weight(0, 1, -0.4f), std::exp(-1.0f), 1e-5f);
  EXPECT_GT(weight(0, 1, 100, twin::NO_VARIANCE), 0.999f);
  EXPECT_EQ(weight(0, 1, 100, 0, 0), 1);
}

TEST(Reconstruction, JitterCoversThePixelEvenly) {
  glm::vec2 sum(0);
  int quadrants[4] = {};
  for (uint32_t i = 0; i < 16; ++i) {
    const glm::vec2 j = passes::halton_jitter(i);
    EXPECT_LT(std::max(std::abs(j.x), std::abs(j.y)), 0.5f);
    sum += j;
    ++quadrants[(j.x > 0) + 2 * (j.y > 0)];
  }
  EXPECT_LT(glm::length(sum / 16.0f), 0.05f);
  for (const int count : quadrants) EXPECT_GE(count, 3);
  EXPECT_EQ(passes::halton_jitter(3), passes::halton_jitter(19));
}

// The plane through both cameras' eyes: a point seen by the last camera is found where it was.
TEST(Reconstruction, BlockTurnsTheLastViewIntoThisOne) {
  passes::FrameView view;
  view.size = {64, 36};
  view.camera = {.position = {1, 2, 3}, .forward = {0, 0, -1}, .up = {0, 1, 0}, .vfov = 1};
  view.previous_camera = {.position = {0.5f, 2, 3.5f}, .forward = {0, 0, -1}, .up = {0, 1, 0}, .vfov = 1};
  const passes::ReprojectBlock block = passes::make_reproject_block(view);
  const glm::vec4 p = block.view_from_previous_view * glm::vec4(0.2f, 0.1f, -4, 1);
  EXPECT_NEAR(p.x, -0.3f, 1e-5f);
  EXPECT_NEAR(p.y, 0.1f, 1e-5f);
  EXPECT_NEAR(p.z, -3.5f, 1e-5f);
}

}  // namespace
}  // namespace nf::test
