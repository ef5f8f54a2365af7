// Direct light of sun, point and spot lights: diffuse and specular apart, and the radiance that the GI gathers from
// (direct diffuse + emission of this frame).
#version 460
#include "common/brdf.glsl"
#include "common/fetch.glsl"
#include "common/frame.glsl"
#include "common/pack.glsl"
#include "common/scene.glsl"
#include "common/surface.glsl"
#include "common/view.glsl"
#include "params/shadow"

FETCH_FLOAT_IMAGE(depth);
FETCH_UINT_IMAGE(normal);
uniform texture2D albedo;
uniform texture2D material;
uniform texture2D emissive;
layout(scalar) readonly buffer light_table { Light rows[]; } lights;
#ifdef SHADOWED
uniform texture2D shadow_map;
uniform samplerShadow shadow_compare;
#endif

layout(location = 0) out vec4 direct_diffuse;
layout(location = 1) out vec4 direct_specular;
layout(location = 2) out uint radiance;

// Share of the sun that arrives: 3x3 taps of the hardware's 2x2 comparison. The receiver is moved along its normal by the
// texel's footprint, which grows with the slope (normal offset), so a plane never shadows itself.
float sun_visibility(vec3 world, vec3 n, vec3 to_light) {
#ifdef SHADOWED
  float cosine = clamp(dot(n, to_light), 0.0, 1.0);
  float sine = sqrt(1.0 - cosine * cosine);
  vec3 offset = n * (shadow.normal_bias * frame.shadow_texel * (0.5 + sine)) + to_light * (shadow.bias * frame.shadow_texel);
  vec4 p = frame.shadow_from_world * vec4(world + offset, 1.0);
  vec2 uv = p.xy * 0.5 + 0.5;
  float texel = 1.0 / float(textureSize(shadow_map, 0).x);
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      sum += textureLod(sampler2DShadow(shadow_map, shadow_compare), vec3(uv + vec2(x, y) * texel, p.z), 0.0);
  return sum / 9.0;
#else
  return 1.0;
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  direct_diffuse = direct_specular = vec4(0.0);
  radiance = 0u;
  float z = FETCH(depth, pixel);
  if (z <= 0.0) return;
  vec4 material_texel = texelFetch(material, pixel, 0);
  Surface s = unpack_surface(texelFetch(albedo, pixel, 0), material_texel);
  vec3 view_position_here = view_position(vec2(pixel) + 0.5, z, frame.ray_scale, frame.ray_offset);
  mat3 world_from_view = mat3(frame.world_from_view);
  vec3 world = (frame.world_from_view * vec4(view_position_here, 1.0)).xyz;
  vec3 n = world_from_view * unpack_normal(FETCH(normal, pixel));
  vec3 v = normalize(frame.camera_position - world);
  float n_v = max(dot(n, v), 1e-4);
  float alpha = max(s.roughness * s.roughness, 2e-3);
  vec3 reflectance = diffuse_reflectance(s, material_texel.b);

  vec3 diffuse = vec3(0.0), specular = vec3(0.0);
  for (uint i = 0; i < frame.light_count; ++i) {
    Light light = lights.rows[i];
    vec3 l = -light.direction;
    vec3 irradiance = light.radiance;
    if (light.directional == 0u) {
      vec3 to = light.position - world;
      float d2 = max(dot(to, to), 1e-8);
      l = to * inversesqrt(d2);
      float cone = clamp(dot(light.direction, -l) * light.cone_scale + light.cone_offset, 0.0, 1.0);
      // KHR_lights_punctual's recommended window.
      float ratio = light.range > 0.0 ? d2 / (light.range * light.range) : 0.0;
      irradiance *= cone * cone * clamp(1.0 - ratio * ratio, 0.0, 1.0) / d2;
    }
    float n_l = dot(n, l);
    if (n_l <= 0.0) continue;
    if (i == 0u && light.directional != 0u) irradiance *= sun_visibility(world, n, l);
    irradiance *= n_l;
    vec3 h = normalize(l + v);
    float n_h = clamp(dot(n, h), 0.0, 1.0);
    vec3 fresnel = fresnel_schlick(s.f0, clamp(dot(v, h), 0.0, 1.0));
    diffuse += irradiance * reflectance * (1.0 / 3.14159265358979);
    if (frame.lambert == 0u) specular += irradiance * fresnel * (ggx_distribution(n_h, alpha) * smith_visibility(n_l, n_v, alpha));
  }
  direct_diffuse = vec4(min(diffuse, 65504.0), 1.0);
  direct_specular = vec4(min(specular, 65504.0), 1.0);
  radiance = pack_rgb9e5(diffuse + texelFetch(emissive, pixel, 0).rgb);
}
