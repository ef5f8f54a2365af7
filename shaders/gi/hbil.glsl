// Horizon-based indirect lighting (Mayaux 2018): wherever a horizon rises, the surface that raised it sends its light through
// what it newly covers; what stays open is a cone around the bent normal, through which the environment shines. Compiles as
// GLSL and as C++; beside what gi/march.glsl needs the including file provides `hbil` with its choices
// (passes/gi/hbil_params.h) as constants HBIL_*, FETCH_RADIANCE, environment_cone(direction, cone, ao): irradiance / pi, and with
// HBIL_MIPS radiance_level(texel, level): the mean over 2^level x 2^level texels, level up to RADIANCE_LEVELS.
#ifndef NF_GI_HBIL_GLSL
#define NF_GI_HBIL_GLSL

#include "gi/inspect.glsl"
#include "gi/march.glsl"

const int SPACE_SHARED = 0;
const int REJECT_ONE_SIDED = 0;
const int REJECT_RUNNING = 1;
const int REJECT_CODE = 3;
const int CONE_COSINE = 0;
const int CONE_UNIFORM = 2;
const int FAR_SH_CONE = 0;
const int FAR_FACTOR = 1;

struct Lit {
  float visibility;  // cosine-weighted, 1 = open
  vec3 bent;         // unit, view space
  float cone;        // cosine of its half aperture
  vec3 gi;           // irradiance / pi
  vec3 ambient;      // irradiance / pi of the environment
};

// What the slices add up to.
struct Sums {
  float cosine_ao;
  float uniform_ao;
  vec3 bent;
  vec3 gi;
};

// --- closed forms, theta from the view vector; n = (n . D, n . V) ---

// The integral of (sin, cos)(theta) |sin theta| from theta_0 <= 0 to theta_1 >= 0 (equations 5 and 6). `printed`: with the
// printed sign, by which a symmetric slice leans to one side.
vec2 open_slice(float theta_0, float theta_1, bool printed) {
  float s0 = sin(theta_0);
  float c0 = cos(theta_0);
  float s1 = sin(theta_1);
  float c1 = cos(theta_1);
  float x = printed ? theta_1 - theta_0 + s0 * c0 - s1 * c1 : theta_1 + theta_0 - s0 * c0 - s1 * c1;
  return 0.5f * vec2(x, 2.0f - c0 * c0 - c1 * c1);
}

// The integral of n . (sin, cos) sin from theta_0 to theta_1, 0 <= theta_0 <= theta_1 (equation 18).
float horizon_increment(vec2 n, float theta_0, float theta_1) {
  float s0 = sin(theta_0);
  float c0 = cos(theta_0);
  float s1 = sin(theta_1);
  float c1 = cos(theta_1);
  return 0.5f * (n.x * (theta_1 - theta_0 + s0 * c0 - s1 * c1) + n.y * (c0 * c0 - c1 * c1));
}

// Cosine of the half aperture of the cone that is as open (equation 12 and its right form).
float cone_cosine(float cosine_ao, float uniform_ao) {
  if (HBIL_CONE == CONE_COSINE) return sqrt(clamp(1.0f - cosine_ao, 0.0f, 1.0f));
  return clamp(1.0f - (HBIL_CONE == CONE_UNIFORM ? uniform_ao : cosine_ao), 0.0f, 1.0f);
}

// Energy that irradiance at the bent normal times AO loses, given back (section 2.2.3); the paper's F0(alpha).
float energy_factor(float ao) { return ao * (1.0f + 0.5f * pow(max(1.0f - ao, 0.0f), 0.75f)); }

// The bands of irradiance's spherical harmonics through a cone, as shares of the hemisphere's (section 2.2.4).
vec3 cone_bands(float cone) {
  float t2 = cone * cone;
  return vec3(1.0f - t2, 1.0f - t2 * cone, 3.0f * (1.0f - t2 * t2) - 2.0f * (1.0f - t2));
}

// --- a sample's light ---

// What a side of a slice remembers of the samples before.
struct Running {
  vec3 light;
  float trust;  // REJECT_CODE: how much of a further one still counts
};

// The level of the radiance's mips whose texels are as wide as a step.
int step_level(Side side, Steps steps, int i) {
  float width = step_distance(side, steps, float(i + 1)) - step_distance(side, steps, float(i));
  return clamp(int(floor(log2(max(width, 1.0f)))), 0, RADIANCE_LEVELS);
}

Running start_running(Receiver receiver) {
  Running running;
  running.light = unpack_rgb9e5(FETCH_RADIANCE(receiver.pixel));
  running.trust = 1.0f;
  return running;
}

vec3 sample_light(Receiver receiver, Tap tap, int level, INOUT(Running) running) {
  vec3 light = HBIL_MIPS != 0 ? radiance_level(tap.texel, level) : unpack_rgb9e5(FETCH_RADIANCE(tap.texel));
  if (HBIL_REJECT == REJECT_ONE_SIDED)
    return dot(unpack_normal_octahedron(FETCH_NORMAL(tap.texel)), tap.towards) < 0.0f ? light : vec3(0.0f);
  if (HBIL_REJECT == REJECT_RUNNING) {
    float facing = -dot(unpack_normal(FETCH_NORMAL(tap.texel)), normalize(tap.towards));
    running.light = mix(running.light, light, smoothstep(hbil.reject_from, hbil.reject_to, facing));
    return running.light;
  }
  if (HBIL_REJECT == REJECT_CODE) {
    // Mayaux's ComputeHBIL_Interleaved.hlsl: what is straight above may be turned away further; trust that is lost does not come
    // back; light from aslant fades, fully from 2 m on.
    float apart = length(tap.towards);
    vec3 direction = tap.towards / max(apart, 1e-6f);
    float facing = -dot(unpack_normal(FETCH_NORMAL(tap.texel)), direction);
    float above = smoothstep(0.5f, 0.9f, dot(receiver.normal, direction));
    running.trust *= smoothstep(mix(-0.04f, -0.8f, above), mix(-0.02f, -0.4f, above), facing);
    float aslant = 1.0f - clamp(facing, 0.0f, 1.0f);
    float fade = 1.0f - clamp(0.5f * apart, 0.0f, 1.0f) * aslant * aslant;
    running.light = mix(running.light, fade * light, running.trust);
    return running.light;
  }
  return light;
}

// --- slices as the other techniques have them ---

// Share of the slice beyond the angle of sine s.
float share_over(Measure measure, float s) { return 1.0f - measure_cdf(measure, s, slice_k(s)); }

void shared_side(Receiver receiver, Slice slice, Side side, float total, float weight, INOUT(Sums) sums) {
  Steps steps = make_steps();
  Measure measure = make_measure(slice.cos_gamma, slice.sin_gamma, total);
  float horizon = 1.0f;
  float covered = 0.0f;
  vec3 light = vec3(0.0f);
  Running running = start_running(receiver);
  for (int i = 0; i < steps.count && side.pixels >= 1.0f; ++i) {
    Tap tap = take_tap(receiver, side, steps, i);
    INSPECT_HORIZON(horizon, covered, light);
    float s = tap.depth > 0.0f ? side_sine(tap.s, tap.c, tap.m, side.sin_gamma) : 1.0f;
    if (s < horizon) {
      float share = share_over(measure, s);
      light += (share - covered) * sample_light(receiver, tap, step_level(side, steps, i), running);
      covered = share;
      horizon = s;
    }
    INSPECT_RAISED(i, tap, false, horizon, s, covered - inspect_horizon.y, light - inspect_light);
  }
  float c = sqrt(max(1.0f - horizon * horizon, 0.0f));
  vec2 open = slice_moment(slice, horizon, c);
  float measured = weight * slice.n_length * slice_total(slice.cos_gamma, slice.sin_gamma, slice_k_exact(slice.sin_gamma));
  sums.cosine_ao -= measured * covered;
  sums.uniform_ao -= weight * 0.5f * (slice.cos_gamma * c + slice.sin_gamma * horizon);
  sums.bent += weight * slice.n_length * (slice.tangent * open.x + slice.normal * open.y);
  sums.gi += measured * light;
}

void shared_slice(Receiver receiver, vec3 noise, int index, float share, INOUT(Sums) sums) {
  vec3 direction = slice_direction(receiver, index, noise.x);
  Slice slice = make_slice(receiver.v, receiver.normal, direction);
  float total = slice_total(slice.cos_gamma, slice.sin_gamma, slice_k(slice.sin_gamma));
  float weight = share * slice_azimuth_weight(receiver, direction);
  for (int back_side = 0; back_side < 2; ++back_side) {
    Side side = make_side(receiver, slice, direction, back_side == 0 ? 1.0f : -1.0f);
    side.noise = rotated(noise.y, step_index(2 * index + back_side, 0, gi.steps));
    INSPECT_SIDE(index, back_side, side);
    shared_side(receiver, slice, side, total, weight, sums);
    slice = mirror(slice);
  }
  INSPECT_SLICE(weight * slice.n_length * slice_total(slice.cos_gamma, slice.sin_gamma, slice_k_exact(slice.sin_gamma)), share,
                weight, total, slice, direction);
}

// --- the paper's own space (sections 1.1 to 1.3) ---

// Returns the horizon's angle from V, and adds the side's light. n = (n . D, n . V), D to this side.
float local_side(Receiver receiver, Side side, vec2 n, float start, float share, INOUT(Sums) sums) {
  Steps steps = make_steps();
  float highest = start;
  float theta = acos(clamp(start, -1.0f, 1.0f));
  Running running = start_running(receiver);
  for (int i = 0; i < steps.count && side.pixels >= 1.0f; ++i) {
    Tap tap = take_tap(receiver, side, steps, i);
    float cosine = dot(tap.towards, receiver.v) * inversesqrt(dot(tap.towards, tap.towards) + 1e-30f);
    INSPECT_HORIZON(theta, 0.0f, sums.gi);
    if (tap.depth > 0.0f && cosine > highest) {
      float risen = acos(min(cosine, 1.0f));
      sums.gi += share * horizon_increment(n, risen, theta) * sample_light(receiver, tap, step_level(side, steps, i), running);
      highest = cosine;
      theta = risen;
    }
    INSPECT_RAISED(i, tap, false, sin(theta), sqrt(max(1.0f - cosine * cosine, 0.0f)),
                   horizon_increment(HBIL_PRINTED_SIGN != 0 && inspect_side == 1 ? vec2(-n.x, n.y) : n, theta,
                                     inspect_horizon.x),
                   (sums.gi - inspect_light) / share);
  }
  return theta;
}

void local_slice(Receiver receiver, vec3 noise, int index, float share, INOUT(Sums) sums) {
  // Along Y the cross product fails: another axis there.
  vec3 up = abs(receiver.v.y) < 0.999f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f);
  vec3 right = normalize(cross(up, receiver.v));
  float azimuth = (float(index) + noise.x) * (PI / float(gi.slices));
  vec3 d = cos(azimuth) * right + sin(azimuth) * cross(receiver.v, right);
  vec3 on_screen = normalize(vec3(d.x, d.y, 0.0f));
  vec2 n = vec2(dot(receiver.normal, d), dot(receiver.normal, receiver.v));
  float t = HBIL_NORMAL_START != 0 ? -n.x / n.y : 0.0f;
  float start = t * inversesqrt(1.0f + t * t);
  Side side = make_side(receiver, make_slice(receiver.v, receiver.normal, on_screen), on_screen, 1.0f);
  side.noise = rotated(noise.y, step_index(2 * index, 0, gi.steps));
  INSPECT_SIDE(index, 0, side);
  float front = local_side(receiver, side, n, start, share, sums);
  side.direction = -side.direction;
  side.pixels = march_length(receiver, on_screen, side.direction);
  side.noise = rotated(noise.y, step_index(2 * index + 1, 0, gi.steps));
  INSPECT_SIDE(index, 1, side);
  float back = -local_side(receiver, side, vec2(-n.x, n.y), -start, share, sums);
  vec2 open = open_slice(back, front, HBIL_PRINTED_SIGN != 0);
  sums.cosine_ao += share * dot(n, open);
  INSPECT_LOCAL_SLICE(share,
                      share * dot(n, open_slice(-acos(clamp(-start, -1.0f, 1.0f)), acos(clamp(start, -1.0f, 1.0f)),
                                                HBIL_PRINTED_SIGN != 0)),
                      on_screen, d, receiver.v);
  sums.uniform_ao += share * (1.0f - 0.5f * (cos(front) + cos(back)));
  sums.bent += share * (d * open.x + receiver.v * open.y);
}

// --- the pixel ---

Lit estimate_hbil(ivec2 pixel) {
  Lit result;
  result.visibility = 1.0f;
  result.bent = vec3(0.0f);
  result.cone = 0.0f;
  result.gi = vec3(0.0f);
  result.ambient = vec3(0.0f);
  Receiver receiver = make_receiver(pixel);
  if (receiver.depth <= 0.0f) return result;
  INSPECT_RECEIVER(receiver);

  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  Sums sums;
  // As in gi/bitmask.glsl: the weights have the mean 1, so the shared slices only take away.
  sums.cosine_ao = HBIL_SPACE == SPACE_SHARED ? 1.0f : 0.0f;
  sums.uniform_ao = HBIL_SPACE == SPACE_SHARED ? 1.0f : 0.0f;
  sums.bent = vec3(0.0f);
  sums.gi = vec3(0.0f);
  float share = 1.0f / float(gi.slices);
  for (int i = 0; i < gi.slices; ++i) {
    if (HBIL_SPACE == SPACE_SHARED)
      shared_slice(receiver, noise, i, share, sums);
    else
      local_slice(receiver, noise, i, share, sums);
  }
  result.visibility = sums.cosine_ao;
  result.gi = sums.gi;
  result.bent = dot(sums.bent, sums.bent) > 1e-12f ? normalize(sums.bent) : receiver.normal;
  float ao = clamp(sums.cosine_ao, 0.0f, 1.0f);
  result.cone = cone_cosine(ao, sums.uniform_ao);
  result.ambient = environment_cone(result.bent, result.cone, ao);
  return result;
}

#endif
