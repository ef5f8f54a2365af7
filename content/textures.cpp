// Generated pictures: an integer hash for chance, so that they are the same everywhere.
#include "textures.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace nf::content {
namespace {

using glm::vec2;
using glm::vec3;

// "lowbias32" (C. Wellons, hash-prospector), mapped to [0, 1).
float chance(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return float((x ^ (x >> 16)) >> 8) / 16777216.0f;
}

image::Image8 blank(uint32_t size, uint32_t channels) {
  return {.width = size,
          .height = size,
          .channels = channels,
          .pixels = std::vector<uint8_t>(size_t(size) * size * channels)};
}

uint8_t byte(float value) {
  return uint8_t(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

void set(image::Image8& picture, uint32_t x, uint32_t y, vec3 color) {
  uint8_t* pixel = &picture.pixels[(size_t(y) * picture.width + x) * picture.channels];
  for (int c = 0; c < 3; ++c) pixel[c] = byte(color[c]);
}

constexpr uint32_t courses = 12, bricks_in_course = 4;

struct Brick {
  uint32_t id;
  float height;  // 0 in the joint, 1 on the face, a bevel between
};

Brick brick_at(vec2 p) {  // p in [0, 1), repeating
  p -= glm::floor(p);
  const float v = p.y * float(courses);
  const uint32_t course = std::min(uint32_t(v), courses - 1);
  float u = p.x * float(bricks_in_course) + (course % 2 ? 0.5f : 0.0f);
  const uint32_t column = uint32_t(u) % bricks_in_course;
  u -= std::floor(u);
  // Distance to the brick's edge, in parts of the picture.
  const float edge = std::min(std::min(u, 1 - u) / float(bricks_in_course),
                              std::min(v - float(course), float(course) + 1 - v) / float(courses));
  return {course * bricks_in_course + column, glm::smoothstep(0.004f, 0.012f, edge)};
}

}  // namespace

Bricks brick_pictures(uint32_t size) {
  Bricks result{blank(size, 3), blank(size, 3)};
  const float step = 1.0f / float(size);
  constexpr float depth = 0.012f;  // of the joints, in parts of the picture
  for (uint32_t y = 0; y < size; ++y) {
    for (uint32_t x = 0; x < size; ++x) {
      const vec2 p = (vec2(x, y) + 0.5f) * step;
      const Brick here = brick_at(p);
      const vec3 clay = glm::mix(vec3(0.72f, 0.45f, 0.36f), vec3(0.82f, 0.62f, 0.5f), chance(here.id));
      const float grain = 0.96f + 0.04f * chance(y * size + x + 1000);
      set(result.color, x, y, grain * glm::mix(vec3(0.78f, 0.76f, 0.72f), clay, here.height));

      // v runs down the picture, the normal's y up.
      const float du = brick_at(p + vec2(step, 0)).height - brick_at(p - vec2(step, 0)).height;
      const float dv = brick_at(p + vec2(0, step)).height - brick_at(p - vec2(0, step)).height;
      const vec3 normal = glm::normalize(vec3(-du * depth, dv * depth, 2 * step));
      set(result.normal, x, y, normal * 0.5f + 0.5f);
    }
  }
  return result;
}

image::Image8 leaf_picture(uint32_t size) {
  image::Image8 result = blank(size, 4);
  // The colour goes on under alpha 0, so that filtering draws no dark seam.
  const vec3 green{0.36f, 0.5f, 0.2f};
  for (uint32_t i = 0; i < size * size; ++i) set(result, i % size, i / size, green);

  constexpr uint32_t leaves = 140;
  for (uint32_t leaf = 0; leaf < leaves; ++leaf) {
    const vec2 center(chance(leaf * 4), chance(leaf * 4 + 1));
    const float angle = 2 * std::numbers::pi_v<float> * chance(leaf * 4 + 2);
    const float length = 0.06f + 0.04f * chance(leaf * 4 + 3);
    const vec2 along(std::cos(angle), std::sin(angle));
    const vec3 shade = green * (0.7f + 0.6f * chance(leaf + 5000));
    for (uint32_t y = 0; y < size; ++y) {
      for (uint32_t x = 0; x < size; ++x) {
        vec2 d = (vec2(x, y) + 0.5f) / float(size) - center;
        d -= glm::round(d);  // over the border and back in
        const float s = glm::dot(d, along) / length;
        const float t = (along.x * d.y - along.y * d.x) / (0.45f * length);
        // Two arcs that meet in points at s = +-1.
        if (std::abs(s) >= 1 || std::abs(t) >= 1 - s * s) continue;
        set(result, x, y, std::abs(t) < 0.08f ? shade * 1.25f : shade);
        result.pixels[(size_t(y) * size + x) * 4 + 3] = 255;
      }
    }
  }
  return result;
}

}  // namespace nf::content
