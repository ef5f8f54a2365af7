// Skinning and morphing, vertex by vertex, and the interval arithmetic of their boxes.
#include "scene/deform.h"

#include <cmath>
#include <limits>

#include "core/error.h"

namespace nf::scene {

namespace {

// What the deformation of one instance reads.
struct Pose {
  const Primitive& primitive;
  const float* weight = nullptr;  // of the morph targets
  const mat4* joint = nullptr;    // null = not skinned
  mat4 world{1};
};

Pose pose_of(const Scene& scene, uint32_t instance, Moment moment) {
  NF_CHECK(instance < scene.instances.size(), "instance {} of {}", instance, scene.instances.size());
  const uint32_t node = scene.instances.node[instance], skin = scene.instances.skin[instance];
  const bool now = moment == Moment::Now;
  Pose pose{.primitive = scene.primitives[scene.instances.primitive[instance]]};
  pose.world = now ? scene.nodes.world[node] : scene.nodes.previous_world[node];
  if (pose.primitive.target_count > 0) {
    const std::vector<float>& weights = now ? scene.morph_weights.value : scene.morph_weights.previous;
    pose.weight = weights.data() + scene.nodes.first_weight[node];
  }
  if (skin != none) {
    const std::vector<mat4>& matrices = now ? scene.joints.matrix : scene.joints.previous_matrix;
    pose.joint = matrices.data() + scene.skins[skin].first_joint;
  }
  return pose;
}

vec3 morphed(const Pose& pose, vec3 base, const std::vector<vec3>& delta, uint32_t vertex) {
  const Primitive& p = pose.primitive;
  for (uint32_t target = 0; target < p.target_count; ++target) {
    base += pose.weight[target] * delta[p.first_delta + target * p.vertex_count + vertex];
  }
  return base;
}

mat4 matrix_of(const Scene& scene, const Pose& pose, uint32_t vertex) {
  if (!pose.joint) return pose.world;
  const uint32_t row = pose.primitive.first_influence + vertex;
  mat4 sum(0);
  for (int k = 0; k < 4; ++k) sum += scene.influences.weight[row][k] * pose.joint[scene.influences.joint[row][k]];
  return sum;
}

vec3 unit_or(const vec3& v, const vec3& fallback) {
  const float length = glm::length(v);
  return length > 1e-20f && std::isfinite(length) ? v / length : fallback;
}

// The cofactor matrix: the inverse transpose times the determinant, without its division. Keeps the side of mirrored
// surfaces' normals.
glm::mat3 normal_matrix(const glm::mat3& m) {
  const glm::mat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? cofactor * -1.f : cofactor;
}

// Arvo 1990: the box of a transformed box has |M| * half size.
void add_box(const mat4& matrix, const vec3& center, const vec3& extent, Bounds& bounds) {
  const glm::mat3 linear(matrix);
  const glm::mat3 absolute(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
  const vec3 middle = vec3(matrix * vec4(center, 1)), reach = absolute * extent;
  bounds.min = glm::min(bounds.min, middle - reach);
  bounds.max = glm::max(bounds.max, middle + reach);
}

// How far the targets can take any vertex, at these weights.
Bounds morph_reach(const Scene& scene, const Pose& pose) {
  Bounds reach;
  for (uint32_t target = 0; target < pose.primitive.target_count; ++target) {
    const Bounds& box = scene.morph_deltas.target_bounds[pose.primitive.first_target + target];
    const vec3 a = pose.weight[target] * box.min, b = pose.weight[target] * box.max;
    reach.min += glm::min(a, b);
    reach.max += glm::max(a, b);
  }
  return reach;
}

}  // namespace

vec3 deformed_position(const Scene& scene, uint32_t instance, uint32_t vertex, Moment moment) {
  const Pose pose = pose_of(scene, instance, moment);
  const vec3 base = scene.geometry.position[pose.primitive.vertex_offset + vertex];
  const vec3 position = morphed(pose, base, scene.morph_deltas.position, vertex);
  return vec3(matrix_of(scene, pose, vertex) * vec4(position, 1));
}

Deformed deform(const Scene& scene, uint32_t instance, Moment moment) {
  const Pose pose = pose_of(scene, instance, moment);
  const Geometry& geometry = scene.geometry;
  Deformed result;
  for (uint32_t i = 0; i < pose.primitive.vertex_count; ++i) {
    const uint32_t row = pose.primitive.vertex_offset + i;
    const mat4 matrix = matrix_of(scene, pose, i);
    const vec3 position = morphed(pose, geometry.position[row], scene.morph_deltas.position, i);
    const vec3 normal = morphed(pose, geometry.normal[row], scene.morph_deltas.normal, i);
    const vec3 world_normal = unit_or(normal_matrix(glm::mat3(matrix)) * normal, vec3(0, 1, 0));
    result.position.push_back(vec3(matrix * vec4(position, 1)));
    result.normal.push_back(world_normal);
    vec4 tangent = geometry.tangent[row];
    if (tangent.w != 0) {
      const vec3 along = glm::mat3(matrix) * morphed(pose, vec3(tangent), scene.morph_deltas.tangent, i);
      const vec3 across = along - world_normal * glm::dot(world_normal, along);
      tangent = vec4(unit_or(across, vec3(1, 0, 0)), tangent.w);
    }
    result.tangent.push_back(tangent);
  }
  return result;
}

Bounds deformed_bounds(const Scene& scene, uint32_t instance) {
  constexpr float huge = std::numeric_limits<float>::max();
  const Pose pose = pose_of(scene, instance, Moment::Now);
  const Bounds reach = morph_reach(scene, pose);
  const vec3 shift = reach.min * 0.5f + reach.max * 0.5f, grow = reach.max * 0.5f - reach.min * 0.5f;
  Bounds bounds{vec3(huge), vec3(-huge)};
  if (!pose.joint) {
    const Bounds& box = pose.primitive.bounds;
    add_box(pose.world, (box.min + box.max) * 0.5f + shift, (box.max - box.min) * 0.5f + grow, bounds);
    return bounds;
  }
  const JointBoxes& boxes = scene.joint_boxes;
  for (uint32_t i = 0; i < pose.primitive.joint_box_count; ++i) {
    const uint32_t row = pose.primitive.first_joint_box + i;
    add_box(pose.joint[boxes.joint[row]], boxes.center[row] + shift, boxes.extent[row] + grow, bounds);
  }
  return bounds;
}

}  // namespace nf::scene
