// The forms of the slice techniques (shaders/gi/bitmask.glsl, horizon.glsl): hit rules, sector counts and measures,
// thickness, emitters, the environment, hbao and gtao; each against its closed form, and the printed forms against what
// they miss.
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "slice_twin.h"

namespace {

using bed::Bed;
using glm::dvec3;
using glm::ivec2;
using glm::vec2;
using glm::vec3;
using twin::HorizonParams;
using twin::kDegree;
using twin::kPi;
using twin::mean;
using twin::mean_horizons;
using twin::Params;
using twin::thorough;
using twin::use;

// As `--mode paper` sets them (passes/gi/techniques.cpp).
Params paper(Params params) {
  params.slice_measure = twin::SLICES_SCREEN;
  params.projection = twin::PROJECTION_VIEW_COSINE;
  params.back_along = 1;
  params.span = 1;
  params.sector_rule = twin::RULE_ROUND;
  params.sector_measure = twin::MEASURE_UNIFORM_ANGLE;
  params.emitter = twin::EMITTER_COSINE;
  return params;
}

// A floor, and a wall in the plane x = 1 up to elevation beta as seen from the origin.
Bed wall(double beta, dvec3 eye, dvec3 target) {
  Bed bed{{{twin::floor_quad()}, {}, {}}, {eye, target, 90, {2048, 2048}}};
  bed.scene.quads.push_back({{1, 0, -500}, {0, 0, 1000}, {0, std::tan(beta * kDegree), 0}, vec3(1)});
  return bed;
}

double wall_form(double beta) {
  return 0.5 * (1 - std::cos(beta * kDegree));
}

// --- sectors ---

// Mean number of bits beyond the true width, over where the interval lies (techniques.md 3.4).
TEST(HitRules, WidthsAreOffByWhatIsKnown) {
  const double widths[] = {0.1, 0.25, 0.5, 1, 1.5, 2.5};
  // Of the uniformly placed interval [x, x + w): jitter and centre are unbiased; the others by the fraction they round.
  const double ceil_off[] = {0.9, 0.75, 0.5, 0, 0.5, 0.5}, round_off[] = {-0.1, -0.25, 0.5, 0, 0.5, 0.5},
               floor_off[] = {-0.1, -0.25, -0.5, 0, -0.5, -0.5};
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> place(4, 20);
  for (int i = 0; i < 6; ++i) {
    const double expected[] = {0, 0, ceil_off[i], round_off[i], floor_off[i]};
    for (int rule = 0; rule < 5; ++rule) {
      twin::bitmask = {};
      twin::bitmask.sector_rule = rule;
      double sum = 0;
      constexpr int kCount = 20000;
      for (int n = 0; n < kCount; ++n) {
        const float x = place(engine);
        // Widths that lie on a rounding border are nudged to where the table has them.
        const twin::Range r = twin::sector_range(
            x, x + float(widths[i]) + (rule == 3 ? 1e-4f : -1e-5f * float(rule == 2)) + (rule == 4 ? 1e-5f : 0.0f));
        sum += std::popcount(twin::range_word(r, 0));
      }
      EXPECT_NEAR(sum / kCount - widths[i], expected[rule], 0.012) << "rule " << rule << ", width " << widths[i];
    }
  }
}

// The 40 slivers of techniques.md 3.4: a surface over 8 sectors, seen as intervals of a fifth of a sector.
TEST(HitRules, SliversOfASurface) {
  const int expected[] = {8, 8, 8, 0, 0};
  for (int rule = 0; rule < 5; ++rule) {
    twin::bitmask = {};
    twin::bitmask.sector_rule = rule;
    unsigned mask = 0;
    for (int i = 0; i < 40; ++i)
      mask |= twin::range_word(twin::sector_range(4 + 0.2f * float(i) + 1e-3f, 4 + 0.2f * float(i + 1) + 1e-3f), 0);
    EXPECT_EQ(std::popcount(mask), expected[rule]) << "rule " << rule;
  }
}

TEST(Sectors, AnyCountIsFilledByAFullHemisphere) {
  for (int choice = 0; choice < 6; ++choice) {
    twin::bitmask = {};
    twin::bitmask.sectors = choice;
    const int count = 4 << choice;
    for (float xi : {0.0f, 0.3f, 0.999f}) {
      const twin::Range r = twin::sector_range(xi, float(count) + xi);
      int set = 0;
      for (int word = 0; word < 4; ++word) set += std::popcount(twin::range_word(r, word));
      EXPECT_EQ(set, count);
    }
  }
}

// More sectors converge to the same number (3.15 item 14); few of them are coarse only in each pixel.
TEST(Sectors, CountsConverge) {
  Bed bed = wall(60, {-6, 4, 0}, {0.5, 0.8, 0});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  for (int choice = 0; choice < 6; ++choice) {
    Params params = thorough(64, 128);
    params.sectors = choice;
    EXPECT_NEAR(mean(pixel, params, 8).visibility, 1 - wall_form(60), choice < 2 ? 2.5e-2 : 1e-2) << (4 << choice);
  }
}

TEST(FastAcos, IsWithinItsBound) {
  double worst = 0;
  for (int i = -10000; i <= 10000; ++i)
    worst = std::max(worst, std::abs(double(twin::fast_acos(float(i) / 10000)) - std::acos(i / 10000.0)));
  std::printf("fast acos: %.4f rad\n", worst);
  EXPECT_LT(worst, 0.0092);
  EXPECT_GT(worst, 0.005) << "the bound is near";
}

// --- measures ---

// A cone-shaped pit seen from its axis: only directions within `half` of n = V are open.
TEST(Measures, PitByItsClosedForms) {
  twin::look_through({});
  const ivec2 pixel(512);
  for (const double half : {30.0, 45.0, 60.0, 75.0}) {
    const float slope = float(std::tan(half * kDegree));
    // All around, in each texel, the wall of the cone.
    twin::fetch = [=](ivec2 p) {
      const float away = glm::length(vec2(p - pixel)) / 512;
      return bed::Texel{10 * slope / (slope + away), vec3(0, 0, 1), vec3(0), {}};
    };
    const double c = std::cos(half * kDegree), s = std::sin(half * kDegree);
    const double expected[] = {s * s, half / 90, 1 - c, s};
    for (int measure = 0; measure < 4; ++measure) {
      Params params = thorough(32, 4);
      params.radius = 0.2f;
      params.sector_measure = measure;
      params.span = 1;  // a cone's tip is no plane
      params.fast_acos = 0;
      EXPECT_NEAR(mean(pixel, params, 64).visibility, expected[measure], 6e-3) << half << " measure " << measure;
      params.projection = twin::PROJECTION_VIEW_COSINE;
      EXPECT_NEAR(mean(pixel, params, 64).visibility, expected[measure], 6e-3) << half << " measure " << measure;
    }
    // Four masks join the cosine's curve by straight lines from fourth to fourth of the angle.
    Params params = thorough(32, 4);
    params.radius = 0.2f;
    params.sector_measure = twin::MEASURE_FOUR_MASKS;
    params.span = 1;
    const double quarter = std::floor(half / 22.5), low = std::sin(quarter * 22.5 * kDegree),
                 high = std::sin((quarter + 1) * 22.5 * kDegree);
    EXPECT_NEAR(mean(pixel, params, 64).visibility, low + (high - low) * (half / 22.5 - quarter), 8e-3) << half;
    HorizonParams horizon;
    EXPECT_NEAR(mean_horizons(pixel, params, horizon, 16).visibility, s * s, 6e-3) << half;
    horizon.uniform = 1;
    EXPECT_NEAR(mean_horizons(pixel, params, horizon, 16).visibility, 1 - c, 6e-3) << half;
  }
}

// The printed form depends on the camera; the right one does not (3.15 item 8).
TEST(Measures, WallFromManyViews) {
  double spread[2], low[2] = {2, 2}, high[2] = {-1, -1};
  for (int view = 0; view < 25; ++view) {
    const double tilt = (15 + 15 * (view / 5)) * kDegree, turn = (180 + (view % 5 - 2) * 30) * kDegree;
    const dvec3 eye = 6.0 * dvec3(std::cos(turn) * std::sin(tilt), std::cos(tilt), std::sin(turn) * std::sin(tilt));
    Bed bed = wall(60, eye, {0.3, 0.5, 0});
    use(bed);
    const ivec2 pixel = bed.camera.texel_of(dvec3(0));
    for (int form = 0; form < 2; ++form) {
      Params params = form ? paper(thorough(24, 64)) : thorough(24, 64);
      const double seen = mean(pixel, params, 2).visibility;
      low[form] = std::min(low[form], seen), high[form] = std::max(high[form], seen);
    }
  }
  for (int form = 0; form < 2; ++form) spread[form] = high[form] - low[form];
  std::printf("wall of 60 degrees, truth .750, 25 views: radiometric %.3f to %.3f, paper %.3f to %.3f\n", low[0],
              high[0], low[1], high[1]);
  EXPECT_NEAR(low[0], 0.75, 2e-2);
  EXPECT_NEAR(high[0], 0.75, 2e-2);  // some of the wall is out of the picture
  EXPECT_GT(spread[1], 5 * spread[0]);
  EXPECT_LT(low[1], 0.68);
}

// Line 23 of Algorithm 1 with everything around shining 1: .637 for emitters that face the receiver
// (techniques.md 3.7).
TEST(Measures, PaperModeLosesLightInAFurnace) {
  twin::look_through({});
  const ivec2 pixel(512);
  twin::fetch = [=](ivec2 p) {
    const vec2 away = vec2(p - pixel);
    // Facing the receiver: towards it along the screen, for the walls of the slot stand upright.
    const vec3 facing = p == pixel ? vec3(0, 0, 1) : glm::normalize(vec3(-away.x, away.y, 0));
    return bed::Texel{p == pixel ? 10.0f : 1e-3f, facing, vec3(1), {}};
  };
  Params params = thorough(64, 4);
  params.emitter = twin::EMITTER_NONE;
  EXPECT_NEAR(mean(pixel, params, 4).gi.x, 1, 2e-3);
  params = paper(thorough(64, 4));
  params.emitter = twin::EMITTER_NONE;
  // One sample takes all of its side and weighs it by its own direction, V: the receiver's cosine is 1.
  EXPECT_NEAR(mean(pixel, params, 4).gi.x, 1, 3e-2);
  // The near half of a small sphere round the receiver, far away, seen through the receiver's own texel.
  bed::Camera camera;
  camera.fov_degrees = 4;
  twin::look_through(camera);
  twin::fetch = [&](ivec2 p) {
    const vec3 centre(0, 0, -2), ray = twin::view_ray(vec2(p) + 0.5f, twin::frame.ray_scale, twin::frame.ray_offset);
    const float a = glm::dot(ray, ray), b = glm::dot(ray, centre), c = glm::dot(centre, centre) - 0.0025f;
    const float root = b * b - a * c;
    if (p == pixel) return bed::Texel{2, vec3(0, 0, 1), vec3(0), {}};
    if (root < 0) return bed::Texel{};
    const vec3 at = ray * ((b - std::sqrt(root)) / a);
    return bed::Texel{-at.z, glm::normalize(centre - at), vec3(1), {}};
  };
  // Thin, so that each sector is weighed by the cosines of the sample that takes it; `ceil`, as round loses slivers.
  params = paper(thorough(32, 360));
  params.step_exponent = 1;
  params.sector_rule = twin::RULE_CEIL;
  params.thickness_mode = twin::THICKNESS_CONSTANT;
  params.thickness = 0.005f;
  const double printed = mean(pixel, params, 2).gi.x;
  params = thorough(32, 256);
  const double right = mean(pixel, params, 2).gi.x;
  std::printf("furnace of a sphere: radiometric %.3f, paper %.3f\n", right, printed);
  EXPECT_NEAR(right, 1, 2e-2);
  EXPECT_NEAR(printed, 0.637, 6e-2);  // a sample is at the near end of what it takes
}

// --- horizons ---

// The arc of GTAO's paper, a quarter of (-cos(2h - gamma) + cos(gamma) + 2 h sin(gamma)), is the share between V and
// the horizon.
TEST(Horizons, ArcIsGtaosClosedForm) {
  twin::horizon = {};
  for (double gamma = -1.4; gamma < 1.45; gamma += 0.2)
    for (double h = gamma; h < kPi / 2; h += 0.05) {
      twin::Slice slice{};
      slice.cos_gamma = float(std::cos(gamma)), slice.sin_gamma = float(std::sin(gamma));
      const float total = twin::slice_total(slice.cos_gamma, slice.sin_gamma, twin::slice_k_exact(slice.sin_gamma));
      // There h is measured from V, and gamma is the normal's angle.
      const auto arc = [&](double t) {
        return 0.25 * (-std::cos(2 * (t - gamma) + gamma) + std::cos(gamma) - 2 * (t - gamma) * std::sin(gamma));
      };
      EXPECT_NEAR(double(total) * double(twin::share_beyond(slice, total, float(std::sin(h)))), arc(kPi / 2) - arc(h),
                  1e-5);
    }
}

TEST(Horizons, OpenPlaneAndWall) {
  for (double pitch : {-10.0, -45.0, -80.0}) {
    Bed bed{{{twin::floor_quad()}, {}, {}},
            {{0, 1.7, 0}, {0, 1.7 + std::sin(pitch * kDegree), -std::cos(pitch * kDegree)}}};
    use(bed);
    for (int uniform : {0, 1})
      for (int measure : {twin::SLICES_SCREEN_J, twin::SLICES_VIEW})
        twin::for_grid(bed.camera.size, [&](ivec2 p) {
          if (bed.texel(p).depth <= 0) return;
          Params params = thorough(32, 8);
          params.slice_measure = measure;
          HorizonParams horizon;
          horizon.uniform = uniform;
          EXPECT_NEAR(mean_horizons(p, params, horizon, 1).visibility, 1, 1e-3) << pitch << " " << p.x << " " << p.y;
        });
  }
  for (const dvec3 eye : {dvec3(-6, 4, 0), dvec3(-3, 2, 4)}) {
    Bed bed = wall(60, eye, {0.5, 0.8, 0});
    use(bed);
    const ivec2 pixel = bed.camera.texel_of(dvec3(0));
    EXPECT_NEAR(mean_horizons(pixel, thorough(64, 128), {}, 4).visibility, 1 - wall_form(60), 1e-2);
    HorizonParams uniform;
    uniform.uniform = 1;  // of a half space, the lune between the floor and the wall's top
    EXPECT_NEAR(mean_horizons(pixel, thorough(64, 128), uniform, 4).visibility, 1 - 60.0 / 180, 1.5e-2);
  }
  // As printed, slices are uniform on the screen: 30 degrees below the axis of a level camera an open floor reads .968.
  Bed bed{{{twin::floor_quad()}, {}, {}}, {{0, 1.7, 0}, {0, 1.7, -1}}};
  use(bed);
  Params printed = thorough(256, 4);
  printed.slice_measure = twin::SLICES_SCREEN;
  const ivec2 pixel = bed.camera.texel_of({0, 0, -1.7 / std::tan(30 * kDegree)});
  EXPECT_NEAR(mean_horizons(pixel, printed, {}, 1).visibility, 0.968, 2e-3);
}

// Taller occluders hide more; a bias leaves low ones out; a thin one is forgotten behind it.
TEST(Horizons, HeightBiasAndThinness) {
  double last = 2;
  for (double beta : {10.0, 25.0, 45.0, 70.0}) {
    Bed bed = wall(beta, {-6, 4, 0}, {0.5, 0.8, 0});
    use(bed);
    const double seen = mean_horizons(bed.camera.texel_of(dvec3(0)), thorough(32, 64), {}, 2).visibility;
    EXPECT_LT(seen, last);
    last = seen;
  }
  Bed low = wall(20, {-6, 4, 0}, {0.5, 0.8, 0});
  use(low);
  HorizonParams horizon;
  horizon.bias = 25;
  EXPECT_NEAR(mean_horizons(low.camera.texel_of(dvec3(0)), thorough(32, 64), horizon, 1).visibility, 1, 1e-3);
  Bed bars{{{twin::floor_quad()}, {}, {{{0.5, 0, -500}, {0.52, 1, 500}, vec3(0)}}},
           {{-6, 4, 0}, {0.5, 0.8, 0}, 90, {2048, 2048}}};
  use(bars);
  const ivec2 pixel = bars.camera.texel_of(dvec3(0));
  Params params = thorough(32, 64);
  params.radius = 3;
  const double solid = mean_horizons(pixel, params, {}, 2).visibility;
  HorizonParams thin;
  thin.thin_occluder = 0.2f;
  EXPECT_GT(mean_horizons(pixel, params, thin, 2).visibility, solid + 0.05);
}

TEST(Horizons, MultiBounceCurve) {
  EXPECT_NEAR(twin::multi_bounce(0.2f, 0.8f), 0.4615, 1e-3);
  EXPECT_NEAR(twin::multi_bounce(0.5f, 0.5f), 0.681, 1e-3);
  for (float v = 0; v <= 1; v += 0.1f) {
    EXPECT_NEAR(twin::multi_bounce(v, 0), v, 0.03f);
    EXPECT_GE(twin::multi_bounce(v, 0.6f), v);
  }
  EXPECT_NEAR(twin::multi_bounce(1, 0.8f), 1, 2e-2);
}

// --- bitmask and horizon ---

Bed things() {
  return {{{twin::floor_quad(vec3(0.3f))},
           {{{0.3, 0.4, -3}, 0.5, vec3(1)}, {{-0.9, 0.25, -2.6}, 0.25, vec3(2)}},
           {{{-2, 0, -5}, {-1, 2, -4}, vec3(1)}}},
          {{0, 1.5, 0}, {0, 0.5, -3}, 70, {512, 512}}};
}

// 3.15 item 9: infinite thickness and 128 sectors is GTAO, whose samples are texels.
TEST(Bitmask, InfiniteThicknessIsGtao) {
  const Bed bed = things();
  use(bed);
  double off = 0, worst = 0, occluded = 0;
  int count = 0;
  twin::for_grid(bed.camera.size, [&](ivec2 p) {
    if (bed.texel(p).depth <= 0) return;
    Params params = thorough(2, 16);
    params.radius = 2;
    params.span = 1;
    params.sectors = 5;
    const double a = mean(p, params, 4).visibility, b = mean_horizons(p, params, {}, 4).visibility;
    off += std::abs(a - b), worst = std::max(worst, std::abs(a - b)), occluded += 1 - b;
    ++count;
  });
  EXPECT_GT(occluded / count, 0.02);
  EXPECT_LT(off / count, 2.0 / 255);
  EXPECT_LT(worst, 0.03);
  std::printf("vbao, infinite, against gtao: mean difference %.4f, worst %.4f\n", off / count, worst);
}

TEST(Bitmask, ThicknessModes) {
  // A wall that hangs from 45 to 60 degrees.
  Bed bed{{{twin::floor_quad()}, {}, {}}, {{-6, 1.5, 0}, {0.5, 0.8, 0}, 90, {2048, 2048}}};
  bed.scene.quads.push_back({{1, 1, -500}, {0, 0, 1000}, {0, std::tan(60 * kDegree) - 1, 0}, vec3(1)});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  Params params = thorough(64, 256);
  params.thickness_mode = twin::THICKNESS_CONSTANT;
  params.thickness = 0.7f;
  const double constant = mean(pixel, params, 2).visibility;
  // So thick at that depth: the wall is some 7 m away, its depth a little less by the view's angle.
  params.thickness_mode = twin::THICKNESS_LINEAR;
  params.thickness = 0.1f;
  EXPECT_NEAR(mean(pixel, params, 2).visibility, constant, 1e-2);
  params.thickness_mode = twin::THICKNESS_ANGULAR;
  params.thickness_angle = 90;
  const double angular = mean(pixel, params, 2).visibility;
  params.thickness_mode = twin::THICKNESS_INFINITE;
  EXPECT_NEAR(angular, mean(pixel, params, 2).visibility, 2e-3) << "a right angle reaches the tangent plane";
  params.thickness_mode = twin::THICKNESS_ANGULAR;
  params.thickness_angle = 0;
  params.span = 1;
  EXPECT_EQ(mean(pixel, params, 1).visibility, 1);
}

// A ceiling just within the radius, and just beyond (3.13).
TEST(Bitmask, BallsEndAtTheRadius) {
  for (const double height : {0.9, 1.1}) {
    Bed bed{{{twin::floor_quad(), {{-50, height, -50}, {100, 0, 0}, {0, 0, 100}, vec3(1)}}, {}, {}},
            {{-6, height * 0.5, 0}, {0, height * 0.4, 0}, 60, {2048, 2048}}};
    use(bed);
    const ivec2 pixel = bed.camera.texel_of(dvec3(0));
    for (const int mode : {twin::RADIUS_BALL, twin::RADIUS_BALL_FALLOFF}) {
      Params params = thorough(64, 256);
      params.radius = 1;
      params.radius_mode = mode;
      params.falloff = 1;
      params.thickness_mode = twin::THICKNESS_CONSTANT;
      params.thickness = 0.01f;
      const double seen = mean(pixel, params, 2).visibility, horizon = mean_horizons(pixel, params, {}, 2).visibility;
      if (height > 1) {
        EXPECT_EQ(seen, 1);
        EXPECT_NEAR(horizon, 1, 1e-6);
      }
    }
  }
  // A sphere on the floor, all of it within the ball or none: the disc takes it in both.
  const Bed bed = things();
  use(bed);
  const ivec2 pixel = bed.camera.texel_of({0.9, 0, -3});
  Params params = thorough(64, 64);
  params.radius = 1.5f;
  const double disc = mean(pixel, params, 2).visibility;
  params.radius_mode = twin::RADIUS_BALL;
  const double ball = mean(pixel, params, 2).visibility;
  params.radius_mode = twin::RADIUS_BALL_FALLOFF;
  params.falloff = 1;
  const double falloff = mean(pixel, params, 2).visibility;
  EXPECT_LE(disc, ball + 1e-3);
  EXPECT_LT(ball + 0.005, falloff);
  EXPECT_LT(falloff, 0.999);
}

TEST(Bitmask, EmitterRules) {
  const Bed bed = wall(60, {-6, 4, 0}, {0.5, 0.8, 0});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  Params params = thorough();
  double light[4];
  for (int emitter = 0; emitter < 4; ++emitter) {
    params.emitter = emitter;
    light[emitter] = double(mean(pixel, params, 2).gi.x);
  }
  EXPECT_NEAR(light[twin::EMITTER_ONE_SIDED], wall_form(60), 1e-2);
  EXPECT_NEAR(light[twin::EMITTER_NONE], light[twin::EMITTER_ONE_SIDED], 3e-3);
  EXPECT_NEAR(light[twin::EMITTER_HALF_SPACE], light[twin::EMITTER_ONE_SIDED], 1e-2)
      << "all of it is seen from the front";
  EXPECT_LT(light[twin::EMITTER_COSINE], 0.8 * light[twin::EMITTER_ONE_SIDED]) << "foreshortened twice";
  // Turned over by 90 degrees, the wall's texels say they are a ceiling: only what is above shines down.
  twin::fetch = [&](ivec2 p) {
    bed::Texel texel = bed.texel(p);
    if (texel.radiance.x > 0) texel.normal = vec3(glm::transpose(bed.camera.axes()) * dvec3(0, -1, 0));
    return texel;
  };
  params.emitter = twin::EMITTER_HALF_SPACE;
  EXPECT_NEAR(mean(pixel, params, 2).gi.x, light[twin::EMITTER_ONE_SIDED], 1e-2) << "all of the upper half space";
  twin::fetch = [&](ivec2 p) {
    bed::Texel texel = bed.texel(p);
    if (texel.radiance.x > 0) texel.normal = -texel.normal;
    return texel;
  };
  EXPECT_NEAR(mean(pixel, params, 2).gi.x, 0, 1e-2);
}

// --- bent normals and the environment ---

TEST(Directions, MomentsAreTheirQuadrature) {
  for (double gamma = -1.3; gamma < 1.35; gamma += 0.26)
    for (double a = -1.5; a < 1.5; a += 0.31)
      for (double b = a + 0.1; b < 1.57; b += 0.43) {
        twin::Slice slice{};
        slice.cos_gamma = float(std::cos(gamma)), slice.sin_gamma = float(std::sin(gamma));
        const vec2 seen = twin::slice_moment(slice, float(std::sin(b)), float(std::cos(b))) -
                          twin::slice_moment(slice, float(std::sin(a)), float(std::cos(a)));
        glm::dvec2 sum(0);
        constexpr int kSteps = 2000;
        for (int i = 0; i < kSteps; ++i) {
          const double t = a + (i + 0.5) / kSteps * (b - a);
          sum +=
              glm::dvec2(std::sin(t), std::cos(t)) * (std::cos(t) * std::abs(std::sin(t - gamma)) * (b - a) / kSteps);
        }
        EXPECT_NEAR(seen.x, sum.x, 2e-5);
        EXPECT_NEAR(seen.y, sum.y, 2e-5);
      }
}

// Over a wall the mean open direction turns from it, by the closed form of the open wedge.
TEST(Directions, BentNormalOfAWall) {
  const Bed bed = wall(60, {-6, 4, 0}, {0.5, 0.8, 0});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  // Mean of w over the open wedge, cosine-weighted over pi: by quadrature.
  dvec3 truth(0);
  constexpr int kSide = 800;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double r = std::sqrt((i % kSide + 0.5) / kSide), phi = 2 * kPi * (i / kSide + 0.5) / kSide;
    const dvec3 w(r * std::cos(phi), std::sqrt(1 - r * r), r * std::sin(phi));
    if (w.x <= 0 || w.y / w.x > std::tan(60 * kDegree)) truth += w / double(kSide * kSide);
  }
  const dvec3 view_truth = glm::transpose(bed.camera.axes()) * truth;
  Params params = thorough(64, 128);
  params.regions = 16;
  const vec3 bitmask = mean(pixel, params, 4).bent, horizon = mean_horizons(pixel, params, {}, 4).bent;
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(bitmask[c], view_truth[c], 1e-2) << c;
    EXPECT_NEAR(horizon[c], view_truth[c], 1e-2) << c;
  }
  // An open floor's is the normal, whatever the view.
  Bed open{{{twin::floor_quad()}, {}, {}}, {{0, 1.7, 0}, {0, 1.2, -1}}};
  use(open);
  const ivec2 at(700, 800);
  const vec3 up = glm::transpose(glm::mat3(open.camera.axes())) * vec3(0, 1, 0);
  const vec3 seen[] = {mean(at, thorough(64, 8), 1).bent, mean_horizons(at, thorough(64, 8), {}, 1).bent};
  for (const vec3& bent : seen) EXPECT_LT(glm::length(bent - up * (2.0f / 3)), 4e-3f);
  HorizonParams uniform;
  uniform.uniform = 1;
  EXPECT_LT(glm::length(mean_horizons(at, thorough(64, 8), uniform, 1).bent - up * 0.5f), 4e-3f);
}

// A constant environment is dimmed by visibility, exactly; of one that is bright towards the wall little is left.
TEST(Directions, AmbientByDirection) {
  const Bed bed = wall(60, {-6, 4, 0}, {0.5, 0.8, 0});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  const auto forms = {thorough(16, 64), paper(thorough(16, 64))};
  for (const Params& params : forms) {
    const twin::Gathered seen = mean(pixel, params, 4);
    EXPECT_NEAR(seen.ambient.x, seen.visibility, 1e-4);
  }
  const vec3 to_wall = glm::transpose(glm::mat3(bed.camera.axes())) * vec3(1, 0, 0);
  const vec3 up = glm::transpose(glm::mat3(bed.camera.axes())) * vec3(0, 1, 0);
  // L = 1 + w.x: over the whole hemisphere irradiance / pi is 1, for x averages out.
  const auto kept_from = twin::environment_from, kept_over = twin::environment_over;
  twin::environment_from = [=](vec3 d) { return vec3(1 + glm::dot(d, to_wall)); };
  twin::environment_over = [=](vec3 n) { return vec3(1 + 2.0f / 3 * glm::dot(n, to_wall)); };
  double truth = 0;
  constexpr int kSide = 400;
  for (int i = 0; i < kSide * kSide; ++i) {
    const double r = std::sqrt((i % kSide + 0.5) / kSide), phi = 2 * kPi * (i / kSide + 0.5) / kSide;
    const dvec3 w(r * std::cos(phi), std::sqrt(1 - r * r), r * std::sin(phi));
    if (w.x <= 0 || w.y / w.x > std::tan(60 * kDegree)) truth += (1 + w.x) / (kSide * kSide);
  }
  double error[2];
  for (int form = 0; form < 2; ++form) {
    Params params = form ? paper(thorough(64, 128)) : thorough(64, 128);
    params.regions = 8;
    error[form] = std::abs(double(mean(pixel, params, 4).ambient.x) - truth);
  }
  EXPECT_LT(error[0], 2e-2);
  EXPECT_LT(error[0], error[1]);
  EXPECT_GT(std::abs(double(mean(pixel, thorough(64, 128), 1).visibility) - truth), 0.05)
      << "visibility alone misses it";
  twin::environment_from = kept_from, twin::environment_over = kept_over;
  EXPECT_NEAR(glm::length(up), 1, 1e-6);
}

}  // namespace
