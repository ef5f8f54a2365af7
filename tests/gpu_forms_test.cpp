// The slice techniques through the GPU against closed forms (techniques.md 3.15, items 6 to 8): a pit, a wall from many
// views, furnaces, a dome and a square on a floor. Everything that counts is in view, so that the expected values have
// no missing information in them.
#include <cmath>
#include <functional>

#include "gpu_fixture.h"

namespace nf::test {
namespace {

using content::Builder;
using glm::ivec2;
using glm::vec2;
using glm::vec3;

constexpr double pi = 3.14159265358979;

class Forms : public GpuTest {
 protected:
  Shot thorough(const scene::Scene& scene, const scene::Camera& camera, glm::uvec2 size, const char* technique,
                const std::vector<std::string>& assignments = {}, bool paper = false) {
    passes::FrameSettings settings;
    settings.technique = &passes::find_technique(technique);
    for (const char* text :
         {"material.lambert=true", "gi.slices=8", "gi.steps=48", "gi.radius=100", "gi.thickness_mode=infinite"})
      params::assign(settings.blocks(), text);
    if (paper)
      for (const char* text : settings.technique->paper_mode) params::assign(settings.blocks(), text);
    for (const std::string& text : assignments) params::assign(settings.blocks(), text);
    return shoot(scene, {.size = size, .camera = camera, .settings = settings, .frames = 4, .accumulate = true});
  }
};

vec3 position(const Shot& shot, ivec2 pixel) {
  return {shot.value("position", pixel, 0), shot.value("position", pixel, 1), shot.value("position", pixel, 2)};
}

// Means of a layer and of what it should be over the pixels where `expected` is not negative.
struct Means {
  double value = 0, expected = 0, worst = 0;
  int count = 0;
};
Means compare(const Shot& shot, const char* layer, const std::function<double(vec3)>& expected) {
  Means m;
  const image::Image& depth = shot.layer("depth");
  for (int y = 0; y < int(depth.height); ++y)
    for (int x = 0; x < int(depth.width); ++x) {
      if (shot.value("depth", {x, y}) <= 0) continue;
      const double wanted = expected(position(shot, {x, y}));
      if (wanted < 0) continue;
      const double value = double(shot.value(layer, {x, y}));
      m.value += value, m.expected += wanted, ++m.count;
      m.worst = std::max(m.worst, std::abs(value - wanted));
    }
  m.value /= std::max(m.count, 1), m.expected /= std::max(m.count, 1);
  return m;
}

content::MaterialId black(Builder& b) {
  return b.material({.base_color = vec3(0)});
}
content::MaterialId lamp(Builder& b) {
  return b.material({.base_color = vec3(0), .emissive = vec3(1)});
}
void floor(Builder& b, float half, content::MaterialId material) {
  b.quad({-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}, material);
}
scene::Camera from_above(float height, float fov) {
  return look({0, height, 0}, {0, 0, 0}, fov, {0, 0, -1});
}

// From the middle of a conical pit's floor only directions within `half` of the normal are open.
TEST_F(Forms, PitByItsClosedForms) {
  constexpr float half = 50;
  const double c = std::cos(glm::radians(double(half))), s = std::sin(glm::radians(double(half)));
  Builder b;
  const float height = 1, rim = height * std::tan(glm::radians(half)), foot = 0.1f;
  floor(b, foot, black(b));
  const vec2 line[] = {{rim, height}, {foot, 0}};
  b.revolve(line, 64, vec3(0), black(b));
  const scene::Scene scene = load(b);
  const glm::uvec2 size(129, 129);
  const scene::Camera camera = from_above(3, 66);
  const auto seen = [&](const char* technique, const std::vector<std::string>& assignments = {}) {
    return double(thorough(scene, camera, size, technique, assignments).value("visibility", {64, 64}));
  };
  EXPECT_NEAR(seen("gtao"), s * s, 1e-2);
  EXPECT_NEAR(seen("hbao"), 1 - c, 1e-2);
  EXPECT_NEAR(seen("vbgi"), s * s, 1e-2);
  EXPECT_NEAR(seen("vbao"), s * s, 1e-2);
  EXPECT_NEAR(seen("vbao", {"vbao.sector_measure=uniform_angle", "vbao.fast_acos=false"}), double(half) / 90, 1e-2);
  EXPECT_NEAR(seen("vbao", {"vbao.sector_measure=solid_angle"}), 1 - c, 1e-2);
  EXPECT_NEAR(seen("vbao", {"vbao.sector_measure=sine"}), s, 1e-2);
}

// What a point before a wall sees of the sky does not depend on the camera; as printed it does.
TEST_F(Forms, WallFromManyViews) {
  constexpr float beta = 60;
  Builder b;
  floor(b, 100, black(b));
  const float height = std::tan(glm::radians(beta));
  b.quad({1, 0, -100}, {1, 0, 100}, {1, height, 100}, {1, height, -100}, black(b));
  const scene::Scene scene = load(b);
  double low[2] = {2, 2}, high[2] = {-2, -2};
  for (int view = 0; view < 25; ++view) {
    const float tilt = glm::radians(15.0f + 15.0f * float(view / 5)),
                turn = glm::radians(180.0f + 30.0f * float(view % 5 - 2));
    const vec3 eye = 6.0f * vec3(std::cos(turn) * std::sin(tilt), std::cos(tilt), std::sin(turn) * std::sin(tilt));
    for (const bool paper : {false, true}) {
      if (paper && view % 3 != 0) continue;
      const Shot shot =
          thorough(scene, look(eye, {0.3f, 0.5f, 0}, 90), {80, 80}, "vbao", {"gi.slices=4", "gi.steps=32"}, paper);
      // How far from the closed form, near the origin.
      const Means m = compare(shot, "visibility", [&](vec3 at) {
        if (std::abs(at.x) > 0.4f || at.y > 0.01f || std::abs(at.z) > 0.4f) return -1.0;
        return 1 - 0.5 * (1 - std::cos(std::atan(double(height) / (1 - double(at.x)))));
      });
      ASSERT_GT(m.count, 5) << view;
      low[paper] = std::min(low[paper], m.value - m.expected),
      high[paper] = std::max(high[paper], m.value - m.expected);
    }
  }
  std::printf("wall of 60 degrees, 25 views, off by: radiometric %+.3f to %+.3f, paper %+.3f to %+.3f\n", low[0],
              high[0], low[1], high[1]);
  EXPECT_GT(low[0], -1.2e-2);
  EXPECT_LT(high[0], 1.2e-2);
  EXPECT_GT(high[1] - low[1], 4 * (high[0] - low[0]));
  EXPECT_LT(low[1], -5e-2);
}

// Every point in a sphere gets the same light from a cap of it: its share of the area. So a shining bowl is a furnace
// with the rest of the sphere left open.
TEST_F(Forms, BowlIsAFurnace) {
  constexpr float cap = 70;  // degrees from the lowest point
  std::vector<vec2> line;
  for (int i = 0; i <= 32; ++i) {
    const float angle = glm::radians(cap * float(32 - i) / 32);
    line.emplace_back(std::sin(angle), 1 - std::cos(angle));
  }
  Builder b;
  b.revolve(line, 96, vec3(0), lamp(b));
  const scene::Scene scene = load(b);
  const double expected = 0.5 * (1 - std::cos(glm::radians(double(cap))));
  const auto light = [&](const char* technique, const std::vector<std::string>& assignments, bool paper) {
    const Shot shot = thorough(scene, from_above(2.6f, 56), {96, 96}, technique, assignments, paper);
    const Means gi = compare(shot, "gi", [&](vec3 at) { return glm::length(vec2(at.x, at.z)) < 0.8f ? expected : -1; });
    EXPECT_GT(gi.count, 1000);
    return gi;
  };
  for (const char* emitter : {"vbgi.emitter=half_space", "vbgi.emitter=one_sided"}) {
    const Means gi = light("vbgi", {emitter}, false);
    EXPECT_NEAR(gi.value, expected, 1e-2) << emitter;
    EXPECT_LT(gi.worst, 6e-2) << emitter;
  }
  EXPECT_NEAR(light("hbil", {}, false).value, expected, 2e-2);
  const double printed = light("vbgi", {}, true).value;
  std::printf("bowl of %.4f: paper %.4f\n", expected, printed);
  EXPECT_LT(printed, 0.8 * expected) << "control: the emitter's cosine and the measure as printed lose light";
}

// Share of the cosine-weighted hemisphere that a rectangle of sides a, b parallel to the surface at height c takes, one
// corner above the point.
double parallel_corner(double a, double b, double c) {
  const double x = a / c, y = b / c, rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * pi);
}

// A shining box without a lid: its floor gets all but what the opening takes.
TEST_F(Forms, OpenBoxIsAFurnace) {
  Builder b;
  b.room({0, 0.5f, 0}, {1, 0.5f, 1}, lamp(b));  // seen from outside the lid is not there
  const scene::Scene scene = load(b);
  for (const char* emitter : {"vbgi.emitter=half_space", "vbgi.emitter=one_sided"}) {
    const Shot shot = thorough(scene, from_above(2.2f, 86), {128, 128}, "vbgi", {emitter});
    const Means gi = compare(shot, "gi", [](vec3 at) {
      if (at.y > 0.01f || std::abs(at.x) > 0.9f || std::abs(at.z) > 0.9f) return -1.0;
      double opening = 0;
      for (const double sx : {-1.0, 1.0})
        for (const double sz : {-1.0, 1.0}) opening += parallel_corner(1 - sx * double(at.x), 1 - sz * double(at.z), 1);
      return 1 - opening;
    });
    ASSERT_GT(gi.count, 1000);
    EXPECT_NEAR(gi.value, gi.expected, 1.5e-2) << emitter;
    EXPECT_LT(gi.worst, 8e-2) << emitter;
  }
}

// Hills that shine to all sides: what is not open is light, in each pixel and frame.
TEST_F(Forms, HillsAreAFurnace) {
  Builder b;
  b.surface(
      48, 48,
      [](float s, float t) {
        const float x = 4 * s - 2, z = 2 - 4 * t;
        return content::SurfacePoint{{x, 0.4f * std::sin(4 * x) * std::cos(3 * z), z}, {s, t}};
      },
      lamp(b));
  const scene::Scene scene = load(b);
  for (const char* thickness : {"gi.thickness_mode=infinite", "gi.thickness_mode=constant"}) {
    const auto sums = [&](const char* emitter) {
      const Shot shot = thorough(scene, look({0.5f, 3, 2.5f}, vec3(0), 60), {96, 64}, "vbgi", {thickness, emitter});
      Means sum;
      for (int i = 0; i < 96 * 64; ++i) {
        const ivec2 p(i % 96, i / 96);
        if (shot.value("depth", p) <= 0) continue;
        const double both = double(shot.value("visibility", p) + shot.value("gi", p));
        sum.worst = std::max(sum.worst, std::abs(both - 1)), sum.value += both;
        sum.expected += double(shot.value("visibility", p)), ++sum.count;
      }
      sum.value /= sum.count, sum.expected /= sum.count;
      return sum;
    };
    const Means all = sums("vbgi.emitter=none");
    EXPECT_LT(all.expected, 0.9) << "something is hidden";
    EXPECT_LT(all.worst, 3e-3) << thickness;
    EXPECT_LT(sums("vbgi.emitter=cosine").value, 0.99) << "control";
  }
}

// A shining dome on a black floor: half of a cone about the horizon, sin(beta) = radius / distance.
TEST_F(Forms, DomeOnAFloor) {
  Builder b;
  floor(b, 20, black(b));
  std::vector<vec2> line;
  for (int i = 0; i <= 24; ++i) {
    const double angle = pi / 2 * i / 24;
    line.emplace_back(float(std::cos(angle)), float(std::sin(angle)));
  }
  b.revolve(line, 64, vec3(0), lamp(b));
  const scene::Scene scene = load(b);
  const Shot shot = thorough(scene, from_above(6, 70), {128, 128}, "vbgi");
  const auto form = [](vec3 at) {
    const double distance = double(glm::length(vec2(at.x, at.z)));
    if (at.y > 0.01f || distance < 1.15 || distance > 3) return -1.0;
    const double beta = std::asin(1 / distance);
    return (beta - std::sin(beta) * std::cos(beta)) / pi;
  };
  const Means gi = compare(shot, "gi", form), seen = compare(shot, "visibility", [&](vec3 at) {
                                                const double hidden = form(at);
                                                return hidden < 0 ? -1 : 1 - hidden;
                                              });
  ASSERT_GT(gi.count, 1000);
  EXPECT_NEAR(gi.value, gi.expected, 1e-2);
  EXPECT_NEAR(seen.value, seen.expected, 1e-2);
  EXPECT_LT(gi.worst, 8e-2);
}

// A shining unit square that stands on a black floor.
TEST_F(Forms, SquareOnAFloor) {
  Builder b;
  floor(b, 20, black(b));
  b.quad({1, 0, -0.5f}, {1, 0, 0.5f}, {1, 1, 0.5f}, {1, 1, -0.5f}, lamp(b));
  const scene::Scene scene = load(b);
  const Shot shot = thorough(scene, look({-2.5f, 2.2f, 0}, {0.4f, 0.3f, 0}, 50), {128, 96}, "vbgi");
  const Means gi = compare(shot, "gi", [](vec3 at) {
    if (at.y > 0.01f || at.x < -0.5f || at.x > 0.8f || std::abs(at.z) > 0.6f) return -1.0;
    const double c = 1 - double(at.x), top = std::sqrt(c * c + 1);
    double sum = 0;
    for (const double side : {0.5 - double(at.z), 0.5 + double(at.z)})
      sum += std::atan(side / c) - c / top * std::atan(side / top);
    return sum / (2 * pi);
  });
  ASSERT_GT(gi.count, 500);
  EXPECT_NEAR(gi.value, gi.expected, 1e-2);
  EXPECT_LT(gi.worst, 8e-2);
  std::printf("square on a floor: gi %.4f, expected %.4f, worst %.4f of %d pixels\n", gi.value, gi.expected, gi.worst,
              gi.count);
}

}  // namespace
}  // namespace nf::test
