// ssao, ssdo and raymarch, the text that the GPU runs, over analytic depth buffers: open planes, walls, furnaces,
// scale, what each does wrong by its nature.
#include <gtest/gtest.h>

#include "gather_twin.h"

namespace {

using bed::Bed;
using glm::dvec3;
using glm::ivec2;
using glm::vec3;
using twin::Baked;
using twin::floor_quad;
using twin::Gathered;
using twin::kDegree;
using twin::use;

using Technique = Gathered (*)(ivec2);
struct Named {
  const char* name;
  Technique estimate;
};
const Named all[] = {
    {"ssao", twin::estimate_ssao}, {"ssdo", twin::estimate_ssdo}, {"raymarch", twin::estimate_raymarch}};

// Everything as a user gets it, but this radius.
void defaults(float radius) {
  twin::bitmask = {};
  twin::gi.radius = radius;
  twin::ssao = {};
  twin::ssdo = {};
  twin::raymarch = {};
  twin::frame.frame_index = 0;
}

TEST(Gather, OpenPlaneReadsOneEverywhere) {
  int tested = 0;
  for (double pitch : {-10.0, -35.0, -60.0, -89.9}) {
    for (ivec2 size : {ivec2(512, 512), ivec2(20, 12)}) {
      Bed bed{{{floor_quad(vec3(1))}, {}, {}},
              {{0, 1.7, 0}, {0, 1.7 + std::sin(pitch * kDegree), -std::cos(pitch * kDegree)}, 90, size}};
      use(bed);
      for (const Named& technique : all)
        twin::for_grid(size, [&](ivec2 p) {
          defaults(2);
          for (unsigned frame = 0; frame < 4; ++frame) {
            twin::frame.frame_index = frame;
            const Gathered seen = technique.estimate(p);
            EXPECT_EQ(seen.visibility, 1) << technique.name << pitch << " at " << p.x << " " << p.y;
            EXPECT_EQ(seen.gi, vec3(0)) << technique.name;
          }
          tested += bed.texel(p).depth > 0;
        });
      EXPECT_EQ(bed.outside, 0) << "fetched off the screen";
    }
  }
  EXPECT_GT(tested, 500);
  // Control: a bias of 0, as printed, lets the floor occlude itself.
  Bed bed{{{floor_quad()}, {}, {}}, {{0, 1.7, 0}, {0, 1, -1}, 90, {20, 12}}};
  use(bed);
  defaults(2);
  twin::ssao.self = 1;
  twin::ssao.bias = 0;
  EXPECT_LT(twin::mean_gathered({10, 8}, 16, twin::estimate_ssao).visibility, 0.98);
}

TEST(Gather, BackgroundIsOpenAndBlack) {
  Bed bed;
  use(bed);
  for (const Named& technique : all) {
    defaults(1);
    EXPECT_EQ(technique.estimate({3, 3}).visibility, 1) << technique.name;
    EXPECT_EQ(technique.estimate({3, 3}).gi, vec3(0)) << technique.name;
  }
}

TEST(Gather, StaysOnTheScreen) {
  bed::Camera camera;
  for (ivec2 size : {ivec2(1, 1), ivec2(3, 5), ivec2(67, 31)}) {
    camera.size = size;
    twin::look_through(camera);
    for (const Named& technique : all) {
      defaults(50);
      for (int i = 0; i < size.x * size.y; ++i) {
        twin::fetch = [&](ivec2 p) {
          EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x < size.x && p.y < size.y) << p.x << " " << p.y;
          return bed::Texel{1.0f + 0.1f * float((p.x * 7 + p.y * 3) % 5), vec3(0, 0, 1), vec3(1), {}};
        };
        twin::frame.frame_index = unsigned(i);
        const Gathered seen = technique.estimate({i % size.x, i / size.x});
        EXPECT_TRUE(std::isfinite(seen.visibility) && std::isfinite(seen.gi.x)) << technique.name;
      }
    }
  }
}

// A floor, a ball above it, a box on it, a wall behind.
Bed still_life(double scale, ivec2 size) {
  Bed bed{{{floor_quad(vec3(0.5f))},
           {{dvec3(0.3, 0.6, -3) * scale, 0.4 * scale, vec3(0.2f, 1, 0.2f)}},
           {{dvec3(-1.5, 0, -4) * scale, dvec3(-0.5, 1, -3) * scale, vec3(1, 0.2f, 0.2f)}}},
          {dvec3(0, 1.5, 0) * scale, dvec3(0, 0.4, -3) * scale, 70, size}};
  bed.scene.quads.push_back(
      {dvec3(-4, 0, -5) * scale, dvec3(8, 0, 0) * scale, dvec3(0, 3, 0) * scale, vec3(0.3f, 0.3f, 1)});
  return bed;
}

// What is lit and shaded there: on the floor beside the box, under the ball, at the foot of the wall, on the box and
// the ball.
const dvec3 places[] = {{-0.4, 0, -3.2}, {0.3, 0, -2.9},    {0, 0, -4.8},
                        {-1, 0.5, -3},   {0.3, 0.4, -2.65}, {-0.9, 0, -2.9}};

// The same depths, the same thickness behind them: rays through the buffer against the bitmasks (techniques.md 3.15,
// 10).
TEST(Raymarch, AgreesWithTheBitmasks) {
  const Bed bed = still_life(1, {256, 256});
  const Baked baked(bed);
  baked.use();
  int occluded = 0;
  for (const bool infinite : {false, true}) {
    for (const dvec3& place : places) {
      const ivec2 pixel = bed.camera.texel_of(place);
      defaults(12);
      twin::gi.thickness = 0.3f;
      if (infinite) twin::gi.thickness_mode = twin::THICKNESS_INFINITE;
      twin::raymarch.hit = 1;  // inside
      twin::raymarch.rays = 256;
      twin::gi.steps = 512;
      const Gathered rays = twin::mean_gathered(pixel, 8, twin::estimate_raymarch);
      twin::Params params = twin::gi;
      params.slices = 32;
      params.steps = 512;
      params.radius = 100;
      params.span = 1;  // what is between texels is open to rays
      const twin::Gathered bits = twin::mean(pixel, params, 8);
      EXPECT_NEAR(rays.visibility, bits.visibility, 0.02) << infinite << " at " << place.x << " " << place.z;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(rays.gi[c], bits.gi[c], 0.02) << infinite << " at " << place.x << " " << place.z;
      occluded += bits.visibility < 0.9f;
    }
  }
  EXPECT_GE(occluded, 8);
}

// Figure 16: at the same number of fetches, 32, rays are noisier than the two sides of a slice, which gather from every
// sample.
TEST(Raymarch, IsNoisierThanTheBitmasksAtEqualFetches) {
  const Bed bed = still_life(1, {96, 96});
  const Baked baked(bed);
  baked.use();
  constexpr int frames = 24;
  double variance[2][2] = {};
  for (int y = 30; y < 96; y += 3)
    for (int x = 0; x < 96; x += 3) {
      for (const bool rays : {false, true}) {
        double sum[2] = {}, squares[2] = {};
        defaults(2);
        twin::gi.thickness = 0.5f;
        twin::bitmask.span = 1;  // 32 fetches
        for (unsigned frame = 0; frame < frames; ++frame) {
          twin::frame.frame_index = frame;
          double values[2];
          if (rays) {
            const Gathered seen = twin::estimate_raymarch({x, y});
            values[0] = seen.visibility, values[1] = seen.gi.y;
          } else {
            const twin::Gathered seen = twin::estimate_bitmask({x, y});
            values[0] = seen.visibility, values[1] = seen.gi.y;
          }
          for (int k = 0; k < 2; ++k) sum[k] += values[k], squares[k] += values[k] * values[k];
        }
        for (int k = 0; k < 2; ++k) variance[rays][k] += squares[k] / frames - sum[k] * sum[k] / (frames * frames);
      }
    }
  std::printf("variance of rays over bitmasks: visibility %.2f, light %.2f\n", variance[1][0] / variance[0][0],
              variance[1][1] / variance[0][1]);
  EXPECT_GT(variance[1][0], 1.3 * variance[0][0]);
  EXPECT_GT(variance[1][1], 1.3 * variance[0][1]);
}

// An infinite emissive wall, as for vbgi.
TEST(Raymarch, EmissiveWall) {
  for (double beta : {30.0, 60.0}) {
    Bed bed{{{floor_quad()}, {}, {}}, {{-6, 4, 0}, {0.5, 0.5, 0}, 90, {1024, 1024}}};
    bed.scene.quads.push_back({{1, 0, -500}, {0, 0, 1000}, {0, std::tan(beta * kDegree), 0}, vec3(2, 1, 0.5f)});
    use(bed);
    defaults(30);
    twin::gi.steps = 96;
    twin::gi.thickness_mode = twin::THICKNESS_INFINITE;
    twin::raymarch.rays = 256;
    const Gathered seen = twin::mean_gathered(bed.camera.texel_of(dvec3(0)), 8, twin::estimate_raymarch);
    const double truth = 0.5 * (1 - std::cos(beta * kDegree));
    EXPECT_NEAR(seen.visibility, 1 - truth, 0.012) << beta;
    EXPECT_NEAR(seen.gi.x, 2 * truth, 0.025) << beta;
  }
}

// One ray brings light or sky: where all shines alike they add up to 1, pixel by pixel.
TEST(Gather, WhiteSurroundingsAddUpToOne) {
  Bed bed{{{}, {}, {}}, {{0.3, 0.2, 0.9}, {0, -0.3, -1}, 80, {128, 128}}};
  for (int axis = 0; axis < 3; ++axis)
    for (double side : {-1.0, 1.0}) {
      dvec3 corner(-1), u(0), v(0);
      corner[axis] = side;
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2;
      bed.scene.quads.push_back({corner, u, v, vec3(1)});
    }
  const Baked baked(bed);
  baked.use();
  double disc = 0, clamped = 0;
  int count = 0;
  twin::for_grid({128, 128}, [&](ivec2 p) {
    defaults(1.5f);
    twin::gi.thickness_mode = twin::THICKNESS_INFINITE;
    const Gathered rays = twin::estimate_raymarch(p);
    EXPECT_NEAR(rays.visibility + rays.gi.x, 1, 1e-5);
    EXPECT_NEAR(rays.ambient.x, rays.visibility, 1e-5) << "a white environment through what is open";
    twin::ssdo.sender = twin::SENDER_SOLID_ANGLE;
    const Gathered points = twin::estimate_ssdo(p);
    EXPECT_NEAR(points.visibility + points.gi.x, 1, 1e-5);
    EXPECT_NEAR(points.ambient.x, points.visibility, 1e-5);
    twin::ssdo.sender = twin::SENDER_DISC;
    const Gathered discs = twin::mean_gathered(p, 16, twin::estimate_ssdo);
    disc += discs.gi.x / std::max(1 - discs.visibility, 0.01f);
    twin::ssdo.sender = 2;
    const Gathered printed = twin::mean_gathered(p, 16, twin::estimate_ssdo);
    clamped += printed.gi.x / std::max(1 - printed.visibility, 0.01f);
    ++count;
  });
  std::printf("light over occlusion in a white room: solid angle 1, discs %.3f, as printed %.3f\n", disc / count,
              clamped / count);
}

// The same picture whatever the unit of length, except where the paper's clamp of d to 1 is.
TEST(Ssdo, ScaleInvariance) {
  double worst_printed = 0;
  for (const int sender : {0, 1, 2}) {
    std::vector<Gathered> seen[3];
    const double scales[] = {1, 0.01, 100};
    for (int s = 0; s < 3; ++s) {
      const Bed bed = still_life(scales[s], {96, 96});
      const Baked baked(bed);
      baked.use();
      defaults(float(1.5 * scales[s]));
      twin::gi.thickness *= float(scales[s]);
      twin::ssdo.sender = sender;
      for (int i = 0; i < 96 * 96; i += 37) seen[s].push_back(twin::estimate_ssdo({i % 96, i / 96}));
    }
    int lit = 0;
    for (size_t i = 0; i < seen[0].size(); ++i) {
      for (int s : {1, 2}) {
        const double apart =
            std::max(std::abs(seen[s][i].gi.x - seen[0][i].gi.x), std::abs(seen[s][i].gi.y - seen[0][i].gi.y));
        if (sender == 2) {
          worst_printed = std::max(worst_printed, apart);
        } else {
          EXPECT_LT(apart, 1e-3) << sender;
          EXPECT_NEAR(seen[s][i].visibility, seen[0][i].visibility, 1e-3);
        }
      }
      lit += seen[0][i].gi.x > 0.01;
    }
    EXPECT_GT(lit, 10);
  }
  EXPECT_GT(worst_printed, 0.1) << "control: the printed form is not";
}

// A pole far in front of a wall that nothing occludes: how much each range check darkens the wall beside it.
TEST(Ssao, AuraOfEachRangeCheck) {
  Bed bed{{{}, {}, {{{-0.1, -5, -3.1}, {0.1, 5, -2.9}, vec3(0)}}}, {{0, 0, 0}, {0, 0, -1}, 60, {256, 256}}};
  bed.scene.quads.push_back({{-50, -50, -12}, {100, 0, 0}, {0, 100, 0}, vec3(0)});
  const Baked baked(bed);
  baked.use();
  double aura[5];
  for (int range = 0; range < 5; ++range) {
    defaults(1);
    twin::ssao.range = range;
    // Beside the pole, as far as a sphere of the radius reaches: 0.33 at the pole's edge to 0.33 + 1 / 12 tan.
    double sum = 0;
    int count = 0;
    for (int x = 128; x < 160; ++x) {
      const ivec2 p(x, 128);
      if (baked.texels[size_t(p.y * 256 + p.x)].depth < 11) continue;
      sum += 1 - twin::mean_gathered(p, 8, twin::estimate_ssao).visibility;
      ++count;
    }
    aura[range] = sum / count;
  }
  std::printf("aura: none %.4f, constant %.4f, linear %.4f, quadratic %.4f, smoothstep %.4f\n", aura[0], aura[1],
              aura[2], aura[3], aura[4]);
  EXPECT_GT(aura[0], 0.05);
  EXPECT_LT(aura[4], 0.2 * aura[0]);
  EXPECT_EQ(aura[1], 0);
  EXPECT_EQ(aura[2], 0);
  EXPECT_EQ(aura[3], 0);
}

// The corridor of the vbgi test: red to the left, green to the right.
TEST(Gather, ColourLandsOnItsSide) {
  Bed bed{{{floor_quad()}, {}, {}}, {{0, 3, 3}, {0, 0.5, -3}, 90, {512, 512}}};
  bed.scene.quads.push_back({{-2, 0, 100}, {0, 0, -200}, {0, 2, 0}, vec3(1, 0, 0)});
  bed.scene.quads.push_back({{2, 0, 100}, {0, 0, -200}, {0, 2, 0}, vec3(0, 1, 0)});
  use(bed);
  for (const Named& technique : all) {
    defaults(1.5f);
    for (double x : {-1.6, 1.6}) {
      const vec3 light = twin::mean_gathered(bed.camera.texel_of(dvec3(x, 0, -2)), 64, technique.estimate).gi;
      EXPECT_GT(x < 0 ? light.x : light.y, 0.02) << technique.name;
      EXPECT_EQ(x < 0 ? light.y : light.x, 0) << technique.name;
      EXPECT_EQ(light.z, 0);
    }
  }
}

TEST(Ssao, ChapmansKernelIsInTheHemisphereAndDenserNearThePixel) {
  for (int n : {8, 16, 64}) {
    double mean = 0;
    for (int i = 0; i < n; ++i) {
      const vec3 p = twin::chapman_point(i, n);
      EXPECT_GT(p.z, 0);
      EXPECT_LE(glm::length(p), 1.0001f);
      EXPECT_GE(glm::length(p), 0.0999f);
      mean += glm::length(p) / float(n);
      // Turning is a rotation about the normal.
      const vec3 normal = glm::normalize(vec3(1, 2, i % 2 ? -3 : 3)), turned = twin::turned_about(normal, p, 0.3f);
      EXPECT_NEAR(glm::dot(turned, normal), p.z, 1e-6);
      EXPECT_NEAR(glm::length(turned), glm::length(p), 1e-6);
    }
    EXPECT_LT(mean, 0.42);
  }
  EXPECT_NEAR(glm::length(twin::turned_about(vec3(0, 1, 0), vec3(1, 0, 0), 0.1f)), 1, 1e-6) << "the other axis there";
}

TEST(Gather, DirectionsHaveTheirDensity) {
  const vec3 n = glm::normalize(vec3(0.3f, -0.5f, 0.7f));
  vec3 mean(0);
  double cosine = 0, uniform = 0;
  constexpr int count = 4096;
  for (int i = 0; i < count; ++i) {
    const vec3 u = twin::turned_point(vec3(0.5f), i);
    const vec3 d = twin::cosine_direction(n, u.x, u.y);
    EXPECT_NEAR(glm::length(d), 1, 1e-5);
    mean += d / float(count);
    cosine += glm::dot(d, n) / count;
    uniform += glm::dot(twin::uniform_direction(n, u.x, u.y), n) / count;
  }
  EXPECT_NEAR(cosine, 2.0 / 3, 2e-3);
  EXPECT_NEAR(uniform, 0.5, 2e-3);
  EXPECT_LT(glm::length(mean - n * (2.0f / 3)), 3e-3f);
}

}  // namespace
