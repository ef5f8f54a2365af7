// Skinned and morphed vertices in world space, now and one update before: once a frame, for all views.
#pragma once

#include "graph/graph.h"
#include "host_table.h"
#include "scene/scene.h"

namespace nf::passes {

#define NF_DEFORM_FIELDS(F) F(Uint, job_count) F(Uint, vertex_count)
NF_DECLARE_BLOCK(DeformBlock, "deform", NF_DEFORM_FIELDS)

// What the pass reads: the undeformed streams are SceneTables'.
class DeformTables {
 public:
  DeformTables(gpu::Device& device, const scene::Scene& scene);
  ~DeformTables();
  DeformTables(const DeformTables&) = delete;
  DeformTables& operator=(const DeformTables&) = delete;
  void update(const scene::Changes& changes);

  // By instance: its first row of the pass's output, or none when it is only transformed.
  const std::vector<uint32_t>& first_row() const { return first_row_; }
  uint32_t vertex_count() const { return vertex_count_; }
  uint32_t job_count() const { return job_count_; }
  const gpu::Buffer& jobs() const { return jobs_; }
  const gpu::Buffer& influences() const { return influences_; }
  const gpu::Buffer& deltas() const { return deltas_; }
  const gpu::Buffer& joints() const { return joints_.current(); }
  const gpu::Buffer& weights() const { return weights_.current(); }
  const gpu::Buffer& nothing() const { return nothing_; }

 private:
  gpu::Device& device_;
  const scene::Scene& scene_;
  std::vector<uint32_t> first_row_;
  uint32_t vertex_count_ = 0, job_count_ = 0;
  gpu::Buffer jobs_, influences_, deltas_, nothing_;
  HostTable joints_, weights_;
};

struct DeformPass {
  gpu::Pipeline pipeline;
};
DeformPass create_deform(gpu::Pipelines& pipelines);

class SceneTables;
// Rows as DeformedVertex of shaders/common/scene.glsl; a buffer to bind where nothing is deformed.
graph::Buf add_deform(graph::Graph& graph, const DeformPass& pass, const SceneTables& scene);

}  // namespace nf::passes
