// Morphs by the node's weights, then skins by the instance's joints, or else transforms by its node (glTF 2.0, 3.7.2.2
// and 3.7.3.3): as engine/scene/deform.cpp does it, for this frame and, of the position, for the one before.
#version 460
#include "common/scene.glsl"
#include "params/deform"

layout(local_size_x = 64) in;

struct Job {
  uint first_row, vertex_count, first_vertex, instance;
  uint first_influence, first_joint;  // NONE: not skinned
  uint first_delta, target_count, first_weight;
};
struct Influence {
  uvec2 joint;  // four of 16 bits
  vec4 weight;
};
struct Delta {
  vec3 position, normal, tangent;
};
struct Joint {
  mat4 now, before;
};

layout(scalar) readonly buffer job_table { Job rows[]; } jobs;
layout(scalar) readonly buffer position_table { vec3 rows[]; } positions;
layout(scalar) readonly buffer normal_table { vec3 rows[]; } normals;
layout(scalar) readonly buffer tangent_table { vec4 rows[]; } tangents;
layout(scalar) readonly buffer influence_table { Influence rows[]; } influences;
layout(scalar) readonly buffer delta_table { Delta rows[]; } deltas;
layout(scalar) readonly buffer joint_table { Joint rows[]; } joints;
layout(scalar) readonly buffer weight_table { vec2 rows[]; } weights;  // now, before
layout(scalar) readonly buffer instance_table { Instance rows[]; } instances;
layout(scalar) writeonly buffer deformed_table { DeformedVertex rows[]; } deformed;

vec3 unit_or(vec3 v, vec3 fallback) {
  float l = length(v);
  return l > 1e-20 ? v / l : fallback;
}

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= deform.vertex_count) return;
  uint low = 0, high = deform.job_count - 1;  // the last job that begins at or before the row
  while (low < high) {
    uint middle = (low + high + 1) / 2;
    if (jobs.rows[middle].first_row <= row) low = middle;
    else high = middle - 1;
  }
  Job job = jobs.rows[low];
  uint v = row - job.first_row;

  vec3 position = positions.rows[job.first_vertex + v], previous = position;
  vec3 normal = normals.rows[job.first_vertex + v];
  vec4 tangent = tangents.rows[job.first_vertex + v];
  for (uint t = 0; t < job.target_count; ++t) {
    Delta delta = deltas.rows[job.first_delta + t * job.vertex_count + v];
    vec2 weight = weights.rows[job.first_weight + t];
    position += weight.x * delta.position;
    previous += weight.y * delta.position;
    normal += weight.x * delta.normal;
    tangent.xyz += weight.x * delta.tangent;
  }

  mat4 now, before;
  if (job.first_joint == NONE) {
    now = instances.rows[job.instance].world;
    before = instances.rows[job.instance].previous_world;
  } else {
    Influence influence = influences.rows[job.first_influence + v];
    now = before = mat4(0.0);
    for (int k = 0; k < 4; ++k) {
      uint joint = (influence.joint[k / 2] >> (16 * (k & 1))) & 0xFFFFu;
      now += influence.weight[k] * joints.rows[job.first_joint + joint].now;
      before += influence.weight[k] * joints.rows[job.first_joint + joint].before;
    }
  }

  DeformedVertex result;
  result.position = (now * vec4(position, 1.0)).xyz;
  result.previous = (before * vec4(previous, 1.0)).xyz;
  // Normals by the cofactors, with the determinant's sign: the side of mirrored surfaces' normals is kept.
  mat3 linear = mat3(now);
  mat3 cofactors = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
  float side = dot(cofactors[0], linear[0]) < 0.0 ? -1.0 : 1.0;
  result.normal = unit_or(cofactors * normal * side, vec3(0.0, 1.0, 0.0));
  result.tangent = tangent;
  if (tangent.w != 0.0) {
    vec3 along = linear * tangent.xyz;
    result.tangent.xyz = unit_or(along - result.normal * dot(result.normal, along), vec3(1.0, 0.0, 0.0));
  }
  deformed.rows[row] = result;
}
