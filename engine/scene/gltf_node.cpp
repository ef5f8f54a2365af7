// The node hierarchy of one glTF scene, and the instances it makes of the meshes.
#include <algorithm>
#include <cmath>

#include "scene/gltf_import.h"
#include "scene/text.h"
#include "scene/update.h"

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
  nodes.first_weight.push_back(0);
  nodes.weight_count.push_back(0);
  nodes.touched.push_back(0);
  nodes.moved.push_back(0);
  nodes.name.push_back(one_line(importer.model.nodes[file_row].name));
}

// The weights of a node's morphed mesh: the node's own, else the mesh's, else 0.
void append_weights(Importer& importer, uint32_t file_row, uint32_t node, const PrimitiveRange& range) {
  uint32_t targets = 0;
  for (uint32_t i = 0; i < range.count; ++i) {
    targets = std::max(targets, importer.scene.primitives[range.first + i].target_count);
  }
  if (targets == 0) return;
  const tinygltf::Node& source = importer.model.nodes[file_row];
  const std::vector<double>& mesh = importer.model.meshes[size_t(source.mesh)].weights;
  const std::vector<double>& weights = source.weights.empty() ? mesh : source.weights;
  MorphWeights& table = importer.scene.morph_weights;
  importer.scene.nodes.first_weight[node] = uint32_t(table.value.size());
  importer.scene.nodes.weight_count[node] = targets;
  for (size_t i = 0; i < targets; ++i) table.value.push_back(i < weights.size() ? float(weights[i]) : 0.f);
  table.previous = table.wanted = table.value;
}

// The skin of an instance; none where the primitive is not made for one.
uint32_t skin_of(const Importer& importer, int file_skin, const Primitive& primitive) {
  if (file_skin < 0 || primitive.first_influence == none) return none;
  const uint32_t row = importer.skin_rows[size_t(file_skin)];
  if (row == none) return none;
  const Scene& scene = importer.scene;
  const uint32_t joints = scene.skins[row].joint_count;
  const uint32_t last = scene.joint_boxes.joint[primitive.first_joint_box + primitive.joint_box_count - 1];
  if (last >= joints) refuse("a mesh uses the joint {}, but skins[{}] has only {} joints", last, file_skin, joints);
  return row;
}

void append_instances(Importer& importer, uint32_t file_row, uint32_t node, const PrimitiveRange& range) {
  Instances& instances = importer.scene.instances;
  importer.budget.take(uint64_t(range.count) * 52, "instances");
  const tinygltf::Node& source = importer.model.nodes[file_row];
  for (uint32_t i = 0; i < range.count; ++i) {
    const Primitive& primitive = importer.scene.primitives[range.first + i];
    instances.node.push_back(node);
    instances.primitive.push_back(range.first + i);
    instances.skin.push_back(skin_of(importer, source.skin, primitive));
    instances.center.push_back(vec3(0));
    instances.extent.push_back(vec3(0));
    instances.mirrored.push_back(0);
    if (source.skin < 0 && primitive.first_influence != none) {
      importer.warn_once("meshes made for a skin, at nodes without one, stay in their bind pose");
    }
  }
}

}  // namespace

std::vector<uint32_t> import_nodes(Importer& importer) {
  std::vector<uint32_t> parents = file_parents(importer);
  refuse_cycles(importer, parents);
  const std::vector<uint32_t> order = scene_order(importer, parents);
  importer.node_rows.assign(parents.size(), none);
  for (size_t row = 0; row < order.size(); ++row) {
    const uint32_t file_row = order[row], parent = parents[file_row];
    importer.node_rows[file_row] = uint32_t(row);
    const uint32_t parent_row = parent < parents.size() ? importer.node_rows[parent] : none;
    append_node(importer, file_row, parent_row, importer.scene.nodes);
  }
  import_skins(importer, order);
  std::map<int, PrimitiveRange> meshes;  // only those the scene uses are imported
  for (size_t row = 0; row < order.size(); ++row) {
    const int mesh = importer.model.nodes[order[row]].mesh;
    if (mesh < 0) continue;
    if (!meshes.contains(mesh)) meshes[mesh] = import_mesh(importer, size_t(mesh));
    append_weights(importer, order[row], uint32_t(row), meshes[mesh]);
    append_instances(importer, order[row], uint32_t(row), meshes[mesh]);
  }
  return order;
}

}  // namespace nf::scene::gltf
