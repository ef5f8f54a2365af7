// Sums of blocks of 16x16 texels; FIRST takes the luminance of a colour, and its alpha.
#version 460
#include "common/color.glsl"

uniform texture2D source;
layout(location = 0) out vec4 energy;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * 16, size = textureSize(source, 0);
  ivec2 end = min(first + 16, size);
  energy = vec4(0.0);
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) {
      vec4 texel = texelFetch(source, ivec2(x, y), 0);
#ifdef FIRST
      energy.xy += vec2(luminance(texel.rgb), texel.a);
#else
      energy += texel;
#endif
    }
}
