// One pass of an edge-aware blur: a-trous wavelets (Dammertz et al. 2010) in 3x3 taps `spacing` apart, guided by the depth's
// plane, the normal, and brightness as far as its variance says that it is not noise (Schied et al. 2017). Weights sum to one,
// at borders and edges too. WIDE: 5x5 taps. LAST: writes what composition reads.
#version 460
#include "common/color.glsl"
#include "common/denoise.glsl"
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/view.glsl"
#include "params/denoise"
#include "params/denoise_step"

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
FETCH_UINT_IMAGE(state_in);
#ifdef HAS_GI
FETCH_UINT_IMAGE(light_in);
#endif
#ifdef HAS_AMBIENT
FETCH_UINT_IMAGE(ambient_in);
#endif
#ifdef HAS_BENT
FETCH_UINT_IMAGE(bent_in);
#endif

#ifdef LAST
layout(location = 0) out float visibility;
#define LIGHT_TYPE vec4
#else
layout(location = 0) out uint state;
#define LIGHT_TYPE uint
#endif
#ifdef HAS_GI
layout(location = GI_AT) out LIGHT_TYPE light;
#endif
#ifdef HAS_AMBIENT
layout(location = AMBIENT_AT) out LIGHT_TYPE ambient;
#endif
#ifdef HAS_BENT
layout(location = BENT_AT) out LIGHT_TYPE bent;
#endif

#ifdef WIDE
const int RADIUS = 2;
const float KERNEL[3] = float[](0.375, 0.25, 0.0625);
#else
const int RADIUS = 1;
const float KERNEL[2] = float[](0.5, 0.25);
#endif

float brightness_at(ivec2 q) {
#ifdef HAS_GI
  return luminance(unpack_rgb9e5(FETCH(light_in, q)));
#else
  return unpack_visibility(FETCH(state_in, q));
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = frame.size - 1;
  float z = FETCH(depth, pixel);
  vec3 n = unpack_normal(FETCH(normal, pixel));
  vec3 ray = view_ray(vec2(pixel) + 0.5, frame.ray_scale, frame.ray_offset);
  float plane = dot(n, ray) * z;
  uint own_state = FETCH(state_in, pixel);
  float own_brightness = brightness_at(pixel);
  Edges edges = make_edges(z, denoise.depth, denoise.normal);
  float own_variance = unpack_variance(own_state);

  float weights = 0.0, open = 0.0, variance = 0.0;
  vec3 light_sum = vec3(0.0), ambient_sum = vec3(0.0), bent_sum = vec3(0.0);
  for (int y = -RADIUS; y <= RADIUS; ++y)
    for (int x = -RADIUS; x <= RADIUS; ++x) {
      ivec2 q = pixel + ivec2(x, y) * denoise_step.spacing;
      bool inside = q.x >= 0 && q.y >= 0 && q.x <= last.x && q.y <= last.y;
      q = clamp(q, ivec2(0), last);
      float zq = FETCH(depth, q);
      vec3 nq = unpack_normal(FETCH(normal, q));
      vec3 ray_q = vec3(ray.xy + vec2(q - pixel) * frame.ray_scale, -1.0);
      uint state_q = FETCH(state_in, q);
#ifdef HAS_GI
      vec3 light_q = unpack_rgb9e5(FETCH(light_in, q));
      float brightness_q = luminance(light_q);
#else
      float brightness_q = unpack_visibility(state_q);
#endif
      float w = edge_weight(edges, dot(n, ray_q) * zq - plane, dot(n, nq), brightness_q - own_brightness,
                            own_variance + unpack_variance(state_q), denoise.luminance);
      bool centre = x == 0 && y == 0;
      w = centre ? 1.0 : inside && zq > 0.0 ? w : 0.0;
      w *= KERNEL[abs(x)] * KERNEL[abs(y)];
      weights += w;
      open += w * unpack_visibility(state_q);
      variance += w * w * unpack_variance(state_q);
#ifdef HAS_GI
      light_sum += w * light_q;
#endif
#ifdef HAS_AMBIENT
      ambient_sum += w * unpack_rgb9e5(FETCH(ambient_in, q));
#endif
#ifdef HAS_BENT
      uint bent_q = FETCH(bent_in, q);
      bent_sum += bent_q == NO_BENT ? vec3(0.0) : w * unpack_normal(bent_q);
#endif
    }
  float scale = 1.0 / weights;
#ifdef LAST
  visibility = open * scale;
#ifdef HAS_GI
  light = vec4(min(light_sum * scale, 65504.0), 1.0);
#endif
#ifdef HAS_AMBIENT
  ambient = vec4(min(ambient_sum * scale, 65504.0), 1.0);
#endif
#ifdef HAS_BENT
  bent = vec4(bent_sum * scale, 0.0);
#endif
#else
  state = pack_state(open * scale, min(variance * scale * scale, NO_VARIANCE));
#ifdef HAS_GI
  light = pack_rgb9e5(light_sum * scale);
#endif
#ifdef HAS_AMBIENT
  ambient = pack_rgb9e5(ambient_sum * scale);
#endif
#ifdef HAS_BENT
  bent = dot(bent_sum, bent_sum) > 1e-12 ? pack_normal(bent_sum) : NO_BENT;
#endif
#endif
}
