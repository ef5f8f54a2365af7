// The node hierarchy of one glTF scene, and the instances it makes of the meshes.
#include <cmath>

#include "core/log.h"
#include "scene/gltf_import.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

constexpr uint32_t chosen_scene_parent = none - 1;  // "parent" of the chosen scene's roots, in the file's table

std::string node_name(const Importer& importer, size_t node) {
  return describe("node", node, one_line(importer.model.nodes[node].name));
}

// The parent of every node of the file; refuses two parents.
std::vector<uint32_t> file_parents(const Importer& importer) {
  const std::vector<tinygltf::Node>& nodes = importer.model.nodes;
  std::vector<uint32_t> parents(nodes.size(), none);
  for (size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : nodes[i].children) {
      uint32_t& parent = parents.at(size_t(child));
      if (size_t(child) == i) refuse("{} is its own child: the hierarchy has a cycle", node_name(importer, i));
      if (parent != none) {
        refuse("{} has two parents: {} and {}", node_name(importer, size_t(child)), node_name(importer, parent),
               node_name(importer, i));
      }
      parent = uint32_t(i);
    }
  }
  return parents;
}

// Appends the subtrees under `order`, breadth first: parents come before children.
void add_descendants(const Importer& importer, std::vector<uint32_t>& order) {
  for (size_t i = 0; i < order.size(); ++i) {
    for (const int child : importer.model.nodes[order[i]].children) order.push_back(uint32_t(child));
  }
}

void refuse_cycles(const Importer& importer, const std::vector<uint32_t>& parents) {
  std::vector<uint32_t> order;
  for (size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == none) order.push_back(uint32_t(i));
  }
  // With one parent each, what no root reaches hangs on a cycle.
  add_descendants(importer, order);
  if (order.size() == parents.size()) return;
  std::vector<bool> reached(parents.size());
  for (const uint32_t node : order) reached[node] = true;
  for (size_t i = 0; i < reached.size(); ++i) {
    if (!reached[i]) refuse("{} is part of, or below, a cycle in the hierarchy", node_name(importer, i));
  }
}

std::vector<uint32_t> scene_order(const Importer& importer, std::vector<uint32_t>& parents) {
  std::vector<uint32_t> order;
  if (importer.model.scenes.empty()) {
    for (size_t i = 0; i < parents.size(); ++i) {
      if (parents[i] == none) order.push_back(uint32_t(i));
    }
  } else {
    const size_t row = importer.model.defaultScene >= 0 ? size_t(importer.model.defaultScene) : 0;
    if (row >= importer.model.scenes.size()) refuse("scene {} does not exist", row);
    for (const int root : importer.model.scenes[row].nodes) {
      uint32_t& parent = parents.at(size_t(root));
      if (parent == chosen_scene_parent) refuse("{} is listed twice in its scene", node_name(importer, size_t(root)));
      if (parent != none) {
        refuse("{} has two parents: its scene and {}", node_name(importer, size_t(root)), node_name(importer, parent));
      }
      parent = chosen_scene_parent;
      order.push_back(uint32_t(root));
    }
  }
  add_descendants(importer, order);
  return order;
}

mat4 compose(const vec3& translation, const quat& rotation, const vec3& scale) {
  mat4 matrix = glm::mat4_cast(rotation);
  for (int axis = 0; axis < 3; ++axis) matrix[axis] *= scale[axis];
  matrix[3] = vec4(translation, 1);
  return matrix;
}

struct Local {
  vec3 translation{0}, scale{1};
  quat rotation{1, 0, 0, 0};
  mat4 matrix{1};
};

// The rotation and scale nearest to a matrix, for whoever edits the node; the matrix itself stays what is drawn.
void decompose(Local& local) {
  glm::mat3 axes(local.matrix);
  local.translation = vec3(local.matrix[3]);
  for (int i = 0; i < 3; ++i) local.scale[i] = glm::length(axes[i]);
  if (glm::determinant(axes) < 0) local.scale.x = -local.scale.x;
  if (!(glm::abs(local.scale.x * local.scale.y * local.scale.z) > 1e-30f)) return;
  for (int i = 0; i < 3; ++i) axes[i] /= local.scale[i];
  local.rotation = glm::normalize(glm::quat_cast(axes));
}

Local local_transform(const Importer& importer, size_t row) {
  const tinygltf::Node& node = importer.model.nodes[row];
  Local local;
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) local.matrix[i / 4][i % 4] = float(node.matrix[size_t(i)]);
    const vec4 last = glm::transpose(local.matrix)[3];
    if (glm::distance(last, vec4(0, 0, 0, 1)) > 1e-4f)
      refuse("{} has a matrix that is not affine", node_name(importer, row));
    decompose(local);
    return local;
  }
  const auto component = [](const std::vector<double>& list, int i) { return float(list[size_t(i)]); };
  for (int i = 0; i < 3 && node.translation.size() == 3; ++i) local.translation[i] = component(node.translation, i);
  for (int i = 0; i < 3 && node.scale.size() == 3; ++i) local.scale[i] = component(node.scale, i);
  if (node.rotation.size() == 4) {
    const glm::dvec4 q(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]);
    const double length = glm::length(q);
    if (!(length > 1e-6 && length < 1e6)) refuse("{} has a rotation that is no quaternion", node_name(importer, row));
    const vec4 unit(q / length);
    local.rotation = quat(unit.w, unit.x, unit.y, unit.z);
  }
  local.matrix = compose(local.translation, local.rotation, local.scale);
  return local;
}

void append_node(const Importer& importer, uint32_t file_row, uint32_t parent, Nodes& nodes) {
  const Local local = local_transform(importer, file_row);
  nodes.parent.push_back(parent);
  nodes.translation.push_back(local.translation);
  nodes.rotation.push_back(local.rotation);
  nodes.scale.push_back(local.scale);
  nodes.local_matrix.push_back(local.matrix);
  nodes.world.push_back(mat4(1));
  nodes.previous_world.push_back(mat4(1));
  nodes.name.push_back(one_line(importer.model.nodes[file_row].name));
}

void append_instances(Importer& importer, uint32_t node, const PrimitiveRange& range) {
  Instances& instances = importer.scene.instances;
  importer.budget.take(uint64_t(range.count) * 48, "instances");
  for (uint32_t i = 0; i < range.count; ++i) {
    instances.node.push_back(node);
    instances.primitive.push_back(range.first + i);
    instances.center.push_back(vec3(0));
    instances.extent.push_back(vec3(0));
    instances.mirrored.push_back(0);
  }
}

}  // namespace

std::vector<uint32_t> import_nodes(Importer& importer) {
  std::vector<uint32_t> parents = file_parents(importer);
  refuse_cycles(importer, parents);
  const std::vector<uint32_t> order = scene_order(importer, parents);
  std::vector<uint32_t> row_of(parents.size(), none);
  std::map<int, PrimitiveRange> meshes;  // only those the scene uses are imported
  for (size_t row = 0; row < order.size(); ++row) {
    const uint32_t file_row = order[row], parent = parents[file_row];
    row_of[file_row] = uint32_t(row);
    append_node(importer, file_row, parent < parents.size() ? row_of[parent] : none, importer.scene.nodes);
    const tinygltf::Node& node = importer.model.nodes[file_row];
    if (node.skin >= 0) importer.warn_once("skins are not applied: skinned meshes stay in their bind pose");
    if (node.mesh < 0) continue;
    if (!meshes.contains(node.mesh)) meshes[node.mesh] = import_mesh(importer, size_t(node.mesh));
    append_instances(importer, uint32_t(row), meshes[node.mesh]);
  }
  return order;
}

}  // namespace nf::scene::gltf
