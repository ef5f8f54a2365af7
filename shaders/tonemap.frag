// Exposure, tone curve and the sRGB transfer function, to 8 bits.
#version 460
#include "params/tonemap"

uniform texture2D lit;
layout(location = 0) out vec4 ldr;

// Narkowicz 2015, "ACES filmic tone mapping curve": a rational fit of the ACES RRT + ODT, per channel.
vec3 aces(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }

vec3 srgb_encode(vec3 x) {
  return mix(12.92 * x, 1.055 * pow(max(x, vec3(1e-8)), vec3(1.0 / 2.4)) - 0.055, greaterThan(x, vec3(0.0031308)));
}

void main() {
  vec3 x = texelFetch(lit, ivec2(gl_FragCoord.xy), 0).rgb * exp2(tonemap.exposure_ev);
  x = tonemap.curve == 0 ? aces(x) : clamp(x, 0.0, 1.0);
  ldr = vec4(srgb_encode(x), 1.0);
}
