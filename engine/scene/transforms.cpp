// World matrices from the node hierarchy, and the boxes that follow from them. Assumes the nodes' topological order, so
// one forward loop is enough.
#include <limits>

#include "scene/scene.h"

namespace nf::scene {

namespace {

void update_instances(Scene& scene) {
  Instances& instances = scene.instances;
  const float huge = std::numeric_limits<float>::max();
  Bounds bounds{vec3(huge), vec3(-huge)};
  for (size_t i = 0; i < instances.size(); ++i) {
    const mat4& world = scene.nodes.world[instances.node[i]];
    const Bounds& box = scene.primitives[instances.primitive[i]].bounds;
    const glm::mat3 linear(world);
    // Arvo 1990: the box of a transformed box has |M| * half size.
    const glm::mat3 absolute(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
    instances.center[i] = vec3(world * vec4((box.min + box.max) * 0.5f, 1));
    instances.extent[i] = absolute * ((box.max - box.min) * 0.5f);
    instances.mirrored[i] = glm::determinant(linear) < 0;
    bounds.min = glm::min(bounds.min, instances.center[i] - instances.extent[i]);
    bounds.max = glm::max(bounds.max, instances.center[i] + instances.extent[i]);
  }
  scene.bounds = instances.size() > 0 ? bounds : Bounds{};
}

}  // namespace

void update_transforms(Scene& scene) {
  Nodes& nodes = scene.nodes;
  nodes.previous_world = nodes.world;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const uint32_t parent = nodes.parent[i];
    nodes.world[i] = parent == none ? nodes.local_matrix[i] : nodes.world[parent] * nodes.local_matrix[i];
  }
  update_instances(scene);
}

}  // namespace nf::scene
