// Surfaces, as shaders/gbuffer.vert, gbuffer.frag and common/surface.glsl make them.
#include "reference/world.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "image/image.h"
#include "scene/deform.h"

namespace nf::reference {
namespace {

float decoded(uint8_t value) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (size_t i = 0; i < 256; ++i) t[i] = image::linear_from_srgb(float(i) / 255);
    return t;
  }();
  return table[value];
}

int wrapped(int i, int size, scene::Wrap wrap) {
  if (wrap == scene::Wrap::Clamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == scene::Wrap::Mirror ? 2 * size : size;
  i %= period;
  if (i < 0) i += period;
  return i < size ? i : period - 1 - i;
}

vec4 texel(const scene::Picture& picture, int x, int y) {
  const uint8_t* p = picture.rgba.data() + (size_t(y) * picture.width + size_t(x)) * 4;
  const float alpha = float(p[3]) / 255;
  if (picture.srgb) return {decoded(p[0]), decoded(p[1]), decoded(p[2]), alpha};
  return vec4(p[0], p[1], p[2], 255 * alpha) / 255.0f;
}

float texel_alpha(const scene::Picture& picture, int x, int y) {
  return float(picture.rgba[(size_t(y) * picture.width + size_t(x)) * 4 + 3]) / 255;
}

// The texture at its finest level; `read` gives a texel.
template <class Read>
auto filtered(const scene::Scene& scene, const scene::Texture& t, vec2 uv, const Read& read) {
  const scene::Picture& picture = scene.pictures[t.picture];
  const int width = int(picture.width), height = int(picture.height);
  if (width == 0 || height == 0) return decltype(read(picture, 0, 0))(1);
  const scene::Sampler& s = t.sampler;
  // Far-off coordinates would overflow an int; a texture has no detail there anyway.
  const vec2 at = glm::clamp(uv * vec2(width, height), vec2(-1e8f), vec2(1e8f));
  if (s.mag == scene::Filter::Nearest)
    return read(picture, wrapped(int(std::floor(at.x)), width, s.u), wrapped(int(std::floor(at.y)), height, s.v));
  const vec2 corner = glm::floor(at - 0.5f), f = at - 0.5f - corner;
  const int x0 = wrapped(int(corner.x), width, s.u), x1 = wrapped(int(corner.x) + 1, width, s.u);
  const int y0 = wrapped(int(corner.y), height, s.v), y1 = wrapped(int(corner.y) + 1, height, s.v);
  return glm::mix(glm::mix(read(picture, x0, y0), read(picture, x1, y0), f.x),
                  glm::mix(read(picture, x0, y1), read(picture, x1, y1), f.x), f.y);
}

template <class T>
T between(const T& a, const T& b, const T& c, float u, float v) {
  return a * (1 - u - v) + b * u + c * v;
}

}  // namespace

World::World(const scene::Scene& scene, const Settings& settings)
    : scene_(scene),
      lambert_(settings.lambert),
      albedo_scale_(settings.albedo_scale),
      emissive_scale_(settings.emissive_scale) {
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    if (settings.cancel && *settings.cancel) throw Cancelled();
    WorldInstance instance;
    instance.primitive = &scene.primitives[scene.instances.primitive[i]];
    instance.material = &scene.materials[instance.primitive->material];
    instance.blended = instance.material->alpha == scene::AlphaMode::Blend && settings.blending == Blending::Over;
    instance.masked = instance.material->alpha != scene::AlphaMode::Opaque && !instance.blended;
    instance.mirrored = scene.instances.mirrored[i] ? -1.0f : 1.0f;
    if (scene.instances.skin[i] != scene::none || instance.primitive->target_count > 0) {
      scene::Deformed deformed = scene::deform(scene, uint32_t(i), scene::Moment::Now);
      instance.position = std::move(deformed.position);
      instance.normal = std::move(deformed.normal);
      instance.tangent = std::move(deformed.tangent);
    } else {
      const scene::mat4& world = scene.nodes.world[scene.instances.node[i]];
      instance.linear = mat3(world);
      const vec3 x(world[0]), y(world[1]), z(world[2]);
      instance.cofactor = mat3(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)) * instance.mirrored;
      const uint32_t first = instance.primitive->vertex_offset, count = instance.primitive->vertex_count;
      instance.position.reserve(count + 1);
      for (uint32_t v = first; v < first + count; ++v)
        instance.position.push_back(vec3(world * vec4(scene.geometry.position[v], 1)));
    }
    instance.position.emplace_back(0);
    instances_.push_back(std::move(instance));
  }
}

World::Vertex World::vertices(uint32_t instance, uint32_t triangle) const {
  const scene::Primitive& p = *instances_[instance].primitive;
  const uint32_t* index = scene_.geometry.index.data() + p.first_index + size_t(triangle) * 3;
  return {p.vertex_offset + index[0], p.vertex_offset + index[1], p.vertex_offset + index[2]};
}

World::Corners World::corners(uint32_t instance, uint32_t triangle) const {
  const WorldInstance& i = instances_[instance];
  const uint32_t* index = scene_.geometry.index.data() + i.primitive->first_index + size_t(triangle) * 3;
  return {i.position[index[0]], i.position[index[1]], i.position[index[2]]};
}

vec3 World::front_normal(uint32_t instance, uint32_t triangle) const {
  const Corners c = corners(instance, triangle);
  const vec3 normal = glm::cross(c.b - c.a, c.c - c.a) * instances_[instance].mirrored;
  const float length = glm::length(normal);
  return length > 0 ? normal / length : vec3(0, 1, 0);
}

vec4 World::texture(uint32_t row, vec2 uv) const {
  return filtered(scene_, scene_.textures[row], uv, texel);
}

vec2 World::uv(const scene::Material& m, scene::Slot slot, const Vertex& i, float u, float v) const {
  const scene::Geometry& g = scene_.geometry;
  const scene::UvMapping& mapping = m.mapping_of(slot);
  const std::vector<vec2>& set = mapping.set == 0 ? g.uv0 : g.uv1;
  return mapping.linear * between(set[i.a], set[i.b], set[i.c], u, v) + mapping.offset;
}

float World::alpha(uint32_t instance, uint32_t triangle, float u, float v) const {
  const scene::Material& m = *instances_[instance].material;
  const scene::Geometry& g = scene_.geometry;
  const Vertex i = vertices(instance, triangle);
  float alpha = m.base_color.w * between(g.color[i.a].w, g.color[i.b].w, g.color[i.c].w, u, v);
  if (m.base_color_texture != scene::none)
    alpha *=
        filtered(scene_, scene_.textures[m.base_color_texture], uv(m, scene::Slot::BaseColor, i, u, v), texel_alpha);
  return alpha;
}

bool World::hole(uint32_t instance, uint32_t triangle, float u, float v) const {
  const scene::Material& m = *instances_[instance].material;
  return alpha(instance, triangle, u, v) < (m.alpha == scene::AlphaMode::Mask ? m.alpha_cutoff : 0.5f);
}

vec3 World::emission(uint32_t instance, uint32_t triangle, float u, float v) const {
  const scene::Material& m = *instances_[instance].material;
  if (m.emissive_texture == scene::none) return m.emissive * emissive_scale_;
  return m.emissive * emissive_scale_ *
         vec3(texture(m.emissive_texture, uv(m, scene::Slot::Emissive, vertices(instance, triangle), u, v)));
}

vec3 World::environment(vec3 direction) const {
  return scene::radiance(scene_.environment, direction);
}

Surface World::surface(const Hit& hit, vec3 direction) const {
  const WorldInstance& instance = instances_[hit.instance];
  const scene::Material& m = *instance.material;
  const scene::Geometry& g = scene_.geometry;
  const Corners c = corners(hit.instance, hit.triangle);
  const Vertex i = vertices(hit.instance, hit.triangle);
  Surface s;
  s.position = between(c.a, c.b, c.c, hit.u, hit.v);
  const vec3 reach = glm::max(glm::abs(c.a), glm::max(glm::abs(c.b), glm::abs(c.c)));
  s.epsilon = 1e-7f + 4e-6f * std::max(reach.x, std::max(reach.y, reach.z));
  s.ng = front_normal(hit.instance, hit.triangle);
  const bool front = glm::dot(s.ng, direction) <= 0;
  if (!front) s.ng = -s.ng;

  // A deformed instance has vertices of its own.
  const bool own = !instance.normal.empty();
  const uint32_t first = own ? instance.primitive->vertex_offset : 0;
  const auto at_hit = [&](const auto& rows) {
    return between(rows[i.a - first], rows[i.b - first], rows[i.c - first], hit.u, hit.v);
  };
  const vec3 interpolated = instance.cofactor * at_hit(own ? instance.normal : g.normal);
  const float length = glm::length(interpolated);
  s.n = length > 0 ? interpolated / length : s.ng;
  if (length > 0 && !front) s.n = -s.n;
  const auto looked_up = [&](uint32_t row, scene::Slot slot) { return texture(row, uv(m, slot, i, hit.u, hit.v)); };
  const vec4 tangent = at_hit(own ? instance.tangent : g.tangent);
  if (m.normal_texture != scene::none && !lambert_ && glm::dot(vec3(tangent), vec3(tangent)) > 0) {
    vec3 t = instance.linear * vec3(tangent);
    t = glm::normalize(t - s.n * glm::dot(s.n, t));
    const vec3 b = glm::cross(s.n, t) * (tangent.w * instance.mirrored);
    const vec3 mapped = vec3(looked_up(m.normal_texture, scene::Slot::Normal)) * 2.0f - 1.0f;
    const vec3 n = t * (mapped.x * m.normal_scale) + b * (mapped.y * m.normal_scale) + s.n * mapped.z;
    if (glm::dot(n, n) > 1e-12f && std::isfinite(glm::dot(n, n))) s.n = glm::normalize(n);
  }

  vec4 base = m.base_color * between(g.color[i.a], g.color[i.b], g.color[i.c], hit.u, hit.v);
  if (m.base_color_texture != scene::none) base *= looked_up(m.base_color_texture, scene::Slot::BaseColor);
  s.albedo = glm::clamp(vec3(base) * albedo_scale_, vec3(0), vec3(1));
  if (m.unlit) {
    s.emission = vec3(base) * emissive_scale_;
    s.albedo = vec3(0);
    return s;
  }
  if (front || m.double_sided) s.emission = emission(hit.instance, hit.triangle, hit.u, hit.v);
  if (lambert_) {
    s.diffuse = s.albedo;
    return s;
  }
  float metallic = m.metallic;
  s.roughness = m.roughness;
  if (m.metallic_roughness_texture != scene::none) {
    const vec4 texel = looked_up(m.metallic_roughness_texture, scene::Slot::MetallicRoughness);
    metallic *= texel.z;
    s.roughness *= texel.y;
  }
  const float reflected = (m.ior - 1) / (m.ior + 1);
  float specular = m.specular;
  vec3 tint = m.specular_color;
  if (m.specular_texture != scene::none) specular *= looked_up(m.specular_texture, scene::Slot::Specular).w;
  if (m.specular_color_texture != scene::none)
    tint *= vec3(looked_up(m.specular_color_texture, scene::Slot::SpecularColor));
  const float f0 = std::min(reflected * reflected * std::max({tint.x, tint.y, tint.z}), 1.0f) * specular;
  s.f0 = glm::mix(vec3(f0), s.albedo, metallic);
  s.diffuse = s.albedo * ((1 - metallic) * (1 - f0));
  return s;
}

}  // namespace nf::reference
