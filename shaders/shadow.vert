// Depth from a light. MASKED surfaces bring what the cut-out needs.
#version 460
#include "common/scene.glsl"
#include "params/shadow_view"

layout(location = 0) in vec3 in_position;
layout(scalar) readonly buffer instance_table { Instance rows[]; } instances;
#ifdef MASKED
layout(location = 3) in vec2 in_uv0;
layout(location = 4) in vec4 in_color;
layout(location = 0) out vec2 uv0;
layout(location = 1) out float alpha;
layout(location = 2) flat out uint material_row;
#endif

void main() {
  Instance instance = instances.rows[gl_InstanceIndex];
  gl_Position = shadow_view.clip_from_world * (instance.world * vec4(in_position, 1.0));
#ifdef MASKED
  uv0 = in_uv0;
  alpha = in_color.a;
  material_row = instance.material;
#endif
}
