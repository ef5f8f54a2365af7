// Sharpening after TAA, which blurs: the difference to the four neighbours is added, within their range.
#version 460
#include "common/frame.glsl"
#include "common/taa.glsl"
#include "params/taa"

uniform texture2D resolved;
layout(location = 0) out vec4 sharp;

vec3 at(ivec2 pixel) { return compress(texelFetch(resolved, clamp(pixel, ivec2(0), frame.size - 1), 0).rgb); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 c = at(pixel), l = at(pixel + ivec2(-1, 0)), r = at(pixel + ivec2(1, 0)), u = at(pixel + ivec2(0, -1)), d = at(pixel + ivec2(0, 1));
  vec3 low = min(c, min(min(l, r), min(u, d))), high = max(c, max(max(l, r), max(u, d)));
  sharp = vec4(min(expand(clamp(c + taa.sharpness * (c - 0.25 * (l + r + u + d)), low, high)), 65504.0), 1.0);
}
