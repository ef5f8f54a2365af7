// Cut-outs of masked surfaces in the shadow map. A blended surface keeps the share of the texels that its alpha says, so that
// filtered it lets 1 - alpha of the light through: stochastic transparency (Enderton et al. 2010) with the thresholds of Jimenez
// 2014's interleaved gradient noise, which fill the range evenly over any 3 x 3 texels; others in every frame.
#version 460
#include "common/frame.glsl"
#include "common/noise.glsl"
#include "common/scene.glsl"
#include "params/shadow_view"

layout(location = 0) in vec2 uv0;
layout(location = 1) in float alpha;
layout(location = 2) flat in uint material_row;
layout(location = 4) flat in uint instance_row;
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
  if (m.layers[0] >= 0) a *= texture(base_color_map, vec3(uv, m.layers[0])).a;
  float threshold = m.alpha_cutoff;
  if (m.blended != 0u && shadow_view.blends != 0u) {
    // Surfaces behind each other, a box's two walls too, must not always drop the same texels: each has a turn of its own,
    // and steps of its own from frame to frame.
    uint surface = hash_uint(2u * instance_row + uint(gl_FrontFacing));
    threshold = unit_float(surface + frame.frame_index * hash_uint(surface) +
                           interleaved_gradient(uint(gl_FragCoord.x), uint(gl_FragCoord.y)));
    if (a <= threshold) discard;
  }
  if (a < threshold) discard;
}
