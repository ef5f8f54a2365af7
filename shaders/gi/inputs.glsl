// What the slice techniques read of the G-buffer: depth is linear, 0 = background; normals are view space, octahedral.
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "params/gi"

#define NOISE_KIND GI_NOISE
#include "common/noise_table.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);

// A software device gives each of its threads one half of the groups in order: rows of groups are dealt out in turn, so that
// no thread has all of the sky.
ivec2 dispatch_pixel() {
  uvec2 pixel = gl_GlobalInvocationID.xy;
#ifdef NF_FETCH_STORAGE
  uint half_rows = (gl_NumWorkGroups.y + 1u) / 2u;
  uint row = gl_WorkGroupID.y;
  row = row < half_rows ? 2u * row : 2u * (row - half_rows) + 1u;
  pixel.y = row * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
#endif
  return ivec2(pixel);
}

#define INOUT(type) inout type
#define FETCH_DEPTH(texel) FETCH(depth, texel)
#define FETCH_NORMAL(texel) FETCH(normal, texel)
