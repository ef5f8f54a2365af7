// What graph tests are built from: shader interfaces made by hand instead of by reflection, and look-ups in plans.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "graph/plan.h"

namespace nf::graph {

inline gpu::Slot sampled(std::string name) {
  return {.name = std::move(name), .kind = gpu::SlotKind::SampledImage};
}
inline gpu::Slot storage_in(std::string name, VkFormat format = VK_FORMAT_UNDEFINED) {
  return {.name = std::move(name), .kind = gpu::SlotKind::StorageImage, .readonly = true, .format = format};
}
inline gpu::Slot storage_out(std::string name, VkFormat format = VK_FORMAT_UNDEFINED) {
  return {.name = std::move(name), .kind = gpu::SlotKind::StorageImage, .writeonly = true, .format = format};
}
inline gpu::Slot storage_inout(std::string name) {
  return {.name = std::move(name), .kind = gpu::SlotKind::StorageImage};
}

// Owns the interfaces that pipelines point to; every pipeline has an id of its own.
class Shaders {
 public:
  gpu::Pipeline make(std::vector<gpu::Slot> slots, std::vector<std::string> color_outputs = {}) {
    interfaces_.push_back({.slots = std::move(slots), .color_outputs = std::move(color_outputs)});
    return {gpu::PipelineId{uint16_t(interfaces_.size() - 1)}, &interfaces_.back()};
  }

 private:
  std::deque<gpu::ShaderInterface> interfaces_;
};

// validate() without what small graphs need not care about: outputs that nobody reads, histories used blindly.
inline std::vector<Diagnostic> faults(const Graph& graph) {
  std::vector<Diagnostic> found = validate(graph);
  std::erase_if(found, [](const Diagnostic& d) {
    return d.kind == Diagnostic::Kind::WrittenNeverRead || d.kind == Diagnostic::Kind::ValidityIgnored;
  });
  return found;
}

inline constexpr VkPipelineStageFlags2 compute_stage = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
inline constexpr VkPipelineStageFlags2 fragment_stage = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
inline constexpr VkPipelineStageFlags2 color_stage = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
inline constexpr VkPipelineStageFlags2 copy_stage = VK_PIPELINE_STAGE_2_COPY_BIT;
inline constexpr VkAccessFlags2 sampled_read = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
inline constexpr VkAccessFlags2 storage_read = VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
inline constexpr VkAccessFlags2 storage_write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;

inline const PlannedPass* planned_pass(const Plan& plan, uint32_t pass) {
  for (const PlannedPass& planned : plan.passes)
    if (planned.pass == pass) return &planned;
  return nullptr;
}

// The barriers of `tex` in front of row `pass`; of all resources without one.
inline std::vector<Barrier> barriers_of(const Plan& plan, uint32_t pass, Tex tex = {}) {
  std::vector<Barrier> found;
  if (const PlannedPass* planned = planned_pass(plan, pass))
    for (uint32_t i = 0; i < planned->barrier_count; ++i)
      if (const Barrier& b = plan.barriers[planned->first_barrier + i]; !tex || b.resource == tex.id)
        found.push_back(b);
  return found;
}

// The one barrier of `tex` in front of `pass`, or one that fits nothing.
inline Barrier barrier_of(const Plan& plan, uint32_t pass, Tex tex) {
  const auto found = barriers_of(plan, pass, tex);
  return found.size() == 1 ? found[0] : Barrier{.old_layout = VK_IMAGE_LAYOUT_MAX_ENUM};
}

}  // namespace nf::graph
