// Horizon techniques: what is seen beneath the highest sample on each side of a slice is taken as solid down to the tangent
// plane. HORIZON_UNIFORM 0: the open part by projected solid angle, GTAO (Jimenez et al. 2016); 1: by solid angle, HBAO
// (Bavoil, Sainz, Dimitrov 2008). Compiles as GLSL and as C++; beside what gi/march.glsl needs the including file provides
// `horizon` with its choices (passes/gi/horizon_params.h) as constants HORIZON_*.
#ifndef NF_GI_HORIZON_GLSL
#define NF_GI_HORIZON_GLSL

#include "gi/inspect.glsl"
#include "gi/march.glsl"

const int FALLOFF_QUADRATIC = 1;

struct Openness {
  float visibility;  // 1 = open
  vec3 bent;         // mean of the open directions, weighted by the measure; view space, not unit
};

// The measure's share of a slice beyond an angle of one side, from its sine: 0 at the tangent plane.
float share_beyond(Slice slice, float total, float s) {
  if (HORIZON_UNIFORM != 0)
    return 0.5f * (slice.cos_gamma * sqrt(max(1.0f - s * s, 0.0f)) - slice.sin_gamma * (1.0f - s));
  return 1.0f - measure_cdf(make_measure(slice.cos_gamma, slice.sin_gamma, total), s, slice_k_exact(s));
}

// What a side found: the sine of its horizon, and the share that it covers; the two tell the same unless samples count for less
// with their distance.
struct Horizon {
  float s;
  float covered;
};

float occluder_weight(Receiver receiver, vec3 towards) {
  float distance2 = dot(towards, towards);
  if (HORIZON_FALLOFF == FALLOFF_QUADRATIC) return max(1.0f - distance2 / (receiver.radius * receiver.radius), 0.0f);
  return radius_weight(receiver, sqrt(distance2));
}

bool weighted() { return HORIZON_FALLOFF == FALLOFF_QUADRATIC || GI_RADIUS_MODE == RADIUS_BALL_FALLOFF; }

// Oblique: a sample that rises above the horizon adds what it covers beyond it, by its weight (as HBAO's increments). A sample
// below may lower the horizon by a share: the thin-occluder heuristic of GTAO, section 4.
Horizon find_horizon(Receiver receiver, Slice slice, Side side, float total) {
  Steps steps = make_steps();
  float lowering = horizon.thin_occluder;
  Horizon found;
  found.s = cos(radians(horizon.bias));
  found.covered = 0.0f;
  float start = share_beyond(slice, total, found.s);
  float covered_share = start;
  for (int i = 0; i < steps.count; ++i) {
    Tap tap = take_tap(receiver, side, steps, i);
    INSPECT_HORIZON(found.s, found.covered, vec3(0.0f));
    float s = tap.depth > 0.0f ? side_sine(tap.s, tap.c, tap.m, side.sin_gamma) : 1.0f;
    if (GI_RADIUS_MODE == RADIUS_BALL && HORIZON_FALLOFF != FALLOFF_QUADRATIC)
      s = dot(tap.towards, tap.towards) < receiver.radius * receiver.radius ? s : 1.0f;
    if (weighted()) {
      float weight = occluder_weight(receiver, tap.towards);
      float share = share_beyond(slice, total, s);
      found.covered += s < found.s ? weight * (share - covered_share) : 0.0f;
      covered_share = max(covered_share, share);
      found.s = min(found.s, s);
    } else {
      found.s = s < found.s ? s : mix(found.s, min(s, cos(radians(horizon.bias))), lowering);
    }
    INSPECT_RAISED(i, tap, INSPECT_OUTSIDE_RADIUS(tap), found.s, s,
                   weighted() ? found.covered - inspect_horizon.y
                              : share_beyond(slice, total, found.s) - share_beyond(slice, total, inspect_horizon.x),
                   vec3(0.0f));
  }
  if (!weighted()) found.covered = share_beyond(slice, total, found.s) - start;
  return found;
}

// As printed: the greatest cosine of a sample's angle from V, in three dimensions; far samples are mixed towards the tangent
// plane, cosines and not angles (XeGTAO does so too).
Horizon find_view_horizon(Receiver receiver, Slice slice, Side side, float total) {
  Steps steps = make_steps();
  float lowering = horizon.thin_occluder;
  float bias_s = cos(radians(horizon.bias));
  float bias_c = sin(radians(horizon.bias));
  float lowest = side.cos_gamma * bias_c + side.sin_gamma * bias_s;  // cos(pi/2 - bias - gamma)
  float highest = lowest;
  for (int i = 0; i < steps.count; ++i) {
    Tap tap = take_tap(receiver, side, steps, i);
    INSPECT_HORIZON(min(view_sine(highest, side.sin_gamma, side.cos_gamma), bias_s), 0.0f, vec3(0.0f));
    float cosine = view_cosine(receiver, tap.towards);
    if (weighted() || GI_RADIUS_MODE == RADIUS_BALL) cosine = mix(lowest, cosine, occluder_weight(receiver, tap.towards));
    cosine = tap.depth > 0.0f ? cosine : lowest;
    highest = cosine > highest ? cosine : mix(highest, max(cosine, lowest), lowering);
    INSPECT_RAISED(i, tap, INSPECT_OUTSIDE_RADIUS(tap), min(view_sine(highest, side.sin_gamma, side.cos_gamma), bias_s),
                   view_sine(cosine, side.sin_gamma, side.cos_gamma),
                   share_beyond(slice, total, min(view_sine(highest, side.sin_gamma, side.cos_gamma), bias_s)) -
                       share_beyond(slice, total, inspect_horizon.x),
                   vec3(0.0f));
  }
  Horizon found;
  found.s = min(view_sine(highest, side.sin_gamma, side.cos_gamma), bias_s);
  found.covered = share_beyond(slice, total, found.s) - share_beyond(slice, total, bias_s);
  return found;
}

// First moment of uniform solid angle between V and the angle of sine s on its side, in the slice's axes (HBIL, eq 5 and 6).
vec2 uniform_moment(Slice slice, float s) {
  float c = sqrt(max(1.0f - s * s, 0.0f));
  float sin_a = s * slice.cos_gamma - c * slice.sin_gamma;
  float cos_a = c * slice.cos_gamma + s * slice.sin_gamma;
  float a = atan(sin_a, cos_a);
  float beside = 0.5f * (a - sin_a * cos_a);
  float along = 0.5f * sin_a * sin_a;
  // From V's axes (across, V) to the slice's.
  return vec2(beside * slice.cos_gamma + along * slice.sin_gamma, along * slice.cos_gamma - beside * slice.sin_gamma);
}

vec2 open_moment(Slice slice, float s) {
  if (HORIZON_UNIFORM != 0) return 0.5f * uniform_moment(slice, s);
  return slice_moment(slice, s, sqrt(max(1.0f - s * s, 0.0f)));
}

Openness estimate_horizons(ivec2 pixel) {
  Openness result;
  result.visibility = 1.0f;
  result.bent = vec3(0.0f);
  Receiver receiver = make_receiver(pixel);
  if (receiver.depth <= 0.0f) return result;
  INSPECT_RECEIVER(receiver);

  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  int slices = gi.slices;
  float weights = 0.0f;
  for (int i = 0; i < slices; ++i) {
    vec3 direction = slice_direction(receiver, i, noise.x);
    Slice slice = make_slice(receiver.v, receiver.normal, direction);
    float total = slice_total(slice.cos_gamma, slice.sin_gamma, slice_k_exact(slice.sin_gamma));
    float weight = slice_azimuth_weight(receiver, direction);
    float measure = HORIZON_UNIFORM != 0 ? 1.0f : slice.n_length * total;
    float moment = HORIZON_UNIFORM != 0 ? 1.0f : slice.n_length;
    weights += weight * measure;
    for (int back_side = 0; back_side < 2; ++back_side) {
      Side side = make_side(receiver, slice, direction, back_side == 0 ? 1.0f : -1.0f);
      side.noise = rotated(noise.y, step_index(2 * i + back_side, 0, gi.steps));
      Horizon found;
      found.s = 1.0f;
      found.covered = 0.0f;
      INSPECT_SIDE(i, back_side, side);
      if (side.pixels >= 1.0f) {
        if (GI_PROJECTION == PROJECTION_VIEW_COSINE)
          found = find_view_horizon(receiver, slice, side, total);
        else
          found = find_horizon(receiver, slice, side, total);
      }
      result.visibility -= weight * measure * found.covered / float(slices);
#if HORIZON_BENT
      vec2 open = open_moment(slice, found.s);
      result.bent += (weight * moment / float(slices)) * (slice.tangent * open.x + slice.normal * open.y);
#endif
      slice = mirror(slice);
    }
    INSPECT_SLICE(weight * measure / float(slices),
                  (GI_SLICE_MEASURE == SLICES_SCREEN ? weight * measure : 1.0f) / float(slices), weight, total, slice,
                  direction);
  }
  // As in gi/bitmask.glsl: the weights have the mean 1, except for slices uniform on the screen.
  if (GI_SLICE_MEASURE == SLICES_SCREEN) result.visibility += weights / float(slices) - 1.0f;
  return result;
}

// Light that bounces between the occluders, for surfaces as bright as this one: a fit for albedo up to 0.8 (GTAO, eq 10).
float multi_bounce(float visibility, float albedo) {
  float a = 2.0404f * albedo - 0.3324f;
  float b = -4.7951f * albedo + 0.6417f;
  float c = 2.7552f * albedo + 0.6903f;
  return max(visibility, ((visibility * a + b) * visibility + c) * visibility);
}

#endif
