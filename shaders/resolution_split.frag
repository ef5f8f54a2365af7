// One pixel of each block of factor x factor: what a technique reads of a small picture. A block whose pixel lies outside the
// picture is background.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "params/split"

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
FETCH_UINT_IMAGE(radiance);
layout(location = 0) out float small_depth;
layout(location = 1) out uint small_normal;
layout(location = 2) out uint small_radiance;

void main() {
  ivec2 from = ivec2(gl_FragCoord.xy) * split.factor + split.offset;
  bool inside = all(lessThan(from, frame.size));
  from = min(from, frame.size - 1);
  small_depth = inside ? FETCH(depth, from) : 0.0;
  small_normal = FETCH(normal, from);
  small_radiance = inside ? FETCH(radiance, from) : 0u;
}
