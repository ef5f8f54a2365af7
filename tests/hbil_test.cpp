// hbil (shaders/gi/hbil.glsl as C++): its closed forms against quadrature, the bent cone, the far field through it, and
// the whole estimator over depth beds with known answers.
#include <gtest/gtest.h>
#include <random>

#include "gather_twin.h"

namespace {

using bed::Bed;
using glm::dvec3;
using glm::ivec2;
using glm::vec2;
using glm::vec3;
using twin::Baked;
using twin::floor_quad;
using twin::kDegree;
using twin::kPi;
using twin::use;

void defaults(float radius, int slices, int steps) {
  twin::bitmask = {};
  twin::gi.radius = radius;
  twin::gi.slices = slices;
  twin::gi.steps = steps;
  twin::hbil = {};
  twin::frame.frame_index = 0;
}

// The form that the paper prints, but the sign.
void local_space() {
  twin::hbil.space = 1;
  twin::hbil.reject = twin::REJECT_RUNNING;
  twin::hbil.cone = 1;
}

twin::Gathered mean(ivec2 pixel, int frames) {
  return twin::mean_gathered(pixel, frames, twin::estimate_hbil);
}

// --- closed forms ---

template <class F>
double integral(double from, double to, F f) {
  constexpr int n = 2000;  // midpoints
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += f(from + (to - from) * (i + 0.5) / n);
  return sum * (to - from) / n;
}

TEST(HbilForms, SlicesAgreeWithQuadrature) {
  double worst_printed = 0;
  for (int i = 0; i < 32; ++i)
    for (int j = 0; j < 32; ++j) {
      const double t0 = -kPi * (i + 0.5) / 32, t1 = kPi * (j + 0.5) / 32;
      const double x = integral(t0, t1, [](double t) { return std::sin(t) * std::abs(std::sin(t)); });
      const double y = integral(t0, t1, [](double t) { return std::cos(t) * std::abs(std::sin(t)); });
      const vec2 open = twin::open_slice(float(t0), float(t1), false);
      EXPECT_NEAR(open.x, x, 2e-5);
      EXPECT_NEAR(open.y, y, 2e-5);
      worst_printed = std::max(worst_printed, std::abs(twin::open_slice(float(t0), float(t1), true).x - x));
    }
  EXPECT_NEAR(twin::open_slice(float(-kPi / 2), float(kPi / 2), true).x, kPi / 2, 1e-5)
      << "printed: leans where it must not";
  EXPECT_NEAR(twin::open_slice(float(-kPi / 2), float(kPi / 2), false).x, 0, 1e-6);
  EXPECT_GT(worst_printed, 2);
}

TEST(HbilForms, IncrementsAgreeWithQuadratureAndAddUp) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> uniform(0, float(kPi));
  for (int i = 0; i < 1000; ++i) {
    float a = uniform(engine), b = uniform(engine), c = uniform(engine);
    if (a > b) std::swap(a, b);
    const vec2 n(std::cos(4 * c), std::sin(c));
    const double truth =
        integral(a, b, [&](double t) { return (n.x * std::sin(t) + n.y * std::cos(t)) * std::sin(t); });
    EXPECT_NEAR(twin::horizon_increment(n, a, b), truth, 2e-5);
    const float middle = 0.5f * (a + b);
    EXPECT_NEAR(twin::horizon_increment(n, a, middle) + twin::horizon_increment(n, middle, b), truth, 2e-5);
  }
}

// Light is what the openness loses: the two sides of equation 15.
TEST(HbilForms, IncrementsAreTheComplementOfTheOpenSlice) {
  for (float tilt : {-1.2f, -0.3f, 0.0f, 0.9f})
    for (float front : {0.2f, 0.9f, 1.4f}) {
      const vec2 n(std::sin(tilt), std::cos(tilt));
      const float plane = float(kPi / 2) + tilt, plane_back = float(kPi / 2) - tilt, risen = std::min(front, plane);
      const vec2 all = twin::open_slice(-plane_back, plane, false), open = twin::open_slice(-plane_back, risen, false);
      EXPECT_NEAR(glm::dot(n, all) - glm::dot(n, open), twin::horizon_increment(n, risen, plane), 1e-6);
    }
}

// Equation 19 drops an integral of Fresnel's term that "will influence at most 0.03 % of the final irradiance": its
// share of an open hemisphere's, by the angle between normal and view vector. The slices' increments are that
// irradiance.
TEST(HbilForms, TheFresnelIntegralThatIsDropped) {
  const auto dropped = [](double tilt) {
    constexpr int slices = 360, steps = 2000;
    double open = 0, lost = 0;
    for (int i = 0; i < slices; ++i) {
      const double across = std::sin(tilt) * std::cos((i + 0.5) * double(kPi) / slices), along = std::cos(tilt);
      for (const double side : {1.0, -1.0}) {
        // Down to the tangent plane.
        const double t = -side * across / along, horizon = std::acos(t / std::sqrt(1 + t * t));
        open += double(twin::horizon_increment(vec2(side * across, along), 0, float(horizon))) / slices;
        for (int k = 0; k < steps; ++k) {
          const double theta = (k + 0.5) * horizon / steps;
          lost += std::pow(1 - std::cos(theta / 2), 5) * (side * across * std::sin(theta) + along * std::cos(theta)) *
                  std::sin(theta) * horizon / steps / slices;
        }
      }
    }
    EXPECT_NEAR(open, 1, 1e-4) << tilt;
    return lost / open;
  };
  const double shares[] = {dropped(0), dropped(30 * double(kDegree)), dropped(60 * double(kDegree)),
                           dropped(80 * double(kDegree))};
  std::printf("dropped at 0, 30, 60, 80 degrees: %.3f, %.3f, %.2f, %.2f %%\n", 100 * shares[0], 100 * shares[1],
              100 * shares[2], 100 * shares[3]);
  EXPECT_LT(shares[0], 0.0003);
  EXPECT_NEAR(shares[0], 0.00008, 5e-6);
  EXPECT_NEAR(shares[1], 0.00054, 1e-5);
  EXPECT_NEAR(shares[2], 0.0050, 1e-4);
  EXPECT_NEAR(shares[3], 0.0167, 2e-4);
}

// --- the cone ---

TEST(HbilCone, RoundTripAndWhatThePrintedFormMakesOfIt) {
  const double printed[] = {41.41, 60.0, 75.52};
  for (int i = 0; i < 3; ++i) {
    const double alpha = (30 + 15 * i) * kDegree;
    const float cosine_ao = float(std::pow(std::sin(alpha), 2)), uniform_ao = float(1 - std::cos(alpha));
    twin::hbil.cone = twin::CONE_COSINE;
    EXPECT_NEAR(std::acos(twin::cone_cosine(cosine_ao, uniform_ao)), alpha, 1e-4);
    twin::hbil.cone = twin::CONE_UNIFORM;
    EXPECT_NEAR(std::acos(twin::cone_cosine(cosine_ao, uniform_ao)), alpha, 1e-4);
    twin::hbil.cone = 1;
    EXPECT_NEAR(std::acos(twin::cone_cosine(cosine_ao, uniform_ao)) / kDegree, printed[i], 0.01);
  }
  EXPECT_EQ(twin::energy_factor(1), 1) << "finite where the paper's second form is 0 / 0";
  EXPECT_EQ(twin::energy_factor(0), 0);
}

// Bands of irradiance through a cone: 2 pi times the integral of Y_l0 cos sin, over that of the hemisphere, and those
// are Ramamoorthi's constants.
TEST(HbilCone, BandsAgreeWithQuadrature) {
  const double y0 = 0.282095, y1 = 0.488603, y2 = 0.315392, hemisphere[] = {0.886227, 1.023328, 0.495416};
  const auto band = [&](int l, double top) {
    return 2 * kPi * integral(0, top, [&](double t) {
             const double c = std::cos(t), y = l == 0 ? y0 : l == 1 ? y1 * c : y2 * (3 * c * c - 1);
             return y * c * std::sin(t);
           });
  };
  vec3 last(0);
  for (double degrees : {1.0, 20.0, 45.0, 70.0, 90.0}) {
    const vec3 shares = twin::cone_bands(float(std::cos(degrees * kDegree)));
    for (int l = 0; l < 3; ++l) EXPECT_NEAR(shares[l] * hemisphere[l], band(l, degrees * kDegree), 1e-5) << l;
    // The third band's is greatest at 54.7 degrees, where 3 cos^2 - 1 changes its sign.
    EXPECT_EQ(shares.z > last.z, degrees < 60);
    EXPECT_GT(shares.x, last.x);
    EXPECT_GT(shares.y, last.y);
    last = shares;
  }
  EXPECT_LT(glm::length(last - vec3(1)), 1e-6);
}

// A random environment of second order through a cone: the bands' sum against integration over directions.
TEST(HbilCone, SphericalHarmonicsAgreeWithIntegration) {
  std::mt19937 engine(7);
  std::normal_distribution<float> normal;
  double worst = 0;
  for (int trial = 0; trial < 20; ++trial) {
    // Radiance 1 + a . d + d' Q d with Q symmetric and without trace: bands 0, 1 and 2 of it.
    const vec3 a = 0.2f * vec3(normal(engine), normal(engine), normal(engine));
    const float xy = 0.2f * normal(engine), yz = 0.2f * normal(engine), xz = 0.2f * normal(engine);
    const float xx = 0.2f * normal(engine), yy = 0.2f * normal(engine);
    const auto quadratic = [&](vec3 d) {
      return xx * d.x * d.x + yy * d.y * d.y - (xx + yy) * d.z * d.z +
             2 * (xy * d.x * d.y + yz * d.y * d.z + xz * d.x * d.z);
    };
    const vec3 axis = glm::normalize(vec3(normal(engine), normal(engine), normal(engine)));
    for (double degrees : {30.0, 60.0, 90.0}) {
      const double top = std::cos(degrees * kDegree);
      double truth = 0;
      constexpr int count = 20000;
      for (int i = 0; i < count; ++i) {
        const double z = top + (1 - top) * (i + 0.5) / count, r = std::sqrt(1 - z * z),
                     phi = 2 * kPi * 0.6180339887 * i;
        const vec3 d = twin::about(axis, vec3(r * std::cos(phi), r * std::sin(phi), z));
        truth += (1 + glm::dot(a, d) + quadratic(d)) * z / count * 2 * (1 - top);  // over pi
      }
      const vec3 shares = twin::cone_bands(float(top));
      const double sum = shares.x + 2.0 / 3 * shares.y * glm::dot(a, axis) + 0.25 * shares.z * quadratic(axis);
      worst = std::max(worst, std::abs(sum - truth) / std::abs(truth));
    }
  }
  std::printf("worst relative error of the cone's harmonics: %.5f\n", worst);
  EXPECT_LT(worst, 2e-3);
}

// --- the estimator ---

TEST(Hbil, OpenPlaneReadsOne) {
  for (double pitch : {-10.0, -35.0, -89.9}) {
    Bed bed{{{floor_quad(vec3(1))}, {}, {}},
            {{0, 1.7, 0}, {0, 1.7 + std::sin(pitch * kDegree), -std::cos(pitch * kDegree)}, 90, {512, 512}}};
    use(bed);
    twin::for_grid(bed.camera.size, [&](ivec2 p) {
      if (bed.texel(p).depth <= 0) return;
      defaults(50, 64, 16);
      const twin::Lit seen = twin::estimate_hbil(p);
      EXPECT_NEAR(seen.visibility, 1, 2e-3) << pitch << " at " << p.x << " " << p.y;
      EXPECT_LT(seen.gi.x, 1e-3);
      EXPECT_GT(glm::dot(seen.bent, bed.texel(p).normal), 0.9999f);
      EXPECT_NEAR(seen.ambient.x, 1, 2e-3);
      EXPECT_LT(seen.cone, 0.05f);
    });
    EXPECT_EQ(bed.outside, 0) << "fetched off the screen";
  }
}

// An infinite emissive wall: near field, far field and their sum; and that the paper's space misses it off the axis.
TEST(Hbil, EmissiveWall) {
  double worst_local = 0;
  for (double beta : {30.0, 60.0, 80.0}) {
    Bed bed{{{floor_quad(vec3(1))}, {}, {}}, {{-6, 4, 0}, {0.5, 0.8, 0}, 90, {2048, 2048}}};
    bed.scene.quads.push_back({{1, 0, -500}, {0, 0, 1000}, {0, std::tan(beta * kDegree), 0}, vec3(2, 1, 0.5)});
    use(bed);
    const ivec2 pixel = bed.camera.texel_of(dvec3(0));
    const double truth = 0.5 * (1 - std::cos(beta * kDegree));
    defaults(1000, 64, 256);
    const twin::Gathered seen = mean(pixel, 4);
    EXPECT_NEAR(seen.gi.y, truth, 1e-2) << beta;
    EXPECT_NEAR(seen.visibility, 1 - truth, 1e-2) << beta;
    EXPECT_NEAR(seen.ambient.x + seen.gi.y, 1, 1e-2) << "far and near in a white furnace";
    local_space();
    const twin::Gathered local = mean(pixel, 4);
    worst_local = std::max(worst_local, std::abs(local.visibility - (1 - truth)));
  }
  std::printf("wall: worst error of visibility in local space %.4f\n", worst_local);
}

// A furnace: everything shines alike; near and far field are complements, pixel by pixel.
TEST(Hbil, FarAndNearAreComplements) {
  Bed bed{{{}, {{{0.3, -0.6, -0.3}, 0.35, vec3(1)}}, {}}, {{-0.3, 0.2, 0.9}, {0, -0.3, -1}, 80, {128, 128}}};
  for (int axis = 0; axis < 3; ++axis)
    for (double side : {-1.0, 1.0}) {
      dvec3 corner(-1), u(0), v(0);
      corner[axis] = side;
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2;
      bed.scene.quads.push_back({corner, u, v, vec3(1)});
    }
  const Baked baked(bed);
  baked.use();
  int occluded = 0;
  double printed = 0;
  twin::for_grid({128, 128}, [&](ivec2 p) {
    defaults(10, 2, 16);
    twin::hbil.reject = 2;
    const twin::Lit seen = twin::estimate_hbil(p);
    EXPECT_NEAR(seen.visibility + seen.gi.x, 1, 1e-3);
    EXPECT_NEAR(seen.ambient.x + seen.gi.x, 1, 1e-2);
    twin::gi.slices = 32;
    local_space();
    const twin::Lit local = twin::estimate_hbil(p);
    EXPECT_NEAR(local.visibility + local.gi.x, 1, 0.03) << "slices about V: so many, so near";
    twin::hbil.printed_sign = 1;
    printed = std::max(printed, std::abs(twin::estimate_hbil(p).visibility + local.gi.x - 1.0));
    occluded += seen.visibility < 0.9f;
  });
  EXPECT_GT(occluded, 20);
  EXPECT_GT(printed, 0.1) << "control: with the printed sign they are not";
}

// With everything solid down to the tangent plane the bitmasks have horizons too.
TEST(Hbil, IsVbgiWithInfiniteThickness) {
  Bed bed{{{floor_quad(vec3(0.5f))},
           {{{0.3, 0.6, -3}, 0.4, vec3(0.2f, 1, 0.2f)}},
           {{{-1.5, 0, -4}, {-0.5, 1, -3}, vec3(1, 0.2f, 0.2f)}}},
          {{0, 1.5, 0}, {0, 0.4, -3}, 70, {128, 128}}};
  const Baked baked(bed);
  baked.use();
  double visibility = 0, light = 0;
  int count = 0;
  for (int y = 60; y < 128; y += 3)
    for (int x = 0; x < 128; x += 3) {
      defaults(4, 4, 16);
      const twin::Lit one = twin::estimate_hbil({x, y});
      twin::gi.thickness_mode = twin::THICKNESS_INFINITE;
      twin::bitmask.sectors = 5;                        // 128
      twin::bitmask.span = 1;                           // texels, as hbil's
      twin::bitmask.emitter = twin::EMITTER_ONE_SIDED;  // by the texel, as hbil does
      const twin::Gathered other = twin::estimate_bitmask({x, y});
      visibility += std::abs(one.visibility - other.visibility);
      light += std::abs(one.gi.x - other.gi.x);
      ++count;
    }
  std::printf("hbil against vbgi, infinite thickness: visibility %.5f, light %.5f\n", visibility / count,
              light / count);
  EXPECT_LT(visibility / count, 2.0 / 255);
  EXPECT_LT(light / count, 2.0 / 255);
}

TEST(Hbil, LightOfSurfacesTurnedAway) {
  Bed bed{{{floor_quad(vec3(0))}, {}, {}}, {{-6, 4, 0}, {0.5, 0.8, 0}, 90, {512, 512}}};
  bed.scene.quads.push_back({{1, 0, -500}, {0, 0, 1000}, {0, 1.7, 0}, vec3(1)});
  use(bed);
  const ivec2 pixel = bed.camera.texel_of(dvec3(0));
  twin::fetch = [&](ivec2 p) {
    bed::Texel texel = bed.texel(p);
    if (texel.radiance.x > 0) texel.normal = -texel.normal;
    return texel;
  };
  defaults(100, 16, 64);
  const twin::Gathered away = mean(pixel, 1);
  EXPECT_EQ(away.gi.x, 0);
  EXPECT_LT(away.visibility, 0.8f) << "it still occludes";
  twin::hbil.reject = twin::REJECT_RUNNING;
  EXPECT_LT(mean(pixel, 1).gi.x, 0.02) << "the dark floor's light stays";
  twin::hbil.reject = twin::REJECT_CODE;
  EXPECT_LT(mean(pixel, 1).gi.x, 0.02) << "no trust left where it might be tolerant, higher up";
  twin::hbil.reject = 2;
  const float all = mean(pixel, 1).gi.x;
  EXPECT_GT(all, 0.2);
  // Turned to the receiver all count fully, but with the code's fade.
  use(bed);
  twin::hbil.reject = 0;
  EXPECT_NEAR(mean(pixel, 1).gi.x, all, 1e-6);
  twin::hbil.reject = twin::REJECT_CODE;
  EXPECT_LT(mean(pixel, 1).gi.x, 0.99 * all);
  EXPECT_GT(mean(pixel, 1).gi.x, 0.7 * all);
}

// The filter of the author's code (ComputeHBIL_Interleaved.hlsl, BilateralFilterDepth and SampleIrradiance_TEMP)
// written out once more, in double precision and with the code's own signs, over sides of random samples.
TEST(Hbil, RejectionAsInTheCode) {
  struct Code {
    double weight = 1;
    dvec3 radiance;
    void sample(dvec3 center_to_sample, dvec3 center_normal, dvec3 normal, dvec3 sampled, bool vertical) {
      const auto saturate = [](double x) { return std::clamp(x, 0.0, 1.0); };
      const auto smooth = [&](double a, double b, double x) {
        const double t = saturate((x - a) / (b - a));
        return t * t * (3 - 2 * t);
      };
      const double distance = glm::length(center_to_sample);
      const dvec3 to_center = -center_to_sample / distance;
      const double verticality = vertical ? smooth(0.5, 0.9, saturate(-glm::dot(to_center, center_normal))) : 0;
      const double low = (1 - verticality) * -0.04 + verticality * -0.8,
                   high = (1 - verticality) * -0.02 + verticality * -0.4;
      weight *= smooth(low, high, glm::dot(to_center, normal));
      const double fade = 1 - saturate(0.5 * distance) * std::pow(1 - saturate(glm::dot(to_center, normal)), 2);
      radiance = (1 - weight) * radiance + weight * fade * sampled;
    }
  };
  std::mt19937 engine(3);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform;
  const auto direction = [&] { return glm::normalize(vec3(normal(engine), normal(engine), normal(engine))); };
  constexpr int samples = 6;
  double worst = 0, without_verticality = 0, other = 0;
  int faded = 0, trusted = 0;
  defaults(4, 1, samples);
  for (int side = 0; side < 500; ++side) {
    std::vector<bed::Texel> texels(samples + 1);
    for (bed::Texel& texel : texels) {
      texel.normal = direction();
      texel.radiance = vec3(uniform(engine), uniform(engine), uniform(engine));
    }
    twin::fetch = [&](ivec2 p) { return texels.at(size_t(p.x)); };
    twin::Receiver receiver{};
    receiver.pixel = {samples, 0};
    receiver.normal = direction();
    Code code{1, texels[samples].radiance}, flat = code;
    twin::Running running = twin::start_running(receiver), blended = running;
    for (int i = 0; i < samples; ++i) {
      twin::Tap tap{};
      tap.texel = {i, 0};
      tap.towards = 3 * uniform(engine) * direction();
      // Over the receiver's plane, and mostly turned to it: else trust is gone with the first.
      if (glm::dot(tap.towards, receiver.normal) < 0) tap.towards = -tap.towards;
      if (uniform(engine) < 0.7f) texels[size_t(i)].normal = -glm::normalize(tap.towards + 0.8f * direction());
      twin::hbil.reject = twin::REJECT_CODE;
      const vec3 light = twin::sample_light(receiver, tap, 0, running);
      code.sample(tap.towards, receiver.normal, texels[size_t(i)].normal, texels[size_t(i)].radiance, true);
      flat.sample(tap.towards, receiver.normal, texels[size_t(i)].normal, texels[size_t(i)].radiance, false);
      twin::hbil.reject = twin::REJECT_RUNNING;
      const vec3 blend = twin::sample_light(receiver, tap, 0, blended);
      worst = std::max(worst, glm::length(dvec3(light) - code.radiance));
      without_verticality = std::max(without_verticality, glm::length(flat.radiance - code.radiance));
      other = std::max(other, glm::length(dvec3(blend) - code.radiance));
      faded += running.trust < 0.01f;
      trusted += running.trust > 0.99f;
    }
  }
  // Radiance has 9 bits, a normal 16.
  EXPECT_LT(worst, 5e-3);
  EXPECT_GT(without_verticality, 0.3) << "control";
  EXPECT_GT(other, 0.3) << "control: the paper's text is another filter";
  EXPECT_GT(faded, 300);
  EXPECT_GT(trusted, 300);
}

// Section 2.1: without the normal a tilted surface is no more open than one that faces the eye.
TEST(Hbil, HorizonsStartAtTheTangentPlane) {
  Bed bed{{{floor_quad(vec3(0))}, {}, {}}, {{0, 2, 0}, {0, 1, -2}, 60, {256, 256}}};
  use(bed);
  defaults(5, 32, 16);
  local_space();
  const float with = twin::estimate_hbil({128, 140}).visibility;
  twin::hbil.normal_start = 0;
  const float without = twin::estimate_hbil({128, 140}).visibility;
  EXPECT_NEAR(with, 1, 0.03);
  EXPECT_LT(without, with - 0.05f);
}

}  // namespace
