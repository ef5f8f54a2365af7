// Marching along the two sides of a slice through the depth buffer: what the slice techniques share. The text compiles as
// GLSL and as C++; the including file provides `frame`, `gi`, FETCH_DEPTH, FETCH_NORMAL over texels, and the choices of
// passes/gi/gi_params.h as constants (GI_RADIUS_MODE ...).
#ifndef NF_GI_MARCH_GLSL
#define NF_GI_MARCH_GLSL

#include "common/noise.glsl"
#include "common/pack.glsl"
#include "common/slice.glsl"
#include "common/view.glsl"

// The choices, in the order of gi_params.h.
const int SLICES_SCREEN = 0;
const int SLICES_SCREEN_J = 1;
const int SLICES_VIEW = 2;
const int PROJECTION_OBLIQUE = 0;
const int PROJECTION_VIEW_COSINE = 1;
const int RADIUS_DISC = 0;
const int RADIUS_BALL = 1;
const int RADIUS_BALL_FALLOFF = 2;
const int THICKNESS_CONSTANT = 0;
const int THICKNESS_LINEAR = 1;
const int THICKNESS_ANGULAR = 2;
const int THICKNESS_INFINITE = 3;
const int BACK_SAMPLE_RAY = 0;

// What a pixel gathers.
struct Gathered {
  float visibility;  // 1 = open
  vec3 bent;         // mean of the open directions, weighted by the measure; view space, not unit
  vec3 gi;           // irradiance / pi
  vec3 ambient;      // irradiance / pi of the environment
};

struct Receiver {
  ivec2 pixel;
  float depth;   // 0: background
  vec3 ray;      // its position at depth 1
  vec3 v;        // unit, towards the eye
  vec3 normal;   // faces the eye
  float radius;  // metres
};

// One side of a slice, with a sample's projections written as affine functions of its depth and its offset in pixels:
// sample - receiver = (depth - receiver depth) * ray + depth * (offset * ray_scale, 0).
struct Side {
  vec2 direction;  // unit, in pixels
  float pixels;    // how far the march goes; below 1: nowhere
  float noise;     // of the steps
  vec2 s_offset;   // projection onto the slice's tangent
  float s_depth;
  vec2 c_offset;   // projection onto normal / |n_p|
  float c_depth;
  vec2 m_offset;   // projection onto the slice's normal / |n_p|: 0 along the receiver's ray
  float s_step;    // of a pixel along the side
  float c_step;
  float sin_gamma;
  float cos_gamma;
};

// A texel on the way. s, c, m: its oblique coordinates (common/slice.glsl).
struct Tap {
  ivec2 texel;
  vec2 offset;    // pixels
  float depth;    // 0: background
  vec3 towards;   // from the receiver, metres
  float s;
  float c;
  float m;
};

Receiver make_receiver(ivec2 pixel) {
  Receiver receiver;
  receiver.pixel = pixel;
  receiver.depth = FETCH_DEPTH(pixel);
  receiver.ray = view_ray(vec2(pixel) + 0.5f, frame.ray_scale, frame.ray_offset);
  receiver.v = -normalize(receiver.ray);
  receiver.normal = facing_normal(unpack_normal(FETCH_NORMAL(pixel)), receiver.v);
  receiver.radius = gi.radius;
  return receiver;
}

// Slices at equal angles, turned by the noise: the screen direction of one.
vec3 slice_direction(Receiver receiver, int slice, float noise) {
  float azimuth = (float(slice) + noise) * (PI / float(gi.slices));
  return GI_SLICE_MEASURE == SLICES_VIEW ? view_direction(azimuth, receiver.v) : screen_direction(azimuth);
}

// Weight that makes slices uniform on the screen count as if they were uniform about V (techniques.md 3.6).
float slice_azimuth_weight(Receiver receiver, vec3 direction) {
  return GI_SLICE_MEASURE == SLICES_SCREEN_J ? azimuth_weight(receiver.v, direction) : 1.0f;
}

// Pixels that the march can go: to the radius, or until the nearest texel would be off the screen.
float march_length(Receiver receiver, vec3 direction, vec2 step_direction) {
  float reach = receiver.radius / receiver.depth * length(vec2(direction.x, direction.y) * frame.pixels_per_tangent);
  vec2 last = vec2(step_direction.x > 0.0f ? float(frame.size.x - 1 - receiver.pixel.x) : float(receiver.pixel.x),
                   step_direction.y > 0.0f ? float(frame.size.y - 1 - receiver.pixel.y) : float(receiver.pixel.y));
  vec2 border = (last + 0.49f) / max(abs(step_direction), vec2(1e-6f));
  return min(reach, min(border.x, border.y));
}

// `sign`: 1 along +direction, with the slice as it is; -1 against it, with the slice mirrored.
Side make_side(Receiver receiver, Slice slice, vec3 direction, float sign) {
  vec3 lift = receiver.normal / slice.n_length;
  vec3 beside = cross(receiver.ray, slice.tangent);
  beside /= length(beside) * slice.n_length;
  Side side;
  side.direction = normalize(vec2(direction.x, -direction.y) * frame.pixels_per_tangent) * sign;
  side.pixels = march_length(receiver, direction, side.direction);
  side.noise = 0.0f;
  side.s_offset = vec2(slice.tangent.x, slice.tangent.y) * frame.ray_scale;
  side.s_depth = dot(receiver.ray, slice.tangent);
  side.c_offset = vec2(lift.x, lift.y) * frame.ray_scale;
  side.c_depth = dot(receiver.ray, lift);
  side.m_offset = vec2(beside.x, beside.y) * frame.ray_scale;
  side.s_step = dot(side.direction, side.s_offset);
  side.c_step = dot(side.direction, side.c_offset);
  side.sin_gamma = slice.sin_gamma;
  side.cos_gamma = slice.cos_gamma;
  return side;
}

// x^e without pow: exact for whole e in 1..4, blended between; `parts` is clamp(e - (1, 2, 3), 0, 1).
float step_power(float x, vec3 parts) {
  float less = x - 1.0f;
  return x * (1.0f + parts.x * less) * (1.0f + parts.y * less) * (1.0f + parts.z * less);
}

// A whole exponent may be known to the compiler.
#ifndef STEP_EXPONENT
#define STEP_EXPONENT 0
#endif
float step_share(float x, vec3 parts) {
  if (STEP_EXPONENT == 1) return x;
  if (STEP_EXPONENT == 2) return x * x;
  return step_power(x, parts);
}

// Where the steps of a march are, as shares of its length.
struct Steps {
  int count;
  float scale;
  float base;
  vec3 parts;
};

Steps make_steps() {
  Steps steps;
  steps.count = gi.steps;
  steps.scale = 1.0f / float(gi.steps);
  steps.base = GI_STEP_JITTER != 0 ? 0.0f : 0.5f;
  steps.parts = clamp(vec3(gi.step_exponent) - vec3(1.0f, 2.0f, 3.0f), 0.0f, 1.0f);
  return steps;
}

// Pixels from the receiver to a share of the steps. Not nearer than one pixel: the nearest texel is then never the receiver.
float step_distance(Side side, Steps steps, float step_number) {
  return 1.0f + (side.pixels - 1.0f) * step_share(step_number * steps.scale, steps.parts);
}

Tap take_tap(Receiver receiver, Side side, Steps steps, int i) {
  float distance_in_pixels = step_distance(
      side, steps, float(i) + steps.base + (GI_STEP_JITTER != 0 ? rotated(side.noise, i) : 0.0f));
  Tap tap;
  tap.offset = floor(side.direction * distance_in_pixels + 0.5f);
  tap.texel = receiver.pixel + ivec2(tap.offset);
  tap.depth = FETCH_DEPTH(tap.texel);
  float deeper = tap.depth - receiver.depth;
  vec2 beside = tap.offset * frame.ray_scale * tap.depth;
  tap.towards = receiver.ray * deeper + vec3(beside.x, beside.y, 0.0f);
  tap.s = deeper * side.s_depth + tap.depth * dot(tap.offset, side.s_offset);
  tap.c = deeper * side.c_depth + tap.depth * dot(tap.offset, side.c_offset);
  tap.m = tap.depth * dot(tap.offset, side.m_offset);
  return tap;
}

// Sine of the angle from V plus gamma: where the other papers put a direction, whose angle from V in three dimensions is
// taken for the one in the slice. Off the slice it is another: an open floor then occludes itself (techniques.md 3.5).
float view_sine(float cos_alpha, float sin_gamma, float cos_gamma) {
  float sin_alpha = sqrt(max(1.0f - cos_alpha * cos_alpha, 0.0f));
  float below = cos_gamma * cos_alpha - sin_gamma * sin_alpha;  // cos(alpha + gamma)
  return below > 0.0f ? sin_gamma * cos_alpha + cos_gamma * sin_alpha : 1.0f;
}

float view_cosine(Receiver receiver, vec3 towards) {
  return dot(towards, receiver.v) * inversesqrt(dot(towards, towards) + 1e-30f);
}

// Sine of a point's angle theta on its side of the slice, in [sin gamma, 1]; 1 at and below the tangent plane.
float point_sine(Receiver receiver, Side side, float s, float c, float m, vec3 towards) {
  if (GI_PROJECTION == PROJECTION_VIEW_COSINE)
    return view_sine(view_cosine(receiver, towards), side.sin_gamma, side.cos_gamma);
  return side_sine(s, c, m, side.sin_gamma);
}

// How much an occluder at a distance counts (techniques.md 3.13): the same in the references.
float radius_weight(Receiver receiver, float distance) {
  if (GI_RADIUS_MODE == RADIUS_DISC) return 1.0f;
  if (GI_RADIUS_MODE == RADIUS_BALL) return distance < receiver.radius ? 1.0f : 0.0f;
  return clamp((receiver.radius - distance) / max(gi.falloff * receiver.radius, 1e-6f), 0.0f, 1.0f);
}

#endif
