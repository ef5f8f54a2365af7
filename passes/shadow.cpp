// Fitting and choice of the shadow maps.
#include "shadow.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nf::passes {
namespace {

using glm::vec2;
using glm::vec3;

// Texels at a map's border that no receiver falls in: room for the filter, and for standing on whole texels.
float guard(const ShadowParams& params) {
  return params.least_filter + 2;
}

// The smallest sphere about a slice of the view: its centre's depth and its radius. `k` is the tangent of half the
// view's diagonal.
vec2 slice_sphere(float near, float far, float k) {
  const float k2 = k * k;
  if (k2 * (far + near) >= far - near) return {far, far * k};
  return {0.5f * (far + near) * (1 + k2),
          0.5f * std::sqrt((far - near) * (far - near) + 2 * (far * far + near * near) * k2 +
                           (far + near) * (far + near) * k2 * k2)};
}

// In steps of a quarter octave, so that cascades seldom change their size as the camera moves.
float view_distance(const scene::Camera& camera, const scene::Bounds& bounds, float limit) {
  const vec3 center = (bounds.min + bounds.max) * 0.5f, extent = (bounds.max - bounds.min) * 0.5f;
  float far = glm::dot(center - camera.position, camera.forward) + glm::dot(extent, glm::abs(camera.forward));
  far = std::exp2(std::ceil(std::log2(std::max(far, camera.near * 2)) * 4) / 4);
  return limit > 0 ? std::clamp(limit, camera.near * 1.01f, far) : far;
}

// Calls visit at the ends of what the planes leave of the segment from a to b; a plane (n, d) keeps dot(n, p) + d >= 0.
template <class Planes, class Visit>
void clip_segment(vec3 a, vec3 b, const Planes& planes, const Visit& visit) {
  float first = 0, last = 1;
  for (const glm::vec4& plane : planes) {
    const float at_a = glm::dot(vec3(plane), a) + plane.w, at_b = glm::dot(vec3(plane), b) + plane.w;
    if (at_a < 0 && at_b < 0) return;
    if (at_a < 0) first = std::max(first, at_a / (at_a - at_b));
    if (at_b < 0) last = std::min(last, at_a / (at_a - at_b));
  }
  if (first > last) return;
  visit(glm::mix(a, b, first));
  visit(glm::mix(a, b, last));
}

struct Square {
  vec2 middle{0};
  float half = 0;
};

// The square, in light space, about all that the camera can see of the box up to the depth `far`: the corners of a
// pyramid and a box cut with each other lie on the edges of one, cut by the other. Its side grows in eighths of an
// octave, so that it seldom changes as the camera moves. half = 0: nothing is in view.
Square square_in_view(const scene::Camera& camera, vec2 tangents, const scene::Bounds& bounds, float far,
                      const SunBlock& sun) {
  const vec3 right = glm::normalize(glm::cross(camera.forward, camera.up)), up = glm::cross(right, camera.forward);
  const vec3 slack = (bounds.max - bounds.min) * 0.005f + 1e-3f;
  const std::array<vec3, 2> box = {bounds.min - slack, bounds.max + slack};
  std::array<vec3, 4> ends;
  for (size_t i = 0; i < 4; ++i)
    ends[i] = camera.position + far * (camera.forward + right * (i == 1 || i == 2 ? tangents.x : -tangents.x) +
                                       up * (i < 2 ? tangents.y : -tangents.y));
  std::array<glm::vec4, 6> box_planes;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      vec3 n(0);
      n[axis] = side ? -1.0f : 1.0f;
      box_planes[size_t(axis * 2 + side)] = glm::vec4(n, -glm::dot(n, box[size_t(side)]));
    }
  std::array<glm::vec4, 5> view_planes = {glm::vec4(-camera.forward, glm::dot(camera.forward, camera.position) + far)};
  const vec3 inwards[] = {camera.forward * tangents.x + right, camera.forward * tangents.x - right,
                          camera.forward * tangents.y + up, camera.forward * tangents.y - up};
  for (size_t i = 0; i < 4; ++i) view_planes[i + 1] = glm::vec4(inwards[i], -glm::dot(inwards[i], camera.position));

  vec2 low(1e30f), high(-1e30f);
  const auto take = [&](vec3 p) {
    const vec2 at(glm::dot(sun.right, p), glm::dot(sun.down, p));
    low = glm::min(low, at), high = glm::max(high, at);
  };
  for (size_t i = 0; i < 4; ++i) {
    clip_segment(camera.position, ends[i], box_planes, take);
    clip_segment(ends[i], ends[(i + 1) % 4], box_planes, take);
  }
  for (size_t edge = 0; edge < 12; ++edge) {
    const size_t axis = edge / 4;
    vec3 a, b;
    for (size_t other = 0; other < 3; ++other)
      a[int(other)] = b[int(other)] = box[other == (axis + 1) % 3 ? edge & 1 : edge >> 1 & 1][int(other)];
    a[int(axis)] = box[0][int(axis)], b[int(axis)] = box[1][int(axis)];
    clip_segment(a, b, view_planes, take);
  }
  if (low.x > high.x) return {};
  const float half = std::max({high.x - low.x, high.y - low.y, 1e-3f}) * 0.5f;
  return {(low + high) * 0.5f, std::exp2(std::ceil(std::log2(half) * 8) / 8)};
}

float luminance(vec3 c) {
  return glm::dot(c, vec3(0.2126f, 0.7152f, 0.0722f));
}

bool is_spot(const scene::PunctualLight& light) {
  return light.outer_cone < 3.14f;
}

float importance(const scene::PunctualLight& light, vec3 eye) {
  const vec3 to = light.position - eye;
  const float share = is_spot(light) ? 0.5f * (1 - std::cos(light.outer_cone)) : 1.0f;
  const float away = std::max(glm::length(to) - light.range, 0.0f);
  const float reach = light.range > 0 ? 1 / (1 + away * away) : 1.0f;
  return luminance(light.color) * light.intensity * share * reach / (1 + glm::dot(to, to));
}

void add_tiles(const scene::PunctualLight& light, const ShadowParams& params, std::vector<ShadowTile>& tiles) {
  const float inner = 1 - 2 * guard(params) / float(params.tile_resolution);
  const float near = std::max(light.radius, 0.02f);
  if (is_spot(light)) {
    const float half_angle = std::min(light.outer_cone, glm::radians(80.0f));
    tiles.push_back({light.position, light.direction, inner / std::tan(half_angle), near});
    return;
  }
  for (int face = 0; face < 6; ++face) {
    vec3 axis(0);
    axis[face / 2] = face % 2 ? -1.0f : 1.0f;
    tiles.push_back({light.position, axis, inner, near});
  }
}

void choose_tiles(const scene::Scene& scene, vec3 eye, const ShadowParams& params, ShadowPlan& plan) {
  std::vector<uint32_t> order(scene.punctual.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return importance(scene.punctual[a], eye) > importance(scene.punctual[b], eye);
  });
  int left = params.tiles;
  for (const uint32_t i : order) {
    const int wanted = is_spot(scene.punctual[i]) ? 1 : 6;
    if (wanted > left) continue;
    left -= wanted;
    plan.first_tile[i] = 0;
  }
  for (size_t i = 0; i < scene.punctual.size(); ++i) {
    if (plan.first_tile[i] < 0) continue;
    plan.first_tile[i] = int32_t(plan.tiles.size());
    add_tiles(scene.punctual[i], params, plan.tiles);
  }
}

}  // namespace

void map_axes(vec3 axis, vec3& right, vec3& down) {
  const float s = axis.z < 0 ? -1.0f : 1.0f;
  const float a = -1 / (s + axis.z), b = axis.x * axis.y * a;
  right = {1 + s * axis.x * axis.x * a, s * b, -s * axis.x};
  down = {b, s + axis.y * axis.y * a, -axis.y};
}

SunBlock fit_sun(const scene::Camera& camera, glm::uvec2 size, const scene::Bounds& bounds,
                 const scene::DirectionalLight& light, const ShadowParams& params) {
  SunBlock sun;
  sun.direction = glm::normalize(light.direction);
  sun.irradiance = light.color * light.irradiance;
  sun.tan_radius = std::tan(glm::radians(light.angle_deg) * 0.5f);
  map_axes(sun.direction, sun.right, sun.down);
  if (!params.enabled) return sun;

  const vec3 center = (bounds.min + bounds.max) * 0.5f;
  const vec3 extent = glm::max((bounds.max - bounds.min) * 0.5f, vec3(1e-3f));
  const float depth = glm::dot(glm::abs(sun.direction), extent) * 1.01f;
  sun.depth_scale = -0.5f / depth;
  sun.depth_offset = 0.5f - glm::dot(sun.direction, center) * sun.depth_scale;

  const float texels = float(params.resolution), inner = std::max(1 - 2 * guard(params) / texels, 0.1f);
  const float scene_half =
      std::max(glm::dot(glm::abs(sun.right), extent), glm::dot(glm::abs(sun.down), extent)) / inner;
  const float ty = std::tan(camera.vfov * 0.5f), tx = ty * float(size.x) / float(std::max(size.y, 1u));
  const float near = camera.near, far = view_distance(camera, bounds, params.distance);
  const auto split = [&](int i) {
    const float t = float(i) / float(params.cascades);
    return glm::mix(glm::mix(near, far, t), near * std::pow(far / near, t), params.split);
  };
  // Where the cascades grow as large as the scene, the last has what is in view of it.
  Square all{{glm::dot(sun.right, center), glm::dot(sun.down, center)}, scene_half};
  const float k = std::sqrt(tx * tx + ty * ty);
  const bool reaches_all = slice_sphere(split(params.cascades - 1), far, k).y / inner >= scene_half;
  if (const Square seen = square_in_view(camera, {tx, ty}, bounds, far, sun);
      reaches_all && seen.half > 0 && seen.half / inner < scene_half)
    all = {seen.middle, seen.half / inner};
  vec3* cascades[] = {&sun.cascade0, &sun.cascade1, &sun.cascade2, &sun.cascade3};
  for (int i = 0; i < params.cascades; ++i) {
    const vec2 sphere = slice_sphere(split(i), split(i + 1), k);
    const bool last = sphere.y / inner >= all.half;
    const vec3 at = camera.position + camera.forward * sphere.x;
    Square square{{glm::dot(sun.right, at), glm::dot(sun.down, at)}, sphere.y / inner};
    if (last) square = all;
    const float texel = 2 * square.half / texels;
    if (square.half < scene_half) square.middle = glm::floor(square.middle / texel + 0.5f) * texel;
    *cascades[sun.cascade_count++] = vec3(square.middle, 1 / square.half);
    if (last) break;
  }
  return sun;
}

vec3 cascade_of(const SunBlock& sun, uint32_t cascade) {
  return std::array{sun.cascade0, sun.cascade1, sun.cascade2, sun.cascade3}[cascade];
}

glm::mat4 clip_from_cascade(const SunBlock& sun, uint32_t cascade) {
  const vec3 c = cascade_of(sun, cascade);
  return glm::transpose(glm::mat4(glm::vec4(sun.right * c.z, -c.x * c.z), glm::vec4(sun.down * c.z, -c.y * c.z),
                                  glm::vec4(sun.direction * sun.depth_scale, sun.depth_offset), glm::vec4(0, 0, 0, 1)));
}

glm::mat4 clip_from_tile(const ShadowTile& tile) {
  vec3 right, down;
  map_axes(tile.axis, right, down);
  const auto row = [&](vec3 axis) { return glm::vec4(axis, -glm::dot(axis, tile.position)); };
  return glm::transpose(
      glm::mat4(row(right * tile.scale), row(down * tile.scale), glm::vec4(0, 0, 0, tile.near), row(tile.axis)));
}

ShadowPlan plan_shadows(const scene::Camera& camera, glm::uvec2 size, const scene::Scene& scene,
                        const ShadowParams& params, Blending blending) {
  ShadowPlan plan;
  plan.blending = blending;
  plan.first_tile.assign(scene.punctual.size(), -1);
  if (!scene.directional.empty()) plan.sun = fit_sun(camera, size, scene.bounds, scene.directional[0], params);
  if (params.enabled) choose_tiles(scene, camera.position, params, plan);
  for (const scene::Material& material : scene.materials) {
    plan.masked |= draw_class_of(material, Blending::CutOut) == DrawClass::Masked;
    plan.mapped |= draw_class_of(material, Blending::CutOut) == DrawClass::Mapped;
  }
  return plan;
}

}  // namespace nf::passes
