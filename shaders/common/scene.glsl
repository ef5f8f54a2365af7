// Rows of the scene's tables, as passes/scene_tables.cpp writes them (scalar layout).
#ifndef NF_COMMON_SCENE_GLSL
#define NF_COMMON_SCENE_GLSL

struct Instance {
  mat4 world;
  mat4 previous_world;
  uint material;
  float mirrored;
};

struct Material {
  vec4 base_color;
  vec3 emissive;
  float metallic;
  float roughness;
  float normal_scale;
  float alpha_cutoff;
  ivec4 layers;  // base colour, metallic-roughness, normal, emissive; -1 = no texture
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
