// Depth from a light. MASKED surfaces bring what the cut-out needs.
#version 460
#include "common/scene.glsl"
#include "params/shadow_view"

layout(location = 0) in vec3 in_position;
layout(scalar) readonly buffer instance_table { Instance rows[]; } instances;
layout(scalar) readonly buffer deformed_table { DeformedVertex rows[]; } deformed;
#ifdef MASKED
layout(location = 3) in vec2 in_uv0;
layout(location = 4) in vec4 in_color;
layout(location = 5) in vec2 in_uv1;
layout(location = 0) out vec2 uv0;
layout(location = 1) out float alpha;
layout(location = 2) flat out uint material_row;
layout(location = 4) flat out uint instance_row;
#ifdef MAPPED
layout(location = 3) out vec2 uv1;
#endif
#endif

void main() {
  Instance instance = instances.rows[gl_InstanceIndex];
  vec3 world = instance.deformed == NONE
                   ? (instance.world * vec4(in_position, 1.0)).xyz
                   : deformed.rows[instance.deformed + uint(gl_VertexIndex) - instance.first_vertex].position;
  gl_Position = shadow_view.clip_from_world * vec4(world, 1.0);
#ifdef MASKED
  uv0 = in_uv0;
#ifdef MAPPED
  uv1 = in_uv1;
#endif
  alpha = in_color.a;
  material_row = instance.material;
  instance_row = uint(gl_InstanceIndex);
#endif
}
