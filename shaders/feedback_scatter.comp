// Last frame's pixels go where this frame's camera sees them (HBIL 3.2). The first run keeps the nearest depth of those that land
// on a pixel; with OWNER the second keeps which of them has it, the lowest number of several, so that the result does not depend
// on the order in which threads run. What has moved by itself lands where it was and is told by its depth later.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/view.glsl"
#include "params/reproject"

layout(local_size_x = 8, local_size_y = 8) in;
FETCH_FLOAT_IMAGE(previous_depth);
layout(r32ui) uniform uimage2D nearest;
#ifdef OWNER
layout(r32ui) uniform uimage2D owner;
#endif

void main() {
  ivec2 from = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(from, frame.size)) || reproject.previous_depth_valid == 0) return;
  float z = FETCH(previous_depth, from);
  vec3 before = view_position(vec2(from) + 0.5, z, reproject.previous_ray_scale, reproject.previous_ray_offset);
  vec3 now = (reproject.view_from_previous_view * vec4(before, 1.0)).xyz;
  if (z <= 0.0 || now.z >= -1e-4) return;
  // A texel's middle must not fall on a border of texels by rounding.
  ivec2 to = ivec2(floor(pixel_of(now, frame.ray_scale, frame.ray_offset) + 1e-3));
  if (any(lessThan(to, ivec2(0))) || any(greaterThanEqual(to, frame.size))) return;
  uint depth_bits = floatBitsToUint(-now.z);  // positive floats order like integers
#ifdef OWNER
  if (imageLoad(nearest, to).x == depth_bits) imageAtomicMin(owner, to, uint(from.y * frame.size.x + from.x));
#else
  imageAtomicMin(nearest, to, depth_bits);
#endif
}
