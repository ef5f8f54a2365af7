// The GI pass itself (shaders/gi/vbgi.glsl, the text the GPU runs) over analytic depth buffers: open planes, emissive
// walls, slots, rectangles whose light and visibility have closed forms.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "slice_twin.h"

namespace {

using bed::Bed;
using bed::Quad;
using glm::dvec3;
using glm::ivec2;
using glm::vec3;
using twin::floor_quad;
using twin::for_grid;
using twin::kDegree;
using twin::kPi;
using twin::look_through;
using twin::mean;
using twin::thorough;
using twin::use;

// --- surfaces that see nothing ---

TEST(Estimator, OpenPlaneReadsOneEverywhere) {
  int tested = 0;
  for (double pitch : {0.0, -10.0, -35.0, -60.0, -89.9}) {
    Bed bed{{{floor_quad(vec3(1))}, {}, {}},
            {{0, 1.7, 0}, {0, 1.7 + std::sin(pitch * kDegree), -std::cos(pitch * kDegree)}}};
    use(bed);
    for (int measure : {twin::SLICES_SCREEN_J, twin::SLICES_VIEW}) {
      for (unsigned infinite : {0u, 1u}) {
        twin::Params params = thorough(64, 16);
        params.slice_measure = measure;
        params.thickness_mode = infinite ? twin::THICKNESS_INFINITE : twin::THICKNESS_CONSTANT;
        for_grid(bed.camera.size, [&](ivec2 p) {
          twin::Gathered seen = mean(p, params, 1);
          EXPECT_NEAR(seen.visibility, 1, 2e-3) << pitch << " at " << p.x << " " << p.y;
          EXPECT_LT(seen.gi.x, 1e-3);
          tested += bed.texel(p).depth > 0;
        });
      }
    }
    EXPECT_EQ(bed.outside, 0) << "fetched off the screen";
  }
  EXPECT_GT(tested, 500);
}

// Few texels: positions half a texel off would leave the plane.
TEST(Estimator, OpenPlaneReadsOneAtLowResolution) {
  Bed bed{{{floor_quad()}, {}, {}}, {{0, 1.7, 0}, {0, 0.7, -1}, 90, {20, 12}}};
  use(bed);
  for (int i = 0; i < 20 * 12; ++i) EXPECT_NEAR(mean(ivec2(i % 20, i / 20), thorough(16, 16), 1).visibility, 1, 2e-3);
}

// Slices uniform on the screen keep their bias (techniques.md 3.6), to be compared with.
TEST(Estimator, ScreenMeasureReadsWhatOthersRead) {
  Bed bed{{{floor_quad()}, {}, {}}, {{0, 1.7, 0}, {0, 1.7, -1}}};
  use(bed);
  twin::Params params = thorough(256, 4);
  params.slice_measure = twin::SLICES_SCREEN;
  ivec2 pixel = bed.camera.texel_of({0, 0, -1.7 / std::tan(30 * kDegree)});
  EXPECT_NEAR(mean(pixel, params, 1).visibility, 0.968, 2e-3);
}

// Rounding in the depth buffer, many times that of a float, shows nowhere, at grazing views neither.
TEST(Estimator, OpenPlaneForgivesDepthErrors) {
  Bed bed{{{floor_quad()}, {}, {}}, {{0, 1.7, 0}, {0, 1.4, -1}}};
  use(bed);
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> error(-1e-5f, 1e-5f);
  twin::fetch = [&](ivec2 p) {
    bed::Texel texel = bed.texel(p);
    texel.depth *= 1 + error(engine);
    return texel;
  };
  twin::Params params;
  params.thickness_mode = twin::THICKNESS_INFINITE;
  for_grid(bed.camera.size,
           [&](ivec2 p) { EXPECT_NEAR(mean(p, params, 64).visibility, 1, 5e-4) << p.x << " " << p.y; });
}

TEST(Estimator, OpenPlaneHasNoNoise) {
  Bed bed{{{floor_quad()}, {}, {}}, {{0, 1.7, 0}, {0, 1.2, -1}}};
  use(bed);
  twin::Params params;
  params.slices = 1;
  for (unsigned frame = 0; frame < 64; ++frame) {
    twin::bitmask = params;
    twin::frame.frame_index = frame;
    EXPECT_NEAR(twin::estimate_bitmask(ivec2(100, 900)).visibility, 1, 1e-6);
  }
}

TEST(Estimator, BackgroundIsOpenAndBlack) {
  Bed bed;
  use(bed);
  twin::Gathered seen = mean(ivec2(3, 3), twin::Params{}, 1);
  EXPECT_EQ(seen.visibility, 1);
  EXPECT_EQ(seen.gi, vec3(0));
}

// --- surfaces that see nothing but light: the weights' mean ---

// A slot one texel wide: everything around is nearer and reaches down, so each slice is covered from V to both
// horizons.
twin::Gathered slot(ivec2 pixel, vec3 normal, int measure, int slices, int frames) {
  look_through({});
  twin::fetch = [=](ivec2 p) {
    return bed::Texel{p == pixel ? 10.0f : 1e-3f, p == pixel ? normal : vec3(0, 0, 1), vec3(1, 2, 4), {}};
  };
  twin::Params params = thorough(slices, 4);
  params.slice_measure = measure;
  params.emitter = 1;
  return mean(pixel, params, frames);
}

TEST(Estimator, SlotIsAFurnaceEverywhere) {
  double worst_without_j = 0;
  for_grid(ivec2(1024) - 2, [&](ivec2 p) {
    p += 1;  // a texel of slot all round
    for (vec3 n : {vec3(0, 0, 1), glm::normalize(vec3(1, 2, 3)), glm::normalize(vec3(-3, 1, 2))}) {
      look_through({});
      vec3 v = -glm::normalize(twin::view_ray(glm::vec2(p) + 0.5f, twin::frame.ray_scale, twin::frame.ray_offset));
      if (glm::dot(n, v) < 0.1f) continue;
      for (int measure : {twin::SLICES_SCREEN_J, twin::SLICES_VIEW}) {
        twin::Gathered seen = slot(p, n, measure, 64, 1);
        EXPECT_NEAR(seen.gi.x, 1, 2e-3) << p.x << " " << p.y << " measure " << measure;
        EXPECT_NEAR(seen.gi.z, 4, 8e-3);
        EXPECT_NEAR(seen.visibility, 0, 2e-3);
      }
      worst_without_j = std::max(worst_without_j, std::abs(slot(p, n, twin::SLICES_SCREEN, 64, 1).gi.x - 1.0));
    }
  });
  EXPECT_GT(worst_without_j, 0.1) << "control: the test must notice a missing J";
}

// Visibility and light of white surroundings add to 1 for each pixel and frame, whatever is sampled (HBIL's far + near
// = 1).
TEST(Estimator, VisibilityAndWhiteLightAreComplements) {
  Bed bed{{{floor_quad(vec3(1))}, {{{0.3, 0.4, -3}, 0.5, vec3(1)}}, {{{-2, 0, -5}, {-1, 2, -4}, vec3(1)}}},
          {{0, 1.5, 0}, {0, 0.5, -3}}};
  use(bed);
  int occluded = 0;
  for (unsigned infinite : {0u, 1u}) {
    for (int slices : {1, 2, 5}) {
      for_grid(bed.camera.size, [&](ivec2 p) {
        if (bed.texel(p).depth <= 0) return;
        twin::Params params;
        params.slices = slices;
        params.thickness_mode = infinite ? twin::THICKNESS_INFINITE : twin::THICKNESS_CONSTANT;
        params.emitter = 1;
        twin::Gathered seen = mean(p, params, 1);
        EXPECT_NEAR(seen.visibility + seen.gi.x, 1, 1e-5);
        occluded += seen.visibility < 0.9f;
      });
    }
  }
  EXPECT_GT(occluded, 10);
}

// --- an infinite emissive wall ---

double wall_form(double beta) {
  return 0.5 * (1 - std::cos(beta * kDegree));
}

// Wall in the plane x = 1, up to elevation beta as seen from the origin.
Bed wall_bed(double beta, dvec3 eye, dvec3 target, vec3 radiance) {
  double height = std::tan(beta * kDegree);
  Bed bed{{{floor_quad()}, {}, {}}, {eye, target, 90, {4096, 4096}}};
  bed.scene.quads.push_back({{1, 0, -500}, {0, 0, 1000}, {0, height, 0}, radiance});
  return bed;
}

TEST(Estimator, EmissiveWall) {
  struct View {
    double beta;
    dvec3 eye, target;
  };
  // Across and aslant, from above and nearly along the floor; the wall runs out of the picture far to both sides.
  const View views[] = {{30, {-6, 4, 0}, {0.5, 0.3, 0}},    {30, {-3, 1, 4}, {0.5, 0.3, 0}},
                        {60, {-6, 4, 0}, {0.5, 0.8, 0}},    {60, {-6, 1, 3}, {0.5, 0.8, 0}},
                        {80, {-12, 6, 0}, {0.5, 2.5, 0}},   {80, {-12, 2, 5}, {0.5, 2.5, 0}},
                        {60, {-2.5, 9, 0.5}, {0.2, 0.5, 0}}};
  for (const View& view : views) {
    Bed bed = wall_bed(view.beta, view.eye, view.target, vec3(2, 1, 0.5));
    use(bed);
    ivec2 pixel = bed.camera.texel_of(dvec3(0));
    ASSERT_LT(glm::length(bed.texel(pixel).world), 0.02);
    twin::Gathered seen = mean(pixel, thorough(), 4);
    EXPECT_NEAR(seen.gi.y, wall_form(view.beta), 1e-2) << view.beta << " from " << view.eye.x;
    EXPECT_NEAR(seen.gi.x, 2 * wall_form(view.beta), 2e-2);
    EXPECT_NEAR(seen.visibility, 1 - wall_form(view.beta), 1e-2);
    EXPECT_EQ(bed.outside, 0);
    // Two slices a frame and the mean over frames come to the same.
    EXPECT_NEAR(mean(pixel, thorough(2), 128).gi.y, seen.gi.y, 4e-3);
  }
}

// Without J the same wall is wrong: the control of the test above.
TEST(Estimator, EmissiveWallWithoutTheAzimuthWeightMisses) {
  Bed bed = wall_bed(60, {-6, 4, 0}, {0.5, 0.8, -5}, vec3(1));  // the receiver 35 degrees off the axis
  use(bed);
  ivec2 pixel = bed.camera.texel_of(dvec3(0));
  twin::Params params = thorough();
  double right = mean(pixel, params, 4).visibility;
  params.slice_measure = twin::SLICES_VIEW;
  EXPECT_NEAR(mean(pixel, params, 4).visibility, right, 5e-3) << "two ways to the same measure";
  params.slice_measure = twin::SLICES_SCREEN;
  EXPECT_GT(std::abs(mean(pixel, params, 4).visibility - right), 0.01);
}

TEST(Estimator, WallShinesFromItsFrontOnly) {
  Bed bed = wall_bed(60, {-6, 4, 0}, {0.5, 0.8, 0}, vec3(1));
  use(bed);
  // As if every wall texel showed a surface turned away from the receiver.
  twin::fetch = [&](ivec2 p) {
    bed::Texel texel = bed.texel(p);
    if (texel.radiance.x > 0) texel.normal = -texel.normal;
    return texel;
  };
  ivec2 pixel = bed.camera.texel_of(dvec3(0));
  twin::Params params = thorough();
  twin::Gathered seen = mean(pixel, params, 1);
  EXPECT_EQ(seen.gi.x, 0);
  EXPECT_NEAR(seen.visibility, 1 - wall_form(60), 1e-2) << "it still occludes";
  params.emitter = 1;
  EXPECT_NEAR(mean(pixel, params, 1).gi.x, wall_form(60), 1.5e-2);
}

TEST(Estimator, RedAndGreenWallsLandOnTheirSides) {
  // A corridor along -z, 4 wide and 2 high, open above.
  Bed bed{{{floor_quad()}, {}, {}}, {{0, 3, 3}, {0, 0.5, -3}, 90, {2048, 2048}}};
  bed.scene.quads.push_back({{-2, 0, 100}, {0, 0, -200}, {0, 2, 0}, vec3(1, 0, 0)});
  bed.scene.quads.push_back({{2, 0, 100}, {0, 0, -200}, {0, 2, 0}, vec3(0, 1, 0)});
  use(bed);
  for (double x : {-1.5, -1.0, 0.0, 1.0, 1.5}) {
    twin::Gathered seen = mean(bed.camera.texel_of(dvec3(x, 0, -2)), thorough(), 2);
    EXPECT_NEAR(seen.gi.x, wall_form(std::atan(2 / (2 + x)) / kDegree), 1.5e-2) << x;
    EXPECT_NEAR(seen.gi.y, wall_form(std::atan(2 / (2 - x)) / kDegree), 1.5e-2) << x;
    EXPECT_EQ(seen.gi.z, 0);
  }
}

// --- rectangles ---

// Form factor from the floor at the origin, by the area form cos cos' / (pi d^2).
double form_factor(const Quad& quad) {
  constexpr int kGrid = 400;
  dvec3 normal = glm::cross(quad.u, quad.v);
  double sum = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    dvec3 at = quad.corner + (i % kGrid + 0.5) / kGrid * quad.u + (i / kGrid + 0.5) / kGrid * quad.v;
    double d2 = glm::dot(at, at);
    sum += std::max(at.y, 0.0) * std::abs(glm::dot(normal, at)) / (kPi * d2 * d2);
  }
  return sum / (kGrid * kGrid);
}

// Thin, and sampled densely enough that the thickness bridges the samples.
TEST(Estimator, EmissiveRectangles) {
  const Quad quads[] = {{{1, 0, -1}, {0, 0, 2}, {0, 1.5, 0}, vec3(1)},         // standing on the floor
                        {{1, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0}, vec3(1)},       // hanging
                        {{-0.5, 1, -0.75}, {1, 0, 0}, {0, 0, 1.5}, vec3(1)}};  // overhead, parallel
  const double truth[] = {form_factor(quads[0]), form_factor(quads[1]), form_factor(quads[2])};
  EXPECT_NEAR(form_factor({{1, 0, -10}, {0, 0, 20}, {0, 1, 0}}), wall_form(45), 1e-3);
  for (int i = 0; i < 3; ++i) {
    Bed bed{{{floor_quad(), quads[i]}, {}, {}}, {{-3, 0.4, 0.4}, {0, 0.6, 0}, 60, {4096, 4096}}};
    use(bed);
    twin::Params params = thorough(96, 4096);
    params.step_exponent = 1;
    params.thickness_mode = twin::THICKNESS_CONSTANT;
    params.thickness = 0.01f;
    twin::Gathered seen = mean(bed.camera.texel_of(dvec3(0)), params, 1);
    EXPECT_NEAR(seen.gi.x, truth[i], 1e-2) << i;
    EXPECT_NEAR(seen.visibility, 1 - truth[i], 1e-2) << i;
  }
}

// Infinite thickness closes the gap below a hanging rectangle.
TEST(Estimator, InfiniteThicknessReachesTheTangentPlane) {
  Bed bed{{{floor_quad()}, {}, {}}, {{-6, 1.5, 0}, {0.5, 0.8, 0}, 90, {4096, 4096}}};
  bed.scene.quads.push_back({{1, 1, -500}, {0, 0, 1000}, {0, std::tan(60 * kDegree) - 1, 0}, vec3(1)});
  use(bed);
  ivec2 pixel = bed.camera.texel_of(dvec3(0));
  twin::Params params = thorough();
  EXPECT_NEAR(mean(pixel, params, 2).visibility, 1 - wall_form(60), 1e-2);
  params.thickness_mode = twin::THICKNESS_CONSTANT;
  params.thickness = 0;  // then what is seen is left
  EXPECT_NEAR(mean(pixel, params, 2).visibility, 1 - (wall_form(60) - wall_form(45)), 2e-3);
  params.span = 1;
  EXPECT_EQ(mean(pixel, params, 1).visibility, 1) << "texels alone";
}

}  // namespace
