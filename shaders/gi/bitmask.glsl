// Visibility bitmasks (Therrien, Levesque, Gilet 2023, Algorithm 1): of the sectors of a slice, those that a sample is the
// first to cover are lost to the sky and receive its light. By default the sectors are equal parts of projected solid
// angle, so counting bits integrates; the choices bring back the forms that the paper and others use. Compiles as GLSL and
// as C++; beside what gi/march.glsl needs the including file provides `bitmask` with its choices (passes/gi/bitmask_params.h)
// as constants BITMASK_*, and
//   BITMASK_LIGHT    1: gathers light; then FETCH_RADIANCE(texel)
//   BITMASK_AMBIENT  1: gathers the environment; then environment_from(direction), its radiance, and environment_over(normal),
//                    its irradiance / pi over the open hemisphere, view space
#ifndef NF_GI_BITMASK_GLSL
#define NF_GI_BITMASK_GLSL

#include "gi/span.glsl"

#define SECTOR_COUNT (4 << BITMASK_SECTORS)
#ifndef MASK_WORDS
#define MASK_WORDS ((SECTOR_COUNT + 31) / 32)
#endif
#include "common/sectors.glsl"
#include "gi/inspect.glsl"

// The choices, in the order of bitmask_params.h.
const int RULE_JITTER = 0;
const int RULE_CENTRE = 1;
const int RULE_CEIL = 2;
const int RULE_ROUND = 3;
const int MEASURE_COSINE = 0;
const int MEASURE_UNIFORM_ANGLE = 1;
const int MEASURE_SOLID_ANGLE = 2;
const int MEASURE_SINE = 3;
const int MEASURE_FOUR_MASKS = 4;
const int SPAN_INTERVAL = 0;
const int EMITTER_ONE_SIDED = 0;
const int EMITTER_NONE = 1;
const int EMITTER_COSINE = 2;
const int EMITTER_HALF_SPACE = 3;

// --- where a direction lies on the sectors ---

// Position, in sectors, of the angle with sine s on one side of a slice: constant + linear s + square s^2 + cube s^3 + curve k(s),
// where k is s^5, asin(s) or sqrt(1 - s^2) as the measure has it.
struct Scale {
  float constant;
  float linear;
  float square;
  float cube;
  float curve;
};

Scale make_scale(Slice slice, float total, float sign, float noise) {
  Scale scale;
  scale.constant = 0.5f;
  scale.linear = 0.0f;
  scale.square = 0.0f;
  scale.cube = 0.0f;
  scale.curve = 0.0f;
  if (BITMASK_SECTOR_MEASURE == MEASURE_COSINE) {
    Measure measure = make_measure(slice.cos_gamma, slice.sin_gamma, total);
    scale.constant = measure.constant;
    scale.linear = -measure.c1 * K1;
    scale.square = measure.c0;
    scale.cube = -measure.c1 * K3;
    scale.curve = -measure.c1 * K5;
  } else if (BITMASK_SECTOR_MEASURE == MEASURE_SOLID_ANGLE) {
    scale.constant = 1.0f + 0.5f * slice.sin_gamma;
    scale.linear = -0.5f * slice.sin_gamma;
    scale.curve = -0.5f * slice.cos_gamma;
  } else if (BITMASK_SECTOR_MEASURE == MEASURE_SINE) {
    scale.linear = 0.5f;
  } else {
    scale.curve = 1.0f / PI;
  }
  float sectors = sign * float(SECTOR_COUNT);
  scale.constant = (sign > 0.0f ? 0.0f : float(SECTOR_COUNT)) + noise + sectors * scale.constant;
  scale.linear *= sectors;
  scale.square *= sectors;
  scale.cube *= sectors;
  scale.curve *= sectors;
  return scale;
}

float sector_position(Scale scale, float s) {
  if (BITMASK_SECTOR_MEASURE == MEASURE_COSINE)  // with K(s) multiplied out by make_scale
    return scale.constant + s * (scale.linear + s * (scale.square + s * (scale.cube + s * s * scale.curve)));
  if (BITMASK_SECTOR_MEASURE == MEASURE_SOLID_ANGLE)
    return scale.constant + scale.linear * s + scale.curve * sqrt(max(1.0f - s * s, 0.0f));
  if (BITMASK_SECTOR_MEASURE == MEASURE_SINE) return scale.constant + scale.linear * s;
  return scale.constant + scale.curve * (BITMASK_FAST_ACOS != 0 ? HALF_PI - fast_acos(s) : asin(clamp(s, -1.0f, 1.0f)));
}

// Sectors [first, last) or [last, first).
struct Range {
  int first;
  int last;
};

// The hit rules (techniques.md 3.4). The first two round the end points and neither lose nor count twice; the others, as
// printed, round the width.
Range sector_range(float front, float back) {
  Range range;
  if (BITMASK_SECTOR_RULE == RULE_JITTER || BITMASK_SECTOR_RULE == RULE_CENTRE) {
    range.first = int(floor(front));
    range.last = int(floor(back));
  } else {
    float width = abs(back - front);
    range.first = int(floor(min(front, back)));
    range.last = range.first + int(BITMASK_SECTOR_RULE == RULE_CEIL    ? ceil(width)
                                   : BITMASK_SECTOR_RULE == RULE_ROUND ? floor(width + 0.5f)
                                                                       : floor(width));
  }
  if (SECTOR_COUNT < 32) {
    range.first = min(range.first, SECTOR_COUNT);
    range.last = min(range.last, SECTOR_COUNT);
  }
  return range;
}

uint range_word(Range range, int word) { return sector_span_word(range.first, range.last, word); }

// How many sectors the bits of a word are worth. Four masks: bits at equal angles, a fourth of the angle from n_p each
// weighted by its mean cosine (as EEVEE does; needs 8 sectors or more).
float word_worth(uint bits, int word) {
  if (BITMASK_SECTOR_MEASURE != MEASURE_FOUR_MASKS) return float(bitCount(bits));
  float worth = 0.0f;
  for (int i = 0; i < 4; ++i) {
    int low = i * SECTOR_COUNT / 8;
    int high = (i + 1) * SECTOR_COUNT / 8;
    uint group = sector_span_word(low, high, word) | sector_span_word(SECTOR_COUNT - high, SECTOR_COUNT - low, word);
    // The sine of the band's far angle less that of its near one, over its share of the angle; from the tangent plane inwards.
    float near = i == 3 ? 0.0f : i == 2 ? 0.38268343f : i == 1 ? 0.70710678f : 0.92387953f;
    float far = i == 3 ? 0.38268343f : i == 2 ? 0.70710678f : i == 1 ? 0.92387953f : 1.0f;
    worth += 4.0f * (far - near) * float(bitCount(bits & group));
  }
  return worth;
}

// --- one slice ---

// What has been found in a slice, in sectors.
struct Tally {
  Mask covered;
  float worth;
  vec3 light;
};

// Where the sectors whose rays meet the plane of the emitter from its front begin: at the direction in that plane. They reach to the
// end of the side, or to V where `across`, the normal's part along the slice's tangent, is not negative.
int emitter_horizon(Slice slice, Scale scale, int start, vec3 normal, float across) {
  float along = dot(normal, slice.normal);
  // across sin(theta) + along cos(theta) < 0, which changes at:
  float s = (across < 0.0f ? along : -along) * inversesqrt(across * across + along * along + 1e-30f);
  return s > slice.sin_gamma ? int(floor(sector_position(scale, s))) : start;
}

// Light that reaches the receiver per sector, of a texel found at `towards` whose normal, of any length, is `emitter`.
vec3 texel_light(Receiver receiver, Tap tap, vec3 emitter) {
#if BITMASK_LIGHT
  float weight = 1.0f;
  if (BITMASK_EMITTER == EMITTER_ONE_SIDED) weight = dot(emitter, tap.towards) < 0.0f ? 1.0f : 0.0f;
  if (BITMASK_EMITTER == EMITTER_COSINE) weight = max(-dot(normalize(emitter), normalize(tap.towards)), 0.0f);
  // Measures without the receiver's cosine take it at the sample (line 23); uniform solid angle is then worth twice.
  if (BITMASK_SECTOR_MEASURE == MEASURE_UNIFORM_ANGLE || BITMASK_SECTOR_MEASURE == MEASURE_SOLID_ANGLE)
    weight *= max(dot(receiver.normal, normalize(tap.towards)), 0.0f);
  if (BITMASK_SECTOR_MEASURE == MEASURE_SOLID_ANGLE) weight *= 2.0f;
  return weight * unpack_rgb9e5(FETCH_RADIANCE(tap.texel));
#else
  return vec3(0.0f);
#endif
}

// Steps from a front point to its back point: `per_metre` of depth along the sample's own view ray, or along the receiver's.
struct Slab {
  vec3 along;  // metres for each unit of `depth`
  float s;
  float c;
  float m;
  float depth;     // in units of `along`
};

Slab make_slab(Receiver receiver, Side side, Tap tap) {
  float thickness = GI_THICKNESS_MODE == THICKNESS_LINEAR ? gi.thickness * tap.depth : gi.thickness;
  Slab slab;
  if (GI_BACK_ALONG == BACK_SAMPLE_RAY) {
    // `thickness` along a ray is that much less in depth.
    vec2 beside = tap.offset * frame.ray_scale;
    slab.along = receiver.ray + vec3(beside.x, beside.y, 0.0f);
    slab.s = side.s_depth + dot(tap.offset, side.s_offset);
    slab.c = side.c_depth + dot(tap.offset, side.c_offset);
    slab.m = dot(tap.offset, side.m_offset);
    slab.depth = thickness * inversesqrt(dot(slab.along, slab.along));
  } else {
    slab.along = -receiver.v;
    slab.s = -side.sin_gamma;
    slab.c = -side.cos_gamma;
    slab.m = 0.0f;
    slab.depth = thickness;
  }
  if (GI_THICKNESS_MODE == THICKNESS_INFINITE) slab.depth = 1e6f;
  return slab;
}

// Cuts front and back to what lies within the radius: x shares of `along`. Empty when y <= x.
vec2 within_radius(Receiver receiver, Tap tap, Slab slab) {
  float a = dot(slab.along, slab.along);
  float b = dot(tap.towards, slab.along);
  float c = dot(tap.towards, tap.towards) - receiver.radius * receiver.radius;
  float root2 = b * b - a * c;
  float root = sqrt(max(root2, 0.0f));
  return root2 > 0.0f ? vec2(max((-b - root) / a, 0.0f), min((root - b) / a, slab.depth)) : vec2(0.0f);
}

// Sine of an angle larger by the angular thickness.
float turned_sine(float s, float cos_turn, float sin_turn) {
  float c = sqrt(max(1.0f - s * s, 0.0f));
  return c * cos_turn > s * sin_turn ? s * cos_turn + c * sin_turn : 1.0f;
}

// Walks from the receiver outwards along one side.
void walk(Receiver receiver, Slice slice, Side side, Scale scale, INOUT(Tally) tally) {
  Steps steps = make_steps();
  int start = int(floor(sector_position(scale, slice.sin_gamma)));
  float end = sector_position(scale, 1.0f);
  Mask to_start;
  Mask to_end;
  for (int word = 0; word < MASK_WORDS; ++word) {
    to_start.words[word] = low_mask(start - 32 * word);
    to_end.words[word] = low_mask(int(floor(end)) - 32 * word);
  }
  float cos_thickness = cos(radians(gi.thickness_angle));
  float sin_thickness = sin(radians(gi.thickness_angle));
  float near = 0.5f;  // from the receiver's own texel on

  for (int i = 0; i < steps.count; ++i) {
    Tap tap = take_tap(receiver, side, steps, i);
    Slab slab = make_slab(receiver, side, tap);
    bool hit = tap.depth > 0.0f;
    float weight = 1.0f;
    float front_depth = 0.0f;
    if (GI_RADIUS_MODE != RADIUS_DISC) {
      vec2 part = within_radius(receiver, tap, slab);
      hit = hit && part.y > part.x;
      tap.towards += part.x * slab.along;
      tap.s += part.x * slab.s;
      tap.c += part.x * slab.c;
      tap.m += part.x * slab.m;
      front_depth = part.x;
      slab.depth = part.y - part.x;
      if (GI_RADIUS_MODE == RADIUS_BALL_FALLOFF) weight = radius_weight(receiver, length(tap.towards));
    }

    // Sines of the front, and of the back or, where that is an angle further, of the front before it.
    float back_depth = GI_THICKNESS_MODE == THICKNESS_ANGULAR ? 0.0f : slab.depth;
    float front_sine;
    float back_sine;
    if (BITMASK_SPAN == SPAN_INTERVAL) {
      float far = step_distance(side, steps, float(i + 1));
      Span span = make_span(side, tap, near, far);
      near = far;
      back_depth += front_depth;
      front_sine = span_sine(receiver, side, tap, span,
                             shows_front(receiver, tap, span, front_depth) ? span.far : span.near, front_depth);
      back_sine = span_sine(receiver, side, tap, span,
                            shows_front(receiver, tap, span, back_depth) ? span.near : span.far, back_depth);
    } else {
      front_sine = point_sine(receiver, side, tap.s, tap.c, tap.m, tap.towards);
      vec3 through = tap.towards + back_depth * slab.along;
      back_sine = point_sine(receiver, side, tap.s + back_depth * slab.s, tap.c + back_depth * slab.c,
                             tap.m + back_depth * slab.m, through);
    }
    if (GI_THICKNESS_MODE == THICKNESS_ANGULAR) back_sine = turned_sine(back_sine, cos_thickness, sin_thickness);
    float front = sector_position(scale, front_sine);
    float back = GI_THICKNESS_MODE == THICKNESS_INFINITE ? end : sector_position(scale, back_sine);

    Range range = sector_range(front, back);
    Mask fresh = empty_mask();
    uint any = 0u;
    float fresh_worth = 0.0f;
    INSPECT_TALLY(tally);
    for (int word = 0; word < MASK_WORDS; ++word) {
      fresh.words[word] = hit ? range_word(range, word) & ~tally.covered.words[word] : 0u;
      tally.covered.words[word] |= fresh.words[word];
      any |= fresh.words[word];
      if (GI_RADIUS_MODE == RADIUS_BALL_FALLOFF) fresh_worth += word_worth(fresh.words[word], word);
    }
    if (GI_RADIUS_MODE == RADIUS_BALL_FALLOFF) tally.worth += weight * fresh_worth;
#if BITMASK_LIGHT
    if (any != 0u) {
      vec3 emitter = vec3(0.0f);
      if (BITMASK_EMITTER != EMITTER_NONE) emitter = unpack_normal_octahedron(FETCH_NORMAL(tap.texel));
      float across = dot(emitter, slice.tangent);
      int horizon = BITMASK_EMITTER == EMITTER_HALF_SPACE ? emitter_horizon(slice, scale, start, emitter, across) : 0;
      float lit_worth = 0.0f;
      for (int word = 0; word < MASK_WORDS; ++word) {
        uint lit = fresh.words[word];
        if (BITMASK_EMITTER == EMITTER_HALF_SPACE)
          lit &= low_mask(horizon - 32 * word) ^ (across < 0.0f ? to_end.words[word] : to_start.words[word]);
        lit_worth += word_worth(lit, word);
      }
      tally.light += weight * lit_worth * texel_light(receiver, tap, emitter);
    }
#endif
    INSPECT_BITS(i, tap, hit, front, back, weight, tally);
  }
}

// --- the environment ---

// Directional ambient (section 3.2) and the bent normal: the slice in regions of equal angle, of each region its mean direction
// and its share of covered sectors, which is taken off what an open hemisphere gives; or of open ones, which are added, where
// that is not known.
bool from_open_hemisphere() { return BITMASK_SECTOR_MEASURE == MEASURE_COSINE && GI_SLICE_MEASURE != SLICES_SCREEN; }

#if BITMASK_AMBIENT
void gather_regions(Slice slice, Scale front_scale, Scale back_scale, float weight, Mask covered, INOUT(vec3) bent,
                    INOUT(vec3) ambient) {
  int regions = bitmask.regions;
  float share = (from_open_hemisphere() ? -weight : weight) / float(SECTOR_COUNT);
  uint flip = from_open_hemisphere() ? 0u : 0xFFFFFFFFu;
  float last_position = sector_position(back_scale, 1.0f);
  vec2 last_moment = slice_moment(slice, -1.0f, 0.0f);
  for (int i = 1; i <= regions; ++i) {
    float theta = (float(i) / float(regions) - 0.5f) * PI;
    float s = i == regions ? 1.0f : sin(theta);
    float c = i == regions ? 0.0f : cos(theta);
    float position = s >= slice.sin_gamma ? sector_position(front_scale, s) : sector_position(back_scale, -s);
    vec2 moment = slice_moment(slice, s, c);
    Range range;  // regions meet, whatever the rule for samples
    range.first = int(floor(last_position));
    range.last = int(floor(position));
    float counted = 0.0f;
    for (int word = 0; word < MASK_WORDS; ++word)
      counted += word_worth(range_word(range, word) & (covered.words[word] ^ flip), word);
    float middle = theta - 0.5f * PI / float(regions);
    vec2 mean = vec2(sin(middle), cos(middle));
    if (BITMASK_SECTOR_MEASURE == MEASURE_COSINE) {
      float sectors = position - last_position;
      float total = slice_total(slice.cos_gamma, slice.sin_gamma, slice_k_exact(slice.sin_gamma));
      mean = sectors > 1e-3f ? (moment - last_moment) * (float(SECTOR_COUNT) / (sectors * total)) : mean;
    }
    vec3 direction = slice.tangent * mean.x + slice.normal * mean.y;
    bent += share * counted * direction;
    ambient += share * counted * environment_from(normalize(direction));
    last_position = position;
    last_moment = moment;
  }
}
#endif

// --- the pixel ---

Gathered estimate_bitmask(ivec2 pixel) {
  Gathered result;
  result.visibility = 1.0f;
  result.bent = vec3(0.0f);
  result.gi = vec3(0.0f);
  result.ambient = vec3(0.0f);
  Receiver receiver = make_receiver(pixel);
  if (receiver.depth <= 0.0f) return result;
  INSPECT_RECEIVER(receiver);

#if BITMASK_AMBIENT
  if (from_open_hemisphere()) {
    result.bent = receiver.normal * (2.0f / 3.0f);
    result.ambient = environment_over(receiver.normal);
  }
#endif

  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  int slices = gi.slices;
  float weights = 0.0f;

  for (int i = 0; i < slices; ++i) {
    vec3 direction = slice_direction(receiver, i, noise.x);
    float sector_noise = BITMASK_SECTOR_RULE == RULE_JITTER   ? rotated(noise.z, i)
                         : BITMASK_SECTOR_RULE == RULE_CENTRE ? 0.5f
                                                              : 0.0f;
    Slice slice = make_slice(receiver.v, receiver.normal, direction);
    float total = slice_total(slice.cos_gamma, slice.sin_gamma, slice_k(slice.sin_gamma));

    Tally tally;
    tally.covered = empty_mask();
    tally.worth = 0.0f;
    tally.light = vec3(0.0f);
    for (int back_side = 0; back_side < 2; ++back_side) {
      float sign = back_side == 0 ? 1.0f : -1.0f;
      Side side = make_side(receiver, slice, direction, sign);
      side.noise = rotated(noise.y, step_index(2 * i + back_side, 0, gi.steps));
      INSPECT_SIDE(i, back_side, side);
      if (side.pixels >= 1.0f) walk(receiver, slice, side, make_scale(slice, total, sign, sector_noise), tally);
      slice = mirror(slice);
    }

    // The exact total here: with the polynomial's, the mean weight would be off by up to 0.002.
    float weight = slice_azimuth_weight(receiver, direction);
    if (BITMASK_SECTOR_MEASURE == MEASURE_COSINE)
      weight *= slice.n_length * slice_total(slice.cos_gamma, slice.sin_gamma, slice_k_exact(slice.sin_gamma));
    weights += weight;
    float covered = 0.0f;
    for (int word = 0; word < MASK_WORDS; ++word) covered += word_worth(tally.covered.words[word], word);
    if (GI_RADIUS_MODE != RADIUS_BALL_FALLOFF) tally.worth = covered;
    result.visibility -= weight * tally.worth / (float(slices) * float(SECTOR_COUNT));
    result.gi += weight / (float(slices) * float(SECTOR_COUNT)) * tally.light;
    INSPECT_SLICE(weight / (float(slices) * float(SECTOR_COUNT)),
                  (GI_SLICE_MEASURE == SLICES_SCREEN ? weight : 1.0f) / float(slices), weight, total, slice, direction);
    INSPECT_POSITIONS(slice, make_scale(slice, total, 1.0f, sector_noise),
                      make_scale(mirror(slice), total, -1.0f, sector_noise));
#if BITMASK_AMBIENT
    // Of occluders that count for less, all regions alike get their slice's share.
    float part = from_open_hemisphere() && covered > 0.0f ? tally.worth / covered : 1.0f;
    gather_regions(slice, make_scale(slice, total, 1.0f, sector_noise),
                   make_scale(mirror(slice), total, -1.0f, sector_noise), weight * part / float(slices), tally.covered,
                   result.bent, result.ambient);
#endif
  }
  // The weights have the mean 1, so an open hemisphere is known without sampling: taking 1 for their sum (a control variate)
  // leaves the expected value and frees open surfaces of noise. Slices uniform on the screen lack that mean: there it is the
  // sum, bias included.
  if (GI_SLICE_MEASURE == SLICES_SCREEN) result.visibility += weights / float(slices) - 1.0f;
  return result;
}

#endif
