// The split of an error, against numbers made by hand, and with noise of known size.
#include "image/error_split.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "image/ring.h"

namespace nf::image {
namespace {

Image flat(float value, uint32_t width = 64, uint32_t height = 48, uint32_t channels = 3) {
  return {width, height, channels, std::vector<float>(size_t(width) * height * channels, value)};
}
Halves exact(const Image& picture) {
  return {picture, picture};
}
Image noisy(const Image& picture, float sigma, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, sigma);
  Image out = picture;
  for (float& value : out.pixels) value += normal(random);
  return out;
}

TEST(ErrorSplit, PartsOfConstants) {
  const ErrorSplit s = split_error(exact(flat(0.7f)), exact(flat(0.4f)), exact(flat(0.5f)), {});
  EXPECT_NEAR(s.total.bias, 0.2, 1e-6);
  EXPECT_NEAR(s.estimator.bias, 0.3, 1e-6);
  EXPECT_NEAR(s.missing.bias, -0.1, 1e-6);
  EXPECT_NEAR(s.total.rmse, 0.2, 1e-6);
  EXPECT_NEAR(s.estimator.rmse, 0.3, 1e-6);
  EXPECT_NEAR(s.missing.rmse, 0.1, 1e-6);
  EXPECT_NEAR(s.total.floor, 0, 1e-6);
  const ErrorSplit none = split_error(exact(flat(1)), exact(flat(1)), exact(flat(1)), {});
  EXPECT_EQ(none.total.rmse, 0);
  EXPECT_EQ(none.total.bias, 0);
}

TEST(ErrorSplit, OnlyPixelsThatCount) {
  Image test = flat(0, 2, 1, 1);
  test.pixels = {3, 100};
  const ErrorPart part = error_between(exact(test), exact(flat(1, 2, 1, 1)), {1, 0});
  EXPECT_EQ(part.bias, 2);
  EXPECT_EQ(part.rmse, 2);
  EXPECT_EQ(noise_of({test, flat(1, 2, 1, 1)}, {1, 0}), 1);
}

// Noise of both sides leaves the RMSE where it is; without halves it does not.
TEST(ErrorSplit, NoiseIsNoError) {
  const Image truth = flat(1, 160, 90), off = flat(1.1f, 160, 90);
  const Halves test{noisy(off, 0.5f, 1), noisy(off, 0.5f, 2)}, reference{noisy(truth, 0.3f, 3), noisy(truth, 0.3f, 4)};
  const ErrorPart part = error_between(test, reference, {});
  EXPECT_NEAR(part.rmse, 0.1, 0.02);
  EXPECT_LT(part.floor, part.rmse);
  EXPECT_NEAR(noise_of(test, {}), 0.5 / std::sqrt(2), 0.01);
  EXPECT_NEAR(noise_of(reference, {}), 0.3 / std::sqrt(2), 0.01);
  const ErrorPart naive = error_between(exact(mean_of(test)), exact(mean_of(reference)), {});
  EXPECT_NEAR(naive.rmse, std::sqrt(0.01 + (0.25 + 0.09) / 2), 0.01);
  // No error at all: below what can be told.
  const ErrorPart none = error_between({noisy(truth, 0.5f, 5), noisy(truth, 0.5f, 6)}, reference, {});
  EXPECT_LT(none.rmse, 2 * none.floor);
  EXPECT_LT(none.floor, 0.1);
}

TEST(ErrorSplit, NotFiniteStaysSeen) {
  Image bad = flat(1);
  bad.pixels[5] = std::nanf("");
  EXPECT_TRUE(std::isnan(error_between(exact(bad), exact(flat(1)), {}).rmse));
}

// Three maps beside each other, one scale: the same error has the same colour in each.
TEST(ErrorSplit, Picture) {
  const Image8 picture = split_picture(flat(0.7f), flat(0.4f), flat(0.5f), {}, 0.3f);
  ASSERT_EQ(picture.width, 3 * 64u + 8);
  ASSERT_GT(picture.height, 48u);
  const auto color = [&](uint32_t x) {
    const uint8_t* p = picture.pixels.data() + (size_t(20) * picture.width + x) * 3;
    return std::array<int, 3>{p[0], p[1], p[2]};
  };
  const auto expected = [](float t) {
    const Rgb8 c = heat_color(t);
    return std::array<int, 3>{c.r, c.g, c.b};
  };
  const auto near = [](std::array<int, 3> a, std::array<int, 3> b) {
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 2);
  };
  near(color(30), expected(2 / 3.0f));
  near(color(68 + 30), expected(1));
  near(color(136 + 30), expected(1 / 3.0f));
  EXPECT_EQ(color(65), color(133));  // the gaps
}

}  // namespace
// A bar of depth 1 before a wall at 2, and a hole in the wall.
TEST(Ring, BesideWhatIsNearer) {
  const std::vector<float> depth = {2, 2, 2, 1, 2, 2, 2, 0,  //
                                    2, 2, 2, 2, 2, 2, 2, 2};
  EXPECT_EQ(image::ring_behind(depth, 8, 2, 0.5f),
            (std::vector<uint8_t>{0, 1, 1, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(image::ring_behind(depth, 8, 2, 1.5f), std::vector<uint8_t>(16, 0));
  EXPECT_EQ(image::ring_behind(depth, 8, 0, 0.5f), std::vector<uint8_t>(16, 0));
}

}  // namespace nf::image
