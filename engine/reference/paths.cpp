// Two walks a sample: one of cosine-distributed directions from diffuse surface to diffuse surface for gi, ambient and
// visibility; and, where the scene has specular reflection and it is asked for, one of all lobes.
#include "reference/paths.h"

#include "reference/scatter.h"
#include "scene/camera.h"

namespace nf::reference {
namespace {

constexpr float far_away = std::numeric_limits<float>::infinity();

bool is_black(vec3 c) {
  return c.x == 0 && c.y == 0 && c.z == 0;
}

// Off the surface by the error of its position.
vec3 start(const Surface& s) {
  return s.position + s.ng * s.epsilon;
}

// Walks need the direction to the eye on the normal's side; the shader clamps alike.
vec3 seen_from(const mat3& frame, vec3 towards_eye) {
  vec3 v = glm::transpose(frame) * towards_eye;
  v.z = std::max(v.z, 1e-4f);
  return glm::normalize(v);
}

struct Reflected {
  vec3 diffuse{0}, specular{0};
};

// Light of suns, points and spots that `s` sends towards -direction. Below the geometric surface everything is dark.
Reflected direct_light(const Integrator& it, const Surface& s, vec3 direction, Stream* stream, uint64_t& ray_count) {
  Reflected out;
  const mat3 frame = frame_about(s.n);
  const vec3 v = seen_from(frame, -direction);
  for (size_t i = 0; i < it.lights.count(); ++i) {
    const Arriving a = it.lights.arriving(i, s, stream ? stream->next2() : vec2(0.5f));
    const float n_l = glm::dot(s.n, a.to_light);
    if (n_l <= 0 || is_black(a.irradiance) || glm::dot(s.ng, a.to_light) <= 0) continue;
    ++ray_count;
    const float open = it.rays.open({start(s), a.to_light, 0, a.distance});
    if (open == 0) continue;
    out.diffuse += a.irradiance * s.diffuse * (open * n_l / pi);
    if (!is_black(s.f0)) {
      const vec3 l = glm::transpose(frame) * a.to_light;
      out.specular += a.irradiance * open * reference::specular(s.f0, alpha_of(s.roughness), v, l);
    }
  }
  return out;
}

struct Emitted {
  vec3 radiance{0}, to_light{0};
  float distance = 0;
  float density = 0;  // per solid angle, as seen from the receiver
};

// One emissive point that `s` sees.
Emitted seen_emitter(const Integrator& it, const Surface& s, Stream& stream, uint64_t& ray_count) {
  Emitted out;
  const float choice = stream.next1();
  const EmitterPoint e = it.lights.emitter_point(s.position, choice, stream.next2());
  if (e.density == 0) return out;
  const vec3 to = e.position - s.position;
  const float distance2 = glm::dot(to, to);
  if (!(distance2 > 0)) return out;
  out.distance = std::sqrt(distance2);
  out.to_light = to / out.distance;
  const float cosine = -glm::dot(e.ng, out.to_light);
  if (cosine <= 0 || glm::dot(s.n, out.to_light) <= 0 || glm::dot(s.ng, out.to_light) <= 0) return out;
  const vec3 origin = start(s), end = e.position + e.ng * e.epsilon;
  ++ray_count;
  const float open = it.rays.open({origin, end - origin, 0, 1});
  if (open == 0) return out;
  out.density = e.density * distance2 / cosine;
  out.radiance = e.radiance * open;
  return out;
}

// The density, per solid angle, with which seen_emitter would have chosen a hit.
float emitter_density(const Integrator& it, const Hit& hit, const Surface& at, vec3 from, vec3 direction) {
  const vec3 to = at.position - from;
  const float cosine = -glm::dot(at.ng, direction);
  return cosine > 0 ? it.lights.density(hit.instance, hit.triangle) * glm::dot(to, to) / cosine : 0;
}

// Balance heuristic. `mine` and `other` are the densities of the two ways to find the same point.
float weight(const Integrator& it, EmitterSampling way, float mine, float other) {
  if (!it.lights.any_emitters()) return 1;
  if (it.settings.emitters != EmitterSampling::Both) return it.settings.emitters == way ? 1.0f : 0.0f;
  return mine / (mine + other);
}

// Whether bright texels of the environment are chosen, too.
bool chooses_sky(const Integrator& it) {
  return it.lights.sky().any() && it.settings.sky == SkySampling::Both;
}

// The balance heuristic's weight of a direction that a lobe of density `mine` gave and that found the sky.
float sky_weight(const Integrator& it, vec3 direction, float mine) {
  return chooses_sky(it) ? mine / (mine + it.lights.sky().density(direction)) : 1;
}

struct SkyLight {
  vec3 radiance{0}, to_light{0};
  float density = 0;  // per solid angle; 0: nothing is seen there
};

// A bright direction of the sky, where `s` sees it.
SkyLight seen_sky(const Integrator& it, const Surface& s, Stream& stream, uint64_t& ray_count) {
  const Sky::Choice c = it.lights.sky().choose(stream.next2());
  if (!(c.density > 0) || glm::dot(s.n, c.direction) <= 0 || glm::dot(s.ng, c.direction) <= 0) return {};
  ++ray_count;
  const float open = it.rays.open({start(s), c.direction, 0, far_away});
  if (open == 0) return {};
  return {it.world.environment(c.direction) * open, c.direction, c.density};
}

// What `s` gets of the sky over pi, by that choice and with its weight against cosine-distributed directions.
vec3 chosen_sky(const Integrator& it, const Surface& s, Stream& stream, uint64_t& ray_count) {
  const SkyLight l = seen_sky(it, s, stream, ray_count);
  if (!(l.density > 0)) return vec3(0);
  const float cosine = glm::dot(s.n, l.to_light) / pi;
  return l.radiance * (cosine / (l.density + cosine));
}

// How open a direction is whose first hit is at distance t; techniques.md's three meanings of the radius.
float openness(const Settings& settings, vec3 receiver, vec3 direction, float distance) {
  const float radius = settings.radius;
  switch (settings.radius_mode) {
    case RadiusMode::Ball:
      return distance < radius ? 0.0f : 1.0f;
    case RadiusMode::BallFalloff: {
      if (radius == far_away) return 0;
      const float edge = std::max(settings.falloff * radius, 1e-6f);
      return 1 - std::clamp((radius - distance) / edge, 0.0f, 1.0f);
    }
    case RadiusMode::Disc: {
      if (radius == far_away) return 0;
      const scene::mat4 view = scene::view_from_world(settings.camera);
      const vec3 p(view * vec4(receiver, 1)), q(view * vec4(receiver + direction * distance, 1));
      if (p.z >= -1e-6f) return distance < radius ? 0.0f : 1.0f;  // a later bounce: in no picture, so no disc
      if (q.z >= -1e-6f) return 1;                                // behind the eye: in no picture
      const vec2 apart = vec2(q) / -q.z - vec2(p) / -p.z;
      return glm::length(apart) * -p.z <= radius ? 0.0f : 1.0f;
    }
  }
  return 1;
}

void diffuse_walk(const Integrator& it, Stream& stream, PixelSample& sample, uint64_t& ray_count) {
  const Settings& settings = it.settings;
  const uint32_t bounces = it.wanted.gi ? settings.bounces : 0;
  const bool gathers_sky = settings.include_ambient && bounces > 0;
  const bool first = it.wanted.visibility || it.wanted.ambient;
  const bool surfaces = it.lights.any_emitters() && settings.emitters != EmitterSampling::Directions;
  Surface s = sample.surface;
  vec3 throughput(1);
  const uint32_t rays = std::max<uint32_t>(bounces + gathers_sky, first);
  for (uint32_t k = 0; k < rays; ++k) {
    if (surfaces && k < bounces) {
      const Emitted e = seen_emitter(it, s, stream, ray_count);
      if (e.density > 0) {
        const float cosine = glm::dot(s.n, e.to_light);
        float w = weight(it, EmitterSampling::Surfaces, e.density, cosine / pi);
        if (settings.bound_gi) w *= 1 - openness(settings, s.position, e.to_light, e.distance);
        sample.gi[k] += throughput * e.radiance * (w * cosine / (pi * e.density));
      }
    }
    if (chooses_sky(it)) {
      if (k == 0 && it.wanted.ambient) sample.ambient += s.diffuse * chosen_sky(it, s, stream, ray_count);
      if (k > 0 && gathers_sky) sample.gi[k - 1] += throughput * chosen_sky(it, s, stream, ray_count);
    }
    const vec3 direction = frame_about(s.n) * cosine_direction(stream.next2());
    const float cosine = glm::dot(s.n, direction);
    // Below the geometric surface there is only its own inside.
    const bool inside = glm::dot(direction, s.ng) <= 0 || cosine <= 0;
    Hit hit;
    if (!inside) {
      ++ray_count;
      hit = it.rays.closest({start(s), direction, 0, far_away});
    }
    if (k == 0) {
      sample.visibility = inside ? 0 : hit.any() ? openness(settings, s.position, direction, hit.t) : 1;
      sample.bent = direction * sample.visibility;
    }
    if (inside) return;
    if (!hit.any()) {
      const vec3 sky = it.world.environment(direction) * sky_weight(it, direction, cosine / pi);
      if (k == 0) sample.ambient += s.diffuse * sky;
      if (k > 0 && gathers_sky) sample.gi[k - 1] += throughput * sky;
      return;
    }
    if (k >= bounces) return;
    if (settings.bound_gi) throughput *= 1 - openness(settings, s.position, direction, hit.t);
    const Surface y = it.world.surface(hit, direction);
    if (!is_black(y.emission)) {
      const float other = emitter_density(it, hit, y, s.position, direction);
      sample.gi[k] += throughput * y.emission * weight(it, EmitterSampling::Directions, cosine / pi, other);
    }
    if (it.lights.count() > 0) sample.gi[k] += throughput * direct_light(it, y, direction, &stream, ray_count).diffuse;
    throughput *= y.diffuse;
    if (is_black(throughput)) return;
    s = y;
  }
}

// Light straight from the environment over the specular lobe.
void ambient_specular(const Integrator& it, vec3 direction, Stream& stream, PixelSample& sample, uint64_t& ray_count) {
  const Surface& s = sample.surface;
  const mat3 frame = frame_about(s.n);
  const vec3 v = seen_from(frame, -direction);
  const float alpha = alpha_of(s.roughness);
  if (chooses_sky(it)) {
    const SkyLight sky = seen_sky(it, s, stream, ray_count);
    if (sky.density > 0) {
      const vec3 to_light = glm::transpose(frame) * sky.to_light;
      sample.ambient += reference::specular(s.f0, alpha, v, to_light) * sky.radiance /
                        (sky.density + specular_density(alpha, v, to_light));
    }
  }
  const vec3 l = specular_direction(alpha, v, stream.next2());
  const float density = specular_density(alpha, v, l);
  const vec3 out = frame * l;
  if (density <= 0 || glm::dot(out, s.ng) <= 0) return;
  const vec3 reflected =
      reference::specular(s.f0, alpha, v, l) * it.world.environment(out) * (sky_weight(it, out, density) / density);
  if (is_black(reflected)) return;
  ++ray_count;
  sample.ambient += reflected * it.rays.open({start(s), out, 0, far_away});
}

// A vertex of the walk over all lobes. `all` is the light that a path carries, `diffuse` the part of it whose every
// bounce was diffuse, which belongs to other layers.
struct Lobes {
  mat3 frame;
  vec3 v;
  float alpha, share;  // of specular directions
  const Surface& s;

  Lobes(const Surface& surface, vec3 direction)
      : frame(frame_about(surface.n)), v(seen_from(frame, -direction)), alpha(alpha_of(surface.roughness)), s(surface) {
    const vec3 f = fresnel_schlick(s.f0, v.z);
    const float d = s.diffuse.x + s.diffuse.y + s.diffuse.z, g = f.x + f.y + f.z;
    share = d + g > 0 ? std::clamp(g / (d + g), 0.1f, 1.0f) : 1.0f;
  }
  float density(vec3 l) const { return l.z <= 0 ? 0 : share * specular_density(alpha, v, l) + (1 - share) * l.z / pi; }
  vec3 diffuse_lobe(vec3 l) const { return s.diffuse * (std::max(l.z, 0.0f) / pi); }
  vec3 specular_lobe(vec3 l) const { return reference::specular(s.f0, alpha, v, l); }
  vec3 sample(Stream& stream) const {
    const bool glossy = stream.next1() < share;
    const vec2 u = stream.next2();
    return glossy ? specular_direction(alpha, v, u) : cosine_direction(u);
  }
};

void specular_walk(const Integrator& it, vec3 direction, Stream& stream, PixelSample& sample, uint64_t& ray_count) {
  const Settings& settings = it.settings;
  const bool surfaces = it.lights.any_emitters() && settings.emitters != EmitterSampling::Directions;
  Surface s = sample.surface;
  vec3 all(1), diffuse(1);
  for (uint32_t k = 0; k < settings.bounces + settings.include_ambient; ++k) {
    const Lobes lobes(s, direction);
    if (surfaces && k < settings.bounces) {
      const Emitted e = seen_emitter(it, s, stream, ray_count);
      const vec3 l = glm::transpose(lobes.frame) * e.to_light;
      if (e.density > 0 && l.z > 0) {
        const float w = weight(it, EmitterSampling::Surfaces, e.density, lobes.density(l)) / e.density;
        const vec3 both = lobes.diffuse_lobe(l) + lobes.specular_lobe(l);
        sample.specular += (all * both - diffuse * lobes.diffuse_lobe(l)) * e.radiance * w;
      }
    }
    if (k > 0 && settings.include_ambient && chooses_sky(it)) {
      const SkyLight sky = seen_sky(it, s, stream, ray_count);
      const vec3 to_light = glm::transpose(lobes.frame) * sky.to_light;
      if (sky.density > 0)
        sample.specular += (all * (lobes.diffuse_lobe(to_light) + lobes.specular_lobe(to_light)) -
                            diffuse * lobes.diffuse_lobe(to_light)) *
                           sky.radiance / (sky.density + lobes.density(to_light));
    }
    const vec3 l = lobes.sample(stream);
    const float density = lobes.density(l);
    const vec3 out = lobes.frame * l;
    if (density <= 0 || glm::dot(out, s.ng) <= 0) return;
    all *= (lobes.diffuse_lobe(l) + lobes.specular_lobe(l)) / density;
    diffuse *= lobes.diffuse_lobe(l) / density;
    if (is_black(all)) return;
    ++ray_count;
    const Hit hit = it.rays.closest({start(s), out, 0, far_away});
    if (!hit.any()) {
      if (k > 0 && settings.include_ambient)
        sample.specular += (all - diffuse) * it.world.environment(out) * sky_weight(it, out, density);
      return;
    }
    if (k >= settings.bounces) return;
    const Surface y = it.world.surface(hit, out);
    if (!is_black(y.emission)) {
      const float other = emitter_density(it, hit, y, s.position, out);
      sample.specular += (all - diffuse) * y.emission * weight(it, EmitterSampling::Directions, density, other);
    }
    if (it.lights.count() > 0) {
      const Reflected r = direct_light(it, y, out, &stream, ray_count);
      sample.specular += all * (r.diffuse + r.specular) - diffuse * r.diffuse;
    }
    s = y;
    direction = out;
  }
}

}  // namespace

Ray camera_ray(const Settings& settings, vec2 pixel) {
  const scene::Camera& camera = settings.camera;
  const vec2 size(settings.size);
  const float ty = std::tan(camera.vfov * 0.5f), tx = ty * size.x / size.y;
  const vec3 in_view(pixel.x * 2 * tx / size.x - tx, ty - pixel.y * 2 * ty / size.y, -1);
  const mat3 world_from_view = glm::transpose(mat3(scene::view_from_world(camera)));
  return {camera.position, world_from_view * in_view, camera.near, far_away};
}

namespace {

PixelSample surface_sample(const Integrator& it, const Hit& hit, vec3 direction, uint64_t& ray_count) {
  PixelSample sample;
  sample.hit = true;
  sample.depth = hit.t;
  sample.surface = it.world.surface(hit, direction);
  if (it.wanted.direct && !it.lights.soft()) {
    const Reflected r = direct_light(it, sample.surface, direction, nullptr, ray_count);
    sample.direct_diffuse = r.diffuse;
    sample.direct_specular = r.specular;
  }
  return sample;
}

}  // namespace

PixelSample first_hit(const Integrator& it, const Ray& ray, uint64_t& ray_count) {
  std::vector<Hit> blended;
  ++ray_count;
  const Hit hit = it.rays.closest_seen(ray, &blended);
  const vec3 direction = glm::normalize(ray.direction);
  PixelSample sample;
  if (hit.any())
    sample = surface_sample(it, hit, direction, ray_count);
  else
    sample.background = it.world.environment(direction);
  for (const Hit& before : blended) {
    const float alpha = std::clamp(it.world.alpha(before.instance, before.triangle, before.u, before.v), 0.0f, 1.0f);
    sample.blended.push_back(surface_sample(it, before, direction, ray_count));
    sample.blended.back().weight = sample.weight * alpha;
    sample.weight *= 1 - alpha;
  }
  return sample;
}

void gather(const Integrator& it, const Ray& ray, Stream& stream, PixelSample& sample, uint64_t& ray_count) {
  for (PixelSample& before : sample.blended) gather(it, ray, stream, before, ray_count);
  if (!sample.hit) return;
  const vec3 direction = glm::normalize(ray.direction);
  if (it.wanted.direct && it.lights.soft()) {
    const Reflected r = direct_light(it, sample.surface, direction, &stream, ray_count);
    sample.direct_diffuse = r.diffuse;
    sample.direct_specular = r.specular;
  }
  sample.gi = {};
  sample.ambient = sample.specular = vec3(0);
  if (it.wanted.gi || it.wanted.ambient || it.wanted.visibility) diffuse_walk(it, stream, sample, ray_count);
  if (is_black(sample.surface.f0)) return;
  if (it.wanted.ambient) ambient_specular(it, direction, stream, sample, ray_count);
  if (it.wanted.specular) specular_walk(it, direction, stream, sample, ray_count);
}

}  // namespace nf::reference
