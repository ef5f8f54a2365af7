// What the G-buffer says about a pixel, and how it is packed. Base colour is stored with gamma 2 in 10 bits; the material
// texel holds metallic, roughness and the dielectric F0 (0 under material.lambert, else 0.04).
#ifndef NF_COMMON_SURFACE_GLSL
#define NF_COMMON_SURFACE_GLSL

vec3 encode_albedo(vec3 albedo) { return sqrt(clamp(albedo, 0.0, 1.0)); }
vec3 decode_albedo(vec3 texel) { return texel * texel; }

struct Surface {
  vec3 albedo;  // base colour
  float metallic;
  float roughness;
  vec3 f0;
};

Surface unpack_surface(vec4 albedo_texel, vec4 material_texel) {
  Surface s;
  s.albedo = decode_albedo(albedo_texel.rgb);
  s.metallic = material_texel.r;
  s.roughness = material_texel.g;
  s.f0 = mix(vec3(material_texel.b), s.albedo, s.metallic);
  return s;
}

// Outgoing diffuse radiance = diffuse reflectance * irradiance / pi.
vec3 diffuse_reflectance(Surface s, float dielectric_f0) { return s.albedo * (1.0 - s.metallic) * (1.0 - dielectric_f0); }

#endif
