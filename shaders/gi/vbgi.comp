// The visibility-bitmask GI pass (shaders/gi/vbgi.glsl) over the G-buffer: depth is linear, 0 = background; normals are view
// space, octahedral; radiance is what surfaces send out.
#version 460

#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "params/gi"
#include "params/vbgi"

layout(local_size_x = 8, local_size_y = 8) in;

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
FETCH_UINT_IMAGE(radiance);
uniform writeonly image2D light;
uniform writeonly image2D visibility;

#define INOUT(type) inout type
#define FETCH_DEPTH(texel) FETCH(depth, texel)
#define FETCH_NORMAL(texel) FETCH(normal, texel)
#define FETCH_RADIANCE(texel) FETCH(radiance, texel)

#include "gi/vbgi.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= frame.size.x || pixel.y >= frame.size.y) return;
  Estimate estimate = estimate_gi(pixel);
  imageStore(light, pixel, vec4(estimate.gi, 1.0f));
  imageStore(visibility, pixel, vec4(estimate.visibility));
}
