// Last frame's reflected light at this frame's pixels, found by motion: alpha 1 where there is some, 0 in holes.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/view.glsl"
#include "params/feedback_state"
#include "params/reproject"
#include "params/temporal"

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
FETCH_FLOAT_IMAGE(previous_depth);
FETCH_UINT_IMAGE(previous_normal);
#include "common/reproject.glsl"
uniform texture2D velocity;
uniform texture2D previous_reflected;
layout(location = 0) out vec4 fed;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = FETCH(depth, pixel);
  vec2 moved = texelFetch(velocity, pixel, 0).xy;
  Point point = make_point(vec2(pixel) + 0.5, z, unpack_normal(FETCH(normal, pixel)), moved);
  // Without `&&`, as in temporal.frag.
  uint past = feedback_state.previous_reflected_valid & reproject.previous_depth_valid & reproject.previous_normal_valid;
  bool valid = past != 0u && z > 0.0;
  vec2 at = vec2(pixel) - moved;
  vec2 low = floor(at + 1e-3);
  vec2 share = max(at - low, 0.0);
  vec4 sum = vec4(0.0);
  int taps = valid ? 4 : 0;
  for (int i = 0; i < taps; ++i) {
    ivec2 corner = ivec2(i & 1, i >> 1);
    vec2 w = mix(1.0 - share, share, vec2(corner));
    ivec2 texel = ivec2(low) + corner;
    float weight = w.x * w.y > 1e-3 && same_surface(point, texel, temporal.depth, temporal.normal) ? w.x * w.y : 0.0;
    sum += weight * vec4(texelFetch(previous_reflected, clamp(texel, ivec2(0), frame.size - 1), 0).rgb, 1.0);
  }
  fed = sum.a > 0.05 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}
