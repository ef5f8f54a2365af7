// Push-pull (Kraus 2009): going up, a texel is the mean of the four below that have light; PULL: going down, a texel without light
// takes its share of the coarser level.
#version 460

uniform texture2D fine;
#ifdef PULL
uniform texture2D coarse;
#endif
layout(location = 0) out vec4 level;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
#ifdef PULL
  vec4 own = texelFetch(fine, pixel, 0);
  ivec2 last = textureSize(coarse, 0) - 1;
  vec2 at = (vec2(pixel) + 0.5) * 0.5 - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 share = at - vec2(low);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 corner = ivec2(i & 1, i >> 1);
    vec2 w = mix(1.0 - share, share, vec2(corner));
    vec4 c = texelFetch(coarse, clamp(low + corner, ivec2(0), last), 0);
    sum += w.x * w.y * vec4(c.rgb, 1.0) * c.a;
  }
  vec3 filled = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
  level = own.a > 0.0 ? own : vec4(filled, sum.a > 0.0 ? 1.0 : 0.0);
#else
  ivec2 last = textureSize(fine, 0) - 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 4; ++i) {
    vec4 f = texelFetch(fine, min(2 * pixel + ivec2(i & 1, i >> 1), last), 0);
    sum += vec4(f.rgb, 1.0) * f.a;
  }
  level = sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
#endif
}
