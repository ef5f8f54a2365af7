// How the GI pass (shaders/gi/march.glsl, bitmask.glsl) samples: which texels it reads, how far, and what one sample
// covers.
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "slice_twin.h"

namespace {

using bed::Bed;
using glm::ivec2;
using glm::vec3;
using twin::floor_quad;
using twin::look_through;
using twin::mean;
using twin::thorough;
using twin::use;

TEST(Estimator, RadiusIsADiscThatFacesTheScreen) {
  twin::Params params = thorough(16, 64);
  params.radius = 1;
  for (double distance : {0.9, 1.02}) {
    Bed bed{{{floor_quad()}, {}, {{{distance, 0, -50}, {50, 3, 50}, vec3(1)}}}, {{0, 5, 0}, {0, 0, 0}}};
    use(bed);
    double seen = mean(ivec2(511, 511), params, 16).visibility;
    if (distance < 1) {
      EXPECT_LT(seen, 0.99);
    } else {
      EXPECT_EQ(seen, 1);
    }
  }
}

// One sample by the affine form against positions in 3D, the back point along the sample's own view ray.
TEST(Estimator, OneSampleIsThatOfThePositions) {
  bed::Camera camera;
  camera.size = {200, 120};
  look_through(camera);
  twin::bitmask = {};
  twin::bitmask.steps = 1;
  twin::bitmask.span = 1;  // the texel by itself
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  int bits = 0;
  for (int i = 0; i < 5000; ++i) {
    ivec2 pixel(int(uniform(engine) * 200), int(uniform(engine) * 120)), texel(-1);
    float z = 1 + uniform(engine), sample_z = z * (0.8f + 0.3f * uniform(engine));
    twin::fetch = [&](ivec2 p) {
      texel = p;
      return bed::Texel{sample_z, vec3(0, 0, 1), vec3(1), {}};
    };
    twin::bitmask.thickness = uniform(engine);
    twin::Receiver receiver;
    receiver.pixel = pixel;
    receiver.depth = z;
    receiver.ray = twin::view_ray(glm::vec2(pixel) + 0.5f, twin::frame.ray_scale, twin::frame.ray_offset);
    receiver.radius = 2;
    vec3 v = receiver.v = -glm::normalize(receiver.ray), n(uniform(engine) - 0.5f, uniform(engine) - 0.5f, 0.5f);
    receiver.normal = n = twin::facing_normal(glm::normalize(n), v);
    vec3 d = twin::screen_direction(uniform(engine) * 3);
    float sign = uniform(engine) < 0.5f ? 1.0f : -1.0f, xi = uniform(engine);
    twin::Slice slice = twin::make_slice(v, n, d);
    if (sign < 0) slice = twin::mirror(slice);
    float k = twin::slice_k(slice.sin_gamma), total = twin::slice_total(slice.cos_gamma, slice.sin_gamma, k);
    twin::Side side = twin::make_side(receiver, slice, d, sign);
    side.noise = uniform(engine);
    if (side.pixels < 1) continue;
    twin::Tally tally{twin::empty_mask(), 0, vec3(0)};
    twin::walk(receiver, slice, side, twin::make_scale(slice, total, sign, xi), tally);
    const unsigned mask = tally.covered.words[0];

    auto at = [&](vec3 position) {
      vec3 delta = position - receiver.ray * z;
      float m = dot(delta, glm::normalize(glm::cross(v, slice.tangent)));
      float s = twin::side_sine(dot(delta, slice.tangent), dot(delta, n) / slice.n_length, m / slice.n_length,
                                slice.sin_gamma);
      // In the unmirrored slice, which is what the sectors are numbered in.
      return 32 * twin::slice_cdf(slice.cos_gamma, sign * slice.sin_gamma, sign * s, sign) + xi;
    };
    vec3 front = twin::view_position(glm::vec2(texel) + 0.5f, sample_z, twin::frame.ray_scale, twin::frame.ray_offset);
    float ends[2] = {at(front), at(front + glm::normalize(front) * twin::bitmask.thickness)};
    if (ends[0] > ends[1]) std::swap(ends[0], ends[1]);
    // Exact but for positions within rounding of a sector's border.
    const float slack = 1e-3f;
    unsigned inner = twin::sector_mask(int(std::floor(ends[0] + slack)), int(std::floor(ends[1] - slack)));
    unsigned outer = twin::sector_mask(int(std::floor(ends[0] - slack)), int(std::floor(ends[1] + slack)));
    EXPECT_EQ(inner & ~mask, 0u) << i;
    EXPECT_EQ(mask & ~outer, 0u) << i;
    bits += std::popcount(mask);
  }
  EXPECT_GT(bits, 10000);
}

TEST(Estimator, TheTwoSidesOfASliceAreJitteredApart) {
  look_through({});
  ivec2 pixel(512);
  std::vector<ivec2> offsets;
  twin::fetch = [&](ivec2 p) {
    if (p != pixel) offsets.push_back(p - pixel);
    return bed::Texel{4, vec3(0, 0, 1), vec3(0), {}};
  };
  twin::bitmask = {};
  twin::bitmask.slices = 4;
  twin::bitmask.steps = 8;
  twin::bitmask.radius = 20;  // so far apart that few texels meet by chance
  twin::bitmask.span = 1;     // nor do their neighbours
  twin::estimate_bitmask(pixel);
  auto mirrored = [&](ivec2 o) { return std::find(offsets.begin(), offsets.end(), -o) != offsets.end(); };
  EXPECT_EQ(offsets.size(), 2u * 4 * 8);
  EXPECT_LT(std::count_if(offsets.begin(), offsets.end(), mirrored), 10);
}

TEST(Estimator, StepPower) {
  for (float x = 0; x <= 1; x += 0.125f) {
    for (int e = 1; e <= 4; ++e) {
      vec3 parts = glm::clamp(vec3(float(e)) - vec3(1, 2, 3), 0.0f, 1.0f);
      EXPECT_NEAR(twin::step_power(x, parts), std::pow(x, e), 1e-6);
    }
    EXPECT_NEAR(twin::step_power(x, vec3(0.5f, 0, 0)), std::pow(x, 1.5), 0.04);
  }
}

// From anywhere to anywhere on a small, odd screen: never off it, never the receiver's own texel.
TEST(Estimator, StaysOnTheScreenAndOffTheReceiver) {
  bed::Camera camera;
  for (ivec2 size : {ivec2(1, 1), ivec2(3, 5), ivec2(67, 31)}) {
    camera.size = size;
    look_through(camera);
    twin::bitmask = thorough(4, 16);
    twin::bitmask.span = 1;
    for (int i = 0; i < size.x * size.y; ++i) {
      ivec2 pixel(i % size.x, i / size.x);
      int own = 0, fetches = 0;
      twin::fetch = [&](ivec2 p) {
        ++fetches;
        own += p == pixel;
        EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x < size.x && p.y < size.y) << p.x << " " << p.y;
        return bed::Texel{1.0f + 0.1f * float((p.x * 7 + p.y * 3) % 5), vec3(0, 0, 1), vec3(1), {}};
      };
      twin::frame.frame_index = unsigned(i);
      twin::Gathered seen = twin::estimate_bitmask(pixel);
      EXPECT_EQ(own, 2) << "the receiver's depth and normal, once each";
      EXPECT_TRUE(std::isfinite(seen.visibility) && std::isfinite(seen.gi.x));
      if (size.x > 3) {
        EXPECT_GT(fetches, 16 * 2);
      }
    }
  }
}

}  // namespace
