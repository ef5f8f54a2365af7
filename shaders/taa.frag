// Temporal antialiasing: frames taken at jittered positions, averaged along the motion; history that the neighbourhood cannot
// explain is clipped towards it (Salvi 2016: variance clipping). A jittered picture shows at p what belongs at p - jitter.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/taa.glsl"
#include "common/view.glsl"
#include "params/reproject"
#include "params/taa"
#include "params/taa_state"

FETCH_FLOAT_IMAGE(depth);
FETCH_FLOAT_IMAGE(previous_depth);
FETCH_UINT_IMAGE(previous_normal);
#include "common/reproject.glsl"

uniform texture2D lit;
uniform texture2D velocity;
uniform texture2D previous;
uniform sampler linear_clamp;
layout(location = 0) out vec4 resolved;  // linear radiance; alpha: frames of the mean

// Catmull-Rom over 4x4 texels by nine bilinear reads less their corners: what remains is divided by its weight.
vec4 history_at(vec2 pixel) {
  vec2 base = floor(pixel - 0.5) + 0.5;
  vec2 f = pixel - base;
  vec4 wx = catmull_rom(f.x), wy = catmull_rom(f.y);
  vec2 middle = vec2(wx.y + wx.z, wy.y + wy.z);
  vec2 inner = base + vec2(wx.z, wy.z) / middle;
  vec2 texel = 1.0 / vec2(frame.size);
  vec4 sum = textureLod(sampler2D(previous, linear_clamp), inner * texel, 0.0) * (middle.x * middle.y);
  float weight = middle.x * middle.y;
  int taps = all(lessThan(f, vec2(1e-3))) ? 0 : 4;  // at rest the texel itself
  for (int i = 0; i < taps; ++i) {
    bool along_x = i < 2, low = (i & 1) == 0;
    float w = along_x ? (low ? wx.x : wx.w) * middle.y : (low ? wy.x : wy.w) * middle.x;
    vec2 at = along_x ? vec2(base.x + (low ? -1.0 : 2.0), inner.y) : vec2(inner.x, base.y + (low ? -1.0 : 2.0));
    sum += w * textureLod(sampler2D(previous, linear_clamp), at * texel, 0.0);
    weight += w;
  }
  return sum / weight;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 sum = vec3(0.0), moment1 = vec3(0.0), moment2 = vec3(0.0);
  float weights = 0.0, count = 0.0, nearest = 3e38;
  ivec2 front = pixel;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 q = clamp(pixel + ivec2(x, y), ivec2(0), frame.size - 1);
      vec3 c = texelFetch(lit, q, 0).rgb;
      if (!is_number(c)) continue;
      c = ycocg_from_rgb(compress(c));
      // This sample lies at q - jitter. A Gaussian of sigma 0.47 pixels, close to Blackman-Harris.
      vec2 away = vec2(x, y) - reproject.jitter;
      float w = exp(-2.29 * dot(away, away));
      sum += c * w;
      weights += w;
      moment1 += c;
      moment2 += c * c;
      count += 1.0;
      float z = FETCH(depth, q);
      if (z > 0.0 && z < nearest) {
        nearest = z;
        front = q;
      }
    }
  vec3 now = weights > 0.0 ? sum / weights : vec3(0.0);
  vec3 mean = moment1 / max(count, 1.0);
  vec3 spread = sqrt(max(moment2 / max(count, 1.0) - mean * mean, 0.0));

  // Edges move with what is in front.
  vec2 centre = vec2(pixel) + 0.5;
  vec2 moved = nearest < 3e38 ? texelFetch(velocity, front, 0).xy
                              : background_velocity(centre, view_ray(centre, frame.ray_scale, frame.ray_offset));
  vec2 at = centre - moved;
  bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThanEqual(at, vec2(frame.size)));
  vec4 history = history_at(at);
  bool valid = taa_state.previous_valid != 0 && inside && is_number(history.rgb);
  float frames = valid ? clamp(history.a, 0.0, 1024.0) + 1.0 : 1.0;
  vec3 before = ycocg_from_rgb(compress(max(history.rgb, 0.0)));
  vec3 kept = taa.clip > 0.0 ? clip_to_box(before, mean, taa.clip * spread + 1e-3 * abs(mean.x)) : before;
  float alpha = 1.0 / min(frames, float(taa.frames));
  vec3 result = valid ? mix(kept, now, alpha) : now;
  resolved = vec4(clamp(expand(rgb_from_ycocg(result)), 0.0, 65504.0), min(frames, float(taa.frames)));
}
