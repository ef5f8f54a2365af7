// A known amount of work: every thread runs a loop of `iterations` rounds.
#version 460
#include "params/loop"
layout(local_size_x = 64) in;
uniform writeonly image2D target;

void main() {
  const uint rounds = uint(loop.iterations);
  float x = float(gl_GlobalInvocationID.x & 255u) * 0.001;
  for (uint i = 0; i < rounds; ++i) x = x * 0.999 + 0.5 * x * x * 0.001 + 0.01;
  imageStore(target, ivec2(gl_GlobalInvocationID.xy), vec4(x));
}
