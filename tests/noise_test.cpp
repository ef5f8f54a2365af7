// The kinds of sampling noise (shaders/common/noise.glsl as C++) and the table behind two of them: distribution,
// independence, spectra.
#include "noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <string>

#include "glsl_twin.h"
#include "image/blue_noise.h"

NF_GLSL_BEGIN
#include "common/noise.glsl"
NF_GLSL_END

namespace {

using glm::ivec2;
using glm::vec3;

const std::vector<uint32_t>& table() {
  static const std::vector<uint32_t> made = nf::passes::make_noise_table();
  return made;
}
uint32_t texel(ivec2 at) {
  return table()[size_t(at.y) * 64 + size_t(at.x)];
}

using Kind = std::function<vec3(ivec2, uint32_t)>;
const std::map<std::string, Kind> kinds = {
    {"hilbert_r2", [](ivec2 p, uint32_t frame) { return twin::noise_hilbert_r2(p, frame, 3); }},
    {"ign", [](ivec2 p, uint32_t frame) { return twin::noise_ign(p, frame, 3); }},
    {"4x4", [](ivec2 p, uint32_t frame) { return twin::noise_4x4(p, frame, 3); }},
    {"blue", [](ivec2 p, uint32_t frame) { return twin::noise_blue(texel(twin::blue_texel(p)), frame, 3); }},
    {"stbn", [](ivec2 p, uint32_t frame) { return twin::noise_stbn(texel(twin::blue_texel(p)), frame, 3); }},
    {"white", [](ivec2 p, uint32_t frame) { return twin::noise_white(p, frame, 3); }}};

// Mean power of a 64 x 64 picture of values in [0, 1) at frequencies of 1 .. `most` periods across it; white noise
// has 1.
double low_power(const std::function<double(int, int)>& value, int most) {
  std::vector<std::complex<double>> wave(64), rows(64);
  for (int i = 0; i < 64; ++i) wave[size_t(i)] = std::polar(1.0, -2 * M_PI * i / 64);
  double sum = 0;
  int count = 0;
  for (int u = 0; u <= most; ++u) {
    for (int y = 0; y < 64; ++y) {
      rows[size_t(y)] = 0;
      for (int x = 0; x < 64; ++x) rows[size_t(y)] += (value(x, y) - 0.5) * wave[size_t(u * x % 64)];
    }
    for (int v = -most; v <= most; ++v) {
      if (u * u + v * v == 0 || u * u + v * v > most * most) continue;
      std::complex<double> amplitude = 0;
      for (int y = 0; y < 64; ++y) amplitude += rows[size_t(y)] * wave[size_t((v + 64) * y % 64)];
      sum += std::norm(amplitude) / 4096 * 12;
      ++count;
    }
  }
  return sum / count;
}

TEST(VoidAndCluster, IsAPermutationThatFollowsItsSeed) {
  const std::vector<uint32_t> one = nf::image::void_and_cluster(16, 1);
  std::vector<uint32_t> sorted = one;
  std::sort(sorted.begin(), sorted.end());
  for (uint32_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
  EXPECT_EQ(one, nf::image::void_and_cluster(16, 1));
  EXPECT_NE(one, nf::image::void_and_cluster(16, 2));
}

TEST(VoidAndCluster, EveryThresholdKeepsPointsApart) {
  const std::vector<uint32_t> ranks = nf::image::void_and_cluster(64, 1);
  // 64 points on 64 x 64: 8.6 apart at best (a hexagonal lattice).
  std::vector<ivec2> points;
  for (int i = 0; i < 4096; ++i)
    if (ranks[size_t(i)] < 64) points.push_back(ivec2(i % 64, i / 64));
  double least = 100;
  for (const ivec2 a : points)
    for (const ivec2 b : points)
      if (a != b) {
        const ivec2 d = glm::min(glm::abs(a - b), 64 - glm::abs(a - b));
        least = std::min(least, std::hypot(d.x, d.y));
      }
  EXPECT_GT(least, 5);
}

// Measured: 0.0003.
TEST(VoidAndCluster, LowFrequenciesAreFarBelowWhiteNoise) {
  std::vector<uint32_t> ranks = nf::image::void_and_cluster(64, 1);
  const auto power = [&] { return low_power([&](int x, int y) { return ranks[size_t(y * 64 + x)] / 4096.0; }, 8); };
  EXPECT_LT(power(), 0.003);
  // Control: shuffled points are white.
  std::shuffle(ranks.begin(), ranks.end(), std::mt19937(1));
  EXPECT_NEAR(power(), 1, 0.3);
}

TEST(NoiseTable, HistogramsAreExactlyUniform) {
  ASSERT_EQ(table().size(), 4096u);
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<int> count(1024);
    for (const uint32_t numbers : table()) ++count[(numbers >> (10 * channel)) & 1023];
    EXPECT_EQ(std::count(count.begin(), count.end(), 4), 1024) << channel;
  }
}

TEST(NoiseKinds, AreUniformAndIndependentOverPixelsAndFrames) {
  for (const auto& [name, kind] : kinds) {
    // The 4x4 pattern repeats: many frames instead of many pixels.
    const int side = name == "4x4" ? 4 : 64;
    constexpr int count = 65536;
    double product[3] = {};
    std::vector<int> bins[3], pairs[3];
    for (int d = 0; d < 3; ++d) bins[d].resize(16), pairs[d].resize(64);
    for (int i = 0; i < count; ++i) {
      const vec3 noise = kind(ivec2(i % side, i / side % side) + 128, uint32_t(i / side / side));
      for (int d = 0; d < 3; ++d) {
        const float a = noise[d], b = noise[(d + 1) % 3];
        ASSERT_TRUE(a >= 0 && a < 1) << name;
        ++bins[d][size_t(a * 16)];
        ++pairs[d][size_t(a * 8) * 8 + size_t(b * 8)];
        product[d] += (a - 0.5) * (b - 0.5) / count * 12;
      }
    }
    for (int d = 0; d < 3; ++d) {
      EXPECT_LT(std::abs(product[d]), 0.015) << name << " correlation of " << d;
      // White noise: 4096 +- 62 and 1024 +- 32; the worst of all three to four times that.
      for (int n : bins[d]) EXPECT_NEAR(n, count / 16, 260) << name << " " << d;
      for (int n : pairs[d]) EXPECT_NEAR(n, count / 64, 140) << name << " pair " << d;
    }
  }
}

TEST(NoiseKinds, FollowFrameAndSeedAndNeverRunOut) {
  for (const auto& [name, kind] : kinds) {
    int same = 0;
    for (int i = 0; i < 1000; ++i) {
      const ivec2 p(i * 7 % 1920, i * 13 % 1080);
      same += kind(p, uint32_t(i)) == kind(p, uint32_t(i + 1)) || kind(p, uint32_t(i)) == kind(p, uint32_t(i + 16));
    }
    EXPECT_LE(same, 1) << name;
    EXPECT_NE(kind(ivec2(1), 0xFFFFFFFFu), kind(ivec2(1), 0xFFFFFFFEu)) << name;
  }
  EXPECT_NE(twin::noise_white(ivec2(1), 1, 1), twin::noise_white(ivec2(1), 1, 2));
  EXPECT_NE(twin::noise_blue(5, 1, 1), twin::noise_blue(5, 1, 2));
}

// What the kinds are for: variance of means over 16 frames, 4 x 4 pixels, both with 32 frames, against white noise's.
// Measured: hilbert_r2 .29 .49 .07, ign .31 .23 .18, 4x4 .31 .06 .02, blue .30 .27 .09, stbn .14 .23 .04.
TEST(NoiseKinds, MeansOverFramesAndBlocks) {
  auto error = [](const Kind& kind, int block, int frames) {
    double sum = 0;
    for (int i = 0; i < 400; ++i) {
      vec3 mean(0);
      for (int k = 0; k < block * block * frames; ++k)
        mean +=
            kind(ivec2(4 * i % 64 + k % block, i / 16 * 4 % 64 + k / block % block), uint32_t(i + k / (block * block)));
      const vec3 off = mean / float(block * block * frames) - 0.5f;
      sum += dot(off, off) / 3;
    }
    return sum / 400 * 12 * block * block * frames;
  };
  for (const auto& [name, kind] : kinds) {
    const double in_time = error(kind, 1, 16), in_space = error(kind, 4, 1), both = error(kind, 4, 32);
    if (name == "white") {
      EXPECT_NEAR(in_time, 1, 0.2);
      EXPECT_NEAR(in_space, 1, 0.2);
      EXPECT_NEAR(both, 1, 0.2);
    } else {
      EXPECT_LT(in_time, 0.45) << name;
      EXPECT_LT(in_space, 0.6) << name;
      EXPECT_LT(both, 0.25) << name;
    }
  }
}

// Turning all pixels wraps some of them around, which costs some of the blue: 0.05 to 0.075 are left. Exchanging
// halves, quarters ... of the values leaves at most 0.06.
TEST(NoiseKinds, BlueStaysBlueInEveryFrame) {
  for (uint32_t frame : {0u, 5u, 37u}) {
    for (int d = 0; d < 3; ++d) {
      auto power = [&](const char* name) {
        return low_power([&](int x, int y) { return kinds.at(name)(ivec2(x, y), frame)[d]; }, 8);
      };
      EXPECT_LT(power("blue"), 0.1) << frame << " " << d;
      EXPECT_LT(power("stbn"), 0.08) << frame << " " << d;
      EXPECT_NEAR(power("white"), 1, 0.3);
    }
  }
}

// Of 2^k frames in turn each pixel has one value in each 2^-k of any dimension, and one in each of 2^k elementary
// intervals of the first two: Sobol's points, whatever scrambles them.
TEST(NoiseKinds, StbnSpreadsItsFramesEvenly) {
  for (const char* name : {"stbn", "white"}) {
    int most_in_one = 0, most_in_cell = 0;
    for (const ivec2 pixel : {ivec2(3, 5), ivec2(40, 21), ivec2(63, 0)})
      for (const uint32_t first : {0u, 64u, 1u << 20}) {
        std::vector<int> ones[3], cells(64);
        for (auto& one : ones) one.resize(64);
        for (uint32_t t = 0; t < 64; ++t) {
          const vec3 noise = kinds.at(name)(pixel, first + t);
          for (int d = 0; d < 3; ++d) most_in_one = std::max(most_in_one, ++ones[d][size_t(noise[d] * 64)]);
          most_in_cell = std::max(most_in_cell, ++cells[size_t(noise.x * 8) * 8 + size_t(noise.y * 8)]);
        }
      }
    EXPECT_EQ(most_in_one == 1, std::string(name) == "stbn") << most_in_one;
    EXPECT_EQ(most_in_cell == 1, std::string(name) == "stbn") << most_in_cell;
  }
}

}  // namespace
