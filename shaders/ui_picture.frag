// Pictures in the user interface, which lie in a buffer: shown as they are, by channel and range, in false colours, or as
// the difference of two. KIND: 1 bytes, 2 floats, 3 a difference. With IMAGE the (first) picture is an image on the device.
// A software device runs every side of a branch, so that what decides is known when this is compiled.
#version 460
#include "common/color.glsl"

const uint SHOW_BYTES = 0u;  // differences
const uint MAP_VIRIDIS = 1u, MAP_DIVERGING = 2u, MAP_FALSE_COLOR = 3u;
const uint FLAG_NEAREST = 1u, FLAG_SRGB = 2u, FLAG_MARK_OUTSIDE = 4u, FLAG_RELATIVE = 8u, FLAG_LOGARITHMIC = 16u;

struct UiDraw {
  uint kind, first, second;  // words of `texels` where the picture begins, and the one it is compared with
  uvec2 size;
  uvec2 second_size;
  uint show, flags;
  float low, high;
};
layout(scalar) readonly buffer draw_table { UiDraw rows[]; } draws;
#if !IMAGE || KIND == 3
layout(scalar) readonly buffer texel_table { uint words[]; } texels;
#endif
#if IMAGE
uniform texture2D shown;
#endif

layout(location = 0) in vec2 uv;
layout(location = 2) flat in uint draw;
layout(location = 0) out vec4 pictures;

vec4 texel(UiDraw d, bool other, ivec2 p) {
  uvec2 size = other ? d.second_size : d.size;
  p = clamp(p, ivec2(0), ivec2(size) - 1);
#if IMAGE
  if (!other) return texelFetch(shown, p, 0);
#endif
#if !IMAGE || KIND == 3
  uint at = uint(p.y) * size.x + uint(p.x);
  uint first = other ? d.second : d.first;
#if KIND == 1
  return unpackUnorm4x8(texels.words[first + at]);
#elif KIND == 3
  if (d.show == SHOW_BYTES) return unpackUnorm4x8(texels.words[first + at]);
#endif
  at = first + at * 4u;
  return uintBitsToFloat(uvec4(texels.words[at], texels.words[at + 1u], texels.words[at + 2u], texels.words[at + 3u]));
#else
  return vec4(0.0);
#endif
}

vec4 lookup(UiDraw d, bool other) {
  vec2 p = uv * vec2(other ? d.second_size : d.size) - 0.5;
  if ((d.flags & FLAG_NEAREST) != 0u) return texel(d, other, ivec2(floor(p + 0.5)));
  ivec2 base = ivec2(floor(p));
  vec2 f = p - vec2(base);
  return mix(mix(texel(d, other, base), texel(d, other, base + ivec2(1, 0)), f.x),
             mix(texel(d, other, base + ivec2(0, 1)), texel(d, other, base + ivec2(1, 1)), f.x), f.y);
}

vec3 srgb_encode(vec3 x) {
  x = clamp(x, 0.0, 1.0);
  return mix(12.92 * x, 1.055 * pow(max(x, vec3(1e-8)), vec3(1.0 / 2.4)) - 0.055, greaterThan(x, vec3(0.0031308)));
}

// From black over violet, red and yellow to white: brightness grows all the way, for eyes that tell no hues apart.
vec3 false_color(float x) {
  x = clamp(x, 0.0, 1.0);
  return clamp(vec3(1.9 * x, 2.2 * x * x - 0.45 * x, x < 0.35 ? 2.2 * x : 0.77 - 1.7 * (x - 0.35) + 6.0 * max(x - 0.75, 0.0)), 0.0, 1.0);
}

// A polynomial through matplotlib's viridis (M. Zucker).
vec3 viridis(float t) {
  t = clamp(t, 0.0, 1.0);
  return vec3(0.277727, 0.005407, 0.334100) +
         t * (vec3(0.105093, 1.404614, 1.384590) +
              t * (vec3(-0.330862, 0.214848, 0.095095) +
                   t * (vec3(-4.634230, -5.799101, -19.332441) +
                        t * (vec3(6.228270, 14.179933, 56.690553) +
                             t * (vec3(4.776385, -13.745145, -65.353033) + t * vec3(-5.435456, 4.645853, 26.312435))))));
}

// Blue, grey, red: the ends and the middle of Moreland 2009, "Diverging color maps for scientific visualization".
vec3 diverging(float t) {
  t = clamp(t, 0.0, 1.0);
  const vec3 middle = vec3(0.865);
  return t < 0.5 ? mix(vec3(0.230, 0.299, 0.754), middle, 2.0 * t) : mix(middle, vec3(0.706, 0.016, 0.150), 2.0 * t - 1.0);
}

// 0 to 1 within the range. Logarithms begin a millionth below its end where it begins at nothing or less.
vec4 in_range(UiDraw d, vec4 value) {
  if ((d.flags & FLAG_LOGARITHMIC) == 0u) return (value - d.low) / max(d.high - d.low, 1e-20);
  float base = max(max(d.low, 1e-6 * d.high), 1e-30);
  return log2(max(value, vec4(base)) / base) / max(log2(max(d.high, base) / base), 1e-20);
}

void main() {
  UiDraw d = draws.rows[draw];
#if KIND == 1
  pictures = vec4(lookup(d, false).rgb, 1.0);
#elif KIND == 3
  vec3 reference = lookup(d, true).rgb;
  vec3 apart = abs(lookup(d, false).rgb - reference);
  if ((d.flags & FLAG_RELATIVE) != 0u) apart /= max(abs(reference), 0.01);
  pictures = vec4(false_color((max(apart.r, max(apart.g, apart.b)) - d.low) / max(d.high - d.low, 1e-20)), 1.0);
#else
  vec4 value = lookup(d, false);
  vec4 x = in_range(d, value);
  uint channels = d.show & 15u, map = d.show >> 4;
  bool one = map != 0u || bitCount(channels) == 1;
  int first = channels == 0u ? 0 : findLSB(channels);
  bvec4 on = notEqual(uvec4(channels) & uvec4(1u, 2u, 4u, 8u), uvec4(0u));
  if (one) {
    x.rgb = vec3(x[first]);
    on = equal(uvec4(0u, 1u, 2u, 3u), uvec4(first));
  } else {
    x.rgb *= vec3(on.rgb) * (on.a ? clamp(value.a, 0.0, 1.0) : 1.0);
    on.a = false;
  }
  if (map == MAP_VIRIDIS) {
    x.rgb = viridis(x.r);
  } else if (map == MAP_DIVERGING) {
    x.rgb = diverging(x.r);
  } else if (map == MAP_FALSE_COLOR) {
    x.rgb = false_color(x.r);
  } else if ((d.flags & FLAG_SRGB) != 0u) {
    x.rgb = srgb_encode(x.rgb);
  }
  if ((d.flags & FLAG_MARK_OUTSIDE) != 0u) {
    if (any(equal(uvec4(on) * uvec4(greaterThan(value, vec4(d.high))), uvec4(1u)))) x.rgb = vec3(1.0, 0.1, 0.0);
    if (any(equal(uvec4(on) * uvec4(lessThan(value, vec4(d.low))), uvec4(1u)))) x.rgb = vec3(0.0, 0.2, 1.0);
  }
  bool good = is_number(value.xyz) && is_number(value.w);
  pictures = vec4(good ? clamp(x.rgb, 0.0, 1.0) : vec3(1.0, 0.0, 1.0), 1.0);
#endif
}
