// Moving things: from local transforms to everything that follows from them, touching only what moved.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace nf::scene {

struct RowRange {
  uint32_t first = 0, count = 0;
  bool operator==(const RowRange&) const = default;
};

// The rows whose content an update changed, as rising ranges: what an uploader has to copy. A row that moved in the
// update before and rests now is among them once more, because its previous transform has caught up. An instance is
// listed when its node's matrices, its box, its joints or its weights changed.
struct Changes {
  std::vector<RowRange> nodes, instances, joints, weights, directional, punctual, cameras;
  bool operator==(const Changes&) const = default;
};

// Sets a node's local transform and marks it touched where that makes a difference. Takes effect with the next update.
void set_local(Nodes& nodes, uint32_t node, const vec3& translation, const quat& rotation, const vec3& scale);

// One step of time: previous transforms become the current ones, then touched nodes and all below them get new world
// matrices, and with them instances, joints, lights, cameras and the scene's bounds. Cost grows with what moved, but
// for one pass over byte flags.
Changes update(Scene& scene);

// translation * rotation * scale.
mat4 compose(const vec3& translation, const quat& rotation, const vec3& scale);

// Places a light or camera by its node's matrix: it looks down -Z, scale does not matter. False, and nothing changes,
// where the matrix has flattened an axis it needs.
bool place(const mat4& world, DirectionalLight& light);
bool place(const mat4& world, PunctualLight& light);
bool place(const mat4& world, Camera& camera);

}  // namespace nf::scene
