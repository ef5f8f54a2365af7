// The closed forms of the visibility bitmask (shaders/common/sectors.glsl, slice.glsl) against loops, quadrature and
// exact values.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>

#include "glsl_twin.h"

NF_GLSL_BEGIN
#include "common/sectors.glsl"
#include "common/slice.glsl"
NF_GLSL_END

namespace {

using twin::uint;
using twin::vec3;

constexpr double kPi = 3.14159265358979323846;

std::mt19937& generator() {
  static std::mt19937 engine(12345);
  return engine;
}
double uniform(double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(generator());
}

vec3 random_unit() {
  double z = uniform(-1, 1), a = uniform(0, 2 * kPi), r = std::sqrt(1 - z * z);
  return vec3(float(r * std::cos(a)), float(r * std::sin(a)), float(z));
}

// V inside a 90-degree field of view.
vec3 random_view() {
  return -glm::normalize(vec3(float(uniform(-1, 1)), float(uniform(-1, 1)), -1.0f));
}

// --- masks ---

uint loop_mask(int a, int b) {
  uint bits = 0;
  for (int i = 0; i < 32; ++i)
    if (i >= a && i < b) bits |= 1u << i;
  return bits;
}

TEST(Sectors, MaskOfEveryPairOfEnds) {
  for (int a = 0; a <= 32; ++a) {
    for (int b = 0; b <= 32; ++b) {
      EXPECT_EQ(twin::sector_mask(a, b), loop_mask(a, b)) << a << " " << b;
      EXPECT_EQ(twin::sector_span(a, b), loop_mask(std::min(a, b), std::max(a, b))) << a << " " << b;
    }
  }
}

TEST(Sectors, EndsOutsideTheWordAreClamped) {
  EXPECT_EQ(twin::low_mask(-1), 0u);
  EXPECT_EQ(twin::low_mask(33), 0xFFFFFFFFu);
  EXPECT_EQ(twin::sector_mask(-5, 40), 0xFFFFFFFFu);
  for (int word = 0; word < 4; ++word)
    for (int a = 0; a <= 128; ++a)
      for (int b = a; b <= 128; ++b)
        ASSERT_EQ(twin::sector_span_word(a, b, word), loop_mask(a - 32 * word, b - 32 * word)) << a << " " << b;
}

// --- the measure ---

double density(double theta, double gamma) {
  return std::cos(theta) * std::abs(std::sin(theta - gamma));
}

double simpson(const std::function<double(double)>& f, double low, double high) {
  constexpr int kIntervals = 200;
  double h = (high - low) / kIntervals, sum = f(low) + f(high);
  for (int i = 1; i < kIntervals; ++i) sum += f(low + h * i) * (i % 2 ? 4 : 2);
  return sum * h / 3;
}

// Split at gamma, where the density has a kink.
double measure(double gamma, double theta) {
  auto f = [&](double t) { return density(t, gamma); };
  double first = simpson(f, -kPi / 2, std::min(theta, gamma));
  return theta > gamma ? first + simpson(f, gamma, theta) : first;
}

float cdf(double gamma, double theta, bool exact) {
  auto cos_gamma = float(std::cos(gamma)), sin_gamma = float(std::sin(gamma)), s = float(std::sin(theta));
  float side = theta >= gamma ? 1.0f : -1.0f;
  return exact ? twin::slice_cdf_exact(cos_gamma, sin_gamma, s, side) : twin::slice_cdf(cos_gamma, sin_gamma, s, side);
}

TEST(SliceMeasure, CdfIsTheQuadratureOnAGrid) {
  double worst_exact = 0, worst_polynomial = 0;
  for (int i = 0; i < 64; ++i) {
    double gamma = -kPi / 2 + kPi * (i + 0.5) / 64;
    double total = measure(gamma, kPi / 2);
    EXPECT_NEAR(total, std::cos(gamma) + gamma * std::sin(gamma), 1e-7);
    for (int j = 0; j <= 64; ++j) {
      double theta = -kPi / 2 + kPi * j / 64;
      double truth = measure(gamma, theta) / total;
      worst_exact = std::max(worst_exact, std::abs(cdf(gamma, theta, true) - truth));
      worst_polynomial = std::max(worst_polynomial, std::abs(cdf(gamma, theta, false) - truth));
    }
  }
  EXPECT_LT(worst_exact, 1e-5);
  EXPECT_LT(worst_polynomial, 0.0034 + 1e-4);
  EXPECT_GT(worst_polynomial, 1e-4) << "the polynomial form is not what was tested";
  RecordProperty("worst_polynomial", std::to_string(worst_polynomial));
}

TEST(SliceMeasure, EndsAreExactAndSidesMeetAtV) {
  for (double gamma = -1.57; gamma < 1.571; gamma += 0.01) {
    for (bool exact : {true, false}) {
      EXPECT_NEAR(cdf(gamma, -kPi / 2, exact), 0.0f, 2e-6f);
      EXPECT_NEAR(cdf(gamma, kPi / 2, exact), 1.0f, 2e-6f);
      EXPECT_NEAR(cdf(gamma, gamma - 1e-9, exact), cdf(gamma, gamma + 1e-9, exact), 2e-6f) << gamma;
    }
  }
}

// The polynomial may dip near the ends when V grazes (its K' is not 0 there), by no more than its error.
TEST(SliceMeasure, CdfRises) {
  for (double gamma = -1.5; gamma < 1.51; gamma += 0.1) {
    float highest_exact = 0, highest = 0;
    for (double theta = -1.57; theta < 1.57; theta += 0.01) {
      EXPECT_GT(cdf(gamma, theta, true), highest_exact - 1e-6f) << gamma << " " << theta;
      EXPECT_GT(cdf(gamma, theta, false), highest - 0.0035f) << gamma << " " << theta;
      highest_exact = std::max(highest_exact, cdf(gamma, theta, true));
      highest = std::max(highest, cdf(gamma, theta, false));
    }
  }
}

// --- the slice frame ---

TEST(SliceFrame, IsOrthonormalAndHoldsVAndDirection) {
  for (int i = 0; i < 1000; ++i) {
    vec3 v = random_view(), n = twin::facing_normal(random_unit(), v);
    vec3 d = twin::screen_direction(float(uniform(0, 2 * kPi)));
    twin::Slice slice = twin::make_slice(v, n, d);
    vec3 plane = glm::normalize(glm::cross(v, d));
    vec3 np = n - plane * dot(n, plane);
    EXPECT_NEAR(slice.n_length, glm::length(np), 1e-5f);
    EXPECT_NEAR(glm::length(slice.tangent), 1.0f, 1e-5f);
    EXPECT_NEAR(dot(slice.tangent, plane), 0.0f, 1e-5f);
    EXPECT_NEAR(dot(slice.tangent, np), 0.0f, 1e-5f);
    EXPECT_NEAR(slice.cos_gamma, dot(v, np) / glm::length(np), 1e-4f);
    EXPECT_NEAR(slice.sin_gamma, dot(v, slice.tangent), 1e-4f);
    // +d lies on the side above V: its angle from V is positive.
    float sin_d = dot(d, slice.tangent), cos_d = dot(d, np) / glm::length(np);
    EXPECT_GT(sin_d * slice.cos_gamma - cos_d * slice.sin_gamma, 0.0f);
  }
}

TEST(SliceFrame, BackFacingNormalsAreTurnedToTheEye) {
  for (int i = 0; i < 1000; ++i) {
    vec3 v = random_view(), n = random_unit(), faced = twin::facing_normal(n, v);
    EXPECT_GT(dot(faced, v), 0.0f);
    if (dot(n, v) > 1e-3f) {
      EXPECT_LT(glm::length(faced - n), 1e-6f);
    }
  }
}

// The coordinates that side_sine takes.
float sine_of(const twin::Slice& slice, vec3 v, vec3 n, vec3 d) {
  vec3 beside = glm::normalize(glm::cross(v, slice.tangent));
  return twin::side_sine(dot(d, slice.tangent), dot(d, n) / slice.n_length, dot(d, beside) / slice.n_length,
                         slice.sin_gamma);
}

// Points of the plane beside the slice, up to 60 degrees off along the plane, and lifted by rounding.
TEST(SliceFrame, ObliqueProjectionKeepsPlanesOnTheHorizon) {
  for (int i = 0; i < 10000; ++i) {
    vec3 v = random_view(), n = twin::facing_normal(random_unit(), v);
    twin::Slice slice = twin::make_slice(v, n, twin::screen_direction(float(uniform(0, 6))));
    vec3 off = glm::cross(n, slice.tangent);
    vec3 in_plane = slice.tangent + off * float(uniform(-1.7, 1.7)) + n * float(uniform(-1e-6, 1e-6));
    float sine = sine_of(slice, v, n, in_plane);
    EXPECT_NEAR(twin::slice_cdf(slice.cos_gamma, slice.sin_gamma, sine, 1.0f), 1.0f, 1e-5f);
  }
}

// At grazing views the nearest texel may lie across the slice: s is then about 0 and its sign is noise.
TEST(SliceFrame, PlanesStayOnTheHorizonAcrossTheSlice) {
  for (int i = 0; i < 1000; ++i) {
    vec3 v = random_view(), n = twin::facing_normal(random_unit(), v);
    twin::Slice slice = twin::make_slice(v, n, twin::screen_direction(float(uniform(0, 6))));
    vec3 across = glm::cross(n, slice.tangent) * (i % 2 ? 1.0f : -1.0f) - slice.tangent * float(uniform(0, 0.3));
    float sine = sine_of(slice, v, n, across + n * 1e-6f);
    EXPECT_GT(twin::slice_cdf(slice.cos_gamma, slice.sin_gamma, sine, 1.0f), 1 - 1e-4f);
  }
}

// In the slice it is the sine; beside it the height above the tangent plane counts.
TEST(SliceFrame, SideSineIsTheSineAndEndsAtTheHorizonAndAtV) {
  for (double theta = -1.5; theta < 1.5; theta += 0.01) {
    float s = 3.0f * float(std::sin(theta)), c = 3.0f * float(std::cos(theta));
    EXPECT_NEAR(twin::side_sine(s, c, 0.0f, -1.0f), std::sin(theta), 1e-6);
    EXPECT_GE(twin::side_sine(s, c, 0.0f, 0.5f), 0.5f);
    if (theta > 0) {
      EXPECT_NEAR(twin::side_sine(0.6f * s, c, 0.8f * s, -1.0f), std::sin(theta), 1e-6);
    }
  }
  EXPECT_EQ(twin::side_sine(-2.0f, -0.1f, 0.0f, -0.9f), 1.0f);  // beyond the horizon, whatever its sine
  EXPECT_EQ(twin::side_sine(0.0f, 0.0f, 0.0f, 0.0f), 1.0f);
}

// --- totals over slices: the white hemisphere ---

enum class Azimuth { Screen, ScreenJ, View };

// Mean over slices of J |n_p| W: 1 for an unoccluded surface.
double open_hemisphere(vec3 v, vec3 n, Azimuth azimuth, int slices, bool exact) {
  double sum = 0;
  for (int i = 0; i < slices; ++i) {
    auto phi = float((i + 0.37) * kPi / slices);
    vec3 d = azimuth == Azimuth::View ? twin::view_direction(phi, v) : twin::screen_direction(phi);
    twin::Slice slice = twin::make_slice(v, n, d);
    float k = exact ? twin::slice_k_exact(slice.sin_gamma) : twin::slice_k(slice.sin_gamma);
    double weight = slice.n_length * twin::slice_total(slice.cos_gamma, slice.sin_gamma, k);
    sum += weight * (azimuth == Azimuth::ScreenJ ? twin::azimuth_weight(v, d) : 1.0f);
  }
  return sum / slices;
}

TEST(OpenHemisphere, MeanOfTheSliceTotalAboutVIsOne) {
  for (int i = 0; i < 50; ++i) {
    vec3 v = random_view(), n;
    do n = random_unit();
    while (dot(n, v) < 0.05f);
    EXPECT_NEAR(open_hemisphere(v, n, Azimuth::View, 4096, true), 1.0, 1e-5);
  }
}

TEST(OpenHemisphere, MeanOfTheAzimuthWeightIsOne) {
  for (int i = 0; i < 50; ++i) {
    vec3 v = random_view();
    double sum = 0;
    for (int j = 0; j < 256; ++j) sum += twin::azimuth_weight(v, twin::screen_direction(float((j + 0.5) * kPi / 256)));
    EXPECT_NEAR(sum / 256, 1.0, 1e-5);
  }
}

// The same plane must read 1 wherever it is seen: 9 x 9 places of a 90-degree field of view, 20 normals.
TEST(OpenHemisphere, PlaneReadsOneEverywhereOnTheScreen) {
  double worst = 0, worst_polynomial = 0, worst_without_j = 0;
  for (int place = 0; place < 81; ++place) {
    auto x = float(place % 9 - 4) / 4, y = float(place / 9 - 4) / 4;
    vec3 v = -glm::normalize(vec3(x, y, -1.0f));
    for (int i = 0; i < 20; ++i) {
      vec3 n;
      do n = random_unit();
      while (dot(n, v) < 1e-2f);
      worst = std::max(worst, std::abs(open_hemisphere(v, n, Azimuth::ScreenJ, 1024, true) - 1));
      worst = std::max(worst, std::abs(open_hemisphere(v, n, Azimuth::View, 1024, true) - 1));
      double polynomial = open_hemisphere(v, n, Azimuth::ScreenJ, 1024, false);
      worst_polynomial = std::max(worst_polynomial, std::abs(polynomial - 1));
      worst_without_j = std::max(worst_without_j, std::abs(open_hemisphere(v, n, Azimuth::Screen, 1024, true) - 1));
    }
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_LT(worst_polynomial, 2e-3);
  EXPECT_GT(worst_without_j, 0.1) << "the test would not notice a missing J";
  RecordProperty("worst_polynomial", std::to_string(worst_polynomial));
}

// What screens without J read (techniques.md 3.6): the control of the test above.
TEST(OpenHemisphere, WithoutTheAzimuthWeightPlanesMiss) {
  const float degree = float(kPi / 180);
  const vec3 up(0, 1, 0);
  auto at = [&](float right, float below) {
    return -glm::normalize(vec3(std::tan(right * degree), -std::tan(below * degree), -1.0f));
  };
  EXPECT_NEAR(open_hemisphere(at(0, 30), up, Azimuth::Screen, 1024, true), 0.968, 1e-3);
  EXPECT_NEAR(open_hemisphere(at(45, 5), up, Azimuth::Screen, 1024, true), 1.110, 1e-3);
  EXPECT_NEAR(open_hemisphere(at(55, 0), vec3(0, 0, 1), Azimuth::Screen, 1024, true), 0.892, 1e-3);
}

// --- jittered end points ---

TEST(Jitter, IsUnbiased) {
  for (double width : {0.1, 0.25, 0.5, 1.0, 1.5, 2.5}) {
    for (double start : {0.0, 3.3, 17.77}) {
      double sum = 0, ceiled = 0;
      for (int i = 0; i < 1000; ++i) {
        double xi = (i + 0.5) / 1000;
        uint bits = twin::sector_span(int(std::floor(start + xi)), int(std::floor(start + width + xi)));
        sum += std::popcount(bits);
        // The post's rule on an interval moved by the same xi.
        int first = int(std::floor(start + xi));
        ceiled += std::popcount(twin::sector_mask(first, first + int(std::ceil(width))));
      }
      EXPECT_NEAR(sum / 1000, width, 1.1e-3);
      if (width < 1) {
        EXPECT_GT(ceiled / 1000 - width, 0.45) << "control: the post's rule counts too much";
      }
    }
  }
}

TEST(Jitter, Telescopes) {
  for (int i = 0; i < 10000; ++i) {
    double xi = uniform(0, 1), points[6];
    for (double& point : points) point = uniform(0, 32);
    std::sort(std::begin(points), std::end(points));
    auto mask = [&](int a, int b) {
      return twin::sector_span(int(std::floor(points[a] + xi)), int(std::floor(points[b] + xi)));
    };
    uint parts = 0;
    for (int j = 0; j < 5; ++j) {
      EXPECT_EQ(parts & mask(j, j + 1), 0u) << "counted twice";
      parts |= mask(j, j + 1);
    }
    EXPECT_EQ(parts, mask(0, 5)) << "gap";
  }
}

TEST(Jitter, AFullHemisphereIsAllSectorsForEveryJitter) {
  for (float xi = 0; xi < 1; xi += 1.0f / 4096)
    EXPECT_EQ(twin::sector_span(int(std::floor(xi)), int(std::floor(32.0f + xi))), 0xFFFFFFFFu);
  float last = 1 - 0x1p-24f;  // 32 + last rounds up to 33
  EXPECT_EQ(twin::sector_span(int(std::floor(last)), int(std::floor(32.0f + last))), 0xFFFFFFFFu);
}

}  // namespace
