// What a texel carries and what it is sampled with: packing (shaders/common/pack.glsl), positions (view.glsl), noise
// (noise.glsl).
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "glsl_twin.h"

NF_GLSL_BEGIN
#include "common/noise.glsl"
#include "common/pack.glsl"
#include "common/view.glsl"
NF_GLSL_END

namespace {

using glm::ivec2;
using glm::vec2;
using glm::vec3;
using twin::uint;

std::mt19937& generator() {
  static std::mt19937 engine(99);
  return engine;
}
float uniform(float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(generator());
}

vec3 random_unit() {
  float z = uniform(-1, 1), a = uniform(0, 6.2831853f), r = std::sqrt(1 - z * z);
  return vec3(r * std::cos(a), r * std::sin(a), z);
}

// --- normals ---

TEST(PackNormal, RoundTripIsWithinAHundredthOfADegree) {
  float worst = 0;
  for (int i = 0; i < 100000; ++i) {
    vec3 n = random_unit();
    worst = std::max(worst, glm::length(twin::unpack_normal(twin::pack_normal(n)) - n));
  }
  EXPECT_LT(worst, 8e-5f);
}

TEST(PackNormal, AxesSignsAndScale) {
  for (vec3 n : {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0), vec3(0, 0, 1), vec3(0, 0, -1)})
    EXPECT_LT(glm::length(twin::unpack_normal(twin::pack_normal(n)) - n), 1e-6f);
  for (int octant = 0; octant < 8; ++octant) {
    vec3 n = glm::normalize(vec3(octant & 1 ? -1 : 1, octant & 2 ? -2 : 2, octant & 4 ? -3 : 3));
    EXPECT_LT(glm::length(twin::unpack_normal(twin::pack_normal(n * 7.5f)) - n), 8e-5f) << octant;
    vec3 octahedron = twin::unpack_normal_octahedron(twin::pack_normal(n));
    EXPECT_LT(glm::length(glm::normalize(octahedron) - n), 8e-5f) << octant;
  }
}

TEST(PackNormal, AnyBitsDecodeToAUnitVector) {
  for (int i = 0; i < 100000; ++i) EXPECT_NEAR(glm::length(twin::unpack_normal(uint(generator()()))), 1.0f, 1e-5f);
}

// --- radiance ---

TEST(PackRadiance, RoundTripIsWithinHalfAStepOfTheLargest) {
  for (int i = 0; i < 100000; ++i) {
    vec3 color = vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)) * std::exp2(uniform(-12, 15));
    float largest = std::max({color.x, color.y, color.z});
    vec3 error = glm::abs(twin::unpack_rgb9e5(twin::pack_rgb9e5(color)) - color);
    // 9 bits hold the largest in 256..511: half a step is at most 1/512 of it.
    EXPECT_LE(std::max({error.x, error.y, error.z}), largest / 511.9f) << color.x << " " << color.y << " " << color.z;
  }
}

TEST(PackRadiance, ExactValuesAndRounding) {
  for (vec3 color : {vec3(0), vec3(1), vec3(0.5f, 0.25f, 2), vec3(511), vec3(65408, 0, 0), vec3(0x1p-24f)})
    EXPECT_EQ(twin::unpack_rgb9e5(twin::pack_rgb9e5(color)), color) << color.x;
  // The mantissa rounds up to 512 and moves to the next exponent.
  EXPECT_EQ(twin::unpack_rgb9e5(twin::pack_rgb9e5(vec3(511.9f))), vec3(512));
  EXPECT_EQ(twin::pack_rgb9e5(vec3(1)), (16u << 27) | (256u << 18) | (256u << 9) | 256u);  // the format's own 1.0
}

TEST(PackRadiance, OutOfRangeValuesAreTamed) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(twin::unpack_rgb9e5(twin::pack_rgb9e5(vec3(inf, -1, nan))), vec3(65408, 0, 0));
  EXPECT_EQ(twin::unpack_rgb9e5(twin::pack_rgb9e5(vec3(1e9f))), vec3(65408));
  EXPECT_EQ(twin::pack_rgb9e5(vec3(1e-12f)) & 0x7FFFFFFu, 0u);
}

// --- positions ---

TEST(View, PixelAndPositionAreInverse) {
  vec2 tangents(1.2f, 0.7f), size(1919, 1079);
  vec2 scale(2 * tangents.x / size.x, -2 * tangents.y / size.y), offset(-tangents.x, tangents.y);
  for (int i = 0; i < 1000; ++i) {
    vec2 pixel(uniform(0, size.x), uniform(0, size.y));
    vec3 position = twin::view_position(pixel, uniform(0.1f, 100), scale, offset);
    EXPECT_LT(glm::length(twin::pixel_of(position, scale, offset) - pixel), 2e-3f);
  }
  // Corners: y down on the screen is y up in the view.
  EXPECT_LT(glm::length(twin::view_position(vec2(0), 2, scale, offset) - vec3(-2.4f, 1.4f, -2)), 1e-5f);
  EXPECT_LT(glm::length(twin::view_position(size, 1, scale, offset) - vec3(1.2f, -0.7f, -1)), 1e-5f);
}

// --- noise ---

TEST(Noise, HilbertCurveVisitsNeighbours) {
  std::vector<ivec2> at(4096, ivec2(-1));
  for (int i = 0; i < 4096; ++i) at[twin::hilbert_index(uint(i % 64), uint(i / 64))] = ivec2(i % 64, i / 64);
  for (size_t i = 1; i < at.size(); ++i) {
    ivec2 step = glm::abs(at[i] - at[i - 1]);
    ASSERT_EQ(step.x + step.y, 1) << "at " << i;
  }
  EXPECT_EQ(twin::hilbert_index(64u + 5u, 128u + 9u), twin::hilbert_index(5u, 9u));
}

TEST(Noise, IsDeterministicInRangeAndFollowsTheSeed) {
  int same = 0;
  for (int i = 0; i < 4096; ++i) {
    ivec2 pixel(i * 7 % 1920, i * 13 % 1080);
    vec3 noise = twin::sampling_noise(pixel, uint(i), 3);
    EXPECT_EQ(noise, twin::sampling_noise(pixel, uint(i), 3));
    for (int d = 0; d < 3; ++d) {
      EXPECT_GE(noise[d], 0.0f);
      EXPECT_LT(noise[d], 1.0f);
    }
    same += noise == twin::sampling_noise(pixel, uint(i), 4);
  }
  EXPECT_EQ(same, 0);
  vec3 late = twin::sampling_noise(ivec2(1, 1), 0xFFFFFFFFu, 0);  // no loss of precision after months
  EXPECT_NE(late, twin::sampling_noise(ivec2(1, 1), 0xFFFFFFFEu, 0));
}

// The fullest of four equal bins of [0, 1).
int fullest_bin(const std::vector<float>& values) {
  int bins[4] = {};
  for (float value : values) ++bins[int(value * 4)];
  return *std::max_element(bins, bins + 4);
}

TEST(Noise, EachDimensionIsStratifiedOverFramesAndOverBlocks) {
  int worst_white = 0;
  for (int d = 0; d < 3; ++d) {
    for (int start = 0; start < 64; ++start) {
      std::vector<float> frames, block, white;
      for (int i = 0; i < 16; ++i) {
        frames.push_back(twin::sampling_noise(ivec2(start, 3), uint(i), 0)[d]);
        block.push_back(twin::sampling_noise(ivec2(4 * start + i % 4, 8 + i / 4), uint(start), 0)[d]);
        white.push_back(uniform(0, 0.99999f));
      }
      EXPECT_LE(fullest_bin(frames), 6) << d;
      EXPECT_LE(fullest_bin(block), 6) << d;
      worst_white = std::max(worst_white, fullest_bin(white));
    }
  }
  EXPECT_GE(worst_white, 8) << "control: white noise is not stratified";
}

// Mean square error of the share of points in boxes, over blocks of 4 x 4 pixels and 8 frames, for two of the
// dimensions.
double box_error(int d0, int d1, bool white) {
  double error = 0;
  int count = 0;
  // The same boxes whatever ran before.
  std::mt19937 engine(5);
  auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine); };
  for (int trial = 0; trial < 200; ++trial) {
    vec2 low(uniform(0, 0.6f), uniform(0, 0.6f)), high = low + vec2(uniform(0.2f, 0.4f), uniform(0.2f, 0.4f));
    double truth = (high.x - low.x) * (high.y - low.y);
    for (int block = 0; block < 64; ++block) {
      int inside = 0;
      for (int i = 0; i < 128; ++i) {
        ivec2 pixel(4 * (block % 8) + i % 4, 4 * (block / 8) + i / 4 % 4);
        vec3 noise = twin::sampling_noise(pixel, uint(i / 16), 0);
        vec2 u = white ? vec2(uniform(0, 1), uniform(0, 1)) : vec2(noise[d0], noise[d1]);
        inside += u.x > low.x && u.x < high.x && u.y > low.y && u.y < high.y;
      }
      error += std::pow(inside / 128.0 - truth, 2);
      ++count;
    }
  }
  return error / count;
}

// Measured: .24, .21, .39.
TEST(Noise, PairsOfDimensionsBeatWhiteNoise) {
  EXPECT_LT(box_error(0, 1, false), 0.45 * box_error(0, 1, true));
  EXPECT_LT(box_error(0, 2, false), 0.45 * box_error(0, 2, true));
  EXPECT_LT(box_error(1, 2, false), 0.45 * box_error(1, 2, true));
}

TEST(Noise, DimensionsAreUncorrelated) {
  for (int d = 0; d < 3; ++d) {
    double sum = 0;
    for (int i = 0; i < 65536; ++i) {
      vec3 noise = twin::sampling_noise(ivec2(i % 64, i / 64 % 64), uint(i / 4096), 0);
      sum += (noise[d] - 0.5) * (noise[(d + 1) % 3] - 0.5);
    }
    EXPECT_LT(std::abs(sum / 65536) * 12, 0.01) << d;
  }
}

TEST(Noise, EveryStepHasItsOwnJitter) {
  for (int slices : {1, 2, 3, 9}) {
    for (int steps : {1, 3, 8, 32}) {
      std::set<int> indices;
      std::vector<float> jitters;
      for (int march = 0; march < 2 * slices; ++march) {
        for (int step = 0; step < steps; ++step) {
          int index = twin::step_index(march, step, steps);
          EXPECT_TRUE(indices.insert(index).second) << "collision at " << march << " " << step;
          // As the estimator does: first to the march, then to the step.
          jitters.push_back(twin::rotated(twin::rotated(0.3f, twin::step_index(march, 0, steps)), step));
          float direct = twin::rotated(0.3f, index), apart = std::abs(direct - jitters.back());
          EXPECT_LT(std::min(apart, 1 - apart), 1e-4f);
        }
      }
      std::sort(jitters.begin(), jitters.end());
      for (size_t i = 1; i < jitters.size(); ++i)  // the golden ratio keeps n points at least 0.38 / n apart
        EXPECT_GT(jitters[i] - jitters[i - 1], 0.3f / float(jitters.size()));
    }
  }
}

}  // namespace
