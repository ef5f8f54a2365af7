// The update of what moved. Nodes are in topological order, so one forward loop over flags finds everything below a
// touched node; the tables that hang on nodes are walked the same way.
#include "scene/update.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/deform.h"

namespace nf::scene {

namespace {

void mark(std::vector<RowRange>& ranges, uint32_t row) {
  if (!ranges.empty() && ranges.back().first + ranges.back().count == row) {
    ++ranges.back().count;
  } else {
    ranges.push_back({row, 1});
  }
}

// Flags of one update, by row.
struct Stale {
  std::vector<uint8_t> node;     // world or previous_world changed
  std::vector<uint8_t> weights;  // the node's morph weights, now or before
  std::vector<uint8_t> skin;
};

void update_nodes(Scene& scene, Stale& stale, Changes& changes) {
  Nodes& nodes = scene.nodes;
  stale.node.assign(nodes.size(), 0);
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    const uint32_t parent = nodes.parent[i];
    const uint8_t moves = nodes.touched[i] | (parent == none ? uint8_t(0) : nodes.moved[parent]);
    if (!(moves | nodes.moved[i])) continue;
    nodes.previous_world[i] = nodes.world[i];
    if (moves) nodes.world[i] = parent == none ? nodes.local_matrix[i] : nodes.world[parent] * nodes.local_matrix[i];
    // Parents come first, so a parent's flag is already this update's.
    nodes.moved[i] = moves;
    nodes.touched[i] = 0;
    stale.node[i] = 1;
    mark(changes.nodes, i);
  }
}

void update_joints(Scene& scene, Stale& stale, Changes& changes) {
  Joints& joints = scene.joints;
  stale.skin.assign(scene.skins.size(), 0);
  for (uint32_t skin = 0; skin < scene.skins.size(); ++skin) {
    const auto [first, count] = scene.skins[skin];
    for (uint32_t joint = first; joint < first + count; ++joint) {
      if (!stale.node[joints.node[joint]]) continue;
      joints.previous_matrix[joint] = joints.matrix[joint];
      joints.matrix[joint] = scene.nodes.world[joints.node[joint]] * joints.inverse_bind[joint];
      stale.skin[skin] = 1;
      mark(changes.joints, joint);
    }
  }
}

void update_weights(Scene& scene, Stale& stale, Changes& changes) {
  MorphWeights& weights = scene.morph_weights;
  stale.weights.assign(weights.value.empty() ? 0 : scene.nodes.size(), 0);
  for (uint32_t node = 0; node < stale.weights.size(); ++node) {
    const uint32_t first = scene.nodes.first_weight[node];
    for (uint32_t i = first; i < first + scene.nodes.weight_count[node]; ++i) {
      if (weights.previous[i] == weights.value[i] && weights.value[i] == weights.wanted[i]) continue;
      weights.previous[i] = weights.value[i];
      weights.value[i] = weights.wanted[i];
      stale.weights[node] = 1;
      mark(changes.weights, i);
    }
  }
}

void update_instances(Scene& scene, const Stale& stale, Changes& changes) {
  Instances& instances = scene.instances;
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const uint32_t node = instances.node[i], skin = instances.skin[i];
    const bool deforms = (skin != none && stale.skin[skin]) || (!stale.weights.empty() && stale.weights[node]);
    if (!stale.node[node] && !deforms) continue;
    const Bounds bounds = deformed_bounds(scene, i);
    instances.center[i] = bounds.min * 0.5f + bounds.max * 0.5f;
    instances.extent[i] = bounds.max * 0.5f - bounds.min * 0.5f;
    const mat4& matrix = skin == none ? scene.nodes.world[node] : scene.joints.matrix[scene.skins[skin].first_joint];
    instances.mirrored[i] = glm::determinant(glm::mat3(matrix)) < 0;
    mark(changes.instances, i);
  }
  if (changes.instances.empty()) return;
  const float huge = std::numeric_limits<float>::max();
  scene.bounds = {vec3(huge), vec3(-huge)};
  for (size_t i = 0; i < instances.size(); ++i) {
    scene.bounds.min = glm::min(scene.bounds.min, instances.center[i] - instances.extent[i]);
    scene.bounds.max = glm::max(scene.bounds.max, instances.center[i] + instances.extent[i]);
  }
}

// Rows of lights or cameras whose node moved.
template <class Row>
void update_placed(const Scene& scene, std::vector<Row>& rows, std::vector<RowRange>& changed) {
  for (uint32_t i = 0; i < rows.size(); ++i) {
    const uint32_t node = rows[i].node;
    if (node == none || !scene.nodes.moved[node]) continue;
    if (place(scene.nodes.world[node], rows[i])) mark(changed, i);
  }
}

bool unit_axis(const vec4& axis, float sign, vec3& unit) {
  const float length = glm::length(vec3(axis));
  if (!(length > 1e-12f) || !std::isfinite(length)) return false;
  unit = vec3(axis) * (sign / length);
  return true;
}

}  // namespace

mat4 compose(const vec3& translation, const quat& rotation, const vec3& scale) {
  mat4 matrix = glm::mat4_cast(rotation);
  for (int axis = 0; axis < 3; ++axis) matrix[axis] *= scale[axis];
  matrix[3] = vec4(translation, 1);
  return matrix;
}

void set_local(Nodes& nodes, uint32_t node, const vec3& translation, const quat& rotation, const vec3& scale) {
  if (nodes.translation[node] == translation && nodes.rotation[node] == rotation && nodes.scale[node] == scale) return;
  nodes.translation[node] = translation;
  nodes.rotation[node] = rotation;
  nodes.scale[node] = scale;
  nodes.local_matrix[node] = compose(translation, rotation, scale);
  nodes.touched[node] = 1;
}

Changes update(Scene& scene) {
  Changes changes;
  Stale stale;
  update_nodes(scene, stale, changes);
  update_joints(scene, stale, changes);
  update_weights(scene, stale, changes);
  update_instances(scene, stale, changes);
  update_placed(scene, scene.directional, changes.directional);
  update_placed(scene, scene.punctual, changes.punctual);
  update_placed(scene, scene.cameras, changes.cameras);
  return changes;
}

void update_transforms(Scene& scene) {
  std::fill(scene.nodes.touched.begin(), scene.nodes.touched.end(), uint8_t(1));
  update(scene);
}

bool place(const mat4& world, DirectionalLight& light) {
  return unit_axis(world[2], -1, light.direction);
}

bool place(const mat4& world, PunctualLight& light) {
  light.position = vec3(world[3]);
  const bool spot = light.outer_cone < 3.14f;
  return unit_axis(world[2], -1, light.direction) || !spot;
}

bool place(const mat4& world, Camera& camera) {
  vec3 forward, up;
  if (!unit_axis(world[2], -1, forward) || !unit_axis(world[1], 1, up)) return false;
  // A skewed node can bring them together; any other up will do then.
  if (glm::length(glm::cross(forward, up)) < 1e-4f) {
    up = std::abs(forward.y) < 0.9f ? vec3(0, 1, 0) : vec3(0, 0, 1);
  }
  camera.position = vec3(world[3]);
  camera.forward = forward;
  camera.up = up;
  return true;
}

void select_variant(Scene& scene, uint32_t variant) {
  for (size_t i = 0; i < scene.primitives.size(); ++i) scene.primitives[i].material = scene.default_material[i];
  for (const VariantMaterial& row : scene.variant_materials) {
    if (row.variant == variant) scene.primitives[row.primitive].material = row.material;
  }
}

}  // namespace nf::scene
