// Ambient occlusion from points in a hemisphere, with colour bleeding (Colliander, Tornquist 2015, after Chapman 2011 and
// Ritschel et al. 2009): a point that lies behind what is seen there counts as occluded, and what is seen sends its light.
// Compiles as GLSL and as C++; beside what gi/hemisphere.glsl needs the including file provides `ssao` with its choices
// (passes/gi/ssao_params.h) as constants SSAO_*, FETCH_RADIANCE and, with SSAO_BLEED, ambient_of(texel).
#ifndef NF_GI_SSAO_GLSL
#define NF_GI_SSAO_GLSL

#include "gi/hemisphere.glsl"
#include "gi/inspect.glsl"

const int KERNEL_COSINE = 0;
const int RANGE_NONE = 0;
const int RANGE_CONSTANT = 1;
const int RANGE_LINEAR = 2;
const int RANGE_QUADRATIC = 3;
const int SELF_PLANE = 0;
const int BLEED_DISC = 0;
const int SHOW_TANGENTS = 1;

// Chapman's kernel: directions from a cube's upper half, lengths that grow with the square of the index.
vec3 chapman_point(int i, int count) {
  uint x = hash_uint(uint(i));
  uint y = hash_uint(x);
  uint z = hash_uint(y);
  vec3 corner = vec3(2.0f * unit_float(x) - 1.0f, 2.0f * unit_float(y) - 1.0f, 0.05f + 0.95f * unit_float(z));
  float share = float(i) / float(count);
  return normalize(corner) * (0.1f + 0.9f * share * share);
}

// A frame about the normal whose tangent is turned by the noise: Gram-Schmidt, from a fixed vector or, where that is parallel
// to the normal, another.
vec3 turned_about(vec3 normal, vec3 p, float turn) {
  vec3 fixed_axis = abs(normal.y) < 0.99f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f);
  vec3 first = normalize(cross(fixed_axis, normal));
  vec3 second = cross(normal, first);
  vec3 tangent = first * cos(2.0f * PI * turn) + second * sin(2.0f * PI * turn);
  return tangent * p.x + cross(normal, tangent) * p.y + normal * p.z;
}

vec3 sample_offset(Receiver receiver, vec3 noise, int i) {
  if (SSAO_KERNEL == KERNEL_COSINE) {
    vec3 u = turned_point(noise, i);
    return cosine_direction(receiver.normal, u.x, u.y) * (u.z * receiver.radius);
  }
  return turned_about(receiver.normal, chapman_point(i, ssao.samples), noise.x) * receiver.radius;
}

// How much an occluder counts, by its difference in depth from the receiver.
float range_weight(Receiver receiver, Probe probe) {
  float apart = abs(probe.depth - receiver.depth);
  if (SSAO_RANGE == RANGE_NONE) return 1.0f;
  float nearness = ssao.range_depth / receiver.depth;
  if (SSAO_RANGE == RANGE_CONSTANT) return apart < ssao.range_limit ? 1.0f : 0.0f;
  if (SSAO_RANGE == RANGE_LINEAR) return apart < ssao.range_limit * nearness ? 1.0f : 0.0f;
  if (SSAO_RANGE == RANGE_QUADRATIC) return apart < ssao.range_limit * nearness * nearness ? 1.0f : 0.0f;
  return smoothstep(0.0f, 1.0f, receiver.radius / max(apart, 1e-6f * receiver.radius));
}

Gathered estimate_ssao(ivec2 pixel) {
  Gathered result;
  result.visibility = 1.0f;
  result.bent = vec3(0.0f);
  result.gi = vec3(0.0f);
  result.ambient = vec3(0.0f);
  Receiver receiver = make_receiver(pixel);
  if (receiver.depth <= 0.0f) return result;
  INSPECT_RECEIVER(receiver);

  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  if (SSAO_SHOW == SHOW_TANGENTS) {
    result.gi = vec3(0.5f) + 0.5f * turned_about(receiver.normal, vec3(1.0f, 0.0f, 0.0f), noise.x);
    return result;
  }
  int count = ssao.samples;
  float share = 1.0f / float(count);
  // The base circle in as many parts as there are samples (SSDO, section 3).
  float area = PI * receiver.radius * receiver.radius * share;
  float bias = ssao.bias;
  for (int i = 0; i < count; ++i) {
    vec3 offset = sample_offset(receiver, noise, i);
    Probe probe = probe_at(receiver, offset);
    bool behind = SSAO_SELF == SELF_PLANE ? probe.behind > 0.0f && rises(receiver, probe) : probe.behind > bias;
    float weight = probe.depth > 0.0f && behind ? range_weight(receiver, probe) : 0.0f;
    if (weight <= 0.0f) {
      INSPECT_POINT(i, probe, receiver, offset, behind, false, 0.0f, vec3(0.0f));
      continue;
    }
    INSPECT_LIGHT(result.gi);
    result.visibility -= weight * share;
    if (SSAO_BLEED != 0) {
      vec3 sender = unpack_normal(FETCH_NORMAL(probe.texel));
      float arriving = SSAO_SENDER == BLEED_DISC
                           ? sender_share(receiver, probe, sender, area) * area / PI
                           : sender_share_printed(receiver, probe, sender, 0.0f) * ssao.sender_area;
      if (arriving > 0.0f)
        result.gi += weight * arriving * (unpack_rgb9e5(FETCH_RADIANCE(probe.texel)) + ambient_of(probe.texel));
    }
    INSPECT_POINT(i, probe, receiver, offset, false, true, weight, (result.gi - inspect_light) / share);
  }
  if (SSAO_BLEED != 0) {
    // The report's filter: dark surfaces show no bleed.
    vec3 own = unpack_rgb9e5(FETCH_RADIANCE(pixel));
    float lit = dot(own, vec3(0.2126f, 0.7152f, 0.0722f));
    float strength = ssao.bleed_strength * (ssao.damping > 0.0f ? min(lit / ssao.damping, 1.0f) : 1.0f);
    result.gi *= strength;
    INSPECT_GAIN(strength);
  }
  INSPECT_POINTS(share, receiver);
  return result;
}

#endif
