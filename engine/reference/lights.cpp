// Lights as shaders/direct.frag has them, and sizes as the view file gives them.
#include "reference/lights.h"

#include <algorithm>
#include <cmath>

#include "reference/scatter.h"

namespace nf::reference {
namespace {

float luminance(vec3 c) {
  return glm::dot(c, vec3(0.2126f, 0.7152f, 0.0722f));
}

// A direction in the cone about `axis`, dense as the cosine with the axis; `cosine` is that cosine.
vec3 cone_direction(vec3 axis, float sine, vec2 u, float& cosine) {
  const vec2 d = disc(u) * sine;
  cosine = std::sqrt(std::max(0.0f, 1 - glm::dot(d, d)));
  return frame_about(axis) * vec3(d, cosine);
}

// KHR_lights_punctual: the cone's edge, and the window at the range.
float attenuation(const scene::PunctualLight& l, vec3 to_light, float distance2) {
  float cone = 1;
  if (l.outer_cone < 3.14f) {
    const float outer = std::cos(l.outer_cone);
    const float scale = 1 / std::max(0.001f, std::cos(l.inner_cone) - outer);
    cone = std::clamp((glm::dot(l.direction, -to_light) - outer) * scale, 0.0f, 1.0f);
  }
  const float ratio = l.range > 0 ? distance2 / (l.range * l.range) : 0;
  return cone * cone * std::clamp(1 - ratio * ratio, 0.0f, 1.0f);
}

// Mean colour of the emissive texture: a weight, so a coarse one does.
float mean_brightness(const World& world, const scene::Material& m) {
  if (m.emissive_texture == scene::none) return 1;
  float sum = 0;
  constexpr int side = 16;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      sum += luminance(vec3(world.texture(m.emissive_texture, (vec2(x, y) + 0.5f) / float(side))));
  // Never nothing: every point that may emit must be found.
  return std::max(sum / (side * side), 0.02f);
}

}  // namespace

Lights::Lights(const World& world) : world_(world), sky_(world.scene().environment) {
  for (const scene::DirectionalLight& l : world.scene().directional) soft_ |= l.angle_deg > 0;
  for (const scene::PunctualLight& l : world.scene().punctual) soft_ |= l.radius > 0;
  double total = 0;
  for (uint32_t row = 0; row < world.instances().size(); ++row) {
    const WorldInstance& instance = world.instances()[row];
    const float power = luminance(instance.material->emissive);
    first_.push_back(scene::none);
    // What is blended or unlit is found by rays alone.
    if (!(power > 0) || instance.blended || instance.material->unlit) continue;
    first_.back() = uint32_t(densities_.size());
    const float brightness = power * mean_brightness(world, *instance.material);
    for (uint32_t t = 0; t < instance.primitive->index_count / 3; ++t) {
      const World::Corners c = world.corners(row, t);
      const float area = 0.5f * glm::length(glm::cross(c.b - c.a, c.c - c.a));
      densities_.push_back(brightness);
      if (!(area > 0)) continue;
      total += double(area) * double(brightness);
      triangles_.push_back({row, t, brightness, total});
    }
  }
  for (float& density : densities_) density = float(double(density) / total);
  for (Emitter& e : triangles_) e.density = float(double(e.density) / total), e.up_to_here /= total;
}

size_t Lights::count() const {
  return world_.scene().directional.size() + world_.scene().punctual.size();
}

Arriving Lights::arriving(size_t light, const Surface& at, vec2 u) const {
  const scene::Scene& scene = world_.scene();
  Arriving out;
  float cosine = 1;
  if (light < scene.directional.size()) {
    const scene::DirectionalLight& l = scene.directional[light];
    const float sine = std::sin(glm::radians(std::min(l.angle_deg, 179.0f)) / 2);
    out.to_light = cone_direction(-l.direction, sine, u, cosine);
    out.irradiance = l.color * (l.irradiance / std::max(cosine, 1e-3f));
    out.distance = 1e30f;
    return out;
  }
  const scene::PunctualLight& l = scene.punctual[light - scene.directional.size()];
  const vec3 to = l.position - at.position;
  const float distance2 = std::max(glm::dot(to, to), 1e-8f), distance = std::sqrt(distance2);
  const vec3 axis = to / distance;
  out.irradiance = l.color * (l.intensity * attenuation(l, axis, distance2) / distance2);
  out.to_light = axis;
  out.distance = distance;
  if (l.radius > 0 && l.radius < distance) {
    // A sphere of radiance I / (pi r^2): the shadow ray ends where it enters.
    const float sine = l.radius / distance;
    out.to_light = cone_direction(axis, sine, u, cosine);
    out.irradiance /= std::max(cosine, 1e-3f);
    const float off2 = distance2 * (1 - cosine * cosine);
    out.distance = distance * cosine - std::sqrt(std::max(l.radius * l.radius - off2, 0.0f));
  }
  return out;
}

EmitterPoint Lights::emitter_point(vec3 receiver, float choice, vec2 u) const {
  const auto found = std::upper_bound(triangles_.begin(), triangles_.end(), double(choice),
                                      [](double value, const Emitter& e) { return value < e.up_to_here; });
  const Emitter& e = found == triangles_.end() ? triangles_.back() : *found;
  // Uniform on the triangle.
  const float root = std::sqrt(u.x), b = root * (1 - u.y), c = root * u.y;
  const World::Corners k = world_.corners(e.instance, e.triangle);
  EmitterPoint point;
  point.position = k.a * (1 - b - c) + k.b * b + k.c * c;
  point.ng = world_.front_normal(e.instance, e.triangle);
  const scene::Material& m = *world_.instances()[e.instance].material;
  if (glm::dot(point.ng, receiver - point.position) < 0) {
    if (!m.double_sided) return point;
    point.ng = -point.ng;
  }
  if (world_.instances()[e.instance].masked && world_.hole(e.instance, e.triangle, b, c)) return point;
  const vec3 reach = glm::max(glm::abs(k.a), glm::max(glm::abs(k.b), glm::abs(k.c)));
  point.epsilon = 1e-7f + 4e-6f * std::max(reach.x, std::max(reach.y, reach.z));
  point.radiance = world_.emission(e.instance, e.triangle, b, c);
  point.density = e.density;
  return point;
}

float Lights::density(uint32_t instance, uint32_t triangle) const {
  return first_[instance] == scene::none ? 0 : densities_[first_[instance] + triangle];
}

}  // namespace nf::reference
