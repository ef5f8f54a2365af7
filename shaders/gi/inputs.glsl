// What the slice techniques read of the G-buffer: depth is linear, 0 = background; normals are view space, octahedral.
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "params/gi"

#define NOISE_KIND GI_NOISE
#include "common/noise_table.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);

#define INOUT(type) inout type
#define FETCH_DEPTH(texel) FETCH(depth, texel)
#define FETCH_NORMAL(texel) FETCH(normal, texel)
