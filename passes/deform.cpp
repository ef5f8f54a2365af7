// Tables and dispatch of the deformation.
#include "deform.h"

#include "gpu/upload.h"
#include "scene_tables.h"

namespace nf::passes {
namespace {

// Rows as shaders/deform.comp declares them (scalar layout).
struct Job {
  uint32_t first_row, vertex_count, first_vertex, instance;
  uint32_t first_influence, first_joint;  // none: not skinned
  uint32_t first_delta, target_count, first_weight;
};
struct InfluenceRow {
  glm::u16vec4 joint;
  glm::vec4 weight;
};
struct DeltaRow {
  glm::vec3 position, normal, tangent;
};
struct JointRow {
  glm::mat4 now, before;
};

constexpr uint32_t deformed_bytes = 13 * 4;

}  // namespace

DeformTables::DeformTables(gpu::Device& device, const scene::Scene& scene) : device_(device), scene_(scene) {
  std::vector<Job> jobs;
  first_row_.assign(scene.instances.size(), scene::none);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Primitive& p = scene.primitives[scene.instances.primitive[i]];
    const uint32_t skin = scene.instances.skin[i], node = scene.instances.node[i];
    if (skin == scene::none && p.target_count == 0) continue;
    first_row_[i] = vertex_count_;
    jobs.push_back({.first_row = vertex_count_,
                    .vertex_count = p.vertex_count,
                    .first_vertex = p.vertex_offset,
                    .instance = i,
                    .first_influence = p.first_influence,
                    .first_joint = skin == scene::none ? scene::none : scene.skins[skin].first_joint,
                    .first_delta = p.first_delta,
                    .target_count = p.target_count,
                    .first_weight = p.target_count ? scene.nodes.first_weight[node] : 0});
    vertex_count_ += p.vertex_count;
  }
  job_count_ = uint32_t(jobs.size());
  std::vector<InfluenceRow> influences;
  for (size_t i = 0; i < scene.influences.size(); ++i)
    influences.push_back({scene.influences.joint[i], scene.influences.weight[i]});
  std::vector<DeltaRow> deltas;
  for (size_t i = 0; i < scene.morph_deltas.position.size(); ++i)
    deltas.push_back({scene.morph_deltas.position[i], scene.morph_deltas.normal[i], scene.morph_deltas.tangent[i]});
  constexpr VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  jobs_ = gpu::upload_table(device, jobs, storage, "deform.jobs");
  influences_ = gpu::upload_table(device, influences, storage, "deform.influences");
  deltas_ = gpu::upload_table(device, deltas, storage, "deform.deltas");
  nothing_ = gpu::upload_buffer(device, {}, storage, "deform.nothing");
  joints_.create<JointRow>(
      device, scene.joints.size(),
      [&](uint32_t i) {
        return JointRow{scene.joints.matrix[i], scene.joints.previous_matrix[i]};
      },
      "deform.joints");
  weights_.create<glm::vec2>(
      device, scene.morph_weights.value.size(),
      [&](uint32_t i) { return glm::vec2(scene.morph_weights.value[i], scene.morph_weights.previous[i]); },
      "deform.weights");
}

DeformTables::~DeformTables() {
  for (gpu::Buffer* buffer : {&jobs_, &influences_, &deltas_, &nothing_}) destroy(device_, *buffer);
  joints_.destroy(device_);
  weights_.destroy(device_);
}

void DeformTables::update(const scene::Changes& changes) {
  joints_.update<JointRow>(changes.joints, [&](uint32_t i) {
    return JointRow{scene_.joints.matrix[i], scene_.joints.previous_matrix[i]};
  });
  weights_.update<glm::vec2>(changes.weights, [&](uint32_t i) {
    return glm::vec2(scene_.morph_weights.value[i], scene_.morph_weights.previous[i]);
  });
}

DeformPass create_deform(gpu::Pipelines& pipelines) {
  return {pipelines.compute("deform.comp")};
}

graph::Buf add_deform(graph::Graph& graph, const DeformPass& pass, const SceneTables& scene) {
  const DeformTables& tables = scene.deform();
  if (tables.vertex_count() == 0) return graph.import("deform.vertices", tables.nothing());
  const graph::Buf out = graph.buffer("deform.vertices", uint64_t(tables.vertex_count()) * deformed_bytes);
  graph.compute("deform", pass.pipeline, "Morphed and skinned vertices")
      .in("jobs", graph.import("deform.jobs", tables.jobs()))
      .in("positions", graph.import("scene.position", scene.positions()))
      .in("normals", graph.import("scene.normal", scene.normals()))
      .in("tangents", graph.import("scene.tangent", scene.tangents()))
      .in("influences", graph.import("deform.influences", tables.influences()))
      .in("deltas", graph.import("deform.deltas", tables.deltas()))
      .in("joints", graph.import("deform.joints", tables.joints()))
      .in("weights", graph.import("deform.weights", tables.weights()))
      .in("instances", graph.import("scene.instances", scene.instances()))
      .out("deformed", out)
      .params(DeformBlock{tables.job_count(), tables.vertex_count()})
      .over(tables.vertex_count());
  return out;
}

}  // namespace nf::passes
