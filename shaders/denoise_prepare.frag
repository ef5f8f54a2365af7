// Packs what the spatial filter reads many times into 32-bit texels, cheap to fetch: light as RGB9E5, visibility and variance
// as 16 bits each. WITH_MEAN: the input is temporal.frag's, clean and with a variance; else it is cleaned here, and there is none.
#version 460
#include "common/color.glsl"
#include "common/denoise.glsl"
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#ifndef WITH_MEAN
#include "params/temporal"
#endif

FETCH_FLOAT_IMAGE(depth);
#include "common/gi_sample.glsl"
#ifdef WITH_MEAN
uniform texture2D moments;
#endif

layout(location = 0) out uint state;
#ifdef HAS_GI
layout(location = GI_AT) out uint packed_light;
#endif
#ifdef HAS_AMBIENT
layout(location = AMBIENT_AT) out uint packed_ambient;
#endif
#ifdef HAS_BENT
layout(location = BENT_AT) out uint packed_bent;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float variance = NO_VARIANCE;
#ifdef WITH_MEAN
  GiSample s = read_sample(pixel);
  vec4 m = texelFetch(moments, pixel, 0);
  if (m.w >= 4.0) variance = m.y / m.w;
#else
  float removed;
  GiSample s = clean_sample(pixel, frame.size, FETCH(depth, pixel), 0.0, temporal.firefly_clamp, removed);
#endif
  state = pack_state(s.visibility, variance);
#ifdef HAS_GI
  packed_light = pack_rgb9e5(s.gi);
#endif
#ifdef HAS_AMBIENT
  packed_ambient = pack_rgb9e5(s.ambient);
#endif
#ifdef HAS_BENT
  packed_bent = dot(s.bent, s.bent) > 0.0 ? pack_normal(s.bent) : NO_BENT;
#endif
}
