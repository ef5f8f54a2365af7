// Running mean over frames: mean += (value - mean) * weight, weight = 1 / frames so far; the value where there is none.
#version 460
#include "params/accumulate"

uniform texture2D value;
uniform texture2D previous_mean;
layout(location = 0) out vec4 mean;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 before = texelFetch(previous_mean, pixel, 0);
  float weight = accumulate.previous_mean_valid != 0 ? accumulate.weight : 1.0;
  mean = before + (texelFetch(value, pixel, 0) - before) * weight;
}
