// ssao, ssdo, raymarch and hbil on the device: what the same text gives as C++ over the same texels; both modes run
// clean.
#include "gather_twin.h"
#include "gpu_fixture.h"
#include "scene/peaks.h"

namespace nf::test {
namespace {

using glm::ivec2;
using glm::vec3;

passes::FrameSettings settings_for(const char* technique, bool paper = false) {
  passes::FrameSettings settings;
  settings.technique = &passes::find_technique(technique);
  settings.gi.shared.radius = 0.8f;
  if (paper) passes::set_paper_mode(settings);
  return settings;
}

// A floor, a wall and a box that shines a little, in the sun and under the sky.
content::Builder corner() {
  content::Builder b;
  const auto white = b.material({.base_color = vec3(0.7f)});
  b.quad({-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}, white);
  b.quad({-3, 0, -2}, {3, 0, -2}, {3, 1.5f, -2}, {-3, 1.5f, -2}, b.material({.base_color = vec3(0.8f, 0.2f, 0.2f)}));
  b.box({0.3f, 0.3f, -0.6f}, vec3(0.3f), 0.4f,
        b.material({.base_color = vec3(0.2f, 0.8f, 0.2f), .emissive = vec3(0.5f)}));
  b.directional_light({0.3f, -1, -0.5f}, 3);
  return b;
}
const scene::Camera camera = look({-0.5f, 1.4f, 1.6f}, {0.2f, 0.3f, -0.8f}, 60);

class Gather : public GpuTest {
 protected:
  // The twin reads what the frame's layers say.
  void look_at(const Shot& shot, glm::uvec2 size, const scene::Scene& scene, const Request& request) {
    passes::FrameView view;
    view.camera = view.previous_camera = request.camera;
    view.size = size;
    view.seed = request.seed;
    const passes::FrameBlock block = passes::make_frame_block(view, scene, {});
    twin::frame.ray_scale = block.ray_scale;
    twin::frame.ray_offset = block.ray_offset;
    twin::frame.pixels_per_tangent = block.pixels_per_tangent;
    twin::frame.size = ivec2(size);
    twin::frame.frame_index = 0;
    twin::frame.seed = request.seed;
    const glm::mat3 turn(block.view_from_world);
    twin::fetch = [&shot, turn](ivec2 p) {
      const auto layer = [&](const char* name) {
        return vec3(shot.value(name, p, 0), shot.value(name, p, 1), shot.value(name, p, 2));
      };
      return bed::Texel{shot.value("depth", p), turn * layer("normal"), layer("radiance"), {}};
    };
  }
};

TEST_F(Gather, DeviceAndHostAgree) {
  scene::Scene scene = load(corner());
  scene.environment.color = {0.4f, 0.5f, 0.6f};
  for (const char* technique : {"ssao", "ssdo", "raymarch", "hbil"}) {
    const Request request{.size = {64, 36}, .camera = camera, .settings = settings_for(technique)};
    const Shot shot = shoot(scene, request);
    look_at(shot, request.size, scene, request);
    twin::bitmask = {};
    twin::gi.radius = 0.8f;
    twin::ssao = {};
    twin::ssdo = {};
    twin::raymarch = {};
    twin::hbil = {};
    int apart = 0, occluded = 0, lit = 0, count = 0;
    for (int i = 0; i < 64 * 36; ++i) {
      const ivec2 p(i % 64, i / 64);
      float visibility;
      vec3 light;
      if (technique == std::string("hbil")) {
        const twin::Lit seen = twin::estimate_hbil(p);
        visibility = seen.visibility, light = seen.gi;
      } else {
        const twin::Gathered seen = technique == std::string("ssao")   ? twin::estimate_ssao(p)
                                    : technique == std::string("ssdo") ? twin::estimate_ssdo(p)
                                                                       : twin::estimate_raymarch(p);
        visibility = seen.visibility, light = seen.gi;
      }
      // Halves hold 11 bits; here and there a point falls on the border of a texel.
      apart += std::abs(shot.value("visibility", p) - visibility) > 2e-3f ||
               std::abs(shot.value("gi_raw", p, 1) - light.y) > 2e-3f + 2e-3f * light.y;
      occluded += visibility < 0.9f;
      lit += light.y > 0.01f;
      ++count;
    }
    EXPECT_LT(apart, count / 50) << technique;
    EXPECT_GT(occluded, count / 20) << technique;
    EXPECT_GT(lit, count / 50) << technique;
  }
}

// ssdo.auto_radius is gi.radius by another way; a technique that does not know it keeps its own.
TEST_F(Gather, TheSceneGivesTheRadius) {
  scene::Scene scene = load(corner());
  scene.environment.color = {0.4f, 0.5f, 0.6f};
  const float peaks = scene::peak_distance(scene);
  EXPECT_GT(peaks, 0.1f);
  const auto pixels = [&](const char* technique, bool automatic, float radius) {
    Request request{.size = {48, 27}, .camera = camera, .settings = settings_for(technique)};
    request.settings.gi.ssdo.auto_radius = automatic;
    request.settings.gi.shared.radius = radius;
    EXPECT_EQ(passes::finds_radius(request.settings), automatic && technique == std::string("ssdo"));
    passes::find_radius(request.settings, scene);
    EXPECT_EQ(request.settings.gi.shared.radius, automatic && technique == std::string("ssdo") ? peaks : radius);
    request.settings.gi.shared.radius = radius;
    return shoot(scene, request).layer("visibility").pixels;
  };
  EXPECT_EQ(pixels("ssdo", true, 4), pixels("ssdo", false, peaks));
  EXPECT_NE(pixels("ssdo", false, 4), pixels("ssdo", false, peaks)) << "control";
  EXPECT_EQ(pixels("ssao", true, 4), pixels("ssao", false, 4));
}

TEST_F(Gather, BothModesGiveAllTheirOutputs) {
  scene::Scene scene = load(corner());
  scene.environment.color = {0.4f, 0.5f, 0.6f};
  for (const char* technique : {"ssao", "ssdo", "raymarch", "hbil"}) {
    for (const bool paper : {false, true}) {
      if (paper && passes::find_technique(technique).paper_mode.empty()) continue;
      const Shot shot =
          shoot(scene, {.size = {33, 19}, .camera = camera, .settings = settings_for(technique, paper), .frames = 2});
      float least = 1, most = 0, light = 0;
      for (int i = 0; i < 33 * 19; ++i) {
        const ivec2 p(i % 33, i / 33);
        least = std::min(least, shot.value("visibility", p));
        most = std::max(most, shot.value("visibility", p));
        light = std::max(light, shot.value("gi_raw", p));
      }
      EXPECT_LT(least, 0.9f) << technique << paper;
      // The sign of HBIL's equation 11 as printed makes tilted surfaces more open than open, or less than closed.
      const bool wrong_sign = paper && technique == std::string("hbil");
      EXPECT_GT(least, wrong_sign ? -1 : -0.1f) << technique << paper;
      EXPECT_NEAR(most, 1, wrong_sign ? 1 : 0.02f) << technique << paper;
      EXPECT_GT(light, 0.01f) << technique << paper;
    }
  }
  // Options that bring other inputs and passes.
  passes::FrameSettings settings = settings_for("ssao");
  const float plain =
      shoot(scene, {.size = {33, 19}, .camera = camera, .settings = settings}).value("gi_raw", {15, 10}, 2);
  settings.gi.ssao.ambient_share = 1;
  const float with_sky =
      shoot(scene, {.size = {33, 19}, .camera = camera, .settings = settings}).value("gi_raw", {15, 10}, 2);
  EXPECT_GE(with_sky, plain);
  settings.gi.ssao.bleed = 0;
  EXPECT_FALSE(shoot(scene, {.size = {33, 19}, .camera = camera, .settings = settings}).layers.contains("gi_raw"));
}

// ssao.specular: the light that is gathered is the direct light of the picture, and emission; without it, or where
// materials have no specular light, the diffuse part alone.
TEST_F(Gather, SpecularLightIsGatheredWhereAsked) {
  content::Builder b;
  b.quad({-3, 0, 3}, {3, 0, 3}, {3, 0, -1.2f}, {-3, 0, -1.2f},
         b.material({.base_color = vec3(0.6f), .metallic = 0.7f, .roughness = 0.5f}));
  b.quad({-3, 0, -1.2f}, {3, 0, -1.2f}, {3, 2, -1.2f}, {-3, 2, -1.2f}, b.material({.base_color = vec3(0.7f)}));
  b.point_light({0.3f, 0.6f, -1.1f}, 2);  // the eye sees it mirrored at the foot of the wall
  const scene::Scene scene = load(b);
  constexpr glm::uvec2 size{48, 27};
  const auto shot = [&](const char* technique, bool specular, bool lambert, bool bleed = true) {
    passes::FrameSettings settings = settings_for(technique);
    settings.gi.ssao.specular = specular;
    settings.gi.ssao.bleed = bleed;
    settings.material.lambert = lambert;
    return shoot(scene, {.size = size, .camera = camera, .settings = settings});
  };
  const auto light = [&](const Shot& of) {
    double all = 0;
    for (int i = 0; i < int(size.x * size.y); ++i)
      all += double(of.value("gi_raw", {i % int(size.x), i / int(size.x)}, 1));
    return all;
  };
  const Shot with = shot("ssao", true, false), without = shot("ssao", false, false);
  int apart = 0, shines = 0;
  for (int i = 0; i < int(size.x * size.y); ++i) {
    const ivec2 p(i % int(size.x), i / int(size.x));
    const float all = with.value("direct", p, 1), diffuse = with.value("direct_diffuse", p, 1);
    // 9 bits, and halves.
    apart += std::abs(with.value("radiance", p, 1) - all) > 0.004f * all + 1e-4f;
    apart += std::abs(without.value("radiance", p, 1) - diffuse) > 0.004f * diffuse + 1e-4f;
    shines += all > 1.2f * diffuse + 0.01f;
  }
  EXPECT_EQ(apart, 0);
  EXPECT_GT(shines, 40);
  EXPECT_GT(light(with), 1.05 * light(without));
  EXPECT_EQ(with.layer("visibility").pixels, without.layer("visibility").pixels);
  EXPECT_EQ(shot("ssao", true, true).layer("gi_raw").pixels, shot("ssao", false, true).layer("gi_raw").pixels)
      << "control: no specular light";
  EXPECT_EQ(shot("ssdo", true, false).layer("gi_raw").pixels, shot("ssdo", false, false).layer("gi_raw").pixels)
      << "control: ssao's alone";
  EXPECT_EQ(shot("ssao", true, false, false).layer("radiance").pixels, without.layer("radiance").pixels)
      << "nobody gathers";
  EXPECT_TRUE(passes::find_technique("ssao").gathers_specular(settings_for("ssao", true).gi)) << "as the report does";
}

// Figure 5 of the report: "the same tangent direction is repeated every fourth pixel on surfaces with the same normal".
TEST_F(Gather, TangentsRepeatEveryFourthPixel) {
  content::Builder b;
  b.quad({-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, b.material({}));
  const scene::Scene scene = load(b);
  const auto repeats = [&](bool paper) {
    passes::FrameSettings settings = settings_for("ssao", paper);
    settings.gi.ssao.blur = false;
    settings.gi.ssao.show = 1;
    const Shot shot = shoot(scene, {.size = {24, 16}, .camera = look({0, 2, 0}, {0, 0, -1}, 50), .settings = settings});
    const auto tangent = [&](int x, int y) {
      return 2.0f * vec3(shot.value("gi_raw", {x, y}, 0), shot.value("gi_raw", {x, y}, 1),
                         shot.value("gi_raw", {x, y}, 2)) -
             1.0f;
    };
    int fourth = 0, next = 0, count = 0;
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 20; ++x, ++count) {
        const vec3 here = tangent(x, y);
        EXPECT_NEAR(glm::length(here), 1, 3e-3f);
        fourth += glm::length(tangent(x + 4, y) - here) + glm::length(tangent(x, y + 4) - here) < 4e-3f;
        next += glm::length(tangent(x + 1, y) - here) < 4e-3f;
      }
    EXPECT_LT(next, count / 10);
    return double(fourth) / count;
  };
  EXPECT_EQ(repeats(true), 1);
  EXPECT_LT(repeats(false), 0.1) << "control: the default's noise does not";
}

// hbil.mips: the levels are means over surfaces, at sizes that cannot be halved too; light that is the same everywhere
// stays what it is, and small lamps make less noise.
TEST_F(Gather, LightFromMips) {
  const auto hbil = [&](bool mips) {
    passes::FrameSettings settings = settings_for("hbil");
    settings.gi.hbil.mips = mips;
    settings.gi.shared.radius = 4;
    settings.gi.shared.steps = 6;  // wide ones
    return settings;
  };
  scene::Scene scene = load(corner());
  scene.environment.color = {0.4f, 0.5f, 0.6f};
  for (const glm::uvec2 size : {glm::uvec2(51, 29), glm::uvec2(3, 5), glm::uvec2(1, 1)}) {
    const Request request{.size = size, .camera = camera, .settings = hbil(true)};
    const Shot shot = shoot(scene, request);
    look_at(shot, size, scene, request);
    twin::bitmask = {};
    twin::gi.radius = 4;
    twin::gi.steps = 6;
    twin::hbil = {};
    int apart = 0, from_texels = 0;
    for (int i = 0; i < int(size.x * size.y); ++i) {
      const ivec2 p(i % int(size.x), i / int(size.x));
      const auto differs = [&](bool mips) {
        twin::hbil.mips = mips;
        const float light = twin::estimate_hbil(p).gi.y;
        return std::abs(shot.value("gi_raw", p, 1) - light) > 2e-3f + 3e-3f * light;
      };
      apart += differs(true);
      from_texels += differs(false);
    }
    EXPECT_LE(apart, int(size.x * size.y) / 50) << size.x;
    EXPECT_GE(from_texels, size.x > 9 ? int(size.x * size.y) / 20 : 0) << "control";
  }

  // A room whose every face shines alike, and lamps on the walls of a dark one.
  for (const bool alike : {true, false}) {
    content::Builder b;
    const auto wall = b.material({.base_color = vec3(0), .emissive = vec3(alike ? 0.7f : 0)});
    const auto lamp = b.material({.base_color = vec3(0), .emissive = vec3(alike ? 0.7f : 20)});
    b.room({0, 1, 0}, vec3(1), wall);
    for (int i = 0; i < 9; ++i) {
      const float x = -0.8f + 0.2f * float(i), y = 0.3f + 0.17f * float(i), r = 0.04f, z = -0.999f;
      b.quad({x - r, y - r, z}, {x + r, y - r, z}, {x + r, y + r, z}, {x - r, y + r, z}, lamp);
    }
    const scene::Scene room = load(b);
    double variance[2] = {}, mean[2] = {};
    Shot shots[2];
    for (const bool mips : {false, true}) {
      constexpr uint32_t seeds = 6;
      std::vector<double> sum(64 * 36), squares(64 * 36);
      for (uint32_t seed = 1; seed <= seeds; ++seed) {
        shots[mips] = shoot(
            room,
            {.size = {64, 36}, .camera = look({0, 1, 0.9f}, {0, 0.9f, -1}, 80), .settings = hbil(mips), .seed = seed});
        for (size_t i = 0; i < sum.size(); ++i) {
          const double x = shots[mips].value("gi_raw", {int(i) % 64, int(i) / 64});
          sum[i] += x, squares[i] += x * x;
        }
      }
      for (size_t i = 0; i < sum.size(); ++i) {
        variance[mips] += (squares[i] - sum[i] * sum[i] / seeds) / (seeds - 1) / double(sum.size());
        mean[mips] += sum[i] / seeds / double(sum.size());
      }
    }
    if (alike) {
      for (int i = 0; i < 64 * 36; ++i) {
        const float x = shots[0].value("gi_raw", {i % 64, i / 64});
        EXPECT_NEAR(shots[1].value("gi_raw", {i % 64, i / 64}), x, 2e-3f * x + 1e-5f) << i;
      }
      EXPECT_GT(mean[0], 0.1);
    } else {
      std::printf("mips: variance x %.3f, mean x %.3f\n", variance[1] / variance[0], mean[1] / mean[0]);
      EXPECT_LT(variance[1], 0.7 * variance[0]);
      EXPECT_NEAR(mean[1] / mean[0], 1, 0.3);
    }
  }
}

TEST_F(Gather, HbilIsVbgiWithInfiniteThickness) {
  scene::Scene scene = load(corner());
  scene.environment.color = {0.4f, 0.5f, 0.6f};
  const auto shot = [&](const char* technique, int thickness_mode) {
    passes::FrameSettings settings = settings_for(technique);
    settings.gi.shared.thickness_mode = thickness_mode;
    settings.gi.shared.slices = 2;
    settings.gi.vbgi.span = 1;  // samples are texels, as hbil's
    return shoot(scene, {.size = {64, 36}, .camera = camera, .settings = settings});
  };
  const auto apart = [](const Shot& a, const Shot& b, const char* layer) {
    double sum = 0;
    for (int i = 0; i < 64 * 36; ++i)
      sum += std::abs(a.value(layer, {i % 64, i / 64}) - b.value(layer, {i % 64, i / 64}));
    return sum / (64 * 36);
  };
  const Shot hbil = shot("hbil", 0), solid = shot("vbgi", 3), thin = shot("vbgi", 0);
  EXPECT_LT(apart(hbil, solid, "visibility"), 2.0 / 255);
  EXPECT_LT(apart(hbil, solid, "gi_raw"), 2.0 / 255);
  EXPECT_GT(apart(hbil, thin, "visibility"), 2.0 / 255) << "control";
}

}  // namespace
}  // namespace nf::test
