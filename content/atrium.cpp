// The atrium: a court of two storeys of arches under an open roof. x runs along the court, y = 0 is its floor.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "atrium_parts.h"
#include "scenes.h"

namespace nf::content {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float bay = 3, half_court = 3;       // a bay of the arcades; the court is 6 m wide
constexpr int bays = 8;                        // along each side; two bays across the ends
constexpr float half_length = bay * bays / 2;  // of the court
constexpr float aisle = 3;                     // depth of the galleries, from the arcade's axis
constexpr float outer_z = half_court + aisle, outer_x = half_length + aisle;
constexpr float floor2 = 5.1f, slab = 0.35f, top = 9.9f;
constexpr Arch lower_arch{bay, 1.18f, 3.15f, floor2 - slab, 0.55f};
constexpr Arch upper_arch{bay, 1.2f, floor2 + 2.75f, top - 0.4f, 0.5f};

quat turned_y(float degrees) {
  return glm::angleAxis(glm::radians(degrees), vec3(0, 1, 0));
}

// Where an arcade's bays stand: the middle of each, and the turn that takes +z to the court.
struct Bay {
  vec3 middle;
  float turn;
};

std::vector<Bay> arcade_bays() {
  std::vector<Bay> list;
  for (int i = 0; i < bays; ++i) {
    const float x = (float(i) + 0.5f) * bay - half_length;
    list.push_back({{x, 0, -half_court}, 0});
    list.push_back({{x, 0, half_court}, 180});
  }
  for (const float z : {-1.5f, 1.5f}) {
    list.push_back({{-half_length, 0, z}, 90});
    list.push_back({{half_length, 0, z}, -90});
  }
  return list;
}

std::vector<vec3> column_places() {
  std::vector<vec3> list;
  for (int i = 0; i <= bays; ++i) {
    for (const float z : {-half_court, half_court}) list.emplace_back(float(i) * bay - half_length, 0, z);
  }
  for (const float x : {-half_length, half_length}) list.emplace_back(x, 0, 0);
  return list;
}

// Shows one object at many places; the first is the object itself, made by `make`.
template <class Make>
void repeat(Builder& b, const std::string& name, const std::vector<Placement>& places, const Make& make) {
  ObjectId first;
  for (size_t i = 0; i < places.size(); ++i) {
    if (i == 0) {
      first = b.object(name, places[i]);
      make();
    } else {
      b.copy(fmt::format("{} {}", name, i), first, places[i]);
    }
  }
}

void add_arcades(Builder& b, const AtriumMaterials& m) {
  std::vector<Placement> lower, upper, railings, lower_columns, upper_columns;
  for (const Bay& place : arcade_bays()) {
    lower.push_back({place.middle, turned_y(place.turn)});
    railings.push_back({place.middle + vec3(0, floor2, 0), turned_y(place.turn)});
  }
  upper = lower;
  for (const vec3& place : column_places()) {
    lower_columns.push_back({place});
    upper_columns.push_back({place + vec3(0, floor2, 0)});
  }
  repeat(b, "lower arch", lower, [&] { add_arch(b, m, lower_arch); });
  repeat(b, "upper arch", upper, [&] { add_arch(b, m, upper_arch); });
  repeat(b, "railing", railings, [&] { add_railing(b, m, bay - 0.42f); });
  repeat(b, "column", lower_columns, [&] { add_column(b, m, lower_arch.spring, 0.24f); });
  repeat(b, "upper column", upper_columns, [&] { add_column(b, m, upper_arch.spring - floor2, 0.19f); });
}

// A wall's face from `from` to `to`, seen from its right-hand side going that way, with windows' niches left to others.
void add_wall(Builder& b, MaterialId stone, vec3 from, vec3 to, float low, float high) {
  const float length = glm::length(to - from);
  b.grid(from + vec3(0, low, 0), to + vec3(0, low, 0), to + vec3(0, high, 0), from + vec3(0, high, 0), 4, 2, stone,
         vec2(length, high - low) / 3.0f);
}

void add_shell(Builder& b, const AtriumMaterials& m) {
  b.object("court floor");
  b.grid({-outer_x, 0, outer_z}, {outer_x, 0, outer_z}, {outer_x, 0, -outer_z}, {-outer_x, 0, -outer_z}, 24, 12,
         m.floor, vec2(outer_x, outer_z) / 1.0f);

  b.object("outer walls");
  const vec3 corner[4] = {
      {-outer_x, 0, -outer_z}, {outer_x, 0, -outer_z}, {outer_x, 0, outer_z}, {-outer_x, 0, outer_z}};
  for (int i = 0; i < 4; ++i) {
    const vec3 from = corner[i], to = corner[(i + 1) % 4];
    add_wall(b, m.ashlar, from, to, 0, top + 0.6f);
    // The same from outside, so that the sun does not pass; and the crown between.
    const vec3 out = glm::normalize(glm::cross(vec3(0, 1, 0), to - from)) * 0.5f;
    add_wall(b, m.ashlar, to + out, from + out, 0, top + 0.6f);
  }

  // Slabs: the ring of the upper floor and of the roof, as boxes.
  b.object("slabs");
  const float inner = 0.3f;
  for (const float side : {-1.0f, 1.0f}) {
    const float z = side * (half_court - inner + outer_z) / 2, depth = (outer_z - half_court + inner) / 2;
    const float x = side * (half_length - inner + outer_x) / 2, width = (outer_x - half_length + inner) / 2;
    b.box({0, floor2 - slab / 2, z}, {outer_x, slab / 2, depth}, 0, m.plaster);
    b.box({x, floor2 - slab / 2, 0}, {width, slab / 2, half_court - inner}, 0, m.plaster);
    b.box({0, top - 0.2f, z}, {outer_x, 0.2f, depth}, 0, m.wood);
    b.box({x, top - 0.2f, 0}, {width, 0.2f, half_court - inner}, 0, m.wood);
  }
  b.object("gallery floors");
  for (const float side : {-1.0f, 1.0f}) {
    const float z0 = side > 0 ? half_court - inner : -outer_z, z1 = side > 0 ? outer_z : -half_court + inner;
    const float y = floor2 + 0.005f;
    b.quad({-outer_x, y, z1}, {outer_x, y, z1}, {outer_x, y, z0}, {-outer_x, y, z0}, m.floor, {outer_x, aisle / 2});
    const float x0 = side > 0 ? half_length - inner : -outer_x, x1 = side > 0 ? outer_x : -half_length + inner;
    const float w = half_court - inner;
    b.quad({x0, y, w}, {x1, y, w}, {x1, y, -w}, {x0, y, -w}, m.floor, {aisle / 2, w});
  }
}

void add_cornices(Builder& b, const AtriumMaterials& m) {
  b.object("cornices");
  const auto ring = [&](float y, float depth, float height) {
    const float x = half_length - 0.27f, z = half_court - 0.27f;
    const vec3 corner[4] = {{-x, y, -z}, {x, y, -z}, {x, y, z}, {-x, y, z}};
    for (int i = 0; i < 4; ++i) add_cornice(b, m.plaster, corner[i], corner[(i + 1) % 4], depth, height);
  };
  ring(floor2 - 0.42f, 0.16f, 0.42f);
  ring(top - 0.42f, 0.4f, 0.55f);
}

void add_roof(Builder& b, const AtriumMaterials& m) {
  b.object("roof");
  // Tiles in waves that fall from the outer wall to the court.
  const auto side = [&](vec3 from, vec3 to) {
    const vec3 along = to - from, out = glm::normalize(glm::cross(along, vec3(0, 1, 0)));
    const float length = glm::length(along), depth = aisle + 0.75f;
    b.surface(
        uint32_t(length * 8), 8,
        [&](float s, float t) {
          const float tile = 0.03f * std::sin(2 * pi * s * length * 2);
          return SurfacePoint{from + along * s - out * (depth * t - 0.45f) + vec3(0, 0.14f + 0.9f * t + tile, 0),
                              {s, -t}};
        },
        m.roof);
  };
  const float x = half_length, z = half_court;
  side({-outer_x, top, -z}, {outer_x, top, -z});
  side({outer_x, top, z}, {-outer_x, top, z});
  side({x, top, -z}, {x, top, z});
  side({-x, top, z}, {-x, top, -z});
}

// Vaults under the galleries, half columns and blind arches on the walls behind.
void add_galleries(Builder& b, const AtriumMaterials& m) {
  std::vector<Placement> vaults, blind, pilasters;
  for (int i = -1; i <= bays; ++i) {
    const float x = (float(i) + 0.5f) * bay - half_length;
    for (const float side : {-1.0f, 1.0f}) {
      vaults.push_back({{x, 0, side * (half_court + aisle / 2)}});
      blind.push_back({{x, 0, side * outer_z}, turned_y(side < 0 ? 0.0f : 180.0f)});
      if (i >= 0) pilasters.push_back({{x - bay / 2, 0, side * (outer_z - 0.02f)}});
    }
  }
  for (const float side : {-1.0f, 1.0f}) {
    for (const float z : {-1.5f, 1.5f}) {
      vaults.push_back({{side * (half_length + aisle / 2), 0, z}});
      blind.push_back({{side * outer_x, 0, z}, turned_y(side < 0 ? 90.0f : -90.0f)});
    }
  }
  repeat(b, "vault", vaults, [&] { add_vault(b, m, bay, aisle, lower_arch.spring + 0.1f, 1.35f); });
  repeat(b, "blind arch", blind, [&] { add_arch(b, m, {bay, 1.18f, 3.15f, floor2 - slab, 0.5f}, true); });
  repeat(b, "wall column", pilasters, [&] { add_column(b, m, lower_arch.spring, 0.22f); });
  std::vector<Placement> doors, shutters;
  for (int i = 0; i < bays; ++i) {
    const float x = (float(i) + 0.5f) * bay - half_length;
    for (const float side : {-1.0f, 1.0f}) {
      const quat turn = turned_y(side < 0 ? 0.0f : 180.0f);
      if (i % 3 == 1) doors.push_back({{x, 0, side * outer_z}, turn});
      shutters.push_back({{x, floor2 + (i % 2 ? 0.0f : 0.9f), side * outer_z}, turn, {1, i % 2 ? 1.45f : 1.0f, 1}});
    }
  }
  for (const float side : {-1.0f, 1.0f}) {
    const quat turn = turned_y(side < 0 ? 90.0f : -90.0f);
    shutters.push_back({{side * outer_x, floor2 + 0.9f, -1.5f}, turn});
    shutters.push_back({{side * outer_x, floor2 + 0.9f, 1.5f}, turn});
    doors.push_back({{side * outer_x, 0, -1.5f}, turn});
    doors.push_back({{side * outer_x, 0, 1.5f}, turn});
  }
  repeat(b, "door", doors, [&] { add_door(b, m, 1.5f, 2.5f); });
  repeat(b, "shutters", shutters, [&] { add_door(b, m, 1.1f, 1.5f); });
  // Beams under the roof of the upper gallery.
  b.object("beams");
  for (int i = -1; i <= 2 * bays + 1; ++i) {
    const float x = float(i) * bay / 2 - half_length;
    for (const float side : {-1.0f, 1.0f}) {
      b.box({x, top - 0.5f, side * (half_court + aisle / 2)}, {0.09f, 0.12f, aisle / 2 - 0.1f}, 0, m.wood);
    }
  }
}

// Two curtains in an arch, drawn to its sides; colours take turns along the court.
void add_curtains(Builder& b, const AtriumMaterials& m) {
  const float rod = lower_arch.spring + 0.45f, width = 1.04f, drop = 3.4f;
  for (size_t color = 0; color < 3; ++color) {
    std::vector<Placement> left, right;
    for (int i = 0; i < bays; ++i) {
      const float x = (float(i) + 0.5f) * bay - half_length;
      for (const float side : {-1.0f, 1.0f}) {
        const size_t turn = size_t(side < 0 ? i : i + 1);
        if (turn % 3 != color || i == 3 || i == 4) continue;  // before the fountain the arches are open
        for (const float half : {-1.0f, 1.0f}) {
          const Placement place{{x - side * half * 0.54f, rod, side * half_court}, turned_y(side < 0 ? 0.0f : 180.0f)};
          (half < 0 ? left : right).push_back(place);
        }
      }
    }
    repeat(b, fmt::format("curtain {} left", color), left, [&] { add_curtain(b, m.cloth[color], width, drop, -1); });
    repeat(b, fmt::format("curtain {} right", color), right, [&] { add_curtain(b, m.cloth[color], width, drop, 1); });
  }
  b.object("curtain rods");
  for (int i = 0; i < bays; ++i) {
    const float x = (float(i) + 0.5f) * bay - half_length;
    for (const float z : {-half_court, half_court}) {
      b.cylinder({x - 1.15f, rod + 0.02f, z}, {x + 1.15f, rod + 0.02f, z}, 0.022f, 8, m.iron);
    }
  }
}

constexpr float period = 4;  // seconds, of all that swings
constexpr int keys = 32;

// Angles at even times of one period, as turns about `axis`; 0 at its start, so that the scene at rest is the scene at
// time 0.
void swing(Builder& b, ObjectId object, vec3 axis, float degrees, float lag) {
  std::vector<float> times;
  std::vector<quat> turns;
  for (int i = 0; i <= keys; ++i) {
    const float phase = 2 * pi * float(i % keys) / keys;
    times.push_back(period * float(i) / keys);
    turns.push_back(glm::angleAxis(glm::radians(degrees) * (std::sin(phase - lag) + std::sin(lag)), axis));
  }
  b.animate_rotation(object, times, turns);
}

// Banners on ropes across the court, each on a chain of joints that the draught moves.
void add_banners(Builder& b, const AtriumMaterials& m) {
  constexpr float drop = 2.9f, width = 1.5f, height = 8.55f;
  constexpr uint32_t links = 5;
  const float places[] = {-7.5f, 1.5f, 7.5f};
  for (size_t i = 0; i < 3; ++i) {
    const vec3 at(places[i], height, 0);
    std::vector<ObjectId> joints;
    for (uint32_t link = 0; link < links; ++link) {
      const vec3 step = link == 0 ? at : vec3(0, -drop / float(links), 0);
      const ObjectId parent = link == 0 ? ObjectId{} : joints.back();
      joints.push_back(b.object(fmt::format("banner {} joint {}", i, link), {step}, parent));
      swing(b, joints.back(), vec3(0, 0, 1), link == 0 ? 5.0f : 4.0f, 0.7f * float(link) + float(i));
    }
    const ObjectId banner = b.object(fmt::format("banner {}", i));
    add_banner(b, m.cloth[i], at, width, drop);
    b.skin(banner, joints, [=](vec3 p) {
      const float along = std::clamp((at.y - p.y) / drop * float(links) - 0.5f, 0.0f, float(links - 1));
      const uint32_t first = std::min(uint32_t(along), links - 2);
      return JointPair{first, first + 1, along - float(first)};
    });
    b.object(fmt::format("rope {}", i));
    b.cylinder(at - vec3(0, 0, half_court), at + vec3(0, 0, half_court), 0.02f, 6, m.iron);
  }
}

void add_lanterns(Builder& b, const AtriumMaterials& m) {
  constexpr float length = 1.25f, crown = lower_arch.spring + 0.1f + 1.35f;
  ObjectId first;
  int row = 0;
  for (const float x : {-7.5f, -1.5f, 4.5f, 10.5f}) {
    for (const float side : {-1.0f, 1.0f}) {
      const Placement place{{x, crown, side * (half_court + aisle / 2)}};
      ObjectId lantern;
      if (!first) {
        lantern = first = b.object("lantern", place);
        add_lantern(b, m, length);
      } else {
        lantern = b.copy(fmt::format("lantern {}", row), first, place);
      }
      swing(b, lantern, glm::normalize(vec3(1, 0, 0.3f * float(row % 3))), 2.5f + float(row % 3), 0.9f * float(row));
      if (row % 2 == (row / 2) % 2) b.point_light({0, -length + 0.12f, 0}, 5, {1, 0.68f, 0.36f}, lantern);
      ++row;
    }
  }
}

void add_plants(Builder& b, const AtriumMaterials& m) {
  for (uint32_t kind = 0; kind < 3; ++kind) {
    std::vector<Placement> places;
    for (int i = 0; i <= bays; ++i) {
      for (const float side : {-1.0f, 1.0f}) {
        if (uint32_t(i + (side > 0 ? 1 : 0)) % 3 != kind) continue;
        const vec3 at(float(i) * bay - half_length + 0.1f * side, 0, side * (half_court - 0.78f));
        const float size = 0.95f + 0.25f * float((uint32_t(i) * 5 + kind * 3) % 4) / 4;
        places.push_back({at, turned_y(float(i) * 77 + side * 40), vec3(size)});
        if (i % 2 == 0) {
          places.push_back({at + vec3(0.1f, floor2, side * 1.75f), turned_y(float(i) * 31), vec3(0.8f)});
        }
      }
    }
    repeat(b, fmt::format("plant {}", kind), places, [&] { add_plant(b, m, 19 + 3 * kind, kind); });
  }
}

constexpr vec3 court_eye{-11.3f, 1.75f, -0.7f}, court_target{2, 3.1f, 0.25f};
constexpr float court_vfov = 62;

}  // namespace

std::string atrium_view() {
  const vec3 &e = court_eye, &t = court_target;
  return fmt::format(
      "{{\"camera\": {{\"position\": [{}, {}, {}], \"target\": [{}, {}, {}], \"vfov_deg\": {}}},\n"
      " \"environment\": {{\"color\": [0.42, 0.58, 0.9], \"intensity\": 0.5}}}}\n",
      e.x, e.y, e.z, t.x, t.y, t.z, court_vfov);
}

std::vector<uint8_t> atrium() {
  Builder b;
  const AtriumMaterials m = atrium_materials(b);
  add_shell(b, m);
  add_arcades(b, m);
  add_cornices(b, m);
  add_roof(b, m);
  add_galleries(b, m);
  add_curtains(b, m);
  add_banners(b, m);
  add_lanterns(b, m);
  add_plants(b, m);
  b.object("fountain");
  add_fountain(b, m);

  b.directional_light({0.34f, -1, 0.3f}, 9, {1, 0.93f, 0.82f});
  b.camera("court", court_eye, court_target, court_vfov);
  b.camera("gallery", {-10.8f, floor2 + 1.75f, 4.3f}, {2.5f, 4.3f, -2.2f}, 60);
  b.camera("aisle", {-11.6f, 1.7f, -4.9f}, {4, 2.1f, -3.9f}, 58);
  b.camera("fountain", {4.6f, 1.5f, 2.1f}, {-2.2f, 2.0f, -2.4f}, 60);
  return b.glb();
}

}  // namespace nf::content
