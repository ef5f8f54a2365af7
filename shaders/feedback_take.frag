// The light of what landed on each pixel, where it is this pixel's surface: alpha 1, 0 in holes.
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
uniform utexture2D owner;
uniform texture2D previous_reflected;
layout(location = 0) out vec4 fed;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uint from = texelFetch(owner, pixel, 0).x;
  float z = FETCH(depth, pixel);
  uint past = feedback_state.previous_reflected_valid & reproject.previous_depth_valid & reproject.previous_normal_valid;
  bool landed = from != 0xFFFFFFFFu && z > 0.0 && past != 0u;
  ivec2 texel = landed ? ivec2(from % uint(frame.size.x), from / uint(frame.size.x)) : ivec2(0);
  Point point;
  point.position = view_position(vec2(pixel) + 0.5, z, frame.ray_scale, frame.ray_offset);
  point.normal = unpack_normal(FETCH(normal, pixel));
  point.slack = 0.0;
  bool same = landed && same_surface(point, texel, temporal.depth, temporal.normal);
  fed = same ? vec4(texelFetch(previous_reflected, texel, 0).rgb, 1.0) : vec4(0.0);
}
