// Measures of sequences against sequences whose answers are known.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "image/temporal.h"

namespace nf::image {
namespace {

Image flat(float value, uint32_t channels = 3) {
  return {40, 30, channels, std::vector<float>(size_t(40) * 30 * channels, value)};
}
Image noisy(float mean, float deviation, std::mt19937_64& random, uint32_t channels = 1) {
  std::normal_distribution<float> normal(mean, deviation);
  Image out = flat(0, channels);
  for (float& value : out.pixels) value = normal(random);
  return out;
}

TEST(TemporalMeasures, TheMeanOfWhiteNoiseSettlesAsTheRootOfItsLength) {
  std::mt19937_64 random(1);
  RunningMean a, b, even;
  std::vector<std::pair<double, double>> white, stratified;
  for (uint32_t n = 1; n <= 128; ++n) {
    a.add(noisy(1, 0.3f, random));
    b.add(noisy(1, 0.3f, random));
    // Errors that the next frame takes back: the mean's error falls as 1 / n.
    even.add(flat(n % 2 ? 1.2f : 0.8f, 1));
    if (n & (n - 1)) continue;
    white.emplace_back(n, rms_difference(a.mean(), b.mean()) / std::sqrt(2.0));
    if (n > 1) stratified.emplace_back(n - 1, 0.2 / (n - 1));
  }
  EXPECT_EQ(a.count(), 128u);
  EXPECT_NEAR(white.front().second, 0.3, 0.02);
  EXPECT_NEAR(log_log_slope(white), -0.5, 0.03);
  EXPECT_NEAR(log_log_slope(stratified), -1, 1e-9);
  EXPECT_NEAR(double(even.mean().pixels[7]), 1, 1e-6);
  EXPECT_TRUE(std::isnan(log_log_slope(std::span(white).first(1))));
}

TEST(TemporalMeasures, TheSpreadOfPicturesIsTheirDeviation) {
  std::mt19937_64 random(3);
  std::vector<Image> pictures;
  for (int i = 0; i < 8; ++i) pictures.push_back(noisy(float(i < 4), 0, random));
  EXPECT_NEAR(spread(pictures), std::sqrt(2.0 / 7), 1e-6) << "four of 0, four of 1";
  for (Image& picture : pictures) picture = noisy(5, 0.3f, random);
  EXPECT_NEAR(spread(pictures), 0.3, 0.01);
  EXPECT_EQ(spread(std::span(pictures).first(1)), 0);
}

TEST(TemporalMeasures, HalfOfThePixelsAreNearer) {
  Image test = flat(1), reference = flat(1);
  // A third off by 10 %, a third by 2 %, a third right; one as dark as nothing does not count.
  for (size_t i = 0; i < test.pixels.size(); ++i)
    test.pixels[i] = i / 3 % 3 == 0 ? 1.1f : i / 3 % 3 == 1 ? 0.98f : 1.0f;
  EXPECT_NEAR(median_relative_error(test, reference), 0.02, 1e-6);
  for (size_t c = 0; c < 3; ++c) reference.pixels[c] = 0;
  EXPECT_NEAR(median_relative_error(test, reference), 0.02, 1e-6);
  std::vector<uint8_t> mask(40 * 30, 0);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = i % 3 == 0 && i > 0;
  EXPECT_NEAR(median_relative_error(test, reference, mask), 0.1, 1e-6);
  EXPECT_TRUE(std::isnan(median_relative_error(test, flat(0))));
}

// An exponential mean with weight a keeps (1 - a)^n of what was.
TEST(TemporalMeasures, AnExponentialMeanHasItsHalfLife) {
  std::mt19937_64 random(2);
  const Image from = noisy(1, 0.2f, random), to = noisy(0.4f, 0.1f, random);
  const std::vector<uint8_t> mask(40 * 30, 1);
  for (const double weight : {0.1, 0.25, 0.6}) {
    std::vector<double> shares;
    for (int n = 1; n < 40; ++n) {
      Image now = noisy(0, 0.05f, random);  // noise beside it
      const float left = float(std::pow(1 - weight, n));
      for (size_t i = 0; i < now.pixels.size(); ++i)
        now.pixels[i] += to.pixels[i] + left * (from.pixels[i] - to.pixels[i]);
      shares.push_back(share_left(now, from, to, mask));
      EXPECT_NEAR(shares.back(), double(left), 0.01);
    }
    // Linear between whole frames, where the curve bends.
    EXPECT_NEAR(half_life(shares), std::log(0.5) / std::log(1 - weight), 0.13) << weight;
  }
  EXPECT_DOUBLE_EQ(half_life(std::vector{0.0}), 0.5) << "gone with the first frame";
  EXPECT_DOUBLE_EQ(half_life(std::vector{1.0, 0.75, 0.25}), 2.5);
  EXPECT_TRUE(std::isinf(half_life(std::vector{0.9, 0.8, 0.7})));
  EXPECT_TRUE(std::isnan(share_left(from, from, from, mask)));
}

TEST(TemporalMeasures, FlickerIsNoiseAndNotDrift) {
  std::mt19937_64 random(3);
  std::vector<Image> drift, noise, steps;
  for (int n = 0; n < 24; ++n) {
    drift.push_back(flat(1 + 0.05f * float(n)));
    noise.push_back(noisy(2, 0.1f, random));
    steps.push_back(flat(n % 2 ? 1.1f : 0.9f));
  }
  EXPECT_NEAR(flicker(drift), 0, 1e-6);
  EXPECT_NEAR(flicker(noise), 0.05, 0.002);
  EXPECT_NEAR(flicker(steps), 0.4 / std::sqrt(6.0), 0.01);
  EXPECT_TRUE(std::isnan(flicker(std::span(noise).first(2))));
}

}  // namespace
}  // namespace nf::image
