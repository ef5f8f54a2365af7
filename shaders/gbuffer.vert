// G-buffer vertices: current and previous positions for the velocity.
#version 460
#include "common/frame.glsl"
#include "common/scene.glsl"

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_tangent;
layout(location = 3) in vec2 in_uv0;
layout(location = 4) in vec4 in_color;

layout(location = 5) in vec2 in_uv1;

layout(scalar) readonly buffer instance_table { Instance rows[]; } instances;
layout(scalar) readonly buffer deformed_table { DeformedVertex rows[]; } deformed;

layout(location = 0) out vec3 normal;   // world, not unit
layout(location = 1) out vec4 tangent;  // world, not unit; w = handedness, 0 = none
layout(location = 2) out vec2 uv0;
layout(location = 3) out vec4 color;
layout(location = 4) out vec3 clip;           // x, y, w without jitter
layout(location = 5) out vec3 previous_clip;
layout(location = 6) flat out uint material_row;
#ifdef MAPPED
layout(location = 7) out vec2 uv1;
#endif

void main() {
  Instance instance = instances.rows[gl_InstanceIndex];
  vec3 world, previous;
  if (instance.deformed == NONE) {
    world = (instance.world * vec4(in_position, 1.0)).xyz;
    previous = (instance.previous_world * vec4(in_position, 1.0)).xyz;
    // Normals transform by the cofactors, which need no inverse; their sign flips with a mirroring transform.
    vec3 x = instance.world[0].xyz, y = instance.world[1].xyz, z = instance.world[2].xyz;
    normal = mat3(cross(y, z), cross(z, x), cross(x, y)) * in_normal * instance.mirrored;
    tangent = vec4(mat3(x, y, z) * in_tangent.xyz, in_tangent.w * instance.mirrored);
  } else {
    DeformedVertex v = deformed.rows[instance.deformed + uint(gl_VertexIndex) - instance.first_vertex];
    world = v.position;
    previous = v.previous;
    normal = v.normal;
    tangent = v.tangent;
  }
  gl_Position = frame.jittered_clip_from_world * vec4(world, 1.0);
  clip = (frame.clip_from_world * vec4(world, 1.0)).xyw;
  previous_clip = (frame.previous_clip_from_world * vec4(previous, 1.0)).xyw;
#ifdef MAPPED
  uv1 = in_uv1;
#endif
  uv0 = in_uv0;
  color = in_color;
  material_row = instance.material;
}
