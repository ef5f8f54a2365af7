// Rays through the depth buffer, as screen-space reflections trace them: the baseline of the visibility-bitmask paper's Figure
// 16. A ray ends where it enters what is taken as solid, and then brings that texel's light. Compiles as GLSL and as C++;
// beside what gi/hemisphere.glsl needs the including file provides `raymarch` with its choices (passes/gi/raymarch_params.h) as
// constants RAYMARCH_*, FETCH_RADIANCE, and
// environment_from(direction), environment_over(normal) as gi/bitmask.glsl has them.
#ifndef NF_GI_RAYMARCH_GLSL
#define NF_GI_RAYMARCH_GLSL

#include "gi/hemisphere.glsl"
#include "gi/inspect.glsl"

const int HIT_CROSSING = 0;

// A step ends inside something, or (crossing) has passed through its front: then the last depth was before it.
bool hits(Receiver receiver, Probe probe, vec3 offset, float last_depth) {
  if (probe.depth <= 0.0f || probe.behind <= 0.0f) return false;
  if (!rises(receiver, probe)) return false;
  if (RAYMARCH_HIT == HIT_CROSSING && last_depth <= probe.depth) return true;
  return is_inside(receiver, probe, offset);
}

Gathered estimate_raymarch(ivec2 pixel) {
  Gathered result;
  result.visibility = 1.0f;
  result.bent = vec3(0.0f);
  result.gi = vec3(0.0f);
  result.ambient = vec3(0.0f);
  Receiver receiver = make_receiver(pixel);
  if (receiver.depth <= 0.0f) return result;
  INSPECT_RECEIVER(receiver);

  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  // What an open hemisphere gives is known: rays that hit are taken off it, so that open surfaces are free of noise.
  result.bent = receiver.normal * (2.0f / 3.0f);
  result.ambient = environment_over(receiver.normal);
  int rays = raymarch.rays;
  float share = 1.0f / float(rays);
  Steps steps = make_steps();
  for (int i = 0; i < rays; ++i) {
    vec3 u = turned_point(noise, i);
    vec3 direction = cosine_direction(receiver.normal, u.x, u.y);
    INSPECT_RAY(i, share, direction, receiver);
    float last_depth = receiver.depth;
    bool hit = false;
    for (int k = 0; k < steps.count && !hit; ++k) {
      float x = (float(k) + steps.base + (GI_STEP_JITTER != 0 ? rotated(u.z, k) : 0.0f)) * steps.scale;
      vec3 offset = direction * (receiver.radius * step_power(x, steps.parts));
      Probe probe = probe_at(receiver, offset);
      hit = hits(receiver, probe, offset, last_depth);
      last_depth = receiver.depth - offset.z;
      INSPECT_LIGHT(result.gi);
      if (hit && faces(probe)) result.gi += share * unpack_rgb9e5(FETCH_RADIANCE(probe.texel));
      INSPECT_POINT(k, probe, receiver, offset, false, hit, hit ? 1.0f : 0.0f, (result.gi - inspect_light) / share);
    }
    if (hit) {
      result.visibility -= share;
      result.bent -= share * direction;
      if (RAYMARCH_AMBIENT != 0) result.ambient -= share * environment_from(direction);
    }
  }
  return result;
}

#endif
