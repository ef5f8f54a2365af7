// What the technique gathers: this frame's direct light and emission, and what the last frame's surfaces reflected of the light
// that they were given (HBIL 2.3.1), no more than keeps the loop's gain below its limit.
#version 460
#include "common/feedback.glsl"
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "params/feedback"
#include "params/feedback_merging"

FETCH_FLOAT_IMAGE(depth);
uniform texture2D direct_diffuse;
uniform texture2D emissive;
uniform texture2D fed;
uniform texture2D previous_energy;
layout(location = 0) out uint radiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 energy = texelFetch(previous_energy, ivec2(0), 0);
  float scale = feedback_merging.previous_energy_valid != 0 ? feedback_scale(energy.x, energy.y, feedback.gain_limit) : 0.0;
  vec4 again = texelFetch(fed, pixel, 0);
  vec3 sum = texelFetch(direct_diffuse, pixel, 0).rgb;
  if (feedback.emissive != 0) sum += texelFetch(emissive, pixel, 0).rgb;
  if (FETCH(depth, pixel) > 0.0) sum += scale * again.a * again.rgb;
  radiance = pack_rgb9e5(sum);
}
