// The visibility bitmask's slices, measure and sectors (shaders/common) as an integrator over scenes given as "is this
// direction blocked", without a depth buffer: closed forms must come out, whatever the camera. And thickness against a
// ray marcher.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "glsl_twin.h"

NF_GLSL_BEGIN
#include "common/sectors.glsl"
#include "common/slice.glsl"
NF_GLSL_END

namespace {

using twin::uint;
using twin::vec3;

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;

enum class Azimuth { Screen, ScreenJ, View };
enum class Form { Exact, Polynomial, UniformAngle };

struct Settings {
  Azimuth azimuth = Azimuth::ScreenJ;
  Form form = Form::Exact;
  int slices = 128;
  int jitters = 64;
};

// Directions and blockers are in view space.
using Blocked = std::function<bool(vec3)>;

// Position on the unit interval of sectors of the angle theta in a slice.
double position(const twin::Slice& slice, double theta, Form form) {
  if (form == Form::UniformAngle) return (theta + kPi / 2) / kPi;
  float side = theta >= std::asin(std::clamp(double(slice.sin_gamma), -1.0, 1.0)) ? 1.0f : -1.0f;
  auto s = float(std::sin(theta));
  return form == Form::Exact ? twin::slice_cdf_exact(slice.cos_gamma, slice.sin_gamma, s, side)
                             : twin::slice_cdf(slice.cos_gamma, slice.sin_gamma, s, side);
}

// Angles at which `blocked` changes, bracketed by a scan and bisected; they come in pairs (begin, end).
std::vector<double> intervals(const std::function<bool(double)>& blocked) {
  constexpr int kScan = 180;
  std::vector<double> ends;
  double end_of_slice = kPi / 2 - 1e-9;
  bool inside = blocked(-end_of_slice);
  if (inside) ends.push_back(-kPi / 2);
  double previous = -end_of_slice;
  for (int i = 1; i <= kScan; ++i) {
    double theta = -end_of_slice + 2 * end_of_slice * i / kScan;
    if (blocked(theta) != inside) {
      double low = previous, high = theta;
      for (int j = 0; j < 40; ++j) {
        double middle = (low + high) / 2;
        (blocked(middle) == inside ? low : high) = middle;
      }
      ends.push_back(high);
      inside = !inside;
    }
    previous = theta;
  }
  if (inside) ends.push_back(kPi / 2);
  return ends;
}

// Visibility of a point with normal n seen along -v: the sum of 3.5 and 3.6 of the techniques guide.
double visibility(vec3 v, vec3 n, const Blocked& blocked, const Settings& settings = {}) {
  double sum = 0;
  for (int i = 0; i < settings.slices; ++i) {
    auto phi = float((i + 0.37) * kPi / settings.slices);
    vec3 d = settings.azimuth == Azimuth::View ? twin::view_direction(phi, v) : twin::screen_direction(phi);
    twin::Slice slice = twin::make_slice(v, n, d);
    vec3 np = (v - slice.sin_gamma * slice.tangent) / slice.cos_gamma;
    std::vector<double> ends = intervals(
        [&](double theta) { return blocked(float(std::cos(theta)) * np + float(std::sin(theta)) * slice.tangent); });
    for (double& end : ends) end = 32 * position(slice, end, settings.form);
    double open = 0;
    for (int j = 0; j < settings.jitters; ++j) {
      double xi = (j + 0.5) / settings.jitters;
      uint mask = 0;
      for (size_t k = 0; k < ends.size(); k += 2)
        mask |= twin::sector_span(int(std::floor(ends[k] + xi)), int(std::floor(ends[k + 1] + xi)));
      open += 1 - std::popcount(mask) / 32.0;
    }
    open /= settings.jitters;
    double j = settings.azimuth == Azimuth::ScreenJ ? twin::azimuth_weight(v, d) : 1.0f;
    double total =
        twin::slice_total(slice.cos_gamma, slice.sin_gamma, twin::slice_k_exact(slice.sin_gamma)) * slice.n_length;
    // The paper's average has no weight.
    sum += settings.form == Form::UniformAngle ? open : j * total * open;
  }
  return sum / settings.slices;
}

// A camera whose picture shows the receiver `off_axis` from its middle: maps the scene's frame, normal +Z, to view
// space.
struct Placement {
  vec3 v, x, y, n;  // towards the eye and the scene's axes, in view space

  Placement(double tilt, double azimuth, double off_axis, double roll) {
    vec3 eye = spherical(tilt, azimuth);
    vec3 side = glm::normalize(glm::cross(eye, std::abs(eye.z) < 0.9f ? vec3(0, 0, 1) : vec3(1, 0, 0)));
    vec3 up = glm::cross(side, eye);
    vec3 turn = float(std::cos(roll)) * side + float(std::sin(roll)) * up;
    vec3 back = float(std::cos(off_axis)) * eye + float(std::sin(off_axis)) * turn;
    vec3 right = glm::normalize(glm::cross(turn - back * dot(turn, back), back));
    vec3 down = glm::cross(right, back);
    auto to_view = [&](vec3 a) { return vec3(dot(a, right), -dot(a, down), dot(a, back)); };
    v = to_view(eye), x = to_view(vec3(1, 0, 0)), y = to_view(vec3(0, 1, 0)), n = to_view(vec3(0, 0, 1));
  }

  static vec3 spherical(double tilt, double azimuth) {
    return vec3(float(std::sin(tilt) * std::cos(azimuth)), float(std::sin(tilt) * std::sin(azimuth)),
                float(std::cos(tilt)));
  }
};

// --- closed forms ---

TEST(Integral, PitOfAConeIsSineSquared) {
  const double paper[] = {1 / 3.0, 0.5, 2 / 3.0, 5 / 6.0};
  int i = 0;
  for (double half_angle : {30, 45, 60, 75}) {
    Placement at(0, 0, 0.3, 1);
    auto cosine = float(std::cos(half_angle * kDegree));
    auto pit = [&](vec3 d) { return dot(d, at.n) < cosine; };
    double truth = std::pow(std::sin(half_angle * kDegree), 2);
    EXPECT_NEAR(visibility(at.v, at.n, pit), truth, 2e-3) << half_angle;
    EXPECT_NEAR(visibility(at.v, at.n, pit, {.form = Form::Polynomial}), truth, 6e-3) << half_angle;
    double uniform = visibility(at.v, at.n, pit, {.azimuth = Azimuth::View, .form = Form::UniformAngle});
    EXPECT_NEAR(uniform, paper[i++], 2e-3) << "control: uniform angles read what the paper's sectors read";
  }
}

// An infinite wall whose top stands at elevation beta, in the direction +x.
Blocked wall(const Placement& at, double beta) {
  auto slope = float(std::tan(beta * kDegree));
  return [at, slope](vec3 d) { return dot(d, at.x) > 0 && dot(d, at.n) < slope * dot(d, at.x); };
}

TEST(Integral, WallFromManyViews) {
  double lowest_paper = 1, highest_paper = 0;
  for (double beta : {30, 60, 80}) {
    double truth = 1 - 0.5 * (1 - std::cos(beta * kDegree));
    double lowest = 1, highest = 0;
    for (int i = 0; i < 25; ++i) {
      Placement at((i % 5) * 20 * kDegree, (i / 5) * 45 * kDegree, 0.15 * (i % 6), i);
      double seen = visibility(at.v, at.n, wall(at, beta));
      EXPECT_NEAR(seen, truth, 2e-3) << "beta " << beta << " view " << i;
      EXPECT_NEAR(visibility(at.v, at.n, wall(at, beta), {.form = Form::Polynomial}), truth, 5e-3) << i;
      lowest = std::min(lowest, seen), highest = std::max(highest, seen);
      if (beta == 60) {
        double paper = visibility(at.v, at.n, wall(at, beta), {.azimuth = Azimuth::View, .form = Form::UniformAngle});
        lowest_paper = std::min(lowest_paper, paper), highest_paper = std::max(highest_paper, paper);
      }
    }
    EXPECT_LT(highest - lowest, 3e-3) << "depends on the view, beta " << beta;
  }
  EXPECT_LT(lowest_paper, 0.60) << "control: the paper's sectors depend on the view (techniques.md 3.5: .488 to .781)";
  EXPECT_GT(highest_paper, 0.76);
}

TEST(Integral, WallReadsWhatThePapersSectorsReadFromAbove) {
  Placement at(0, 0, 0, 0);
  EXPECT_NEAR(visibility(at.v, at.n, wall(at, 30), {.azimuth = Azimuth::View, .form = Form::UniformAngle}), 0.891,
              2e-3);
}

TEST(Integral, WithoutTheAzimuthWeightTheWallMisses) {
  Placement at(60 * kDegree, 90 * kDegree, 50 * kDegree, 0);
  double truth = 1 - 0.5 * (1 - std::cos(60 * kDegree));
  EXPECT_NEAR(visibility(at.v, at.n, wall(at, 60), {.azimuth = Azimuth::View}), truth, 2e-3);
  EXPECT_GT(std::abs(visibility(at.v, at.n, wall(at, 60), {.azimuth = Azimuth::Screen}) - truth), 0.03);
}

// Nusselt: a sphere of radius r resting on the plane, centre at distance D: (r / D)^2 cos = (r / D)^3.
TEST(Integral, SphereOnAPlane) {
  for (double r : {0.3, 0.5, 0.8}) {
    for (int i = 0; i < 5; ++i) {
      Placement at((10 + 16 * i) * kDegree, 0.7 * i, 0.15 * i, i);
      double height = r, away = std::sqrt(1 - r * r);  // D = 1
      auto cosine = float(std::sqrt(1 - r * r));
      vec3 centre = float(away) * at.x + float(height) * at.n;
      double seen = visibility(at.v, at.n, [&](vec3 d) { return dot(d, centre) > cosine; });
      EXPECT_NEAR(seen, 1 - r * r * r, 3e-3) << r << " view " << i;
    }
  }
}

// A sphere that stands clear of the horizon, anywhere: the same projected solid angle from every view.
TEST(Integral, ClearSphereCrossingTheViewVector) {
  double r = 0.4;
  auto cosine = float(std::sqrt(1 - r * r));
  for (int i = 0; i < 9; ++i) {
    Placement at(8 * i * kDegree, 0, 0.1 * i, 0.5 * i);
    vec3 centre = glm::normalize(at.x + at.n * 1.2f);
    double truth = 1 - r * r * dot(centre, at.n);
    EXPECT_NEAR(visibility(at.v, at.n, [&](vec3 d) { return dot(d, centre) > cosine; }), truth, 3e-3) << i;
  }
}

// Form factors of unit squares (Howell's catalogue C-11, C-14): parallel at distance 1, and sharing an edge at a right
// angle.
TEST(Integral, TwoSquares) {
  constexpr int kGrid = 10;
  Settings settings{.slices = 48, .jitters = 32};
  double parallel = 0, perpendicular = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    double px = (i % kGrid + 0.5) / kGrid, py = (i / kGrid + 0.5) / kGrid;
    Placement at((i * 37 % 70) * kDegree, i, 0.3, 2 * i);
    auto above = [&](vec3 d) {
      double z = dot(d, at.n), x = px + dot(d, at.x) / z, y = py + dot(d, at.y) / z;
      return z > 0 && x > 0 && x < 1 && y > 0 && y < 1;
    };
    auto beside = [&](vec3 d) {  // in the plane x = 0
      double t = -px / dot(d, at.x), y = py + t * dot(d, at.y), z = t * dot(d, at.n);
      return t > 0 && y > 0 && y < 1 && z > 0 && z < 1;
    };
    parallel += 1 - visibility(at.v, at.n, above, settings);
    perpendicular += 1 - visibility(at.v, at.n, beside, settings);
  }
  EXPECT_NEAR(parallel / (kGrid * kGrid), 0.19982, 2e-3);
  EXPECT_NEAR(perpendicular / (kGrid * kGrid), 0.20004, 2e-3);
}

// A closed furnace: every sector sees light 1, so irradiance / pi is the sum of the weights, 1.
TEST(Integral, Furnace) {
  for (int i = 0; i < 25; ++i) {
    Placement at((3 + i * 3.4) * kDegree, i, 0.03 * i, i);
    EXPECT_NEAR(visibility(at.v, at.n, [](vec3) { return true; }), 0, 1e-6);
    EXPECT_NEAR(visibility(at.v, at.n, [](vec3) { return false; }, {.slices = 512}), 1, 1e-3) << i;
  }
}

// --- thickness ---

// Whether a ray from the receiver in the slice hits the segment of a view ray between two distances from the eye:
// intersects the lines in the slice, and compares the distance along the view ray.
bool ray_hits_slab(vec3 receiver, vec3 direction, vec3 view_ray, double nearest, double furthest) {
  // receiver + t direction = u view_ray, solved in the plane of the two.
  glm::dvec3 p(receiver), d(direction), r(view_ray);
  glm::dvec3 plane = glm::cross(d, r);
  double scale = dot(plane, plane);
  double t = dot(glm::cross(r, p), plane) / scale, u = dot(glm::cross(d, p), plane) / scale;
  return t > 0 && u >= nearest && u <= furthest;
}

struct SlabCount {
  int disagreements = 0, hits = 0, tested = 0;
};

// `back` gives the back point of a sample; sectors strictly inside the ends must agree with rays through their middles.
SlabCount compare_slab(const std::function<vec3(vec3 sample, vec3 v, float thickness)>& back_point) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  SlabCount count;
  for (int i = 0; i < 10000; ++i) {
    vec3 p = vec3(uniform(engine) * 2 - 1, uniform(engine) * 2 - 1, -1.0f) * (1 + 4 * uniform(engine));
    vec3 v = -glm::normalize(p);
    vec3 n = twin::facing_normal(glm::normalize(vec3(uniform(engine), uniform(engine), uniform(engine)) - 0.5f), v);
    vec3 d = twin::screen_direction(uniform(engine) * 6.2831f);
    twin::Slice slice = twin::make_slice(v, n, d);
    vec3 ray = p / -p.z + d * (0.02f + uniform(engine));
    vec3 sample = ray * (-p.z * (0.5f + uniform(engine)));
    float thickness = 0.05f + uniform(engine);
    vec3 back = back_point(sample, v, thickness);
    auto at = [&](vec3 point) {
      vec3 delta = point - p;
      float s = twin::side_sine(dot(delta, slice.tangent), dot(delta, n) / slice.n_length, 0.0f, slice.sin_gamma);
      return 32 * twin::slice_cdf_exact(slice.cos_gamma, slice.sin_gamma, s, 1.0f);
    };
    double first = at(sample), last = at(back);
    uint mask = twin::sector_span(int(std::floor(first + 0.5)), int(std::floor(last + 0.5)));
    // Rays through the middles of the sectors, found by bisection of the CDF.
    vec3 np = (v - slice.sin_gamma * slice.tangent) / slice.cos_gamma;
    double length = glm::length(sample);
    int begin = 32, end = 0;
    for (int j = 0; j < 32; ++j) {
      double low = std::asin(std::clamp(double(slice.sin_gamma), -1.0, 1.0)), high = kPi / 2;
      auto cdf = [&](double a) {
        return 32 * twin::slice_cdf_exact(slice.cos_gamma, slice.sin_gamma, float(std::sin(a)), 1.0f);
      };
      if (j + 0.5 < cdf(low)) continue;
      for (int k = 0; k < 40; ++k) (cdf((low + high) / 2) < j + 0.5 ? low : high) = (low + high) / 2;
      vec3 direction = float(std::cos(low)) * np + float(std::sin(low)) * slice.tangent;
      if (ray_hits_slab(p, direction, glm::normalize(sample), length, length + thickness)) {
        begin = std::min(begin, j), end = std::max(end, j + 1);
      }
    }
    ++count.tested;
    count.hits += begin < end;
    // One sector at either end may differ.
    uint core = twin::sector_mask(begin + 1, end - 1), hull = twin::sector_mask(begin - 1, end + 1);
    if (begin >= end) core = 0, hull = std::popcount(mask) <= 1 ? mask : 0u;
    count.disagreements += (core & ~mask) != 0 || (mask & ~hull) != 0;
  }
  return count;
}

TEST(Thickness, BackPointAlongTheSamplesOwnRayIsWhatARayMarcherHits) {
  SlabCount count = compare_slab([](vec3 s, vec3, float t) { return s + glm::normalize(s) * t; });
  EXPECT_EQ(count.disagreements, 0);
  EXPECT_GT(count.hits, 3000) << "the test must test something";
}

TEST(Thickness, TheOtherFormsDisagree) {
  SlabCount receiver_ray = compare_slab([](vec3 s, vec3 v, float t) { return s - v * t; });
  EXPECT_GT(receiver_ray.disagreements, 100) << "control: the post's back point, along the receiver's ray";
  SlabCount printed = compare_slab([](vec3 s, vec3, float t) { return s - glm::normalize(s) * t; });
  EXPECT_GT(printed.disagreements, 1000) << "control: the paper's sign";
}

}  // namespace
