// Rows of the scene's tables, as passes/scene_tables.cpp writes them (scalar layout).
#ifndef NF_COMMON_SCENE_GLSL
#define NF_COMMON_SCENE_GLSL

const uint NONE = 0xFFFFFFFFu;

struct Instance {
  mat4 world;
  mat4 previous_world;
  uint material;
  float mirrored;
  uint first_vertex;  // of its primitive: gl_VertexIndex counts from the scene's first
  uint deformed;      // its first row of the deformed vertices; NONE = only transformed
};

// World space.
struct DeformedVertex {
  vec3 position, previous, normal;
  vec4 tangent;
};

struct Material {
  vec4 base_color;
  vec3 emissive;
  float metallic;
  float roughness;
  float normal_scale;
  float alpha_cutoff;
  uint blended;
  int layers[7];         // base colour, metallic-roughness, normal, emissive, occlusion, specular, its colour; -1 = no texture
  float occlusion_strength;
  float ior_f0;          // ((ior - 1) / (ior + 1))^2
  float specular;
  vec3 specular_color;
  uint unlit;
  uint uv_sets;          // bit i: texture i of the seven is looked up with the second set
  mat2 uv_linear[7];     // uv' = linear * uv + offset
  vec2 uv_offset[7];
};

// passes/light_grid.h
struct Light {
  vec3 position;
  float radius;
  vec3 direction;  // of travel, world
  float range;     // 0 = infinite
  vec3 radiance;   // irradiance (directional) or intensity, colour included
  float cone_scale;  // 0: a point light
  float cone_offset;
  int tile;          // first shadow tile; -1: unshadowed
  float tile_scale;  // 1 / tan of half the angle that a tile sees
  float tile_near;
};

#endif
