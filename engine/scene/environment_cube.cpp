// The prefiltered cube map. Not by random directions, which either miss a small sun or smear it: every texel is a sum
// over the whole hemisphere, taken from the environment's mips, coarse where the GGX lobe is flat and fine where it is
// steep. So all light is counted, and nothing sparkles.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <thread>

#include "scene/environment_light.h"

namespace nf::scene {
namespace {

using glm::vec2;
using glm::vec3;
constexpr float pi = glm::pi<float>();
constexpr uint32_t least_side = 64, most_side = 256, last_side = 8, coarsest_side = 4;

// Rows [0, count) in any order; what they write must not overlap.
template <class F>
void for_rows(uint32_t count, F&& row) {
  std::atomic<uint32_t> next = 0;
  const auto work = [&] {
    for (uint32_t i = next++; i < count; i = next++) row(i);
  };
  std::vector<std::thread> others;
  const uint32_t threads = std::min(std::max(std::thread::hardware_concurrency(), 1u), 8u);
  for (uint32_t i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
}

// A mip of the environment itself: six faces, rows from the top. `where` is a texel's centre (unit) and its solid
// angle.
struct Level {
  uint32_t side = 0;
  std::vector<vec3> light;
  std::vector<glm::vec4> where;
};

// Solid angle of a texel, by that of its corner quadrants.
float solid_angle(uint32_t side, uint32_t x, uint32_t y) {
  const auto quadrant = [](double a, double b) { return std::atan2(a * b, std::sqrt(a * a + b * b + 1)); };
  const double x0 = 2.0 * x / side - 1, x1 = 2.0 * (x + 1) / side - 1, y0 = 2.0 * y / side - 1,
               y1 = 2.0 * (y + 1) / side - 1;
  return float(quadrant(x0, y0) - quadrant(x0, y1) - quadrant(x1, y0) + quadrant(x1, y1));
}

// Half as wide, as long as it is too fine to be read with a few samples a texel. Weighted by the rows' solid angles.
Environment shrink(Environment map, uint32_t width) {
  while (map.width >= 2 * width && map.width % 2 == 0 && map.height % 2 == 0) {
    Environment half{.kind = map.kind, .width = map.width / 2, .height = map.height / 2, .rotation = map.rotation};
    half.texels.resize(size_t(half.width) * half.height);
    const float row = pi / float(map.height);
    for_rows(half.height, [&](uint32_t y) {
      const float upper = std::sin((float(2 * y) + 0.5f) * row), lower = std::sin((float(2 * y) + 1.5f) * row);
      const vec3* from = &map.texels[size_t(2 * y) * map.width];
      for (uint32_t x = 0; x < half.width; ++x, from += 2)
        half.texels[size_t(y) * half.width + x] =
            ((from[0] + from[1]) * upper + (from[map.width] + from[map.width + 1]) * lower) / (2 * (upper + lower));
    });
    map = std::move(half);
  }
  return map;
}

Level make_level(uint32_t side) {
  const size_t count = size_t(6) * side * side;
  Level level{side, std::vector<vec3>(count), std::vector<glm::vec4>(count)};
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t x = i % side, y = i / side % side;
    const vec3 centre =
        cube_direction(i / (side * side), (float(x) + 0.5f) / float(side), (float(y) + 0.5f) / float(side));
    level.where[i] = {glm::normalize(centre), solid_angle(side, x, y)};
  }
  return level;
}

Level first_level(const Environment& environment, uint32_t side) {
  const bool is_map = environment.kind == EnvironmentKind::Map;
  const Environment source = is_map ? shrink(environment, 8 * side) : environment;
  Level level = make_level(side);
  for_rows(6 * side, [&](uint32_t row) {
    for (uint32_t x = 0; x < side; ++x) {
      vec3 sum(0);
      for (const vec2 offset : {vec2(0.25f, 0.25f), vec2(0.75f, 0.25f), vec2(0.25f, 0.75f), vec2(0.75f, 0.75f)}) {
        const vec2 at = (vec2(float(x), float(row % side)) + offset) / float(side);
        sum += radiance(source, glm::normalize(cube_direction(row / side, at.x, at.y)));
      }
      level.light[size_t(row) * side + x] = sum * 0.25f;
    }
  });
  return level;
}

// Texel i of a level lies over these four of the next finer one.
std::array<uint32_t, 4> children(uint32_t i, uint32_t side) {
  const uint32_t x = i % side, row = i / side, first = 2 * row * 2 * side + 2 * x;
  return {first, first + 1, first + 2 * side, first + 2 * side + 1};
}

Level coarser(const Level& above) {
  Level level = make_level(above.side / 2);
  for (uint32_t i = 0; i < level.light.size(); ++i) {
    vec3 sum(0);
    float weight = 0;
    for (const uint32_t child : children(i, level.side)) {
      sum += above.light[child] * above.where[child].w;
      weight += above.where[child].w;
    }
    level.light[i] = sum / weight;
  }
  return level;
}

// Four lobes side by side share one walk over the pyramid: their arithmetic then runs in one vector register.
constexpr size_t lanes = 4;
struct Lobes {
  std::array<float, lanes> x{}, y{}, z{};  // axes
  std::array<float, lanes> red{}, green{}, blue{}, weight{};
};

// Sums over the sphere, each part in texels as large as the lobes' slope there allows. `pyramid` begins with the
// coarsest.
void convolve(const std::vector<Level>& pyramid, float roughness, Lobes& lobes) {
  const float alpha = roughness * roughness, a2 = alpha * alpha;
  // Texels are at most alpha + tan(half the angle from the axis) radians wide, over which the lobe changes little, and
  // at most as wide as the rim of the hemisphere allows.
  constexpr float most_area = 0.05f;
  struct Node {
    uint32_t level, texel;
  };
  std::array<Node, 64> stack;
  for (uint32_t root = 0; root < pyramid[0].light.size(); ++root) {
    size_t depth = 0;
    stack[depth++] = {0, root};
    while (depth > 0) {
      const Node node = stack[--depth];
      const Level& level = pyramid[node.level];
      const glm::vec4 where = level.where[node.texel];
      std::array<float, lanes> n_l;
      for (size_t i = 0; i < lanes; ++i) n_l[i] = lobes.x[i] * where.x + lobes.y[i] * where.y + lobes.z[i] * where.z;
      const float nearest = std::max(std::max(n_l[0], n_l[1]), std::max(n_l[2], n_l[3]));
      if (nearest < 0 && nearest * nearest > where.w) continue;  // all below the horizon
      if (node.level + 1 < pyramid.size()) {
        const float width = alpha + std::sqrt(std::max(1 - nearest, 0.0f) / (1 + nearest));
        if (where.w > std::min(width * width, most_area)) {
          for (const uint32_t child : children(node.texel, level.side)) stack[depth++] = {node.level + 1, child};
          continue;
        }
      }
      const vec3 light = level.light[node.texel];
      for (size_t i = 0; i < lanes; ++i) {
        const float d = 0.5f * (1 + n_l[i]) * (a2 - 1) + 1, w = std::max(n_l[i], 0.0f) / (d * d) * where.w;
        lobes.red[i] += light.x * w;
        lobes.green[i] += light.y * w;
        lobes.blue[i] += light.z * w;
        lobes.weight[i] += w;
      }
    }
  }
}

// The four texels of `texels`' mip that lie under texel `block` of the next coarser one.
void filter_block(const std::vector<Level>& pyramid, const Level& target, float roughness, uint32_t block,
                  std::vector<vec3>& texels) {
  const std::array<uint32_t, 4> all = children(block, target.side / 2);
  Lobes lobes;
  for (size_t i = 0; i < lanes; ++i) {
    const glm::vec4 where = target.where[all[i]];
    lobes.x[i] = where.x, lobes.y[i] = where.y, lobes.z[i] = where.z;
  }
  convolve(pyramid, roughness, lobes);
  for (size_t i = 0; i < lanes; ++i)
    texels[all[i]] = vec3(lobes.red[i], lobes.green[i], lobes.blue[i]) / lobes.weight[i];
}

}  // namespace

vec3 cube_direction(uint32_t face, float s, float t) {
  const float x = 2 * s - 1, y = 2 * t - 1;
  const vec3 directions[] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y}, {x, -1, -y}, {x, -y, 1}, {-x, -y, -1}};
  return directions[face];
}

float prefilter_roughness(uint32_t mip, uint32_t mips) {
  return 1 - std::sqrt(std::max(1 - float(mip) / float(mips - 1), 0.0f));
}

float prefilter_mip(float roughness, uint32_t mips) {
  return float(mips - 1) * roughness * (2 - roughness);
}

PrefilteredCube prefilter(const Environment& environment) {
  PrefilteredCube cube{.side = least_side, .mips = {}};
  while (cube.side < most_side && 8 * cube.side < environment.width) cube.side *= 2;
  std::vector<Level> pyramid = {first_level(environment, cube.side)};
  while (pyramid.back().side > coarsest_side) pyramid.push_back(coarser(pyramid.back()));
  std::reverse(pyramid.begin(), pyramid.end());
  uint32_t mips = 1;
  for (uint32_t side = cube.side; side > last_side; side /= 2) ++mips;
  cube.mips.push_back(pyramid.back().light);
  for (uint32_t mip = 1; mip < mips; ++mip) {
    const uint32_t side = cube.side >> mip;
    const float roughness = prefilter_roughness(mip, mips);
    const Level& target = pyramid[pyramid.size() - 1 - mip];
    std::vector<vec3>& texels = cube.mips.emplace_back(target.light.size());
    const uint32_t half = side / 2;
    for_rows(6 * half, [&](uint32_t row) {
      for (uint32_t x = 0; x < half; ++x) filter_block(pyramid, target, roughness, row * half + x, texels);
    });
  }
  return cube;
}

}  // namespace nf::scene
