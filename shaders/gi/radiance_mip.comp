// A level of the mips of what is gathered: the mean over the surfaces in the four texels below; a: their share. FULL: those below
// are the full picture's.
#version 460
#include "common/fetch.glsl"
#include "common/pack.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

#ifdef FULL
#include "common/frame.glsl"
FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(radiance);
#else
uniform texture2D finer;
#endif
uniform writeonly image2D mip;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  ivec2 size = imageSize(mip);
  if (pixel.x >= size.x || pixel.y >= size.y) return;
#ifdef FULL
  ivec2 below = frame.size;
#else
  ivec2 below = textureSize(finer, 0);
#endif
  // The last texel of an odd size has three of them.
  ivec2 from = 2 * pixel;
  ivec2 to = min(ivec2(pixel.x + 1 < size.x ? from.x + 2 : below.x, pixel.y + 1 < size.y ? from.y + 2 : below.y), below);
  vec4 sum = vec4(0.0);
  for (int y = from.y; y < to.y; ++y)
    for (int x = from.x; x < to.x; ++x) {
#ifdef FULL
      vec4 one = FETCH(depth, ivec2(x, y)) > 0.0 ? vec4(unpack_rgb9e5(FETCH(radiance, ivec2(x, y))), 1.0) : vec4(0.0);
#else
      vec4 one = texelFetch(finer, ivec2(x, y), 0);
#endif
      sum += vec4(one.rgb, 1.0) * one.a;
    }
  float texels = float((to.x - from.x) * (to.y - from.y));
  imageStore(mip, pixel, sum.a > 0.0 ? vec4(min(sum.rgb / sum.a, 65504.0), sum.a / texels) : vec4(0.0));
}
