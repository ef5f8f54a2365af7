// Reconstruction's arithmetic: the shaders' text compiled as C++.
#include <cstring>
#include <gtest/gtest.h>
#include <map>

#include "glsl_twin.h"
#include "reproject.h"
#include "resolution.h"

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
#include "common/feedback.glsl"
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

// A closed box of albedo rho whose every wall emits L_e and sees the share F of the light: each frame gathers what the
// walls send out and feeds back what they reflect, as the GPU's passes do with these functions.
struct Box {
  float rho, form_factor, emitted = 1;
  float albedo_limit = 0.9f, gain_limit = 0.95f;
  float reflected = 0, gathered = 0;
  float step() {
    const float scale = twin::feedback_scale(reflected, gathered, gain_limit);
    gathered = emitted + scale * reflected;
    reflected = twin::limit_reflectance(vec3(rho), albedo_limit).x * form_factor * gathered;
    return gathered;
  }
};

TEST(Feedback, AClosedBoxConverges) {
  for (const float f : {1.0f, 0.8f, 0.5f}) {
    Box box{.rho = 0.8f, .form_factor = f};
    float light = 0, before = 0, difference = 0, ratio = 0;
    for (int frame = 0; frame < 60; ++frame) {
      before = light;
      light = box.step();
      if (frame == 8) ratio = (light - before) / difference;
      difference = light - before;
    }
    EXPECT_NEAR(light * (1 - 0.8f * f), 1, 0.01f);
    EXPECT_NEAR(ratio, 0.8f * f, 1e-3f) << "geometric";
  }
}

TEST(Feedback, AWhiteBoxStaysFinite) {
  for (const float limit : {0.9f, 1.0f}) {
    Box box{.rho = 1, .form_factor = 1, .albedo_limit = limit};
    float light = 0;
    for (int frame = 0; frame < 1000; ++frame) light = box.step();
    EXPECT_LE(light, 20.1f);
    EXPECT_NEAR(light, 1 / (1 - std::min(limit, 0.95f)), 0.2f);
  }
  // The control: without both limits it grows with every frame.
  Box free{.rho = 1, .form_factor = 1, .albedo_limit = 1, .gain_limit = 2};
  float light = 0;
  for (int frame = 0; frame < 1000; ++frame) light = free.step();
  EXPECT_GT(light, 900.0f);
}

// Every pixel is in exactly one small picture of an interleaved frame, over frames also of half and quarter resolution;
// a small picture's rays are those of the pixels that it stands for.
TEST(Resolution, GridsCoverEveryPixel) {
  for (int mode = 1; mode < 6; ++mode) {
    const uint32_t frames = mode == 1 ? 4 : mode == 2 ? 16 : mode == 3 ? 2 : 1;
    std::map<std::pair<int, int>, int> seen;
    int factor = 0;
    for (uint32_t frame = 0; frame < frames; ++frame) {
      const passes::PixelGrid grid = passes::make_grid(mode, frame, true);
      factor = grid.factor;
      for (const glm::ivec2 o : grid.offsets) ++seen[{o.x, o.y}];
    }
    EXPECT_EQ(seen.size(), size_t(factor * factor)) << mode;
    for (const auto& [offset, count] : seen) {
      EXPECT_EQ(count, 1);
      EXPECT_LT(std::max(offset.first, offset.second), factor);
    }
    EXPECT_EQ(passes::make_grid(mode, 5, false).offsets, passes::make_grid(mode, 0, true).offsets) << "nobody averages";
  }
}

TEST(Resolution, SmallFramesSeeTheSameRays) {
  passes::FrameBlock frame;
  frame.size = {321, 179};
  frame.ray_scale = {0.004f, -0.004f};
  frame.ray_offset = {-0.64f, 0.36f};
  frame.pixels_per_tangent = {250, 250};
  for (const int factor : {2, 4}) {
    const glm::ivec2 offset(1, factor - 1), q(13, 7);
    const passes::FrameBlock small = passes::make_small_frame(frame, factor, offset, 1, 4);
    const glm::vec2 ray = (glm::vec2(q) + 0.5f) * small.ray_scale + small.ray_offset,
                    expected = (glm::vec2(q * factor + offset) + 0.5f) * frame.ray_scale + frame.ray_offset;
    EXPECT_NEAR(ray.x, expected.x, 1e-6f);
    EXPECT_NEAR(ray.y, expected.y, 1e-6f);
    EXPECT_EQ(small.size, glm::ivec2((321 + factor - 1) / factor, (179 + factor - 1) / factor));
  }
}

TEST(Resolution, OverscanWidensTheView) {
  passes::FrameView view;
  view.size = {200, 100};
  view.camera.vfov = view.previous_camera.vfov = 1;
  const passes::FrameView wide = passes::with_border(view, passes::overscan_border(view.size, 10));
  EXPECT_EQ(wide.size, glm::uvec2(240, 120));
  EXPECT_NEAR(std::tan(wide.camera.vfov / 2), 1.2f * std::tan(0.5f), 1e-5f);
}

}  // namespace
}  // namespace nf::test
