// Linear depth in metres along the view axis from reverse-Z depth (depth = near / distance); 0 = background.
#version 460
#include "common/frame.glsl"

uniform texture2D depth;
layout(location = 0) out float linear_depth;

void main() {
  float d = texelFetch(depth, ivec2(gl_FragCoord.xy), 0).x;
  linear_depth = d > 0.0 ? frame.near / d : 0.0;
}
