// Mean over frames of what the technique gave, where the last frame saw the same surface; with it the variance of its
// brightness, which steers the spatial filter (Schied et al. 2017, SVGF). A second mean over four frames follows changes at
// once: where both differ by more than noise, the long one starts anew.
#version 460
#include "common/color.glsl"
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/view.glsl"
#include "params/reproject"
#include "params/temporal"
#include "params/temporal_state"

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
FETCH_FLOAT_IMAGE(previous_depth);
FETCH_UINT_IMAGE(previous_normal);
#include "common/gi_sample.glsl"
#include "common/reproject.glsl"

uniform texture2D velocity;
uniform texture2D previous_moments;
#ifdef FOLLOW_CHANGES
uniform texture2D nearby;
uniform sampler linear_clamp;
#endif
layout(location = 0) out vec4 moments;  // visibility, variance of one frame's brightness, short mean - long mean, frames
#ifdef HAS_GI
uniform texture2D previous_light;
layout(location = GI_AT) out vec4 light;    // gi, luminance that the clamp removed from this frame's
#endif
#ifdef HAS_AMBIENT
uniform texture2D previous_ambient;
layout(location = AMBIENT_AT) out vec4 mean_ambient;
#endif
#ifdef HAS_BENT
uniform texture2D previous_bent;
layout(location = BENT_AT) out vec4 mean_bent;
#endif

struct Past {
  GiSample mean;
  float variance;
  float ahead;  // short mean - long mean
  float frames;
  float weight;
};

void add_texel(inout Past past, ivec2 texel, float w) {
  vec4 m = texelFetch(previous_moments, texel, 0);
  GiSample s = GiSample(vec3(0.0), m.x, vec3(0.0), vec3(0.0));
#ifdef HAS_GI
  s.gi = texelFetch(previous_light, texel, 0).rgb;
#endif
#ifdef HAS_AMBIENT
  s.ambient = texelFetch(previous_ambient, texel, 0).rgb;
#endif
#ifdef HAS_BENT
  s.bent = texelFetch(previous_bent, texel, 0).xyz;
#endif
  past.mean = add_weighted(past.mean, s, w);
  past.variance += m.y * w;
  past.ahead += m.z * w;
  past.frames += m.w * w;
  past.weight += w;
}

// 1 or 0; without `&&`, which would be conditions: see common/bound.glsl.
uint any_past() {
  uint valid = reproject.previous_depth_valid & reproject.previous_normal_valid & temporal_state.previous_moments_valid;
#ifdef HAS_GI
  valid &= temporal_state.previous_light_valid;
#endif
#ifdef HAS_AMBIENT
  valid &= temporal_state.previous_ambient_valid;
#endif
#ifdef HAS_BENT
  valid &= temporal_state.previous_bent_valid;
#endif
  return valid;
}

// Of the four texels around the point's place, those of the same surface; else of the nine.
Past find_past(ivec2 pixel, Point point, vec2 moved) {
  Past past = Past(nothing(), 0.0, 0.0, 0.0, 0.0);
  vec2 at = vec2(pixel) - moved;
  vec2 low = floor(at + 1e-3);
  vec2 share = max(at - low, 0.0);
  int taps = any_past() == 0u ? 0 : all(lessThan(share, vec2(2e-3))) ? 1 : 4;
  for (int i = 0; i < taps; ++i) {
    ivec2 corner = ivec2(i & 1, i >> 1);
    vec2 w = mix(1.0 - share, share, vec2(corner));
    if (same_surface(point, ivec2(low) + corner, temporal.depth, temporal.normal)) add_texel(past, ivec2(low) + corner, w.x * w.y);
  }
  int wider = taps > 0 && past.weight < 0.05 ? 9 : 0;
  if (wider > 0) past = Past(nothing(), 0.0, 0.0, 0.0, 0.0);
  for (int i = 0; i < wider; ++i) {
    ivec2 texel = ivec2(floor(at + 0.5)) + ivec2(i % 3 - 1, i / 3 - 1);
    if (same_surface(point, texel, temporal.depth, temporal.normal)) add_texel(past, texel, 1.0);
  }
  if (past.weight > 0.0) {
    float scale = 1.0 / past.weight;
    past = Past(add_weighted(nothing(), past.mean, scale), past.variance * scale, past.ahead * scale, past.frames * scale, 1.0);
  }
  return past;
}

// 1 where the light has changed: the short mean is further from the long one than the noise of five pixels lets expect.
float changed(ivec2 pixel, vec2 moved, Past past) {
  ivec2 at = ivec2(floor(vec2(pixel) - moved + 0.5));
  float ahead = 0.0, variance = 0.0;
  for (int i = 0; i < 5; ++i) {
    ivec2 q = at + (i == 4 ? ivec2(0) : ivec2(4 * (i & 1) - 2, 2 * (i & 2) - 2));
    vec4 m = texelFetch(previous_moments, clamp(q, ivec2(0), frame.size - 1), 0);
    ahead += 0.2 * m.z;
    variance += 0.2 * m.y;
  }
  // A mean with weight 1/4 for the newest has 1/7 of a frame's variance; five of them, a fifth of that.
  float noise = temporal.antilag * sqrt(variance / 35.0);
  float scale = max(brightness(past.mean), brightness(past.mean) + ahead);
  return clamp((abs(ahead) - noise - 0.02 * scale) / max(0.1 * scale, 1e-6), 0.0, 1.0);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = FETCH(depth, pixel);
  vec2 moved = texelFetch(velocity, pixel, 0).xy;
  Point point = make_point(vec2(pixel) + 0.5, z, unpack_normal(FETCH(normal, pixel)), moved);
  Past past = find_past(pixel, point, moved);
  float removed;
  GiSample s = clean_sample(pixel, frame.size, z, past.frames > 0.0 ? brightness(past.mean) : 0.0, temporal.firefly_clamp, removed);

  float restart = changed(pixel, moved, past);  // not inside the condition: lavapipe 22.3 crashes over the loop there
  if (temporal.antilag > 0.0 && past.frames > 3.0) past.frames = 1.0 / mix(1.0 / past.frames, 0.5, restart);
#ifdef FOLLOW_CHANGES
  // Texels of 4x4 pixels: those of the last column and row may reach over the picture's border.
  vec2 place = (vec2(pixel) + 0.5) / (4.0 * vec2(textureSize(nearby, 0)));
  float around = textureLod(sampler2D(nearby, linear_clamp), place, 0.0).x;
  past.frames = min(past.frames, max(1.0 / max(temporal.motion * around, 1e-6), 1.0));
#endif
  float frames = min(past.frames + 1.0, float(temporal.frames));
  float alpha = 1.0 / frames;
  float fresh = brightness(s);
  float apart = fresh - brightness(past.mean);
  float short_mean = mix(brightness(past.mean) + past.ahead, fresh, max(alpha, 0.25));
  GiSample mean = add_weighted(add_weighted(nothing(), past.mean, 1.0 - alpha), s, alpha);
  float variance = past.frames > 0.0 ? (1.0 - alpha) * (past.variance + alpha * apart * apart) : 0.0;
  if (z <= 0.0) {
    mean = GiSample(vec3(0.0), 1.0, vec3(0.0), vec3(0.0));
    variance = short_mean = frames = removed = 0.0;
  }

  moments = vec4(mean.visibility, min(variance, 65504.0), clamp(z > 0.0 ? short_mean - brightness(mean) : 0.0, -65504.0, 65504.0), frames);
#ifdef HAS_GI
  light = vec4(min(mean.gi, 65504.0), min(removed, 65504.0));
#endif
#ifdef HAS_AMBIENT
  mean_ambient = vec4(min(mean.ambient, 65504.0), 1.0);
#endif
#ifdef HAS_BENT
  mean_bent = vec4(mean.bent, 0.0);
#endif
}
