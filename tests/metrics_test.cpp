// The measures of difference against values found by hand or by other programs, and what masks and blocks do to them.
#include "image/metrics.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "core/error.h"

namespace nf::image {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Image flat(uint32_t width, uint32_t height, std::vector<float> color) {
  Image image{width, height, uint32_t(color.size()), {}};
  for (size_t i = 0; i < size_t(width) * height; ++i)
    image.pixels.insert(image.pixels.end(), color.begin(), color.end());
  return image;
}

Image noise(uint32_t width, uint32_t height, uint32_t channels, uint32_t seed, float scale = 1) {
  std::mt19937 generator(seed);
  Image image{width, height, channels, std::vector<float>(size_t(width) * height * channels)};
  for (float& value : image.pixels) value = scale * float(generator() >> 8) / 16777216.0f;
  return image;
}

double value_of(Metric metric, const Image& test, const Image& reference, bool hdr = false) {
  return measure(metric, make_pair(test, reference), hdr).value;
}

TEST(Metrics, EqualPicturesDoNotDiffer) {
  const Image image = noise(40, 30, 3, 1, 3);
  for (const MetricInfo& row : metrics()) {
    for (const bool hdr : {false, true}) {
      const Measured m = measure(row.metric, make_pair(image, image), hdr);
      if (row.metric == Metric::Psnr)
        EXPECT_EQ(m.value, double(infinity));
      else
        EXPECT_EQ(m.value, row.more_is_better ? 1 : 0) << row.id;
      EXPECT_EQ(m.pooled.max, 0) << row.id;
    }
  }
}

TEST(Metrics, BlackAgainstWhite) {
  const Image black = flat(64, 48, {0, 0, 0}), white = flat(64, 48, {1, 1, 1});
  EXPECT_EQ(value_of(Metric::Rmse, black, white), 1);
  EXPECT_EQ(value_of(Metric::Mae, black, white), 1);
  EXPECT_EQ(value_of(Metric::Mse, black, white), 1);
  EXPECT_EQ(value_of(Metric::Psnr, black, white), 0);
  EXPECT_NEAR(value_of(Metric::RelMse, black, white), 1 / 1.01, 1e-6);
  EXPECT_NEAR(value_of(Metric::RelMse, white, black), 1 / 0.01, 1e-4);
  // Flat pictures have no variance: SSIM is C1 / (1 + C1).
  EXPECT_NEAR(value_of(Metric::Ssim, black, white), 0.0001 / 1.0001, 1e-5);
  EXPECT_NEAR(value_of(Metric::Flip, black, white), 0.967, 5e-4);
}

TEST(Metrics, MeansByHand) {
  Image test{2, 1, 3, {1, 2, 3, 4, 5, 6}}, reference{2, 1, 3, {1, 1, 1, 4, 4, 0}};
  // Differences 0 1 2 0 1 6.
  EXPECT_DOUBLE_EQ(value_of(Metric::Mae, test, reference), 10.0 / 6);
  EXPECT_DOUBLE_EQ(value_of(Metric::Mse, test, reference), 42.0 / 6);
  EXPECT_DOUBLE_EQ(value_of(Metric::Rmse, test, reference), std::sqrt(7.0));
  EXPECT_DOUBLE_EQ(value_of(Metric::Psnr, test, reference), -10 * std::log10(7.0));
  EXPECT_NEAR(value_of(Metric::RelMse, test, reference), (5 / 1.01 + 1 / 16.01 + 36 / 0.01) / 6, 1e-6);
  const Pair pair = make_pair(test, reference);
  EXPECT_DOUBLE_EQ(bias(pair).difference, 10.0 / 6);
  EXPECT_DOUBLE_EQ(bias(pair).reference, 11.0 / 6);
  EXPECT_DOUBLE_EQ(fraction_above(pair, 2), 0.5);
  EXPECT_DOUBLE_EQ(fraction_above(pair, 6), 0);
  const Measured mae = measure(Metric::Mae, pair, false);
  EXPECT_FLOAT_EQ(mae.map.pixels[0], 1);
  EXPECT_EQ(mae.pooled.worst_x, 1u);
  EXPECT_NEAR(mae.pooled.max, 7.0 / 3, 1e-6);
  EXPECT_NEAR(mae.pooled.p50, (1 + 7.0 / 3) / 2, 1e-6);
}

TEST(Metrics, PercentilesOfACount) {
  Image map{101, 1, 1, {}};
  for (int i = 100; i >= 0; --i) map.pixels.push_back(float(i));
  const Pooled p = pool(map, {});
  EXPECT_EQ(p.mean, 50);
  EXPECT_EQ(p.p50, 50);
  EXPECT_EQ(p.p95, 95);
  EXPECT_EQ(p.max, 100);
  EXPECT_EQ(p.worst_x, 0u);
  EXPECT_EQ(p.count, 101u);
}

TEST(Metrics, WhatIsNoNumberIsAnInfiniteError) {
  Image test = flat(16, 16, {1, 1, 1});
  const Image reference = test;
  test.at(3, 4, 1) = nan;
  const Pair pair = make_pair(test, reference);
  for (const Metric metric : {Metric::Mae, Metric::Mse, Metric::Rmse, Metric::RelMse}) {
    const Measured m = measure(metric, pair, false);
    EXPECT_EQ(m.value, double(infinity));
    EXPECT_EQ(m.pooled.worst_x, 3u);
    EXPECT_EQ(m.pooled.worst_y, 4u);
  }
  EXPECT_EQ(measure(Metric::Flip, pair, true).map.at(3, 4, 0), 1);
  EXPECT_EQ(measure(Metric::Ssim, pair, true).map.at(3, 4, 0), 1);
  EXPECT_EQ(fraction_above(pair, 1e30), 1 / 256.0);
  // Equal infinities do not differ.
  Image a = reference, b = reference;
  a.at(0, 0, 0) = b.at(0, 0, 0) = infinity;
  EXPECT_EQ(value_of(Metric::Mae, a, b), 0);
}

TEST(Metrics, TheMaskDecidesWhatCounts) {
  Image test = flat(32, 32, {0.5f, 0.5f, 0.5f}), reference = test, mask = flat(32, 32, {1});
  for (uint32_t y = 0; y < 32; ++y) {
    for (uint32_t x = 0; x < 8; ++x) {
      mask.at(x, y, 0) = 0;
      test.at(x, y, 0) = nan;
      test.at(x, y, 1) = 90;
    }
  }
  const Pair pair = make_pair(test, reference, mask);
  for (const MetricInfo& row : metrics()) {
    const Measured m = measure(row.metric, pair, true);
    EXPECT_EQ(m.pooled.max, 0) << row.id;
    EXPECT_EQ(m.pooled.count, 32u * 24) << row.id;
  }
  EXPECT_EQ(fraction_above(pair, 0), 0);
}

TEST(Metrics, BlocksAverageBeforeTheyAreMeasured) {
  Image test = flat(9, 8, {1}), reference = flat(9, 8, {1}), mask = flat(9, 8, {1});
  // A checkerboard of +-1 vanishes in blocks of four; the ninth column belongs to none.
  for (uint32_t y = 0; y < 8; ++y)
    for (uint32_t x = 0; x < 9; ++x) test.at(x, y, 0) += (x + y) % 2 ? 1.0f : -1.0f;
  mask.at(5, 1, 0) = 0;
  test.at(5, 1, 0) = 1000;
  const Pair blocks = block_means(make_pair(test, reference, mask), 4);
  EXPECT_EQ(blocks.test.width, 2u);
  EXPECT_EQ(blocks.test.height, 2u);
  EXPECT_EQ(blocks.mask, (std::vector<uint8_t>{1, 0, 1, 1}));
  EXPECT_EQ(measure(Metric::Rmse, blocks, false).value, 0);
  EXPECT_THROW(block_means(make_pair(test, reference), 10), Error);
}

TEST(Metrics, SizesAndChannelsMustFit) {
  EXPECT_THROW(make_pair(flat(2, 2, {1}), flat(2, 3, {1})), Error);
  EXPECT_THROW(make_pair(flat(2, 2, {1, 1}), flat(2, 2, {1, 1, 1})), Error);
  EXPECT_THROW(make_pair(flat(2, 2, {1}), flat(2, 2, {1}), flat(3, 2, {1})), Error);
  const Pair grey = make_pair(flat(2, 2, {0.5f}), flat(2, 2, {0.25f, 0.5f, 1}));
  EXPECT_EQ(grey.test.channels, 3u);
  EXPECT_DOUBLE_EQ(measure(Metric::Mae, grey, false).value, 0.25);
}

// Of a picture and half of it: the window's sums give SSIM in closed form.
TEST(Metrics, SsimOfAGainIsKnown) {
  const Image reference = noise(64, 64, 1, 7);
  Image test = reference;
  for (float& value : test.pixels) value *= 0.5f;
  // test = reference / 2: l = 2 m^2/2 / (1.25 m^2), and c s = v / (1.25 v), both with their constants.
  const Image map = ssim_error(make_pair(test, reference));
  double weight[11], sum = 0;
  for (int i = 0; i < 11; ++i) sum += weight[i] = std::exp(-(i - 5) * (i - 5) / 4.5);
  double mean = 0, square = 0;
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 11; ++x) {
      const double w = weight[x] * weight[y] / (sum * sum);
      const double value = double(reference.at(uint32_t(27 + x), uint32_t(35 + y), 0));
      mean += w * value;
      square += w * value * value;
    }
  }
  const double variance = square - mean * mean, c1 = 1e-4, c2 = 9e-4;
  const double expected = (mean * mean + c1) / (1.25 * mean * mean + c1) * (variance + c2) / (1.25 * variance + c2);
  EXPECT_NEAR(double(map.at(32, 40, 0)), 1 - expected, 2e-5);
}

// The colour part saturates at the distance of green and blue, where it is 1.
TEST(Flip, GreenAgainstBlueIsOne) {
  EXPECT_NEAR(value_of(Metric::Flip, flat(32, 32, {0, 1, 0}), flat(32, 32, {0, 0, 1})), 1, 1e-5);
}

TEST(Flip, IsSymmetricAndGrowsWithContrast) {
  const Image a = noise(48, 48, 3, 3), b = noise(48, 48, 3, 4);
  EXPECT_NEAR(value_of(Metric::Flip, a, b), value_of(Metric::Flip, b, a), 1e-6);
  double last = 0;
  for (const float grey : {0.05f, 0.1f, 0.2f, 0.4f, 0.8f}) {
    const double flip = value_of(Metric::Flip, flat(32, 32, {grey, grey, grey}), flat(32, 32, {0, 0, 0}));
    EXPECT_GT(flip, last);
    last = flip;
  }
}

// From afar the eye averages a fine pattern; from near it sees it.
TEST(Flip, DependsOnTheDistance) {
  Image pattern = flat(96, 96, {0, 0, 0});
  for (uint32_t y = 0; y < 96; ++y)
    for (uint32_t x = 0; x < 96; ++x)
      for (uint32_t c = 0; c < 3; ++c) pattern.at(x, y, c) = float((x + y) % 2);
  const Image grey = flat(96, 96, {0.5f, 0.5f, 0.5f});
  const double near = pool(flip_ldr(pattern, grey, 10), {}).mean, far = pool(flip_ldr(pattern, grey, 120), {}).mean;
  EXPECT_LT(far, 0.5 * near);
}

// An edge that moves by a pixel is seen although the colours around it are equal.
TEST(Flip, SeesMissingPoints) {
  Image dot = flat(64, 64, {0.2f, 0.2f, 0.2f});
  const Image none = dot;
  for (uint32_t c = 0; c < 3; ++c) dot.at(32, 32, c) = 1;
  const Image map = flip_ldr(dot, none);
  EXPECT_GT(map.at(32, 32, 0), 0.2f);
  EXPECT_EQ(map.at(2, 2, 0), 0);
}

// The range of exposures: both ends map their luminance to 0.85 on the tone curve.
TEST(FlipHdr, ExposuresFollowTheReference) {
  Image reference = flat(4, 4, {1, 1, 1});
  for (uint32_t c = 0; c < 3; ++c) reference.at(1, 1, c) = 64;
  const Exposures e = flip_exposures(reference);
  EXPECT_NEAR(double(e.stop - e.start), 6, 1e-4);
  EXPECT_EQ(e.count, 6);
  const double x = 0.6 * std::exp2(double(e.stop));
  EXPECT_NEAR(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.85, 1e-4);
}

// What is too bright for one exposure is seen in another, and scaling both pictures changes nothing.
TEST(FlipHdr, SeesDifferencesAmongHighlights) {
  Image reference = noise(48, 48, 3, 9), test = reference;
  for (uint32_t y = 10; y < 30; ++y)
    for (uint32_t x = 10; x < 30; ++x)
      for (uint32_t c = 0; c < 3; ++c) reference.at(x, y, c) = 200, test.at(x, y, c) = 100;
  EXPECT_LT(value_of(Metric::Flip, test, reference), 1e-6);
  const double hdr = value_of(Metric::Flip, test, reference, true);
  EXPECT_GT(hdr, 0.02);
  for (float& value : test.pixels) value *= 16;
  for (float& value : reference.pixels) value *= 16;
  EXPECT_NEAR(value_of(Metric::Flip, test, reference, true), hdr, 1e-4);
}

TEST(ErrorPictures, ColorsMeanWhatTheBarSays) {
  EXPECT_EQ(heat_color(0).r + heat_color(0).g + heat_color(0).b, 0);
  int last = -1;
  for (float t = 0; t <= 1; t += 0.05f) {
    const Rgb8 c = heat_color(t);
    const int light = 2126 * c.r + 7152 * c.g + 722 * c.b;
    EXPECT_GT(light, last);
    last = light;
  }
  Image map = flat(120, 40, {0.25f});
  map.at(3, 3, 0) = 9;
  std::vector<uint8_t> mask(120 * 40, 1);
  mask[0] = 0;
  const Image8 picture = heat_picture(map, mask, 0.5f);
  const auto at = [&](uint32_t x, uint32_t y) {
    const uint8_t* p = picture.pixels.data() + (size_t(y) * picture.width + x) * 3;
    return std::array<int, 3>{p[0], p[1], p[2]};
  };
  const auto color = [](float t) { return std::array<int, 3>{heat_color(t).r, heat_color(t).g, heat_color(t).b}; };
  EXPECT_EQ(at(50, 20), color(0.5f));
  EXPECT_EQ(at(3, 3), color(1));
  EXPECT_EQ(at(0, 0), (std::array<int, 3>{64, 64, 64}));
  EXPECT_GT(picture.height, 40u);
  EXPECT_EQ(at(119, 43), color(1));  // the bar's right end
  EXPECT_EQ(at(0, 43), color(0));
}

TEST(ErrorPictures, SignedIsRedWhereTooBright) {
  Image test = flat(3, 1, {1, 1, 1}), reference = test;
  test.at(0, 0, 0) = test.at(0, 0, 1) = test.at(0, 0, 2) = 2;
  test.at(2, 0, 0) = test.at(2, 0, 1) = test.at(2, 0, 2) = 0.5f;
  const Image8 picture = signed_picture(make_pair(test, reference), 1);
  EXPECT_EQ(picture.pixels, (std::vector<uint8_t>{255, 0, 0, 255, 255, 255, 128, 128, 255}));
}

}  // namespace
}  // namespace nf::image
