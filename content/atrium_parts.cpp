// Columns, arches, vaults, cloth and plants, as formulas.
#include "atrium_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stone.h"

namespace nf::content {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

// "lowbias32" (C. Wellons, hash-prospector), mapped to [0, 1).
float chance(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return float((x ^ (x >> 16)) >> 8) / 16777216.0f;
}

// Points of a half round moulding of a line of (radius, height) points, from height y on.
void add_torus(std::vector<vec2>& line, float radius, float y, float half) {
  for (int i = 0; i <= 4; ++i) {
    const float angle = -pi / 2 + pi * float(i) / 4;
    line.emplace_back(radius + half * std::cos(angle), y + half + half * std::sin(angle));
  }
}

}  // namespace

AtriumMaterials atrium_materials(Builder& b) {
  const auto relief = [&](const char* name, const Relief& pictures, vec3 tint, float roughness, float scale) {
    return b.material({.name = name,
                       .base_color = tint,
                       .roughness = roughness,
                       .normal_scale = scale,
                       .base_color_picture = b.picture(name, pictures.color),
                       .normal_picture = b.picture(std::string(name) + "_normal", pictures.normal)});
  };
  AtriumMaterials m;
  m.ashlar = relief("ashlar", ashlar_pictures(512), vec3(1), 0.9f, 1);
  m.plaster = relief("plaster", plaster_pictures(512), vec3(1), 0.85f, 1);
  m.floor = relief("floor", floor_pictures(512), vec3(1), 0.55f, 1);
  m.wood = b.material({.name = "wood", .roughness = 0.8f, .base_color_picture = b.picture("wood", wood_picture(512))});
  m.roof = b.material({.name = "roof", .base_color = {0.42f, 0.19f, 0.12f}, .roughness = 0.9f});
  m.iron = b.material({.name = "iron", .base_color = {0.16f, 0.14f, 0.13f}, .metallic = 1, .roughness = 0.5f});
  m.pot = b.material({.name = "pot", .base_color = {0.55f, 0.26f, 0.15f}, .roughness = 0.85f});
  m.soil = b.material({.name = "soil", .base_color = {0.09f, 0.06f, 0.04f}});
  m.water = b.material({.name = "water", .base_color = {0.05f, 0.10f, 0.11f}, .roughness = 0.1f});
  m.flame = b.material({.name = "flame", .base_color = vec3(0.9f), .emissive = {14, 8.5f, 3.5f}});
  m.leaf = b.material({.name = "leaf",
                       .roughness = 0.7f,
                       .alpha_cutoff = 0.5f,
                       .double_sided = true,
                       .base_color_picture = b.picture("leaf", broad_leaf_picture(256))});
  const Relief cloth = cloth_pictures(512);
  const PictureId color = b.picture("cloth", cloth.color), normal = b.picture("cloth_normal", cloth.normal);
  const std::pair<const char*, vec3> dyes[3] = {{"red cloth", {0.62f, 0.05f, 0.04f}},
                                                {"green cloth", {0.08f, 0.34f, 0.10f}},
                                                {"blue cloth", {0.06f, 0.14f, 0.50f}}};
  for (size_t i = 0; i < 3; ++i) {
    m.cloth[i] = b.material({.name = dyes[i].first,
                             .base_color = dyes[i].second,
                             .roughness = 0.95f,
                             .double_sided = true,
                             .base_color_picture = color,
                             .normal_picture = normal});
  }
  return m;
}

void add_column(Builder& b, const AtriumMaterials& m, float height, float radius) {
  const float plate = 0.14f, foot = 0.22f, capital = 0.48f;
  b.box({0, plate / 2, 0}, {1.5f * radius, plate / 2, 1.5f * radius}, 0, m.plaster);
  b.box({0, height - 0.07f, 0}, {1.62f * radius, 0.07f, 1.62f * radius}, 0, m.plaster);
  b.box({0, height - 0.17f, 0}, {1.48f * radius, 0.03f, 1.48f * radius}, 0, m.plaster);

  std::vector<vec2> line{{radius * 1.4f, plate}};
  add_torus(line, radius * 1.2f, plate, 0.06f);
  line.emplace_back(radius * 1.16f, plate + 0.12f);
  add_torus(line, radius * 1.06f, plate + 0.13f, 0.035f);
  // The swelling of a classical shaft: a fifth narrower at the top.
  const float shaft_from = plate + foot, shaft_to = height - capital;
  for (int i = 0; i <= 6; ++i) {
    const float t = float(i) / 6;
    line.emplace_back(radius * (1 - 0.17f * t * t + 0.04f * std::sin(pi * t)), glm::mix(shaft_from, shaft_to, t));
  }
  add_torus(line, radius * 0.83f, shaft_to, 0.03f);
  for (int i = 0; i <= 6; ++i) {
    const float t = float(i) / 6;  // a bell that opens upwards
    line.emplace_back(radius * (0.83f + 0.55f * t * t * t + 0.04f * t), shaft_to + 0.07f + t * 0.2f);
  }
  line.emplace_back(radius * 1.42f, height - 0.2f);
  b.revolve(line, 20, {0, 0, 0}, m.plaster, {2, 1});
}

namespace {

constexpr uint32_t arch_steps = 24;

// Half round bar around the arch, on the side of `sign` of the wall.
void add_archivolt(Builder& b, MaterialId stone, const Arch& arch, float radius, float half, float sign) {
  b.surface(
      arch_steps, 4,
      [&](float s, float t) {
        // Seen from the front of either side, s runs right and t outwards.
        const float angle = pi * (sign > 0 ? 1 - s : s), bulge = pi * t;
        const float r = radius - half * std::cos(bulge);
        const vec3 at(r * std::cos(angle), arch.spring + r * std::sin(angle),
                      sign * (arch.thickness / 2 + half * std::sin(bulge)));
        return SurfacePoint{at, vec2(s * pi * radius * 0.4f, -t * 0.1f)};
      },
      stone);
}

// One face of the wall over the arch, between the height of the arch's edge and the top.
void add_arch_face(Builder& b, MaterialId stone, const Arch& arch, float sign) {
  const float half = arch.width / 2, z = sign * arch.thickness / 2;
  const auto face = [&](float x, float y) { return SurfacePoint{{sign * x, y, z}, vec2(sign * x, -y) / 3.0f}; };
  b.surface(
      arch_steps, 1,
      [&](float s, float t) {
        const float angle = pi * (1 - s);
        const float x = arch.radius * std::cos(angle), edge = arch.spring + arch.radius * std::sin(angle);
        return face(x, glm::mix(edge, arch.top, t));
      },
      stone);
  for (const float side : {-1.0f, 1.0f}) {
    const float inner = side * arch.radius, outer = side * half;
    b.surface(
        1, 1,
        [&](float s, float t) {
          return face(glm::mix(std::min(inner, outer), std::max(inner, outer), s), glm::mix(arch.spring, arch.top, t));
        },
        stone);
  }
}

}  // namespace

void add_arch(Builder& b, const AtriumMaterials& m, const Arch& arch, bool blind) {
  for (const float sign : {1.0f, -1.0f}) {
    if (blind && sign < 0) continue;
    add_arch_face(b, m.ashlar, arch, sign);
    add_archivolt(b, m.plaster, arch, arch.radius + 0.07f, 0.07f, sign);
    add_archivolt(b, m.plaster, arch, arch.radius + 0.27f, 0.04f, sign);
  }
  // The inside of the arch, and the strips of the wall's lower edge beside it.
  const float deep = arch.thickness / 2;
  b.surface(
      arch_steps, 2,
      [&](float s, float t) {
        const float angle = pi * s;
        return SurfacePoint{
            {arch.radius * std::cos(angle), arch.spring + arch.radius * std::sin(angle), glm::mix(deep, -deep, t)},
            vec2(s * pi * arch.radius, t * arch.thickness) / 3.0f};
      },
      m.plaster);
  for (const float side : {-1.0f, 1.0f}) {
    const float a = side * arch.radius, c = side * arch.width / 2, y = arch.spring;
    const float left = std::min(a, c), right = std::max(a, c);
    b.quad({left, y, -deep}, {right, y, -deep}, {right, y, deep}, {left, y, deep}, m.plaster, vec2(0.1f, 0.3f));
  }
}

void add_vault(Builder& b, const AtriumMaterials& m, float width, float depth, float spring, float rise) {
  const auto height = [&](float x, float z) {
    const auto round = [](float u) { return std::sqrt(std::max(0.0f, 1 - u * u)); };
    return spring + rise * std::max(round(x), round(z));
  };
  // Seen from below, x runs right when z runs up. The four corners are left out of the slope's reach.
  b.surface(
      16, 16,
      [&](float s, float t) {
        const float x = 0.998f * (2 * s - 1), z = 0.998f * (2 * t - 1);
        return SurfacePoint{{x * width / 2 / 0.998f, height(x, z), z * depth / 2 / 0.998f},
                            vec2(x * width, -z * depth) / 4.0f};
      },
      m.plaster);
}

void add_railing(Builder& b, const AtriumMaterials& m, float width) {
  b.box({0, 0.06f, 0}, {width / 2, 0.06f, 0.14f}, 0, m.plaster);
  b.box({0, 0.95f, 0}, {width / 2, 0.05f, 0.15f}, 0, m.plaster);
  b.box({0, 0.885f, 0}, {width / 2, 0.015f, 0.11f}, 0, m.plaster);
  const std::vector<vec2> line = {{0.085f, 0.12f}, {0.085f, 0.17f}, {0.045f, 0.2f},  {0.05f, 0.24f}, {0.082f, 0.34f},
                                  {0.085f, 0.42f}, {0.066f, 0.52f}, {0.042f, 0.63f}, {0.04f, 0.7f},  {0.055f, 0.76f},
                                  {0.07f, 0.78f},  {0.07f, 0.82f},  {0.08f, 0.84f},  {0.08f, 0.87f}};
  const int count = int(width / 0.27f);
  for (int i = 0; i < count; ++i) {
    const float x = (float(i) + 0.5f) / float(count) * width - width / 2;
    b.revolve(line, 8, {x, 0, 0}, m.plaster, {0.5f, 0.6f});
  }
}

void add_door(Builder& b, const AtriumMaterials& m, float width, float height) {
  const float half = width / 2;
  for (const float side : {-1.0f, 1.0f}) {
    b.box({side * (half + 0.08f), height / 2, 0.05f}, {0.1f, height / 2, 0.09f}, 0, m.plaster);
    b.box({side * half / 2, height / 2, 0.02f}, {half / 2 - 0.008f, height / 2, 0.04f}, 0, m.wood);
    for (const float y : {0.27f, 0.73f}) {
      b.box({side * half / 2, y * height, 0.06f}, {half / 2 - 0.12f, 0.19f * height, 0.015f}, 0, m.wood);
    }
    b.box({side * 0.07f, 0.48f * height, 0.075f}, {0.015f, 0.09f, 0.02f}, 0, m.iron);
  }
  b.box({0, height + 0.09f, 0.06f}, {half + 0.24f, 0.11f, 0.12f}, 0, m.plaster);
  b.box({0, height + 0.23f, 0.07f}, {half + 0.32f, 0.04f, 0.17f}, 0, m.plaster);
}

void add_curtain(Builder& b, MaterialId cloth, float width, float drop, float gather) {
  b.surface(
      48, 24,
      [&](float s, float t) {
        const float down = 1 - t;  // 0 at the rod
        // Drawn together at two thirds of the way down, where a cord ties it, and falling free below.
        const float tie = std::exp(-std::pow((down - 0.66f) / 0.26f, 2.0f));
        const float narrow = glm::mix(1.0f, 0.3f, tie * (0.25f + 0.75f * glm::smoothstep(0.0f, 0.66f, down)));
        const float center = gather * 0.33f * width * tie;
        const float fold = 0.05f + 0.06f * glm::smoothstep(0.0f, 0.4f, down);
        const float phase = 2 * pi * 6 * s + 0.6f * std::sin(3 * down + 5 * s);
        const float x = center + (s - 0.5f) * width * narrow + 0.02f * std::sin(2 * phase);
        const float sag = 0.1f * std::sin(pi * s) * (1 - down);
        return SurfacePoint{{x, -drop * down - sag, fold * std::sin(phase) + 0.05f * std::sin(9 * down) * tie},
                            vec2(s * 1.5f, down)};
      },
      cloth);
}

void add_banner(Builder& b, MaterialId cloth, vec3 top, float width, float drop) {
  b.surface(
      12, 48,
      [&](float s, float t) {
        const float down = 1 - t;
        const float wave = 0.05f * down * std::sin(5 * down + 3 * s);
        return SurfacePoint{top + vec3(wave, -drop * down, (0.5f - s) * width), vec2(s, down)};
      },
      cloth);
}

void add_plant(Builder& b, const AtriumMaterials& m, uint32_t leaves, uint32_t seed) {
  const std::vector<vec2> pot = {{0.0f, 0.0f},   {0.22f, 0.0f},  {0.24f, 0.03f}, {0.33f, 0.36f}, {0.36f, 0.5f},
                                 {0.37f, 0.52f}, {0.41f, 0.52f}, {0.41f, 0.6f},  {0.36f, 0.6f},  {0.34f, 0.54f}};
  b.revolve(pot, 24, {0, 0, 0}, m.pot);
  const std::vector<vec2> soil = {{0.345f, 0.55f}, {0.0f, 0.57f}};
  b.revolve(soil, 16, {0, 0, 0}, m.soil);
  for (uint32_t i = 0; i < leaves; ++i) {
    const auto random = [&](uint32_t k) { return chance(seed * 7919u + i * 16u + k); };
    // Leaves turn by the golden angle; the older ones, outside, hang lower.
    const float turn = 2.399963f * float(i) + 0.5f * random(0), age = float(i) / float(leaves);
    const float rise = glm::mix(1.3f, 0.6f, age) + 0.2f * (random(1) - 0.5f);  // radians above the floor
    const float length = (0.5f + 0.28f * random(2)) * glm::mix(0.9f, 1.1f, age);
    const float half = 0.29f * length, bend = 0.8f + 0.6f * random(3), stem = 0.14f + 0.4f * (1 - age);
    const vec3 out(std::cos(turn), 0, std::sin(turn)), side(-out.z, 0, out.x);
    b.surface(
        3, 6,
        [&](float s, float t) {
          const float angle = rise - bend * t * t;
          const float u = 2 * s - 1;
          const vec3 along = out * std::cos(angle) + vec3(0, std::sin(angle), 0);
          const vec3 up = vec3(0, std::cos(angle), 0) - out * std::sin(angle);
          const vec3 root = vec3(0, 0.55f, 0) + (out * std::cos(rise) + vec3(0, std::sin(rise), 0)) * stem;
          // Folded a little along its middle.
          return SurfacePoint{root + along * (length * t) - side * (half * u) + up * (0.16f * half * u * u),
                              vec2(s, 1 - t)};
        },
        m.leaf);
    b.cylinder({0, 0.55f, 0}, vec3(0, 0.55f, 0) + (out * std::cos(rise) + vec3(0, std::sin(rise), 0)) * stem, 0.008f, 4,
               m.soil);
  }
}

void add_lantern(Builder& b, const AtriumMaterials& m, float length) {
  b.cylinder({0, 0, 0}, {0, -length + 0.42f, 0}, 0.012f, 6, m.iron);
  const float y = -length;
  const std::vector<vec2> hood = {{0.2f, y + 0.26f}, {0.17f, y + 0.3f}, {0.06f, y + 0.4f}, {0.0f, y + 0.44f}};
  b.revolve(hood, 12, {0, 0, 0}, m.iron);
  const std::vector<vec2> tray = {{0.0f, y - 0.05f}, {0.1f, y - 0.03f}, {0.16f, y}};
  b.revolve(tray, 12, {0, 0, 0}, m.iron);
  const std::vector<vec2> glass = {{0.05f, y + 0.0f}, {0.1f, y + 0.05f}, {0.1f, y + 0.2f}, {0.05f, y + 0.25f}};
  b.revolve(glass, 12, {0, 0, 0}, m.flame);
  for (int i = 0; i < 6; ++i) {
    const float angle = 2 * pi * float(i) / 6;
    const vec3 out(0.155f * std::cos(angle), y, 0.155f * std::sin(angle));
    b.cylinder(out, out + vec3(0.03f * std::cos(angle), 0.27f, 0.03f * std::sin(angle)), 0.01f, 4, m.iron);
  }
}

void add_fountain(Builder& b, const AtriumMaterials& m) {
  std::vector<vec2> rim = {{1.75f, 0.0f}, {1.75f, 0.12f}, {1.62f, 0.16f}, {1.62f, 0.42f}};
  add_torus(rim, 1.64f, 0.42f, 0.06f);
  rim.insert(rim.end(), {{1.4f, 0.54f}, {1.4f, 0.2f}});
  b.revolve(rim, 40, {0, 0, 0}, m.plaster, {8, 0.8f});
  const std::vector<vec2> water = {{1.42f, 0.36f}, {0.0f, 0.36f}};
  b.revolve(water, 32, {0, 0, 0}, m.water);
  const std::vector<vec2> foot = {{0.34f, 0.2f},  {0.34f, 0.44f}, {0.2f, 0.5f},  {0.13f, 0.62f}, {0.12f, 0.85f},
                                  {0.17f, 0.98f}, {0.2f, 1.02f},  {0.48f, 1.1f}, {0.68f, 1.22f}, {0.72f, 1.3f},
                                  {0.66f, 1.3f},  {0.45f, 1.2f},  {0.1f, 1.18f}, {0.07f, 1.3f},  {0.09f, 1.42f},
                                  {0.13f, 1.5f},  {0.1f, 1.6f},   {0.0f, 1.66f}};
  b.revolve(foot, 32, {0, 0, 0}, m.plaster, {2, 0.8f});
  const std::vector<vec2> upper_water = {{0.6f, 1.27f}, {0.08f, 1.27f}};
  b.revolve(upper_water, 24, {0, 0, 0}, m.water);
}

void add_cornice(Builder& b, MaterialId stone, vec3 from, vec3 to, float depth, float height) {
  const vec3 along = glm::normalize(to - from), out = glm::cross(along, vec3(0, 1, 0));
  const float length = glm::length(to - from);
  // A section of (out, up), from below; flat strips.
  const std::vector<vec2> section = {{0, 0},        {0.3f, 0.0f}, {0.3f, 0.18f}, {0.42f, 0.3f}, {0.66f, 0.46f},
                                     {0.66f, 0.6f}, {1, 0.68f},   {1, 1},        {0, 1}};
  for (size_t i = 0; i + 1 < section.size(); ++i) {
    const auto at = [&](vec3 end, vec2 p) { return end + out * (depth * p.x) + vec3(0, height * p.y, 0); };
    b.quad(at(from, section[i]), at(to, section[i]), at(to, section[i + 1]), at(from, section[i + 1]), stone,
           {length / 3, 0.1f});
  }
}

}  // namespace nf::content
