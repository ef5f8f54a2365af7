// How much of what a point sees has changed: the share of taps that found changes, on rings each twice as far from the point as
// the last, where something of one size fills a share that falls as its solid angle does. A texel for 4x4 pixels.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/noise.glsl"
#include "common/view.glsl"

FETCH_FLOAT_IMAGE(depth);
uniform texture2D changes;
layout(location = 0) out float nearby;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  ivec2 pixel = min(texel * 4 + 2, frame.size - 1);
  float z = FETCH(depth, pixel);
  vec3 here = view_position(vec2(pixel) + 0.5, z, frame.ray_scale, frame.ray_offset);
  ivec2 last = (frame.size + 3) / 4 - 1;
  float turn = noise_hilbert_r2(texel, frame.frame_index, frame.seed).x;
  const int RINGS = 6;
  const int SPOKES = 8;
  float sum = min(texelFetch(changes, texel, 0).x * 0.5, 1.0) * float(SPOKES);
  for (int i = 0; i < RINGS * SPOKES; ++i) {
    float reach = exp2(float(i / SPOKES));
    float angle = (float(i) + turn + 0.5 * float(i / SPOKES)) * (6.28318531 / float(SPOKES));
    ivec2 q = texel + ivec2(floor(reach * vec2(cos(angle), sin(angle)) + 0.5));
    bool there = all(greaterThanEqual(q, ivec2(0))) && all(lessThanEqual(q, last));
    vec2 change = texelFetch(changes, clamp(q, ivec2(0), last), 0).xy;
    vec3 towards = view_position(vec2(q * 4 + 2) + 0.5, change.y, frame.ray_scale, frame.ray_offset) - here;
    float beside = 4.0 * reach * abs(frame.ray_scale.y) * z;
    // Before or behind the point it is further away than it looks.
    float weight = beside * beside / max(dot(towards, towards), beside * beside);
    sum += there && z > 0.0 ? weight * min(change.x / (4.0 * reach), 1.0) : 0.0;
  }
  nearby = z > 0.0 ? sum / float((RINGS + 1) * SPOKES) : 0.0;
}
