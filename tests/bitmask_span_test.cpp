// What a sample of the bitmasks stands for (shaders/gi/span.glsl): with few wide steps and next to no thickness,
// surfaces cover what they cover; samples that stand for their texels alone, the control, leave out most of it.
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>

#include "slice_twin.h"

namespace {

using bed::Bed;
using bed::Quad;
using glm::dvec3;
using glm::ivec2;
using glm::vec3;
using twin::floor_quad;
using twin::kDegree;
using twin::kPi;
using twin::mean;
using twin::use;

constexpr int kPoint = 1;

// Next to no thickness: what is covered is what is seen.
twin::Params thin(int slices, int steps) {
  twin::Params params = twin::thorough(slices, steps);
  params.thickness_mode = twin::THICKNESS_CONSTANT;
  params.thickness = 1e-3f;
  return params;
}

double wall_form(double beta) {
  return 0.5 * (1 - std::cos(beta * kDegree));
}

Bed wall_bed(double beta, dvec3 eye, dvec3 target) {
  Bed bed{{{floor_quad()}, {}, {}}, {eye, target, 90, {4096, 4096}}};
  bed.scene.quads.push_back({{1, 0, -500}, {0, 0, 1000}, {0, std::tan(beta * kDegree), 0}, vec3(1)});
  return bed;
}

TEST(Span, AWallIsWholeWhateverTheSteps) {
  struct View {
    double beta;
    dvec3 eye, target;
    int fewest;  // the wall is wider than a step
  };
  for (const View& view : {View{30, {-6, 4, 0}, {0.5, 0.3, 0}, 8}, View{60, {-6, 4, 0}, {0.5, 0.8, 0}, 8},
                           View{60, {-6, 1, 3}, {0.5, 0.8, 0}, 8}, View{60, {-2.5, 9, 0.5}, {0.2, 0.5, 0}, 64}}) {
    Bed bed = wall_bed(view.beta, view.eye, view.target);
    use(bed);
    const ivec2 pixel = bed.camera.texel_of(dvec3(0));
    for (int steps = view.fewest; steps <= 64; steps *= 2) {
      twin::Params params = thin(64, steps);
      const twin::Gathered seen = mean(pixel, params, 16);
      EXPECT_NEAR(seen.visibility, 1 - wall_form(view.beta), 1e-2)
          << view.beta << " from " << view.eye.x << " " << steps;
      EXPECT_NEAR(seen.gi.x, wall_form(view.beta), 1e-2);
      params.span = kPoint;
      EXPECT_GT(mean(pixel, params, 4).visibility, 1 - 0.3 * wall_form(view.beta)) << "control";
    }
    EXPECT_EQ(bed.outside, 0) << "fetched off the screen";
  }
}

// With thickness, too: few steps find what dense texels alone find.
TEST(Span, FewStepsAreWhatManyTexelsAre) {
  Bed bed{{{floor_quad()}, {}, {}}, {{-6, 3, 0}, {0.5, 0.8, 0}, 90, {4096, 4096}}};
  bed.scene.quads.push_back({{1, 1, -500}, {0, 0, 1000}, {0, 0.73, 0}, vec3(1)});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  for (float thickness : {0.1f, 0.3f})
    for (int back_along : {0, 1}) {
      twin::Params params = twin::thorough(64, 4096);
      params.thickness_mode = twin::THICKNESS_CONSTANT;
      params.thickness = thickness;
      params.back_along = back_along;
      params.span = kPoint;
      const double dense = mean(pixel, params, 2).visibility;
      params.steps = 32;
      const double points = mean(pixel, params, 8).visibility;
      params.span = 0;
      EXPECT_NEAR(mean(pixel, params, 8).visibility, dense, 4e-3) << thickness << " " << back_along;
      EXPECT_GT(points, dense + 8e-3) << "control";
    }
}

double form_factor(const Quad& quad) {
  constexpr int kGrid = 400;
  const dvec3 normal = glm::cross(quad.u, quad.v);
  double sum = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const dvec3 at = quad.corner + (i % kGrid + 0.5) / kGrid * quad.u + (i / kGrid + 0.5) / kGrid * quad.v;
    const double d2 = glm::dot(at, at);
    sum += std::max(at.y, 0.0) * std::abs(glm::dot(normal, at)) / (kPi * d2 * d2);
  }
  return sum / (kGrid * kGrid);
}

// Narrower than a step, standing, hanging, and overhead, which shows the receiver its back: seldom met, and the mean is
// right.
TEST(Span, NarrowThingsCountWhatTheyCoverInTheMean) {
  const Quad quads[] = {{{1, 0, -0.05}, {0, 0, 0.1}, {0, 1.2, 0}, vec3(1)},
                        {{1, 0.5, -0.5}, {0, 0, 1}, {0, 0.1, 0}, vec3(1)},
                        {{-0.1, 1, -0.75}, {0.2, 0, 0}, {0, 0, 1.5}, vec3(1)}};
  for (const Quad& quad : quads) {
    const double truth = form_factor(quad);
    Bed bed{{{floor_quad(), quad}, {}, {}}, {{-3, 0.4, 0.4}, {0, 0.6, 0}, 60, {2048, 2048}}};
    use(bed);
    const ivec2 pixel = bed.camera.texel_of(dvec3(0));
    twin::Params params = thin(64, &quad == &quads[2] ? 32 : 12);
    params.step_exponent = 1;
    EXPECT_NEAR(mean(pixel, params, 64).visibility, 1 - truth, 0.15 * truth) << quad.corner.x;
    params.span = kPoint;
    EXPECT_GT(mean(pixel, params, 16).visibility, 1 - 0.3 * truth) << "control";
  }
}

// Each frame by itself: spans on one surface abut, so where its samples fall makes little difference.
TEST(Span, SpansOfOneSurfaceAbut) {
  Bed bed = wall_bed(85, {-6, 4, 0}, {0.5, 0.8, 0});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  double spread[2];
  for (int span : {0, kPoint}) {
    twin::bitmask = thin(1, 48);
    twin::bitmask.span = span;
    twin::bitmask.sectors = 5;
    if (span == kPoint) twin::bitmask.thickness = 0.1f;
    // The same slice; only where the steps' samples are differs.
    double low = 1, high = 0;
    for (float noise = 0.01f; noise < 1; noise += 0.02f) {
      const twin::Receiver receiver = twin::make_receiver(pixel);
      const vec3 direction = twin::screen_direction(float(kPi / 2) - 0.02f);
      const twin::Slice slice = twin::make_slice(receiver.v, receiver.normal, direction);
      const float total = twin::slice_total(slice.cos_gamma, slice.sin_gamma, twin::slice_k(slice.sin_gamma));
      twin::Side side = twin::make_side(receiver, slice, direction, 1);
      side.noise = noise;
      twin::Tally tally{twin::empty_mask(), 0, vec3(0)};
      twin::walk(receiver, slice, side, twin::make_scale(slice, total, 1, 0.5f), tally);
      int covered = 0;
      for (int word = 0; word < 4; ++word) covered += std::popcount(tally.covered.words[word]);
      low = std::min(low, covered / 128.0), high = std::max(high, covered / 128.0);
    }
    spread[span] = high - low;
    if (span == 0) {
      EXPECT_GT(low, 0.1) << "the wall must be there";
    }
  }
  EXPECT_LE(spread[0], 0.04);
  EXPECT_GT(spread[kPoint], 2 * spread[0]) << "control";
}

// The receiver's own plane stays on its horizon however wide the steps and grazing the view.
TEST(Span, OpenPlaneReadsOneWithTwoSteps) {
  for (double drop : {0.05, 0.5, 3.0}) {
    Bed bed{{{floor_quad(vec3(1))}, {}, {}}, {{0, 1.7, 0}, {0, 1.7 - drop, -1}, 90, {160, 90}}};
    use(bed);
    for (int i = 0; i < 40; ++i) {
      const ivec2 pixel(i * 37 % 160, 46 + i * 7 % 44);
      const twin::Gathered seen = mean(pixel, thin(8, 2), 4);
      EXPECT_NEAR(seen.visibility, 1, 1e-3) << drop << " at " << pixel.x << " " << pixel.y;
    }
    EXPECT_EQ(bed.outside, 0) << "fetched off the screen";
  }
}

}  // namespace
