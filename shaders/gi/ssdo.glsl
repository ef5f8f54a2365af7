// Screen-space directional occlusion (Ritschel, Grosch, Seidel 2009, section 3): each direction of the hemisphere has one
// point, at a random distance; where that lies behind what is seen, the direction is taken from the environment, and what
// is seen there sends its light. Compiles as GLSL and as C++; beside what gi/hemisphere.glsl needs the including file provides
// `ssdo` with its choices (passes/gi/ssdo_params.h) as constants SSDO_*, FETCH_RADIANCE, and
// environment_from(direction), environment_over(normal) as gi/bitmask.glsl has them.
#ifndef NF_GI_SSDO_GLSL
#define NF_GI_SSDO_GLSL

#include "gi/hemisphere.glsl"
#include "gi/inspect.glsl"

const int DIRECTIONS_COSINE = 0;
const int BLOCKER_ALL_BEHIND = 0;
const int SENDER_DISC = 0;
const int SENDER_SOLID_ANGLE = 1;

// Form factor of a sender, times the number of samples.
float sender_weight(Receiver receiver, Probe probe, float area, float cosine_weight) {
  if (SSDO_SENDER == SENDER_SOLID_ANGLE) return faces(probe) ? cosine_weight : 0.0f;
  vec3 sender = unpack_normal(FETCH_NORMAL(probe.texel));
  float share = SSDO_SENDER == SENDER_DISC ? sender_share(receiver, probe, sender, area)
                                           : sender_share_printed(receiver, probe, sender, 1.0f);
  return ssdo.strength * share * area * (float(ssdo.samples) / PI);
}

Gathered estimate_ssdo(ivec2 pixel) {
  Gathered result;
  result.visibility = 1.0f;
  result.bent = vec3(0.0f);
  result.gi = vec3(0.0f);
  result.ambient = vec3(0.0f);
  Receiver receiver = make_receiver(pixel);
  if (receiver.depth <= 0.0f) return result;
  INSPECT_RECEIVER(receiver);

  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  bool by_cosine = SSDO_DIRECTIONS == DIRECTIONS_COSINE;
  // What an open hemisphere gives is known: the blocked directions are taken off it, so that open surfaces are free of noise.
  if (by_cosine) {
    result.bent = receiver.normal * (2.0f / 3.0f);
    result.ambient = environment_over(receiver.normal);
  }
  int count = ssdo.samples;
  float share = 1.0f / float(count);
  float area = PI * receiver.radius * receiver.radius * share;
  float fade_start = 1.0f - ssdo.fade;
  for (int i = 0; i < count; ++i) {
    vec3 u = turned_point(noise, i);
    vec3 direction = by_cosine ? cosine_direction(receiver.normal, u.x, u.y) : uniform_direction(receiver.normal, u.x, u.y);
    // cos / pi over the density of the direction.
    float cosine_weight = by_cosine ? 1.0f : 2.0f * u.y;
    vec3 offset = direction * (u.z * receiver.radius);
    Probe probe = probe_at(receiver, offset);
    bool inside = SSDO_BLOCKER == BLOCKER_ALL_BEHIND ? probe.behind > 0.0f : is_inside(receiver, probe, offset);
    float hidden = probe.depth > 0.0f && inside && rises(receiver, probe) ? 1.0f : 0.0f;
    // Section 7.2: blockers near the border of the hemisphere fade.
    if (ssdo.fade > 0.0f) hidden *= 1.0f - smoothstep(fade_start, 1.0f, length(probe.towards) / receiver.radius);
    INSPECT_LIGHT(result.gi);
    float counted = by_cosine ? -hidden * share : cosine_weight * (1.0f - hidden) * share;
    result.visibility -= cosine_weight * hidden * share;
    result.bent += counted * direction;
    if (SSDO_AMBIENT != 0 && counted != 0.0f) result.ambient += counted * environment_from(direction);
    if (SSDO_BOUNCE != 0 && hidden > 0.0f)
      result.gi += hidden * share * sender_weight(receiver, probe, area, cosine_weight) *
                   unpack_rgb9e5(FETCH_RADIANCE(probe.texel));
    INSPECT_POINT(i, probe, receiver, offset, inside && probe.behind > 0.0f && hidden <= 0.0f && ssdo.fade > 0.0f &&
                  rises(receiver, probe), hidden > 0.0f, cosine_weight * hidden, (result.gi - inspect_light) / share);
  }
  INSPECT_POINTS(share, receiver);
  return result;
}

#endif
