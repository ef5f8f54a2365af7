// Towards the picture's border, behind which nothing is known, the GI goes over to what composition takes where there is none:
// open, no bounced light, the environment's light from all of the hemisphere. All by one weight, so that of every direction's light
// as much is added as is taken away. HAS_VISIBILITY and so on say what the technique gives.
#version 460
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "params/edge_fade"
#ifdef ENVIRONMENT_MAP
#include "common/environment.glsl"
#endif

#if defined(HAS_AMBIENT) || defined(HAS_BENT)
FETCH_UINT_IMAGE(normal);
#endif

#ifdef HAS_VISIBILITY
uniform texture2D visibility_in;
layout(location = VISIBILITY_AT) out float visibility;
#endif
#ifdef HAS_GI
uniform texture2D gi_in;
layout(location = GI_AT) out vec4 gi;
#endif
#ifdef HAS_AMBIENT
uniform texture2D ambient_in;
layout(location = AMBIENT_AT) out vec4 ambient;
#endif
#ifdef HAS_BENT
uniform texture2D bent_in;
layout(location = BENT_AT) out vec4 bent;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 off = min(gl_FragCoord.xy, vec2(frame.size) - gl_FragCoord.xy);
  float known = smoothstep(0.0, edge_fade.band, min(off.x, off.y));
#if defined(HAS_AMBIENT) || defined(HAS_BENT)
  vec3 n = unpack_normal(FETCH(normal, pixel));
#endif
#ifdef HAS_VISIBILITY
  visibility = mix(1.0, texelFetch(visibility_in, pixel, 0).x, known);
#endif
#ifdef HAS_GI
  gi = texelFetch(gi_in, pixel, 0);
  gi.rgb *= known;
#endif
#ifdef HAS_AMBIENT
#ifdef ENVIRONMENT_MAP
  vec3 sky = environment_irradiance(mat3(frame.world_from_view) * n);
#else
  vec3 sky = frame.environment;
#endif
  ambient = texelFetch(ambient_in, pixel, 0);
  ambient.rgb = mix(sky, ambient.rgb, known);
#endif
#ifdef HAS_BENT
  bent = texelFetch(bent_in, pixel, 0);
  bent.xyz = mix(n, bent.xyz, known);
#endif
}
