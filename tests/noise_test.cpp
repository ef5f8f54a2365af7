// The kinds of sampling noise (shaders/common/noise.glsl as C++) and the table behind two of them: distribution,
// independence, spectra.
#include "noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <string>
#include <unistd.h>

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
    {"stbn", [](ivec2 p, uint32_t frame) { return twin::noise_stbn(texel(twin::stbn_texel(p, frame)), frame, 3); }},
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

// The same of sequences of 16 values, over 4096 pixels.
double low_power_in_time(const std::function<double(int, int)>& value, int most) {
  double sum = 0;
  for (int pixel = 0; pixel < 4096; ++pixel)
    for (int f = 1; f <= most; ++f) {
      std::complex<double> amplitude = 0;
      for (int t = 0; t < 16; ++t) amplitude += (value(pixel, t) - 0.5) * std::polar(1.0, -2 * M_PI * f * t / 16);
      sum += std::norm(amplitude) / 16 * 12;
    }
  return sum / (4096 * most);
}

TEST(VoidAndCluster, IsAPermutationThatFollowsItsSeed) {
  const std::vector<uint32_t> one = nf::image::void_and_cluster(16, 4, 1);
  std::vector<uint32_t> sorted = one;
  std::sort(sorted.begin(), sorted.end());
  for (uint32_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
  EXPECT_EQ(one, nf::image::void_and_cluster(16, 4, 1));
  EXPECT_NE(one, nf::image::void_and_cluster(16, 4, 2));
}

TEST(VoidAndCluster, EveryThresholdKeepsPointsApart) {
  const std::vector<uint32_t> ranks = nf::image::void_and_cluster(64, 1, 1);
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

// Measured: 0.0003 within a slice of one, 0.003 within a slice of 16, 0.02 and 0.1 at one and two periods in 16 frames.
TEST(VoidAndCluster, LowFrequenciesAreFarBelowWhiteNoise) {
  const std::vector<uint32_t> flat = nf::image::void_and_cluster(64, 1, 1);
  EXPECT_LT(low_power([&](int x, int y) { return flat[size_t(y * 64 + x)] / 4096.0; }, 8), 0.003);
  std::vector<uint32_t> deep = nf::image::void_and_cluster(64, 16, 2);
  auto slice_power = [&] {
    return low_power([&](int x, int y) { return deep[size_t((5 * 64 + y) * 64 + x)] / 65536.0; }, 8);
  };
  auto time_power = [&](int most) {
    return low_power_in_time([&](int pixel, int t) { return deep[size_t(t * 4096 + pixel)] / 65536.0; }, most);
  };
  EXPECT_LT(slice_power(), 0.01);
  EXPECT_LT(time_power(1), 0.05);
  EXPECT_LT(time_power(2), 0.12);
  // Controls: frames moved apart are as blue in space and white in time; shuffled points are white.
  for (int t = 0; t < 16; ++t)
    std::rotate(deep.begin() + t * 4096, deep.begin() + t * 4096 + t * 64 * 19 % 4096, deep.begin() + (t + 1) * 4096);
  EXPECT_LT(slice_power(), 0.01);
  EXPECT_NEAR(time_power(2), 1, 0.1);
  std::shuffle(deep.begin(), deep.end(), std::mt19937(1));
  EXPECT_NEAR(slice_power(), 1, 0.3);
}

TEST(NoiseTable, HistogramsAreExactlyUniform) {
  for (int channel = 0; channel < 3; ++channel) {
    for (bool over_time : {false, true}) {
      std::vector<int> count(1024);
      for (size_t i = over_time ? 4096 : 0; i < (over_time ? table().size() : 4096); ++i)
        ++count[(table()[i] >> (10 * channel)) & 1023];
      const int each = over_time ? 64 : 4;
      EXPECT_EQ(std::count(count.begin(), count.end(), each), 1024) << channel;
    }
  }
}

TEST(NoiseTable, IsKeptInAFileAndMadeAnewWhenThatIsDamaged) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("nearfield-noise-" + std::to_string(getpid()));
  EXPECT_EQ(nf::passes::load_noise_table(folder / "new"), table());
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "new")) files.push_back(entry.path());
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(std::filesystem::file_size(files[0]), table().size() * 4);
  {
    std::fstream file(files[0], std::ios::in | std::ios::out | std::ios::binary);
    file.put(char(~table()[0]));
  }
  EXPECT_NE(nf::passes::load_noise_table(folder / "new"), table()) << "the file is what is read";
  std::filesystem::resize_file(files[0], 1000);
  EXPECT_EQ(nf::passes::load_noise_table(folder / "new"), table());
  EXPECT_EQ(std::filesystem::file_size(files[0]), table().size() * 4);
  std::filesystem::remove_all(folder);
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
// Measured: hilbert_r2 .29 .49 .07, ign .31 .23 .18, 4x4 .31 .06 .02, blue .30 .27 .09, stbn .37 .31 .13.
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

// Turning all pixels wraps some of them around, which costs some of the blue: 0.05 to 0.075 are left.
TEST(NoiseKinds, BlueStaysBlueInEveryFrame) {
  for (uint32_t frame : {0u, 5u, 37u}) {
    for (int d = 0; d < 3; ++d) {
      auto power = [&](const char* name) {
        return low_power([&](int x, int y) { return kinds.at(name)(ivec2(x, y), frame)[d]; }, 8);
      };
      EXPECT_LT(power("blue"), 0.1) << frame << " " << d;
      EXPECT_LT(power("stbn"), 0.1) << frame << " " << d;
      EXPECT_NEAR(power("white"), 1, 0.3);
    }
  }
}

}  // namespace
