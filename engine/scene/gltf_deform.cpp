// Skins and morph targets: the joints of a skin, the influences of a vertex, the deltas of a target.
#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/gltf_mesh.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

struct Influence {
  float weight = 0;
  uint16_t joint = 0;
};

// The four largest weights, scaled to a sum of 1; the first joint alone where there are none.
void keep_four(std::vector<Influence>& influences, glm::u16vec4& joint, vec4& weight) {
  const size_t kept = std::min<size_t>(influences.size(), 4);
  std::partial_sort(influences.begin(), influences.begin() + std::ptrdiff_t(kept), influences.end(),
                    [](const Influence& a, const Influence& b) {
                      return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
                    });
  float sum = 0;
  for (size_t i = 0; i < kept; ++i) sum += influences[i].weight;
  joint = glm::u16vec4(0);
  weight = vec4(1, 0, 0, 0);
  if (!(sum > 0)) return;
  for (int i = 0; i < 4; ++i) {
    const Influence influence = size_t(i) < kept ? influences[size_t(i)] : Influence{};
    weight[i] = influence.weight / sum;
    // Joints without a weight may be anything in a file.
    joint[i] = influence.weight > 0 ? influence.joint : uint16_t(0);
  }
}

struct InfluenceSet {
  Elements joints, weights;
};

std::vector<InfluenceSet> open_influences(Importer& importer, const AttributeSource& source) {
  std::vector<InfluenceSet> sets;
  for (int n = 0;; ++n) {
    const std::string joints = fmt::format("JOINTS_{}", n), weights = fmt::format("WEIGHTS_{}", n);
    if (!source.attributes.contains(joints) || !source.attributes.contains(weights)) return sets;
    InfluenceSet& set = sets.emplace_back();
    open_attribute(importer, source, joints, as_u8 | as_u16, 4, 4, set.joints);
    open_attribute(importer, source, weights, as_float | as_u8 | as_u16, 4, 4, set.weights);
    set.weights.normalized = true;
  }
}

template <class T>
void append(std::vector<T>& table, const std::vector<T>& rows) {
  table.insert(table.end(), rows.begin(), rows.end());
}

}  // namespace

void draft_influences(Importer& importer, const AttributeSource& source, Draft& draft) {
  const std::vector<InfluenceSet> sets = open_influences(importer, source);
  if (sets.empty()) return;
  importer.budget.take(uint64_t(draft.vertex_count) * 24, "vertices");
  draft.joint.resize(draft.vertex_count);
  draft.weight.resize(draft.vertex_count);
  std::vector<Influence> influences;
  bool broken = false, many = false;
  for (size_t i = 0; i < draft.vertex_count; ++i) {
    influences.clear();
    for (const InfluenceSet& set : sets) {
      const glm::u16vec4 joint = read_u16vec4(set.joints, draft.file_vertex(i));
      const vec4 weight = read_float4(set.weights, draft.file_vertex(i));
      for (int k = 0; k < 4; ++k) {
        const bool sane = weight[k] >= 0 && weight[k] < 1e6f;
        broken |= !sane;
        if (sane && weight[k] > 0) influences.push_back({weight[k], joint[k]});
      }
    }
    many |= influences.size() > 4;
    keep_four(influences, draft.joint[i], draft.weight[i]);
  }
  if (broken) importer.warn_once("skin weights that are negative or not finite count as 0");
  if (many) importer.warn_once("vertices with more than four joints keep the four with the largest weights");
}

void draft_targets(Importer& importer, const tinygltf::Primitive& source, size_t file_vertices,
                   const std::string& where, Draft& draft) {
  draft.target_count = source.targets.size();
  if (source.targets.empty()) return;
  importer.budget.take(uint64_t(source.targets.size()) * draft.vertex_count * 36, "morph targets");
  const size_t rows = source.targets.size() * draft.vertex_count;
  const unsigned quantized = importer.quantized ? as_i8 | as_i16 : 0;
  for (std::vector<vec3>* stream : {&draft.delta_position, &draft.delta_normal, &draft.delta_tangent}) {
    stream->assign(rows, vec3(0));
  }
  for (size_t target = 0; target < source.targets.size(); ++target) {
    const AttributeSource attributes{source.targets[target], file_vertices,
                                     fmt::format("{}.targets[{}]", where, target)};
    const auto read = [&](const char* name, std::vector<vec3>& stream) {
      Elements elements;
      if (!open_attribute(importer, attributes, name, as_float | quantized, 3, 3, elements)) return;
      for (size_t i = 0; i < draft.vertex_count; ++i) {
        const vec4 value = read_float4(elements, draft.file_vertex(i));
        if (!finite(value)) refuse("{} {} has a value that is not finite (vertex {})", attributes.where, name, i);
        stream[target * draft.vertex_count + i] = vec3(value);
      }
    };
    read("POSITION", draft.delta_position);
    read("NORMAL", draft.delta_normal);
    read("TANGENT", draft.delta_tangent);
  }
}

void append_influences(Scene& scene, const Draft& draft, Primitive& primitive) {
  if (draft.joint.empty()) return;
  primitive.first_influence = uint32_t(scene.influences.size());
  append(scene.influences.joint, draft.joint);
  append(scene.influences.weight, draft.weight);

  constexpr float huge = std::numeric_limits<float>::max();
  std::vector<Bounds> boxes;
  for (size_t i = 0; i < draft.vertex_count; ++i) {
    for (int k = 0; k < 4; ++k) {
      if (!(draft.weight[i][k] > 0)) continue;
      const size_t joint = draft.joint[i][k];
      if (joint >= boxes.size()) boxes.resize(joint + 1, {vec3(huge), vec3(-huge)});
      boxes[joint].min = glm::min(boxes[joint].min, draft.position[i]);
      boxes[joint].max = glm::max(boxes[joint].max, draft.position[i]);
    }
  }
  JointBoxes& table = scene.joint_boxes;
  primitive.first_joint_box = uint32_t(table.joint.size());
  for (size_t joint = 0; joint < boxes.size(); ++joint) {
    if (boxes[joint].min.x > boxes[joint].max.x) continue;
    table.joint.push_back(uint32_t(joint));
    table.center.push_back(boxes[joint].min * 0.5f + boxes[joint].max * 0.5f);
    table.extent.push_back(boxes[joint].max * 0.5f - boxes[joint].min * 0.5f);
  }
  primitive.joint_box_count = uint32_t(table.joint.size()) - primitive.first_joint_box;
}

void append_targets(Scene& scene, const Draft& draft, Primitive& primitive) {
  MorphDeltas& table = scene.morph_deltas;
  primitive.first_delta = uint32_t(table.position.size());
  primitive.first_target = uint32_t(table.target_bounds.size());
  primitive.target_count = uint32_t(draft.target_count);
  append(table.position, draft.delta_position);
  append(table.normal, draft.delta_normal);
  append(table.tangent, draft.delta_tangent);
  for (size_t target = 0; target < draft.target_count; ++target) {
    Bounds bounds;  // holds 0: a vertex may be one the target leaves alone
    for (size_t i = 0; i < draft.vertex_count; ++i) {
      const vec3 delta = draft.delta_position[target * draft.vertex_count + i];
      bounds.min = glm::min(bounds.min, delta);
      bounds.max = glm::max(bounds.max, delta);
    }
    table.target_bounds.push_back(bounds);
  }
}

namespace {

bool affine(const mat4& matrix) {
  for (int i = 0; i < 16; ++i) {
    if (!std::isfinite(matrix[i / 4][i % 4])) return false;
  }
  return glm::distance(glm::transpose(matrix)[3], vec4(0, 0, 0, 1)) < 1e-3f;
}

void import_skin(Importer& importer, size_t row) {
  const tinygltf::Skin& source = importer.model.skins[row];
  const std::string where = describe("skin", row, source.name);
  if (source.joints.size() > 65536) refuse("{} has more than 65536 joints", where);
  for (const int joint : source.joints) {
    if (importer.node_rows[size_t(joint)] != none) continue;
    importer.warn_once(fmt::format("{} has joints outside the scene: its meshes stay in their bind pose", where));
    return;
  }
  Joints& joints = importer.scene.joints;
  importer.budget.take(source.joints.size() * 196, "joints");
  Elements matrices;
  if (source.inverseBindMatrices >= 0) {
    matrices = open_accessor(importer, source.inverseBindMatrices, as_float, 16, 16, where + " inverseBindMatrices");
    if (matrices.count < source.joints.size()) {
      refuse("{} has {} joints, but only {} inverse bind matrices", where, source.joints.size(), matrices.count);
    }
  }
  importer.skin_rows[row] = uint32_t(importer.scene.skins.size());
  importer.scene.skins.push_back({uint32_t(joints.size()), uint32_t(source.joints.size())});
  for (size_t i = 0; i < source.joints.size(); ++i) {
    const mat4 inverse_bind = source.inverseBindMatrices >= 0 ? read_mat4(matrices, i) : mat4(1);
    if (!affine(inverse_bind)) refuse("{} has an inverse bind matrix that is not affine (joint {})", where, i);
    joints.node.push_back(importer.node_rows[size_t(source.joints[i])]);
    joints.inverse_bind.push_back(inverse_bind);
    joints.matrix.push_back(mat4(1));
    joints.previous_matrix.push_back(mat4(1));
  }
}

}  // namespace

void import_skins(Importer& importer, std::span<const uint32_t> order) {
  importer.skin_rows.assign(importer.model.skins.size(), none);
  std::vector<bool> done(importer.model.skins.size());
  for (const uint32_t node : order) {
    const int skin = importer.model.nodes[node].skin;
    if (skin < 0 || done[size_t(skin)]) continue;
    done[size_t(skin)] = true;
    import_skin(importer, size_t(skin));
  }
}

}  // namespace nf::scene::gltf
