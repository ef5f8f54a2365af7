// Shadows from the depth buffer (Ritschel, Grosch, Seidel 2009, section 4): points on the segment towards a light; one that lies
// behind what is seen there blocks it. Needs the block `shadow` and FETCH_DEPTH(texel).
#ifndef NF_COMMON_SCREEN_SHADOW_GLSL
#define NF_COMMON_SCREEN_SHADOW_GLSL

#include "common/bound.glsl"
#include "common/view.glsl"

// 1 or 0. From `position` with the surface's normal `plane` `reach` metres along l, world space; `dither` in [0, 1) moves the points.
float segment_visibility(vec3 position, vec3 plane, vec3 l, float reach, float dither) {
  vec3 from = (frame.view_from_world * vec4(position, 1.0)).xyz;
  vec3 along = mat3(frame.view_from_world) * l * reach;
  vec3 normal = mat3(frame.view_from_world) * plane;
  float scale = 1.0 / float(shadow.screen_samples);
  float thickness = shadow.screen_thickness > 0.0 ? shadow.screen_thickness : 1e30;
  bool open = true;
  int count = own_bound(shadow.screen_samples, reach);
  for (int i = 0; i < count && open; ++i) {
    vec3 at = from + along * ((float(i) + dither) * scale);
    if (at.z > -frame.near) break;
    ivec2 texel = ivec2(floor(pixel_of(at, frame.ray_scale, frame.ray_offset)));
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, frame.size))) break;
    float depth = FETCH_DEPTH(texel);
    float behind = -at.z - depth;
    vec3 towards = view_position(vec2(texel) + 0.5, depth, frame.ray_scale, frame.ray_offset) - from;
    open = !(depth > 0.0 && behind > 0.0 && behind < thickness && rises_over(normal, towards));
  }
  return open ? 1.0 : 0.0;
}

#endif
