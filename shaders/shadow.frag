// Cut-outs of masked surfaces in the shadow map.
#version 460
#include "common/scene.glsl"

layout(location = 0) in vec2 uv0;
layout(location = 1) in float alpha;
layout(location = 2) flat in uint material_row;
layout(scalar) readonly buffer material_table { Material rows[]; } materials;
layout(set = 1, binding = 0) uniform sampler2DArray base_color_map;

void main() {
  Material m = materials.rows[material_row];
  float a = alpha * m.base_color.a;
  if (m.layers.x >= 0) a *= texture(base_color_map, vec3(uv0, m.layers.x)).a;
  if (a < m.alpha_cutoff) discard;
}
