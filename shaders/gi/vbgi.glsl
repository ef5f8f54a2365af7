// Indirect diffuse light and visibility of one pixel by visibility bitmasks (Therrien et al. 2023) in radiometric form: the
// sectors of a slice are equal parts of projected solid angle, so counting bits integrates. The text compiles as GLSL and as
// C++; the including file provides `frame`, `gi`, `vbgi` and FETCH_DEPTH, FETCH_NORMAL, FETCH_RADIANCE over texels.
#ifndef NF_GI_VBGI_GLSL
#define NF_GI_VBGI_GLSL

#include "common/noise.glsl"
#include "common/pack.glsl"
#include "common/sectors.glsl"
#include "common/slice.glsl"
#include "common/view.glsl"

const int MEASURE_SCREEN = 0;
const int MEASURE_SCREEN_J = 1;
const int MEASURE_VIEW = 2;
const int SECTOR_RULE_JITTER = 0;
const int EMITTER_ONE_SIDED = 0;

struct Estimate {
  float visibility;  // 1 = open
  vec3 gi;           // irradiance / pi
};

struct Receiver {
  ivec2 pixel;
  float depth;
  vec3 ray;      // its position at depth 1
  vec3 normal;
  float radius;  // metres
};

// One side of a slice, with a sample's projections written as affine functions of its depth and its offset in pixels:
// sample - receiver = (depth - receiver depth) * ray + depth * (offset * ray_scale, 0).
struct March {
  vec2 direction;  // unit, in pixels
  vec2 s_offset;   // projection onto the slice's tangent
  float s_depth;
  vec2 c_offset;   // projection onto normal / |n_p|
  float c_depth;
  vec2 m_offset;   // projection onto the slice's normal / |n_p|: 0 along the receiver's ray
  float sin_gamma;
  // Position on the sectors as a function of the sine: p0 + p2 s^2 + pk K(s).
  float p0;
  float p2;
  float pk;
  float end;  // the tangent plane's position
  float noise;
};

float sector_position(March march, float s) { return march.p0 + march.p2 * s * s + march.pk * slice_k(s); }

March make_march(Receiver receiver, Slice slice, float total, vec3 direction, float side, float sector_noise) {
  Measure measure = make_measure(slice.cos_gamma, slice.sin_gamma, total);
  float scale = side * float(SECTOR_COUNT);
  float base = (side > 0.0f ? 0.0f : float(SECTOR_COUNT)) + sector_noise;
  vec3 lift = receiver.normal / slice.n_length;
  vec2 pixels = vec2(direction.x, -direction.y) * frame.pixels_per_tangent * side;
  March march;
  march.direction = normalize(pixels);
  march.s_offset = vec2(slice.tangent.x, slice.tangent.y) * frame.ray_scale;
  march.s_depth = dot(receiver.ray, slice.tangent);
  march.c_offset = vec2(lift.x, lift.y) * frame.ray_scale;
  march.c_depth = dot(receiver.ray, lift);
  vec3 beside = cross(receiver.ray, slice.tangent);
  beside /= length(beside) * slice.n_length;
  march.m_offset = vec2(beside.x, beside.y) * frame.ray_scale;
  march.sin_gamma = slice.sin_gamma;
  march.p0 = base + scale * measure.constant;
  march.p2 = scale * measure.c0;
  march.pk = -scale * measure.c1;
  march.end = sector_position(march, 1.0f);
  march.noise = 0.0f;
  return march;
}

// x^e without pow: exact for whole e in 1..4, blended between; `parts` is clamp(e - (1, 2, 3), 0, 1).
float step_power(float x, vec3 parts) {
  float less = x - 1.0f;
  return x * (1.0f + parts.x * less) * (1.0f + parts.y * less) * (1.0f + parts.z * less);
}

// Pixels that the march can go: to the radius, or until the nearest texel would be off the screen.
float march_length(Receiver receiver, vec3 direction, vec2 step_direction) {
  float reach = receiver.radius / receiver.depth * length(vec2(direction.x, direction.y) * frame.pixels_per_tangent);
  vec2 last = vec2(step_direction.x > 0.0f ? float(frame.size.x - 1 - receiver.pixel.x) : float(receiver.pixel.x),
                   step_direction.y > 0.0f ? float(frame.size.y - 1 - receiver.pixel.y) : float(receiver.pixel.y));
  vec2 border = (last + 0.49f) / max(abs(step_direction), vec2(1e-6f));
  return min(reach, min(border.x, border.y));
}

// Walks from the receiver outwards. Sectors that a sample is the first to cover receive its light.
void walk(Receiver receiver, March march, float pixels, INOUT(uint) mask, INOUT(vec3) light) {
  int steps = gi.steps;
  float inverse_steps = 1.0f / float(steps);
  vec3 parts = clamp(vec3(gi.step_exponent) - vec3(1.0f, 2.0f, 3.0f), 0.0f, 1.0f);
  float jitter_scale = bool(gi.step_jitter) ? 1.0f : 0.0f;
  float jitter_base = bool(gi.step_jitter) ? 0.0f : 0.5f;
  float thickness = gi.thickness;
  bool infinite = bool(gi.infinite_thickness);
  bool one_sided = int(vbgi.emitter) == EMITTER_ONE_SIDED;
  vec2 ray_scale = frame.ray_scale;
  vec2 receiver_tangents = vec2(receiver.ray.x, receiver.ray.y);

  for (int i = 0; i < steps; ++i) {
    // Not nearer than one pixel: the nearest texel is then never the receiver.
    float x = (float(i) + jitter_base + jitter_scale * rotated(march.noise, i)) * inverse_steps;
    float distance_in_pixels = 1.0f + (pixels - 1.0f) * step_power(x, parts);
    vec2 offset = floor(march.direction * distance_in_pixels + 0.5f);
    ivec2 texel = receiver.pixel + ivec2(offset);
    float z = FETCH_DEPTH(texel);

    float deeper = z - receiver.depth;
    float s_offset = dot(offset, march.s_offset);
    float c_offset = dot(offset, march.c_offset);
    float m_offset = dot(offset, march.m_offset);
    float s_front = deeper * march.s_depth + z * s_offset;
    float c_front = deeper * march.c_depth + z * c_offset;
    float front = sector_position(march, side_sine(s_front, c_front, z * m_offset, march.sin_gamma));

    // The back lies `thickness` further along the sample's own view ray: so much deeper.
    vec2 tangents = receiver_tangents + offset * ray_scale;
    float through = thickness * inversesqrt(1.0f + dot(tangents, tangents));
    float s_back = s_front + through * (march.s_depth + s_offset);
    float c_back = c_front + through * (march.c_depth + c_offset);
    float back = sector_position(march, side_sine(s_back, c_back, (z + through) * m_offset, march.sin_gamma));
    back = infinite ? march.end : back;

    uint covered = sector_span(int(floor(front)), int(floor(back)));
    uint fresh = z > 0.0f ? covered & ~mask : 0u;
    if (fresh != 0u) {
      mask |= fresh;
      vec3 towards = receiver.ray * deeper + vec3(offset.x * ray_scale.x, offset.y * ray_scale.y, 0.0f) * z;
      bool faces = dot(unpack_normal_octahedron(FETCH_NORMAL(texel)), towards) < 0.0f;
      float count = faces || !one_sided ? float(bitCount(fresh)) : 0.0f;
      light += count * unpack_rgb9e5(FETCH_RADIANCE(texel));
    }
  }
}

Estimate estimate_gi(ivec2 pixel) {
  Estimate result;
  result.visibility = 1.0f;
  result.gi = vec3(0.0f);
  Receiver receiver;
  receiver.pixel = pixel;
  receiver.depth = FETCH_DEPTH(pixel);
  if (receiver.depth <= 0.0f) return result;

  receiver.ray = view_ray(vec2(pixel) + 0.5f, frame.ray_scale, frame.ray_offset);
  vec3 v = -normalize(receiver.ray);
  receiver.normal = facing_normal(unpack_normal(FETCH_NORMAL(pixel)), v);
  receiver.radius = gi.radius;

  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  int slices = gi.slices;
  int slice_measure = int(vbgi.slice_measure);
  bool jitter_sectors = int(vbgi.sector_rule) == SECTOR_RULE_JITTER;
  float covered = 0.0f;
  float weights = 0.0f;
  vec3 light = vec3(0.0f);

  for (int i = 0; i < slices; ++i) {
    float azimuth = (float(i) + noise.x) * (PI / float(slices));
    vec3 direction = slice_measure == MEASURE_VIEW ? view_direction(azimuth, v) : screen_direction(azimuth);
    float sector_noise = jitter_sectors ? rotated(noise.z, i) : 0.5f;
    Slice slice = make_slice(v, receiver.normal, direction);
    float total = slice_total(slice.cos_gamma, slice.sin_gamma, slice_k(slice.sin_gamma));

    uint mask = 0u;
    vec3 slice_light = vec3(0.0f);
    for (int back_side = 0; back_side < 2; ++back_side) {
      March march = make_march(receiver, slice, total, direction, back_side == 0 ? 1.0f : -1.0f, sector_noise);
      march.noise = rotated(noise.y, step_index(2 * i + back_side, 0, gi.steps));
      float pixels = march_length(receiver, direction, march.direction);
      if (pixels >= 1.0f) walk(receiver, march, pixels, mask, slice_light);
      slice = mirror(slice);
    }

    // The exact total here: with the polynomial's, the mean weight would be off by up to 0.002.
    float weight = slice.n_length * slice_total(slice.cos_gamma, slice.sin_gamma, slice_k_exact(slice.sin_gamma));
    weight *= slice_measure == MEASURE_SCREEN_J ? azimuth_weight(v, direction) : 1.0f;
    weights += weight;
    covered += weight * float(bitCount(mask));
    light += weight * slice_light;
  }

  float share = 1.0f / (float(slices) * float(SECTOR_COUNT));
  // The weights have the mean 1, so an open hemisphere is known without sampling: taking 1 for their sum (a control variate)
  // leaves the expected value and frees open surfaces of noise. Slices uniform on the screen lack that mean: there it is the
  // sum, bias included.
  float open = slice_measure == MEASURE_SCREEN ? weights / float(slices) : 1.0f;
  result.visibility = open - covered * share;
  result.gi = light * share;
  return result;
}

#endif
