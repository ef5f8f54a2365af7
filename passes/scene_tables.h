// The scene on the GPU: vertex streams, tables of instances and materials, textures in arrays, and the frame's
// draws as indirect commands.
//
// Draws are batched so that a draw costs an indirect command and not a descriptor change: textures of one size and
// encoding share an array, materials are rows of a table, and only a change of texture arrays, samplers, culling or
// alpha mode starts a new batch.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "deform.h"
#include "gpu/upload.h"
#include "scene/culling.h"
#include "scene/scene.h"

namespace nf::passes {

// Mapped: textures with a transform or the second set of coordinates, cut out or not. Blended: over the finished frame.
enum class DrawClass : uint8_t { Opaque, Masked, Mapped, Blended };
// What is done with alphaMode BLEND: its own class, or cut out at alpha 0.5 as if it were MASK.
enum class Blending : uint8_t { Over, CutOut };
DrawClass draw_class_of(const scene::Material& material, Blending blending);
enum class Sides : uint8_t { AsMaterial, Both };

struct Batch {
  DrawClass draw_class;
  bool double_sided, mirrored;
  uint32_t texture_set;
  uint32_t first_draw, draw_count;  // rows of the indirect buffer
  bool same_state(const Batch& b) const {
    return draw_class == b.draw_class && double_sided == b.double_sided && mirrored == b.mirrored &&
           texture_set == b.texture_set;
  }
};

// Bindings of a material's texture set.
inline constexpr uint32_t material_textures = uint32_t(scene::Slot::Count);

// One view's draws: the camera's, or a shadow's.
struct DrawList {
  gpu::Buffer commands;  // host-visible, one region a frame in flight
  uint32_t capacity = 0, region = 0;
  std::vector<Batch> batches;
  uint32_t draws = 0;
  bool has(DrawClass draw_class) const;
};

class SceneTables {
 public:
  SceneTables(gpu::Device& device, const scene::Scene& scene);
  ~SceneTables();
  SceneTables(const SceneTables&) = delete;
  SceneTables& operator=(const SceneTables&) = delete;

  // Culls against the frustum, sorts (batch, then front to back from `eye`; blended surfaces back to front) and writes
  // the indirect commands of this frame. Or takes instances that were culled before.
  void build_draws(DrawList& list, const scene::Frustum& frustum, glm::vec3 eye, Blending blending) const;
  void build_draws(DrawList& list, std::span<const uint32_t> instances, glm::vec3 eye, Blending blending) const;
  void destroy_list(DrawList& list) const;

  // Copies what an update of the scene has changed; at most once a frame.
  void update(const scene::Changes& changes);
  // Number of the last update that changed an instance's place or shape; 0: none has.
  uint32_t changed_at(uint32_t instance) const { return changed_at_[instance]; }
  // Whether it has kept both for long enough to be expected to go on so.
  bool rests(uint32_t instance) const {
    return changed_at_[instance] == 0 || updates_ - changed_at_[instance] >= updates_to_rest;
  }
  const scene::Scene& scene() const { return scene_; }

  // Records the batches of one class. Without materials only positions are bound (depth of opaque surfaces).
  void draw(const DrawList& list, DrawClass draw_class, bool with_materials, const graph::Recorder& recorder,
            Sides sides = Sides::AsMaterial) const;

  bool any_blended() const;  // a material with alphaMode BLEND
  VkDescriptorSetLayout material_set_layout() const { return set_layout_; }
  const gpu::Buffer& positions() const { return streams_[0]; }
  const gpu::Buffer& normals() const { return streams_[1]; }
  const gpu::Buffer& tangents() const { return streams_[2]; }
  const DeformTables& deform() const { return deform_; }
  const gpu::Buffer& instances() const { return instances_.current(); }
  const gpu::Buffer& materials() const { return materials_; }
  const gpu::Buffer& reflectance() const { return reflectance_; }  // environment.h
  // All streams in the order of the shaders' locations: position, normal, tangent, uv0, color, uv1.
  static std::span<const gpu::VertexStream> streams();

 private:
  static constexpr uint32_t updates_to_rest = 16;
  struct ArraySlot {
    uint32_t array, layer;
  };
  void upload_geometry();
  void upload_textures();
  void upload_materials();
  void upload_instances();
  VkSampler sampler_for(const scene::Sampler& sampler);
  uint32_t texture_set_for(const scene::Material& material);

  gpu::Device& device_;
  const scene::Scene& scene_;
  std::array<gpu::Buffer, 6> streams_;
  gpu::Buffer indices_, materials_, reflectance_;
  DeformTables deform_;
  HostTable instances_;
  std::vector<uint32_t> changed_at_;  // by instance
  uint32_t updates_ = 0;
  std::vector<gpu::Image> arrays_;        // row 0: one white texel, for materials without a texture
  std::vector<ArraySlot> picture_slots_;  // by scene picture
  std::vector<std::pair<scene::Sampler, VkSampler>> samplers_;
  std::vector<std::array<std::pair<uint32_t, VkSampler>, material_textures>> set_keys_;
  std::vector<VkDescriptorSet> sets_;
  std::vector<uint32_t> material_sets_;  // by material
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
};

}  // namespace nf::passes
