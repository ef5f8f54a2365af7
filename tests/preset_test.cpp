// The presets that follow others' published formulas (content/presets): each is read as a user's file is, and what it
// makes of a technique is held against the formulas written out here, in double precision, over the texels that the
// technique reads.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "frame.h"
#include "gather_twin.h"

namespace {

using bed::Bed;
using glm::dvec2;
using glm::dvec3;
using glm::ivec2;
using glm::vec3;

nf::passes::FrameSettings read(const std::string& name) {
  std::ifstream file(std::string(NF_SOURCE_DIR) + "/content/presets/" + name + ".json");
  const nlohmann::json preset = nlohmann::json::parse(file);
  EXPECT_EQ(preset.at("schema"), "nearfield.preset/1");
  nf::passes::FrameSettings settings;
  settings.technique = &nf::passes::find_technique(preset.at("technique").get<std::string>());
  if (preset.at("mode") == "paper") nf::passes::set_paper_mode(settings);
  nf::params::from_json(settings.blocks(), preset.at("params"));
  return settings;
}

#define COPY(type, name, value, low, high, unit, help) to.name = from.name;
// To the twin's parameters. Returns the technique's name.
std::string use_preset(const std::string& name) {
  const nf::passes::FrameSettings settings = read(name);
  {
    auto& to = twin::bitmask;
    to = {};
    const auto& from = settings.gi.shared;
    NF_GI_PARAMS(COPY)
  }
  const std::string technique = settings.technique->id;
  if (technique == "vbgi") {
    auto& to = twin::bitmask;
    const auto& from = settings.gi.vbgi;
    NF_VBGI_PARAMS(COPY)
  }
  if (technique == "vbao") {
    auto& to = twin::bitmask;
    const auto& from = settings.gi.vbao;
    NF_BITMASK_PARAMS(COPY)
  }
  if (technique == "gtao") {
    auto& to = twin::horizon;
    to = {};
    const auto& from = settings.gi.gtao;
    NF_HORIZON_PARAMS(COPY)
  }
  if (technique == "ssao") {
    auto& to = twin::ssao;
    const auto& from = settings.gi.ssao;
    NF_SSAO_PARAMS(COPY)
  }
  if (technique == "ssdo") {
    auto& to = twin::ssdo;
    const auto& from = settings.gi.ssdo;
    NF_SSDO_PARAMS(COPY)
  }
  if (technique == "hbil") {
    auto& to = twin::hbil;
    const auto& from = settings.gi.hbil;
    NF_HBIL_PARAMS(COPY)
  }
  twin::frame.frame_index = 0;
  return technique;
}
#undef COPY

// A floor, a ball above it, a box on it, a wall behind.
const Bed& still_life() {
  static const Bed bed = [] {
    Bed b{{{twin::floor_quad(vec3(0.5f))},
           {{{0.2, 0.35, -2.4}, 0.3, vec3(0.2f, 1, 0.2f)}},
           {{{-1.0, 0, -3.2}, {-0.3, 0.7, -2.5}, vec3(1, 0.2f, 0.2f)}}},
          {{0, 1.3, 0}, {0, 0.2, -2.6}, 60, {128, 128}}};
    b.scene.quads.push_back({{-4, 0, -3.6}, {8, 0, 0}, {0, 3, 0}, vec3(0.3f, 0.3f, 1)});
    return b;
  }();
  return bed;
}

struct Pixel {
  ivec2 at;
  dvec3 position, v, normal;
};

class Presets : public testing::Test {
 protected:
  Presets() : baked_(still_life()) {}
  dvec3 position(ivec2 p) const {
    const dvec2 t = still_life().camera.tangents();
    const double z = texel(p).depth;
    return dvec3((2 * (p.x + 0.5) / 128 - 1) * t.x, (1 - 2 * (p.y + 0.5) / 128) * t.y, -1) * z;
  }
  const bed::Texel& texel(ivec2 p) const { return baked_.texels.at(size_t(p.y * 128 + p.x)); }
  // The texels that one run reads, in order, without repeats in a row.
  template <class F>
  std::vector<ivec2> reads(ivec2 pixel, F run) {
    std::vector<ivec2> all;
    twin::fetch = [&](ivec2 p) {
      if (p != pixel && (all.empty() || all.back() != p)) all.push_back(p);
      return texel(p);
    };
    run();
    return all;
  }
  // Calls visit(pixel, noise) over a grid of what is not background.
  template <class Visit>
  void over_pixels(Visit visit) {
    for (int y = 20; y < 128; y += 9)
      for (int x = 4; x < 128; x += 9) {
        const ivec2 p(x, y);
        if (texel(p).depth <= 0) continue;
        const dvec3 at = position(p);
        visit(Pixel{p, at, -glm::normalize(at), dvec3(texel(p).normal)}, twin::sampling_noise(p, 0, 0));
      }
  }
  twin::Baked baked_;
};

// The post's slice (HDRP's): n is the angle of the projected normal, from V, positive to the side of -d.
struct SlicePlane {
  dvec3 direction, across;
  double length, n;
};
SlicePlane slice_plane(const Pixel& pixel, double azimuth) {
  SlicePlane s;
  s.direction = {std::cos(azimuth), std::sin(azimuth), 0};
  const dvec3 normal = glm::normalize(glm::cross(s.direction, pixel.v));
  const dvec3 projected = pixel.normal - normal * glm::dot(pixel.normal, normal);
  s.length = glm::length(projected);
  s.across = glm::cross(pixel.v, normal);
  const double cosine = std::clamp(glm::dot(projected, pixel.v) / s.length, -1.0, 1.0);
  s.n = -(glm::dot(projected, s.across) > 0 ? 1 : -1) * std::acos(cosine);
  return s;
}

TEST_F(Presets, AllAreReadWithoutComplaint) {
  int count = 0;
  for (const auto& file : std::filesystem::directory_iterator(std::string(NF_SOURCE_DIR) + "/content/presets")) {
    if (!file.is_regular_file()) continue;  // the folders are sets for `bench`
    EXPECT_NO_THROW(read(file.path().stem().string())) << file.path();
    ++count;
  }
  EXPECT_EQ(count, 10);
}

// Algorithm 1 with the post's UpdateSectors: uniform angles, widths rounded by the rule, line 23 for light. EEVEE
// instead of the receiver's cosine weighs the sectors by it, four bands of equal angle by their means, and behind a
// sample is an angle.
TEST_F(Presets, VisibilityBitmasks) {
  struct Case {
    const char* name;
    int sectors;
    double (*width)(double);
    bool eevee = false;
  };
  const auto round_half_up = [](double x) { return std::floor(x + 0.5); };
  const auto up = [](double x) { return std::ceil(x); };
  for (const Case& c : {Case{"vb-paper", 32, round_half_up}, Case{"vb-post", 32, up}, Case{"ssrt3-like", 32, up},
                        Case{"bevy-like", 4, up}, Case{"eevee-like", 32, up, true}}) {
    const bool light = use_preset(c.name) == "vbgi";
    if (c.eevee) twin::bitmask.slices = 1;  // one of its two: the sides of several cannot be told apart by their taps
    const auto worth = [&](int sector) {
      if (!c.eevee) return 1.0;
      const double band = std::floor(std::abs((sector + 0.5) / c.sectors - 0.5) * 8);
      return 4 * (std::sin((band + 1) * twin::kPi / 8) - std::sin(band * twin::kPi / 8));
    };
    const int slices = twin::gi.slices;
    double apart = 0, light_apart = 0, occluded = 0;
    int count = 0;
    over_pixels([&](const Pixel& pixel, vec3 noise) {
      twin::Gathered seen;
      const std::vector<ivec2> taps = reads(pixel.at, [&] { seen = twin::estimate_bitmask(pixel.at); });
      if (slices > 1 && light) return;
      double visibility = 0, red = 0;
      size_t tap = 0;
      for (int i = 0; i < slices; ++i) {
        const SlicePlane s = slice_plane(pixel, (i + double(noise.x)) * twin::kPi / slices);
        std::vector<bool> mask(size_t(c.sectors));
        // The taps of this slice: those on its line; others follow.
        for (; tap < taps.size(); ++tap) {
          const dvec2 offset = dvec2(taps[tap] - pixel.at) * dvec2(1, -1);
          const double beside = std::abs(offset.x * s.direction.y - offset.y * s.direction.x);
          if (beside > 0.75 && i + 1 < slices) break;
          const dvec3 delta = position(taps[tap]) - pixel.position,
                      back = c.eevee ? delta : delta - pixel.v * double(twin::gi.thickness);
          const double side = offset.x * s.direction.x + offset.y * s.direction.y > 0 ? 1 : -1;
          const auto place = [&](dvec3 d, double turn) {
            const double angle = std::acos(std::clamp(glm::dot(glm::normalize(d), pixel.v), -1.0, 1.0)) + turn;
            return std::clamp((-side * angle - s.n + twin::kPi / 2) / twin::kPi, 0.0, 1.0);
          };
          const double a = place(delta, 0), b = place(back, c.eevee ? glm::radians(5.0) : 0),
                       low = std::min(a, b) * c.sectors;
          const int first = int(low), last = std::min(first + int(c.width(std::abs(b - a) * c.sectors)), c.sectors);
          double fresh = 0;
          for (int j = first; j < last; ++j)
            if (!mask[size_t(j)]) mask[size_t(j)] = true, fresh += worth(j);
          const dvec3 l = glm::normalize(delta);
          const double receiver = c.eevee ? 1 : std::max(glm::dot(pixel.normal, l), 0.0);
          red += fresh / c.sectors * texel(taps[tap]).radiance.x * receiver *
                 std::max(-glm::dot(dvec3(texel(taps[tap]).normal), l), 0.0) / slices;
        }
        double covered = 0;
        for (int j = 0; j < c.sectors; ++j) covered += mask[size_t(j)] ? worth(j) : 0;
        visibility += (1 - covered / c.sectors) / slices;
      }
      apart += std::abs(visibility - seen.visibility);
      if (light) light_apart += std::abs(red - seen.gi.x);
      occluded += 1 - visibility;
      ++count;
    });
    // A sector here and there: the technique takes acos from a polynomial.
    EXPECT_LT(apart / count, 0.1 / c.sectors + 0.015) << c.name;
    EXPECT_LT(light_apart / count, 0.01) << c.name;
    EXPECT_GT(occluded / count, 0.05) << c.name;
  }
}

// GTAO's inner integral with XeGTAO's falloff: cosines mixed towards the tangent plane's.
TEST_F(Presets, GroundTruthAmbientOcclusion) {
  for (const char* name : {"xegtao-high", "hdrp-gtao"}) {
    use_preset(name);
    const int slices = twin::gi.slices;
    double apart = 0, occluded = 0;
    int count = 0;
    over_pixels([&](const Pixel& pixel, vec3 noise) {
      twin::Openness seen;
      const std::vector<ivec2> taps = reads(pixel.at, [&] { seen = twin::estimate_horizons(pixel.at); });
      double visibility = 0;
      size_t tap = 0;
      for (int i = 0; i < slices; ++i) {
        const SlicePlane s = slice_plane(pixel, (i + double(noise.x)) * twin::kPi / slices);
        // n as in XeGTAO: positive to the side of +d.
        const double n = -s.n;
        const double low[2] = {std::cos(twin::kPi / 2 - n),
                               std::cos(twin::kPi / 2 + n)};  // tangent plane, sides -d, +d
        double highest[2] = {low[0], low[1]};
        for (; tap < taps.size(); ++tap) {
          const dvec2 offset = dvec2(taps[tap] - pixel.at) * dvec2(1, -1);
          if (std::abs(offset.x * s.direction.y - offset.y * s.direction.x) > 0.75 && i + 1 < slices) break;
          const int side = offset.x * s.direction.x + offset.y * s.direction.y > 0 ? 1 : 0;
          const dvec3 delta = position(taps[tap]) - pixel.position;
          const double r = twin::gi.radius, far = glm::length(delta);
          const double weight = std::clamp((r - far) / (twin::gi.falloff * r), 0.0, 1.0);
          highest[side] = std::max(highest[side], glm::mix(low[side], glm::dot(delta, pixel.v) / far, weight));
        }
        const double h0 = std::max(-std::acos(std::clamp(highest[0], -1.0, 1.0)), n - twin::kPi / 2);
        const double h1 = std::min(std::acos(std::clamp(highest[1], -1.0, 1.0)), n + twin::kPi / 2);
        const auto arc = [&](double h) { return (std::cos(n) + 2 * h * std::sin(n) - std::cos(2 * h - n)) / 4; };
        visibility += s.length * (arc(h0) + arc(h1)) / slices;
      }
      apart += std::abs(visibility - seen.visibility);
      occluded += 1 - visibility;
      ++count;
    });
    EXPECT_LT(apart / count, 0.01) << name;
    EXPECT_GT(occluded / count, 0.02) << name;
  }
}

// The texel and depth at which a point of view space appears.
struct Seen {
  ivec2 texel;
  bool on_screen;
  double depth;
};
Seen project(dvec3 p) {
  const dvec2 t = still_life().camera.tangents();
  const dvec2 at = (dvec2(p.x / -p.z / t.x, -p.y / -p.z / t.y) * 0.5 + 0.5) * 128.0;
  const ivec2 texel(glm::floor(at));
  return {texel, texel.x >= 0 && texel.y >= 0 && texel.x < 128 && texel.y < 128, -p.z};
}

// Report 003: 16 points of the kernel, quadratic range check, equation 1, the filter of dark surfaces.
TEST_F(Presets, Chapman) {
  use_preset("ssao-chapman");
  EXPECT_EQ(twin::ssao.samples, 16);
  baked_.use();
  double apart = 0, light_apart = 0, occluded = 0;
  int count = 0;
  over_pixels([&](const Pixel& pixel, vec3 noise) {
    const twin::Gathered seen = twin::estimate_ssao(pixel.at);
    const dvec3 first = glm::normalize(glm::cross(dvec3(0, 1, 0), pixel.normal)),
                second = glm::cross(pixel.normal, first);
    const double turn = 2 * twin::kPi * noise.x;
    const dvec3 random = first * std::cos(turn) + second * std::sin(turn);
    const dvec3 tangent = glm::normalize(random - pixel.normal * glm::dot(random, pixel.normal));
    const dvec3 bitangent = glm::cross(pixel.normal, tangent);
    int occluders = 0;
    dvec3 bleed(0);
    for (int i = 0; i < 16; ++i) {
      const dvec3 k(twin::chapman_point(i, 16));
      const Seen s = project(pixel.position + 0.5 * (tangent * k.x + bitangent * k.y + pixel.normal * k.z));
      if (!s.on_screen || texel(s.texel).depth <= 0) continue;
      const double there = texel(s.texel).depth, own = -pixel.position.z;
      if (there >= s.depth - 0.025 || std::abs(there - own) >= 1.0 * std::pow(5.0 / own, 2)) continue;
      ++occluders;
      const dvec3 d = position(s.texel) - pixel.position, l = glm::normalize(d);
      const double c_or = glm::dot(pixel.normal, l), c_oc = -glm::dot(dvec3(texel(s.texel).normal), l);
      if (c_or > 0 && c_oc > 0) bleed += dvec3(texel(s.texel).radiance) * 0.05 * c_or * c_oc / glm::dot(d, d);
    }
    const double lit = glm::dot(dvec3(texel(pixel.at).radiance), dvec3(0.2126, 0.7152, 0.0722));
    bleed *= std::min(lit / 0.05, 1.0);
    apart += std::abs(1 - occluders / 16.0 - seen.visibility);
    light_apart += std::abs(bleed.y - seen.gi.y) / (1 + bleed.y);
    occluded += occluders / 16.0;
    ++count;
  });
  EXPECT_LT(apart / count, 1e-3);
  EXPECT_LT(light_apart / count, 2e-3);
  EXPECT_GT(occluded / count, 0.05);
}

// Paper 004, section 3: uniform directions, cosine and 2 pi / N outside, senders of area pi r^2 / N, d at least 1.
TEST_F(Presets, DirectionalOcclusion) {
  use_preset("ssdo-paper");
  EXPECT_EQ(twin::ssdo.samples, 16);
  baked_.use();
  double apart = 0, light_apart = 0, occluded = 0;
  int count = 0;
  over_pixels([&](const Pixel& pixel, vec3 noise) {
    const twin::Gathered seen = twin::estimate_ssdo(pixel.at);
    const double r = 0.5, area = twin::kPi * r * r / 16;
    double sky = 0, bounce = 0;
    for (int i = 0; i < 16; ++i) {
      const vec3 u = twin::turned_point(noise, i);
      const dvec3 w(twin::uniform_direction(vec3(pixel.normal), u.x, u.y));
      const Seen s = project(pixel.position + w * (u.z * r));
      double blocked = 0;
      dvec3 d(1), l(1);
      if (s.on_screen && texel(s.texel).depth > 0 && texel(s.texel).depth < s.depth) {
        d = position(s.texel) - pixel.position;
        l = glm::normalize(d);
        const double far = std::clamp((glm::length(d) / r - 0.75) / 0.25, 0.0, 1.0);
        if (glm::dot(d, pixel.normal) > 0.002 * glm::length(d)) blocked = 1 - far * far * (3 - 2 * far);
      }
      sky += (1 - blocked) * glm::dot(w, pixel.normal) / twin::kPi * (2 * twin::kPi / 16);
      if (blocked > 0)
        bounce += texel(s.texel).radiance.y / twin::kPi * blocked * area * std::max(glm::dot(pixel.normal, l), 0.0) *
                  std::max(-glm::dot(dvec3(texel(s.texel).normal), l), 0.0) / std::max(glm::dot(d, d), 1.0);
    }
    apart += std::abs(sky - seen.ambient.x);
    light_apart += std::abs(bounce - seen.gi.y);
    occluded += bounce > 0;
    ++count;
  });
  EXPECT_LT(apart / count, 2e-3);
  EXPECT_LT(light_apart / count, 1e-4);
  EXPECT_GT(occluded / count, 0.1);
}

// Paper 002: horizons by their cosine from V, equation 18 wherever one rises, running radiance, the closed forms by
// quadrature.
TEST_F(Presets, HorizonBasedIndirectLighting) {
  use_preset("hbil-paper");
  EXPECT_EQ(twin::gi.slices, 2);
  double apart = 0, light_apart = 0, occluded = 0;
  int count = 0;
  over_pixels([&](const Pixel& pixel, vec3 noise) {
    twin::Lit seen;
    const std::vector<ivec2> taps = reads(pixel.at, [&] { seen = twin::estimate_hbil(pixel.at); });
    const dvec3 right = glm::normalize(glm::cross(dvec3(0, 1, 0), pixel.v)), up = glm::cross(pixel.v, right);
    double ao = 0, near = 0;
    size_t tap = 0;
    for (int i = 0; i < 2; ++i) {
      const double azimuth = (i + double(noise.x)) * twin::kPi / 2;
      const dvec3 d = std::cos(azimuth) * right + std::sin(azimuth) * up;
      const dvec2 n(glm::dot(pixel.normal, d), glm::dot(pixel.normal, pixel.v));
      const double t = -n.x / n.y;
      double horizon[2] = {std::acos(t / std::sqrt(1 + t * t)), std::acos(-t / std::sqrt(1 + t * t))};
      double last[2] = {texel(pixel.at).radiance.y, texel(pixel.at).radiance.y};
      const dvec2 line = glm::normalize(dvec2(d));
      const auto share = [&](double from, double to, double nx) {
        double sum = 0;
        for (int k = 0; k < 200; ++k) {
          const double a = from + (to - from) * (k + 0.5) / 200;
          sum += (nx * std::sin(a) + n.y * std::cos(a)) * std::sin(a);
        }
        return sum * (to - from) / 200;
      };
      for (; tap < taps.size(); ++tap) {
        const dvec2 offset = dvec2(taps[tap] - pixel.at) * dvec2(1, -1);
        if (std::abs(offset.x * line.y - offset.y * line.x) > 0.75 && i == 0) break;
        const int back = glm::dot(offset, line) > 0 ? 0 : 1;
        const dvec3 delta = position(taps[tap]) - pixel.position, l = glm::normalize(delta);
        const double angle = std::acos(std::clamp(glm::dot(l, pixel.v), -1.0, 1.0));
        if (angle >= horizon[back]) continue;
        const double facing = std::clamp((-glm::dot(dvec3(texel(taps[tap]).normal), l) + 0.4) / 0.4, 0.0, 1.0);
        last[back] = glm::mix(last[back], double(texel(taps[tap]).radiance.y), facing * facing * (3 - 2 * facing));
        near += last[back] * share(angle, horizon[back], back ? -n.x : n.x) / 2;
        horizon[back] = angle;
      }
      ao += (share(0, horizon[0], n.x) + share(0, horizon[1], -n.x)) / 2;
    }
    apart += std::abs(ao - seen.visibility);
    light_apart += std::abs(near - seen.gi.y);
    occluded += 1 - ao;
    ++count;
  });
  EXPECT_LT(apart / count, 5e-3);
  EXPECT_LT(light_apart / count, 5e-3);
  EXPECT_GT(occluded / count, 0.05);
}

}  // namespace
