// Cut-outs of masked surfaces in the shadow map.
#version 460
#include "common/scene.glsl"

layout(location = 0) in vec2 uv0;
layout(location = 1) in float alpha;
layout(location = 2) flat in uint material_row;
#ifdef MAPPED
layout(location = 3) in vec2 uv1;
#endif
layout(scalar) readonly buffer material_table { Material rows[]; } materials;
layout(set = 1, binding = 0) uniform sampler2DArray base_color_map;

void main() {
  Material m = materials.rows[material_row];
  float a = alpha * m.base_color.a;
  vec2 uv = uv0;
#ifdef MAPPED
  uv = m.uv_linear[0] * ((m.uv_sets & 1u) != 0u ? uv1 : uv0) + m.uv_offset[0];
#endif
  if (m.layers.x >= 0) a *= texture(base_color_map, vec3(uv, m.layers.x)).a;
  if (a < m.alpha_cutoff) discard;
}
