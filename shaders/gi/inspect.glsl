// What the slice inspector sees of one pixel: a record a sample and a record a slice, from which the pixel's visibility and
// light can be summed up again (passes/gi/inspect.h reads them and says what the members mean). The macros are empty unless the
// pass is compiled with INSPECT, and always in the shaders' C++ twins.
#ifndef NF_GI_INSPECT_GLSL
#define NF_GI_INSPECT_GLSL

#ifdef INSPECT
#include "params/inspect"
layout(scalar) writeonly buffer inspection_table { uint words[]; } inspection;

// Words of a row; rows of slices come after the header, rows of samples after those.
const uint INSPECT_HEADER = 32u;
const uint INSPECT_SLICE_ROW = 64u;
const uint INSPECT_SAMPLE_ROW = 32u;
const int INSPECT_POSITION_COUNT = 33;

const int INSPECT_COUNTED = 0;
const int INSPECT_BACKGROUND = 1;
const int INSPECT_OUTSIDE = 2;
const int INSPECT_OFF_SCREEN = 3;
const int INSPECT_NOTHING_NEW = 4;

bool inspected = false;  // this is the pixel
uint inspect_at = 0u;
uint inspect_slices = 0u;
uint inspect_samples = 0u;
int inspect_slice = 0;
int inspect_side = 0;
uint inspect_before[4] = uint[4](0u, 0u, 0u, 0u);
uint inspect_fresh[4] = uint[4](0u, 0u, 0u, 0u);
vec3 inspect_light = vec3(0.0f);
vec2 inspect_horizon = vec2(0.0f);
vec3 inspect_gain = vec3(1.0f);

void inspect_put(uint x) { inspection.words[inspect_at++] = x; }
void inspect_put(int x) { inspect_put(uint(x)); }
void inspect_put(float x) { inspect_put(floatBitsToUint(x)); }
void inspect_put(vec3 x) { inspect_put(x.x); inspect_put(x.y); inspect_put(x.z); }

void inspect_begin(ivec2 pixel) {
  inspected = pixel.x == inspect.x && pixel.y == inspect.y;
  inspect_at = 0u;
  while (inspected && inspect_at < INSPECT_HEADER) inspect_put(0u);
}

void inspect_receiver(vec3 ray, float depth, vec3 v, vec3 normal, float radius) {
  inspect_at = 8u;
  inspect_put(depth);
  inspect_put(ray);
  inspect_put(v);
  inspect_put(normal);
  inspect_put(radius);
}

void inspect_end(int sectors, float visibility, vec3 gi) {
  inspect_at = 0u;
  inspect_put(inspect_samples);
  inspect_put(inspect_slices);
  inspect_put(sectors);
  inspect_put(visibility);
  inspect_put(gi);
  inspect_at = 19u;
  inspect_put(inspect_gain);
}

void inspect_sample(int step_number, int reason, ivec2 texel, float depth, vec3 towards, float front, float back, float weight,
                    float taken, vec3 light) {
  if (inspect_samples >= uint(inspect.samples)) return;
  inspect_at = INSPECT_HEADER + uint(inspect.slices) * INSPECT_SLICE_ROW + inspect_samples++ * INSPECT_SAMPLE_ROW;
  inspect_put(inspect_slice);
  inspect_put(inspect_side);
  inspect_put(step_number);
  inspect_put(reason);
  inspect_put(texel.x);
  inspect_put(texel.y);
  inspect_put(depth);
  inspect_put(front);
  inspect_put(back);
  inspect_put(weight);
  inspect_put(taken);
  inspect_put(light);
  inspect_put(towards);
  for (int word = 0; word < 4; ++word) inspect_put(inspect_before[word]);
  for (int word = 0; word < 4; ++word) inspect_put(inspect_fresh[word]);
}

void inspect_slice_row(float factor, float base, float weight, float total, float cos_gamma, float sin_gamma, float n_length,
                       vec3 direction, vec3 tangent, vec3 normal) {
  inspect_at = INSPECT_HEADER + uint(inspect_slice) * INSPECT_SLICE_ROW;
  inspect_slices = uint(inspect_slice) + 1u;
  inspect_put(factor);
  inspect_put(base);
  inspect_put(weight);
  inspect_put(total);
  inspect_put(cos_gamma);
  inspect_put(sin_gamma);
  inspect_put(n_length);
  inspect_put(direction);
  inspect_put(tangent);
  inspect_put(normal);
}

#define INSPECT_BEGIN(pixel) inspect_begin(pixel)
#define INSPECT_END(sectors, visibility, gi) \
  if (inspected) inspect_end(sectors, visibility, gi)
#define INSPECT_RECEIVER(receiver) \
  if (inspected) inspect_receiver(receiver.ray, receiver.depth, receiver.v, receiver.normal, receiver.radius)
#define INSPECT_SIDE(slice_number, side_number, side)                                                                \
  inspect_slice = slice_number;                                                                                      \
  inspect_side = side_number;                                                                                        \
  if (inspected && side.pixels < 1.0f) {                                                                             \
    for (int word = 0; word < 4; ++word) inspect_fresh[word] = 0u;                                                   \
    inspect_sample(0, INSPECT_OFF_SCREEN, receiver.pixel, 0.0f, vec3(0.0f), 0.0f, 0.0f, 0.0f, 0.0f, vec3(0.0f)); \
  }
#define INSPECT_SLICE(factor, base, weight, total, slice, direction)                                                   \
  if (inspected)                                                                                                       \
  inspect_slice_row(factor, base, weight, total, slice.cos_gamma, slice.sin_gamma, slice.n_length, direction, slice.tangent, \
                    slice.normal)

// --- bitmasks ---

#define INSPECT_TALLY(tally)                                                                      \
  if (inspected) {                                                                                \
    for (int word = 0; word < MASK_WORDS; ++word) inspect_before[word] = tally.covered.words[word]; \
    inspect_light = tally.light;                                                                  \
  }
#define INSPECT_BITS(step_number, tap, hit, front, back, weight, tally)                                                   \
  if (inspected) {                                                                                                        \
    float worth = 0.0f;                                                                                                   \
    for (int word = 0; word < MASK_WORDS; ++word) {                                                                       \
      inspect_fresh[word] = tally.covered.words[word] & ~inspect_before[word];                                            \
      worth += word_worth(inspect_fresh[word], word);                                                                     \
    }                                                                                                                     \
    int reason = tap.depth <= 0.0f ? INSPECT_BACKGROUND : !hit ? INSPECT_OUTSIDE : worth > 0.0f ? INSPECT_COUNTED         \
                                                                                                : INSPECT_NOTHING_NEW;    \
    inspect_sample(step_number, reason, tap.texel, tap.depth, tap.towards, front, back, weight, weight * worth,           \
                   tally.light - inspect_light);                                                                          \
  }
// Where angles from -pi/2 to pi/2 lie on the sectors.
#define INSPECT_POSITIONS(slice, front_scale, back_scale)                                                       \
  if (inspected) {                                                                                              \
    inspect_at = INSPECT_HEADER + uint(inspect_slice) * INSPECT_SLICE_ROW + 16u;                                \
    for (int k = 0; k < INSPECT_POSITION_COUNT; ++k) {                                                          \
      float s = sin((float(k) / float(INSPECT_POSITION_COUNT - 1) - 0.5f) * PI);                                \
      inspect_put(s >= slice.sin_gamma ? sector_position(front_scale, s) : sector_position(back_scale, -s));    \
    }                                                                                                           \
  }

// --- horizons ---

// Angle of a sine on this side, from the slice's normal.
float inspect_angle(float s) { return (inspect_side == 0 ? 1.0f : -1.0f) * asin(clamp(s, -1.0f, 1.0f)); }

int inspect_horizon_reason(float depth, bool outside, float taken) {
  return depth <= 0.0f ? INSPECT_BACKGROUND : taken != 0.0f ? INSPECT_COUNTED : outside ? INSPECT_OUTSIDE : INSPECT_NOTHING_NEW;
}

// Sine of the horizon before a sample, the share that is covered by then, and the light.
#define INSPECT_HORIZON(s, covered, light) \
  inspect_horizon = vec2(s, covered);      \
  inspect_light = light
#define INSPECT_RAISED(step_number, tap, outside, horizon_sine, sample_sine, taken, light)                                  \
  if (inspected)                                                                                                            \
  inspect_sample(step_number, inspect_horizon_reason(tap.depth, outside, taken), tap.texel, tap.depth, tap.towards,         \
                 inspect_angle(horizon_sine), inspect_angle(sample_sine), 1.0f, taken, light)
// A slice with the view vector for its normal.
#define INSPECT_LOCAL_SLICE(factor, base, direction, tangent, v) \
  if (inspected) inspect_slice_row(factor, base, factor, 0.0f, 1.0f, 0.0f, 1.0f, direction, tangent, v)
#define INSPECT_OUTSIDE_RADIUS(tap) (GI_RADIUS_MODE != RADIUS_DISC && dot(tap.towards, tap.towards) >= gi.radius * gi.radius)

// --- points ---

#define INSPECT_POINTS(factor, receiver) \
  if (inspected) inspect_slice_row(factor, 1.0f, 1.0f, 0.0f, 1.0f, 0.0f, 1.0f, vec3(0.0f), vec3(0.0f), receiver.normal)
#define INSPECT_LIGHT(light) inspect_light = light
// `lost` and `found`: what it took off visibility and added in light, times the number of points.
#define INSPECT_POINT(step_number, probe, receiver, offset, outside, counts, lost, found)                                   \
  if (inspected)                                                                                                            \
  inspect_sample(step_number,                                                                                               \
                 probe.depth <= 0.0f ? (probe.texel == receiver.pixel ? INSPECT_OFF_SCREEN : INSPECT_BACKGROUND)            \
                 : (outside)         ? INSPECT_OUTSIDE                                                                      \
                 : (counts)          ? INSPECT_COUNTED                                                                      \
                                     : INSPECT_NOTHING_NEW,                                                                 \
                 probe.texel, probe.depth, offset, probe.behind, probe.behind, 1.0f, lost, found)
#define INSPECT_GAIN(gain) inspect_gain = vec3(gain)
// A ray stands for a slice; its points are told by INSPECT_POINT.
#define INSPECT_RAY(number, share, ray_direction, receiver)                                                               \
  inspect_slice = number;                                                                                                 \
  if (inspected)                                                                                                          \
  inspect_slice_row(share, share, share, 0.0f, 1.0f, 0.0f, 1.0f, ray_direction, ray_direction, receiver.normal)

#else
#define INSPECT_RAY(number, share, ray_direction, receiver)
#define INSPECT_HORIZON(s, covered, light)
#define INSPECT_RAISED(step_number, tap, outside, horizon_sine, sample_sine, taken, light)
#define INSPECT_LOCAL_SLICE(factor, base, direction, tangent, v)
#define INSPECT_POINTS(factor, receiver)
#define INSPECT_LIGHT(light)
#define INSPECT_POINT(step_number, probe, receiver, offset, outside, counts, lost, found)
#define INSPECT_GAIN(gain)
#define INSPECT_BEGIN(pixel)
#define INSPECT_END(sectors, visibility, gi)
#define INSPECT_RECEIVER(receiver)
#define INSPECT_SIDE(slice_number, side_number, side)
#define INSPECT_SLICE(factor, base, weight, total, slice, direction)
#define INSPECT_TALLY(tally)
#define INSPECT_BITS(step_number, tap, hit, front, back, weight, tally)
#define INSPECT_POSITIONS(slice, front_scale, back_scale)
#endif

#endif
