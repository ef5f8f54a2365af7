// Comparison with a shadow map through a disk of taps, which is turned from pixel to pixel. Needs the block `shadow`.
#ifndef NF_COMMON_SHADOW_FILTER_GLSL
#define NF_COMMON_SHADOW_FILTER_GLSL

uniform sampler nearest_clamp;

// A point in a layer of a map. gradient: change of the receiver plane's depth along u and v. softness: by how much the
// penumbra's radius, in u, grows with the blocker's distance, in depth; 0 for a light without size.
struct MapPoint {
  vec2 uv;
  int layer;
  float depth;
  vec2 gradient;
  float softness;
};

const mat2 GOLDEN_TURN = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);

// Bilinear share of the 2 x 2 texels about `uv` that do not stand above the receiver's plane. Each is compared with the plane
// at its own centre, so that a plane needs no bias to stay out of its own shadow but that of rounding. What lies beyond the
// map is looked up at its border.
float lit_around(texture2DArray map, MapPoint p, vec2 uv, float size) {
  vec2 at = clamp(uv * size - 0.5, vec2(0.0), vec2(size - 1.0));
  vec2 base = floor(at), t = at - base;
  vec2 first = (base + 0.5) / size - p.uv;
  vec4 above = textureGather(sampler2DArray(map, nearest_clamp), vec3((base + 1.0) / size, float(p.layer)));
  float plane = p.depth + dot(p.gradient, first);
  vec2 step = p.gradient / size;
  vec4 lit = vec4(lessThanEqual(above, plane + vec4(step.y, step.x + step.y, step.x, 0.0)));
  return mix(mix(lit.w, lit.z, t.x), mix(lit.x, lit.y, t.x), t.y);
}

// Share of the light that arrives. Soft lights look for blockers first and filter as widely as these cast (Fernando 2005,
// "Percentage-Closer Soft Shadows"); the radius is bounded, the plane of the receiver is followed.
float map_visibility(texture2DArray map, MapPoint p, float size, vec2 spin) {
  float texel = 1.0 / size;
  float least = shadow.least_filter * texel;
  float radius = least;
  int samples = shadow.samples;
  float most = shadow.most_filter * texel;
  float reach = clamp((1.0 - p.depth) * p.softness, least, most);
  int tries = p.softness > 0.0 ? shadow.search_samples : 0;
  float step = 1.0 / float(shadow.search_samples);
  float height = 0.0, blockers = 0.0;
  vec2 turn = spin;
  for (int i = 0; i < tries; ++i) {
    vec2 at = p.uv + turn * (sqrt((float(i) + 0.5) * step) * reach);
    at = clamp(floor(at * size), vec2(0.0), vec2(size - 1.0));
    float above = texelFetch(map, ivec3(at, p.layer), 0).x - p.depth - dot(p.gradient, (at + 0.5) * texel - p.uv);
    height += max(above, 0.0);
    blockers += above > 0.0 ? 1.0 : 0.0;
    turn = GOLDEN_TURN * turn;
  }
  if (tries > 0 && blockers == 0.0) samples = 0;
  radius = clamp(height / max(blockers, 1.0) * p.softness, least, most);
  float lit = 0.0;
  step = 1.0 / float(shadow.samples);
  turn = spin;
  for (int i = 0; i < samples; ++i) {
    vec2 offset = turn * (sqrt((float(i) + 0.5) * step) * radius);
    lit += lit_around(map, p, p.uv + offset, size);
    turn = GOLDEN_TURN * turn;
  }
  return samples == 0 ? 1.0 : lit * step;
}

#endif
