// Light of sun, point and spot lights at a point. SUN_SHADOW, TILE_SHADOWS, LIGHT_GRID: what there is of shadow maps and of
// the grid (passes/lighting.cpp feeds them). SCREEN_SHADOWS: lights without a map are shadowed by the depth buffer; then
// FETCH_DEPTH(texel).
#ifndef NF_COMMON_DIRECT_LIGHT_GLSL
#define NF_COMMON_DIRECT_LIGHT_GLSL

#include "common/bound.glsl"
#include "common/brdf.glsl"
#include "common/frame.glsl"
#include "common/lights.glsl"
#include "common/noise.glsl"
#include "common/scene.glsl"
#include "common/shadow.glsl"
#include "params/light_view"
#include "params/sun"
#if defined(SUN_SHADOW) || defined(TILE_SHADOWS) || defined(SCREEN_SHADOWS)
#include "params/shadow"
#endif
#if defined(SUN_SHADOW) || defined(TILE_SHADOWS)
#include "common/shadow_filter.glsl"
#endif
#ifdef SCREEN_SHADOWS
#include "common/screen_shadow.glsl"
#endif

layout(scalar) readonly buffer light_table { Light rows[]; } light_rows;
#ifdef SUN_SHADOW
uniform texture2DArray sun_map;
#endif
#ifdef TILE_SHADOWS
uniform texture2DArray tile_maps;
#endif
#ifdef LIGHT_GRID
// passes/light_grid.h
#define CLUSTER_PIXELS 32u
#define CLUSTER_SLICES 16
layout(scalar) readonly buffer first_table { uint rows[]; } cluster_first;
layout(scalar) readonly buffer index_table { uint rows[]; } cluster_lights;
#endif

// All in world space.
struct Receiver {
  vec3 position;
  vec3 normal;  // shading normal
  vec3 plane;   // normal of the surface as the depth has it
  vec3 to_eye;
  float alpha;
  vec3 f0;
  vec2 spin;    // direction of this pixel's filter
  float dither;
};

// Of a light without a map, `distance` metres away.
float screen_visibility(Receiver r, vec3 l, float distance) {
#ifdef SCREEN_SHADOWS
  return segment_visibility(r.position, r.plane, l, min(distance, shadow.screen_length), r.dither);
#else
  return 1.0;
#endif
}

#ifdef SUN_SHADOW
// The first cascade that has the point well inside; towards its border by a dither more and more often the next.
float sun_visibility(Receiver r) {
  vec2 at = vec2(dot(sun.right, r.position), dot(sun.down, r.position));
  float limit = 1.0 - shadow.blend * r.dither;
  vec3 cascade = sun.cascade0;
  int layer = 0;
  int count = own_bound(int(sun.cascade_count), r.dither);
  for (int i = 1; i < count; ++i) {
    vec2 ndc = abs(at - cascade.xy) * cascade.z;
    if (max(ndc.x, ndc.y) < limit) break;
    cascade = i == 1 ? sun.cascade1 : i == 2 ? sun.cascade2 : sun.cascade3;
    layer = i;
  }
  // The plane in light space, z towards the light. A plane that faces away is no plane of this lit point's.
  vec3 n = vec3(dot(sun.right, r.plane), dot(sun.down, r.plane), -dot(sun.direction, r.plane));
  if (n.z <= 0.0) n = vec3(dot(sun.right, r.normal), dot(sun.down, r.normal), -dot(sun.direction, r.normal));
  float half_side = 1.0 / cascade.z;
  float size = float(textureSize(sun_map, 0).x);
  float texel = 2.0 * half_side / size;
  float offset = normal_offset(texel, n.z) * shadow.normal_bias;
  MapPoint p;
  p.uv = (at - cascade.xy) * (0.5 * cascade.z) + 0.5;
  p.layer = layer;
  // The plane moves, not the place where it is looked at: a shadow's edge stays where it is.
  float n_z = max(n.z, 5e-3);
  p.depth = (dot(sun.direction, r.position) - offset / n_z - shadow.bias * texel) * sun.depth_scale + sun.depth_offset;
  p.gradient = n.xy / n_z * (2.0 * half_side * sun.depth_scale);
  p.softness = sun.tan_radius * 0.5 * cascade.z / -sun.depth_scale;
  bool inside = all(greaterThanEqual(p.uv, vec2(0.0))) && all(lessThanEqual(p.uv, vec2(1.0)));
  float visible = map_visibility(sun_map, p, size, r.spin);
  return inside ? visible : 1.0;
}
#endif

#ifdef TILE_SHADOWS
float tile_visibility(Receiver r, Light light, vec3 l) {
  vec3 from = r.position - light.position;
  vec3 axis = light.direction;
  bool point = light.cone_scale == 0.0;
  float size = float(textureSize(tile_maps, 0).x);
  vec3 n = dot(r.plane, l) > 0.0 ? r.plane : r.normal;
  float along = point ? max(abs(from.x), max(abs(from.y), abs(from.z))) : dot(axis, from);
  float texel = 2.0 * along / (size * light.tile_scale);
  from += n * (normal_offset(texel, dot(n, l)) * shadow.normal_bias) + l * (shadow.bias * texel);
  MapPoint p;
  p.layer = light.tile;
  if (point) p.layer += face_of(from, axis);
  vec3 right, down;
  map_axes(axis, right, down);
  along = max(dot(axis, from), 1e-4);
  p.uv = vec2(dot(right, from), dot(down, from)) * (0.5 * light.tile_scale / along) + 0.5;
  // 1 / along is affine over the plane: near (n . direction) / (n . from).
  p.depth = light.tile_near / along;
  p.gradient = vec2(dot(right, n), dot(down, n)) * (2.0 * light.tile_near / (light.tile_scale * min(dot(n, from), -1e-3 * along)));
  p.softness = light.radius * 0.5 * light.tile_scale / light.tile_near;
  return map_visibility(tile_maps, p, size, r.spin);
}
#endif

// Adds irradiance (on the surface) from direction l, reflected: glTF 2.0, Appendix B.
void reflect_light(Receiver r, vec3 l, vec3 irradiance, inout vec3 diffuse, inout vec3 specular) {
  diffuse += irradiance;
  float n_v = max(dot(r.normal, r.to_eye), 1e-4);
  vec3 h = normalize(l + r.to_eye);
  vec3 fresnel = fresnel_schlick(r.f0, clamp(dot(r.to_eye, h), 0.0, 1.0));
  specular += irradiance * fresnel *
              (ggx_distribution(clamp(dot(r.normal, h), 0.0, 1.0), r.alpha) * smith_visibility(dot(r.normal, l), n_v, r.alpha));
}

void add_light(uint row, Receiver r, inout vec3 diffuse, inout vec3 specular) {
  Light light = light_rows.rows[row];
  vec3 to = light.position - r.position;
  float d2 = max(dot(to, to), 1e-8);
  vec3 l = to * inversesqrt(d2);
  float n_l = dot(r.normal, l);
  if (n_l <= 0.0) return;
  float arriving = light_falloff(-dot(light.direction, l), light.cone_scale, light.cone_offset, d2, light.range) * n_l / d2;
  if (arriving <= 0.0) return;
#ifdef TILE_SHADOWS
  arriving *= light.tile >= 0 ? tile_visibility(r, light, l) : screen_visibility(r, l, sqrt(d2));
#else
  arriving *= screen_visibility(r, l, sqrt(d2));
#endif
  reflect_light(r, l, light.radiance * arriving, diffuse, specular);
}

// `z`: metres along the view axis. diffuse: irradiance; specular: outgoing radiance.
void direct_light(Receiver r, ivec2 pixel, float z, out vec3 diffuse, out vec3 specular) {
  vec3 noise = sampling_noise(pixel, frame.frame_index, frame.seed);
  float angle = noise.x * 6.28318530717959;
  r.spin = vec2(cos(angle), sin(angle));
  r.dither = noise.y;
  diffuse = specular = vec3(0.0);
  float sun_cosine = -dot(r.normal, sun.direction);
  if (sun_cosine > 0.0) {
#ifdef SUN_SHADOW
    sun_cosine *= sun_visibility(r);
#else
    sun_cosine *= screen_visibility(r, -sun.direction, 1e30);
#endif
    reflect_light(r, -sun.direction, sun.irradiance * sun_cosine, diffuse, specular);
  }
  uint suns = own_bound(light_view.suns, z);
  for (uint i = 0; i < suns; ++i) {
    Light light = light_rows.rows[i];
    float cosine = -dot(r.normal, light.direction);
    if (cosine <= 0.0) continue;
    cosine *= screen_visibility(r, -light.direction, 1e30);
    reflect_light(r, -light.direction, light.radiance * cosine, diffuse, specular);
  }
  uint global = own_bound(light_view.global, z);
  for (uint i = light_view.suns; i < global; ++i) add_light(i, r, diffuse, specular);
#ifdef LIGHT_GRID
  uint slice = uint(clamp(floor(log2(z) * light_view.slice_scale + light_view.slice_offset), 0.0, float(CLUSTER_SLICES - 1)));
  uint cluster = (slice * light_view.grid_height + uint(pixel.y) / CLUSTER_PIXELS) * light_view.grid_width + uint(pixel.x) / CLUSTER_PIXELS;
  uint end = cluster_first.rows[cluster + 1u];
  for (uint i = cluster_first.rows[cluster]; i < end; ++i) add_light(cluster_lights.rows[i], r, diffuse, specular);
#else
  uint all = own_bound(light_view.count, z);
  for (uint i = light_view.global; i < all; ++i) add_light(i, r, diffuse, specular);
#endif
}

#endif
