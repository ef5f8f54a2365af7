// Pictures from noise: a tiling value noise by an integer hash, heights, and the normals of those heights.
#include "stone.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <numbers>

namespace nf::content {
namespace {

using glm::vec2;
using glm::vec3;

constexpr float pi = std::numbers::pi_v<float>;

// "lowbias32" (C. Wellons, hash-prospector), mapped to [0, 1).
float chance(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return float((x ^ (x >> 16)) >> 8) / 16777216.0f;
}

// Smooth noise with `cells` cells across the picture, repeating.
float noise(vec2 p, uint32_t cells, uint32_t seed) {
  p = (p - glm::floor(p)) * float(cells);
  const uint32_t x = std::min(uint32_t(p.x), cells - 1), y = std::min(uint32_t(p.y), cells - 1);
  vec2 f = p - vec2(x, y);
  f = f * f * (3.0f - 2.0f * f);
  const auto corner = [&](uint32_t i, uint32_t j) {
    return chance(((y + j) % cells) * 7919u + ((x + i) % cells) * 104729u + seed * 1299709u);
  };
  return glm::mix(glm::mix(corner(0, 0), corner(1, 0), f.x), glm::mix(corner(0, 1), corner(1, 1), f.x), f.y);
}

// A sum of noises, each twice as fine and half as strong; in [0, 1], 0.5 on average.
float clouds(vec2 p, uint32_t cells, uint32_t seed, int octaves = 5) {
  float sum = 0, weight = 0.5f, total = 0;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * noise(p, cells, seed + uint32_t(i));
    total += weight;
    weight *= 0.5f;
    cells *= 2;
  }
  return sum / total;
}

uint8_t byte(float value) {
  return uint8_t(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

image::Image8 painted(uint32_t size, const std::function<vec3(vec2)>& color) {
  image::Image8 picture{
      .width = size, .height = size, .channels = 3, .pixels = std::vector<uint8_t>(size_t(size) * size * 3)};
  for (uint32_t y = 0; y < size; ++y) {
    for (uint32_t x = 0; x < size; ++x) {
      const vec3 c = color((vec2(x, y) + 0.5f) / float(size));
      for (int i = 0; i < 3; ++i) picture.pixels[(size_t(y) * size + x) * 3 + size_t(i)] = byte(c[i]);
    }
  }
  return picture;
}

// Heights are in parts of the picture. v runs down the picture, the normal's y up.
image::Image8 normals_of(uint32_t size, const std::function<float(vec2)>& height) {
  std::vector<float> heights(size_t(size) * size);
  for (uint32_t i = 0; i < size * size; ++i) heights[i] = height((vec2(i % size, i / size) + 0.5f) / float(size));
  const auto at = [&](uint32_t x, uint32_t y) { return heights[size_t(y % size) * size + x % size]; };
  return painted(size, [&](vec2 p) {
    const uint32_t x = uint32_t(p.x * float(size)), y = uint32_t(p.y * float(size));
    const float step = 2 / float(size);
    const float du = (at(x + 1, y) - at(x + size - 1, y)) / step, dv = (at(x, y + 1) - at(x, y + size - 1)) / step;
    return glm::normalize(vec3(-du, dv, 1)) * 0.5f + 0.5f;
  });
}

struct Block {
  uint32_t id;
  float face;  // 0 in the joint, 1 on the block, a worn edge between
};

Block block_at(vec2 p) {
  constexpr uint32_t courses = 6, in_course = 3;
  p -= glm::floor(p);
  const float v = p.y * float(courses);
  const uint32_t course = std::min(uint32_t(v), courses - 1);
  float u = p.x * float(in_course) + 0.5f * float(course % 2) + 0.17f * chance(course + 90);
  const uint32_t column = uint32_t(u) % in_course;
  u -= std::floor(u);
  const float wear = 0.004f * (clouds(p, 16, 5, 3) - 0.5f);
  const float edge = wear + std::min(std::min(u, 1 - u) / float(in_course),
                                     std::min(v - float(course), float(course) + 1 - v) / float(courses));
  return {course * in_course + column, glm::smoothstep(0.002f, 0.009f, edge)};
}

}  // namespace

Relief ashlar_pictures(uint32_t size) {
  const auto height = [](vec2 p) {
    const Block block = block_at(p);
    return 0.006f * block.face + 0.0035f * clouds(p, 24, 40) * block.face;
  };
  const auto color = [](vec2 p) {
    const Block block = block_at(p);
    const vec3 stone = glm::mix(vec3(0.60f, 0.49f, 0.36f), vec3(0.74f, 0.64f, 0.50f), chance(block.id + 11));
    const float stain = clouds(p, 4, 60), grain = clouds(p, 48, 70, 3);
    const vec3 face = stone * (0.82f + 0.25f * stain + 0.16f * (grain - 0.5f));
    return glm::mix(vec3(0.43f, 0.37f, 0.29f) * (0.9f + 0.2f * grain), face, block.face);
  };
  return {painted(size, color), normals_of(size, height)};
}

Relief floor_pictures(uint32_t size) {
  // Slabs on a grid of half the picture; dark squares, on their corners, at the slabs' corners.
  const auto parts = [](vec2 p) {
    const vec2 q = p * 2.0f, f = q - glm::floor(q), nearest = glm::min(f, 1.0f - f);
    const float diamond = 0.16f - (nearest.x + nearest.y);
    const float joint = std::min(std::min(nearest.x, nearest.y), std::abs(diamond) * 0.7f);
    const uint32_t id = uint32_t(q.x) % 2 + 2 * (uint32_t(q.y) % 2);
    return std::tuple(diamond > 0, glm::smoothstep(0.004f, 0.012f, diamond > 0 ? diamond * 0.7f : joint), id);
  };
  const auto height = [&](vec2 p) { return 0.003f * std::get<1>(parts(p)) + 0.0006f * clouds(p, 32, 80); };
  const auto color = [&](vec2 p) {
    const auto [dark, face, id] = parts(p);
    const float vein = std::pow(1 - std::abs(2 * clouds(p + vec2(0.21f * float(id)), 3, 20 + id) - 1), 9.0f);
    const float stain = clouds(p, 5, 33);
    vec3 stone =
        glm::mix(vec3(0.58f, 0.51f, 0.43f), vec3(0.69f, 0.62f, 0.53f), chance(id + 3)) * (0.85f + 0.25f * stain);
    stone = glm::mix(stone, vec3(0.52f, 0.44f, 0.36f), 0.35f * vein);
    if (dark) stone = vec3(0.24f, 0.20f, 0.19f) * (0.8f + 0.5f * stain);
    return glm::mix(vec3(0.40f, 0.36f, 0.31f), stone, face);
  };
  return {painted(size, color), normals_of(size, height)};
}

Relief plaster_pictures(uint32_t size) {
  const auto height = [](vec2 p) { return 0.0025f * clouds(p, 10, 101, 6); };
  const auto color = [](vec2 p) {
    const float stain = clouds(p, 3, 120), grain = clouds(p, 64, 130, 2);
    return glm::mix(vec3(0.66f, 0.57f, 0.44f), vec3(0.77f, 0.70f, 0.58f), stain) * (0.94f + 0.12f * (grain - 0.5f));
  };
  return {painted(size, color), normals_of(size, height)};
}

Relief cloth_pictures(uint32_t size) {
  constexpr float threads = 96;
  const auto weave = [](vec2 p) {
    const float warp = std::abs(std::sin(pi * threads * p.x)), weft = std::abs(std::sin(pi * threads * p.y));
    const bool over = (uint32_t(p.x * threads) + uint32_t(p.y * threads)) % 2 == 0;
    return over ? warp : weft;
  };
  // A row of diamonds near the picture's lower edge, between two lines.
  const auto ornament = [](vec2 p) {
    const float v = p.y * 10 - 8.3f;  // -1 .. 1 is the band
    if (std::abs(v) > 1) return 0.0f;
    if (std::abs(v) > 0.82f) return 1.0f;
    const float u = p.x * 6 - std::floor(p.x * 6) - 0.5f;
    const float diamond = std::abs(u) * 1.5f + std::abs(v);
    return diamond < 0.62f && diamond > 0.25f ? 1.0f : 0.0f;
  };
  const auto color = [&](vec2 p) {
    const float shade = 0.62f + 0.12f * weave(p) + 0.12f * clouds(p, 6, 200);
    return glm::mix(vec3(shade), vec3(0.98f, 0.94f, 0.80f), 0.85f * ornament(p));
  };
  return {painted(size, color), normals_of(size, [&](vec2 p) { return 0.0012f * weave(p); })};
}

image::Image8 wood_picture(uint32_t size) {
  return painted(size, [](vec2 p) {
    const float ring = clouds(vec2(p.x * 0.25f + 0.13f * noise(p, 3, 301), p.y), 8, 300);
    const float fibre = noise(vec2(p.x * 0.1f, p.y), 128, 310);
    return glm::mix(vec3(0.36f, 0.24f, 0.15f), vec3(0.50f, 0.36f, 0.23f), ring) * (0.85f + 0.3f * fibre);
  });
}

image::Image8 broad_leaf_picture(uint32_t size) {
  image::Image8 picture{
      .width = size, .height = size, .channels = 4, .pixels = std::vector<uint8_t>(size_t(size) * size * 4)};
  for (uint32_t y = 0; y < size; ++y) {
    for (uint32_t x = 0; x < size; ++x) {
      const vec2 p = (vec2(x, y) + 0.5f) / float(size);
      const float along = 1 - p.y, across = std::abs(p.x - 0.5f);
      // Widest below the middle, pointed at the tip; slits between the veins.
      const float width = 0.46f * std::pow(std::sin(pi * std::pow(along, 0.75f)), 0.8f);
      const float vein = std::abs(std::sin(pi * 9 * (along - 0.9f * across)));
      const bool slit = across > 0.55f * width && vein < 0.16f && along > 0.15f && along < 0.9f;
      const bool stalk = across < 0.012f;
      const float shade = 0.75f + 0.25f * vein + 0.2f * clouds(p, 6, 400);
      vec3 color = glm::mix(vec3(0.20f, 0.36f, 0.12f), vec3(0.34f, 0.50f, 0.19f), along) * shade;
      if (across < 0.014f || vein < 0.05f) color = glm::mix(color, vec3(0.52f, 0.62f, 0.32f), 0.6f);
      uint8_t* pixel = &picture.pixels[(size_t(y) * size + x) * 4];
      for (int c = 0; c < 3; ++c) pixel[c] = byte(color[c]);
      pixel[3] = (across < width && !slit) || stalk ? 255 : 0;
    }
  }
  return picture;
}

}  // namespace nf::content
