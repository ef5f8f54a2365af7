// Upload of the scene and building of draw lists.
#include "scene_tables.h"

#include <algorithm>
#include <cstring>
#include <map>

#include "core/log.h"
#include "environment.h"
#include "gpu/frame_ring.h"
#include "mips.h"

namespace nf::passes {
namespace {

// Rows as shaders/common/scene.glsl declares them (scalar layout).
struct InstanceRow {
  glm::mat4 world, previous_world;
  uint32_t material;
  float mirrored;  // -1 where the transform mirrors, else 1
  uint32_t first_vertex, deformed;
};
struct MaterialRow {
  glm::vec4 base_color;
  glm::vec3 emissive;
  float metallic, roughness, normal_scale, alpha_cutoff;
  uint32_t blended;
  int32_t layers[material_textures];  // -1 = no texture
  float occlusion_strength, ior_f0, specular;
  glm::vec3 specular_color;
  uint32_t unlit, uv_sets;
  glm::mat2 uv_linear[material_textures];
  glm::vec2 uv_offset[material_textures];
};

VkSamplerAddressMode address(scene::Wrap wrap) {
  return wrap == scene::Wrap::Repeat   ? VK_SAMPLER_ADDRESS_MODE_REPEAT
         : wrap == scene::Wrap::Mirror ? VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT
                                       : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
}
VkFilter filter(scene::Filter f) {
  return f == scene::Filter::Linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
}

// In the order of the shaders' bindings and of scene::Slot.
std::array<uint32_t, material_textures> textures_of(const scene::Material& m) {
  return {m.base_color_texture, m.metallic_roughness_texture, m.normal_texture,        m.emissive_texture,
          m.occlusion_texture,  m.specular_texture,           m.specular_color_texture};
}

bool is_mapped(const scene::Material& m) {
  const auto textures = textures_of(m);
  for (size_t i = 0; i < textures.size(); ++i)
    if (textures[i] != scene::none && m.mapping[i] != scene::UvMapping{}) return true;
  return false;
}

}  // namespace

DrawClass draw_class_of(const scene::Material& m, Blending blending) {
  if (m.alpha == scene::AlphaMode::Blend && blending == Blending::Over) return DrawClass::Blended;
  if (is_mapped(m)) return DrawClass::Mapped;
  return m.alpha == scene::AlphaMode::Opaque ? DrawClass::Opaque : DrawClass::Masked;
}

bool DrawList::has(DrawClass draw_class) const {
  return std::any_of(batches.begin(), batches.end(), [&](const Batch& b) { return b.draw_class == draw_class; });
}

bool SceneTables::any_blended() const {
  return std::any_of(scene_.materials.begin(), scene_.materials.end(),
                     [](const scene::Material& m) { return m.alpha == scene::AlphaMode::Blend; });
}

std::span<const gpu::VertexStream> SceneTables::streams() {
  static const gpu::VertexStream all[] = {{VK_FORMAT_R32G32B32_SFLOAT, 12},    {VK_FORMAT_R32G32B32_SFLOAT, 12},
                                          {VK_FORMAT_R32G32B32A32_SFLOAT, 16}, {VK_FORMAT_R32G32_SFLOAT, 8},
                                          {VK_FORMAT_R32G32B32A32_SFLOAT, 16}, {VK_FORMAT_R32G32_SFLOAT, 8}};
  return all;
}

SceneTables::SceneTables(gpu::Device& device, const scene::Scene& scene)
    : device_(device), scene_(scene), deform_(device, scene) {
  upload_geometry();
  upload_textures();
  upload_materials();
  upload_instances();
}

SceneTables::~SceneTables() {
  device_.wait_idle();
  for (gpu::Buffer& stream : streams_) destroy(device_, stream);
  for (gpu::Buffer* buffer : {&indices_, &materials_, &reflectance_}) destroy(device_, *buffer);
  instances_.destroy(device_);
  for (gpu::Image& image : arrays_) destroy(device_, image);
  for (const auto& [key, sampler] : samplers_) vkDestroySampler(device_.handle, sampler, nullptr);
  vkDestroyDescriptorPool(device_.handle, pool_, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle, set_layout_, nullptr);
}

void SceneTables::upload_geometry() {
  const scene::Geometry& g = scene_.geometry;
  constexpr VkBufferUsageFlags vertex = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  streams_ = {gpu::upload_table(device_, g.position, vertex, "scene.position"),
              gpu::upload_table(device_, g.normal, vertex, "scene.normal"),
              gpu::upload_table(device_, g.tangent, vertex, "scene.tangent"),
              gpu::upload_table(device_, g.uv0, vertex, "scene.uv0"),
              gpu::upload_table(device_, g.color, vertex, "scene.color"),
              gpu::upload_table(device_, g.uv1, vertex, "scene.uv1")};
  indices_ = gpu::upload_table(device_, g.index, VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "scene.indices");
}

void SceneTables::upload_textures() {
  const std::array<std::byte, 4> white = {std::byte{255}, std::byte{255}, std::byte{255}, std::byte{255}};
  const gpu::ImagePart white_part{0, 0, white};
  arrays_.push_back(gpu::upload_image(device_, {.format = VK_FORMAT_R8G8B8A8_UNORM}, {&white_part, 1}, "scene.white",
                                      gpu::WholeView::Array));

  // Pictures of one size and encoding share an array, split where the device's layer limit asks for it.
  std::map<std::tuple<uint32_t, uint32_t, bool>, std::vector<uint32_t>> classes;
  for (uint32_t i = 0; i < scene_.pictures.size(); ++i)
    classes[{scene_.pictures[i].width, scene_.pictures[i].height, scene_.pictures[i].srgb}].push_back(i);
  picture_slots_.resize(scene_.pictures.size());
  for (const auto& [key, members] : classes) {
    const auto& [width, height, srgb] = key;
    for (size_t first = 0; first < members.size(); first += device_.facts.max_image_layers) {
      const size_t count = std::min<size_t>(device_.facts.max_image_layers, members.size() - first);
      const std::span<const uint32_t> rows = std::span(members).subspan(first, count);
      const std::vector<MipChain> chains = make_mips(scene_.pictures, rows);
      std::vector<gpu::ImagePart> parts;
      for (uint32_t layer = 0; layer < count; ++layer) {
        picture_slots_[rows[layer]] = {uint32_t(arrays_.size()), layer};
        for (uint32_t mip = 0; mip < chains[layer].size(); ++mip)
          parts.push_back({mip, layer, std::as_bytes(std::span(chains[layer][mip]))});
      }
      const gpu::ImageInfo info{.extent = {width, height},
                                .format = srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM,
                                .mips = uint32_t(chains[0].size()),
                                .layers = uint32_t(count)};
      arrays_.push_back(gpu::upload_image(device_, info, parts, fmt::format("scene.textures {}x{}", width, height),
                                          gpu::WholeView::Array));
    }
  }
}

VkSampler SceneTables::sampler_for(const scene::Sampler& wanted) {
  for (const auto& [key, sampler] : samplers_)
    if (key == wanted) return sampler;
  VkSamplerCreateInfo create{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                             .magFilter = filter(wanted.mag),
                             .minFilter = filter(wanted.min),
                             .mipmapMode = wanted.mip == scene::Filter::Linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR
                                                                               : VK_SAMPLER_MIPMAP_MODE_NEAREST,
                             .addressModeU = address(wanted.u),
                             .addressModeV = address(wanted.v),
                             .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                             .maxLod = wanted.mips ? VK_LOD_CLAMP_NONE : 0.25f};
  VkSampler sampler = VK_NULL_HANDLE;
  NF_VK(vkCreateSampler(device_.handle, &create, nullptr, &sampler));
  samplers_.emplace_back(wanted, sampler);
  return sampler;
}

uint32_t SceneTables::texture_set_for(const scene::Material& material) {
  std::array<std::pair<uint32_t, VkSampler>, material_textures> key;
  const auto textures = textures_of(material);
  for (size_t i = 0; i < key.size(); ++i) {
    if (textures[i] == scene::none) {
      key[i] = {0u, sampler_for({})};
    } else {
      const scene::Texture& texture = scene_.textures[textures[i]];
      key[i] = {picture_slots_[texture.picture].array, sampler_for(texture.sampler)};
    }
  }
  const auto found = std::find(set_keys_.begin(), set_keys_.end(), key);
  if (found != set_keys_.end()) return uint32_t(found - set_keys_.begin());
  set_keys_.push_back(key);
  return uint32_t(set_keys_.size() - 1);
}

void SceneTables::upload_materials() {
  std::vector<MaterialRow> rows;
  for (const scene::Material& m : scene_.materials) {
    material_sets_.push_back(texture_set_for(m));
    const float reflected = (m.ior - 1) / (m.ior + 1);
    const float cutoff = m.alpha == scene::AlphaMode::Mask    ? m.alpha_cutoff
                         : m.alpha == scene::AlphaMode::Blend ? 0.5f
                                                              : 0.0f;
    MaterialRow row{.base_color = m.base_color,
                    .emissive = m.emissive,
                    .metallic = m.metallic,
                    .roughness = m.roughness,
                    .normal_scale = m.normal_scale,
                    .alpha_cutoff = cutoff,
                    .blended = m.alpha == scene::AlphaMode::Blend,
                    .layers = {},
                    .occlusion_strength = m.occlusion_strength,
                    .ior_f0 = reflected * reflected,
                    .specular = m.specular,
                    .specular_color = m.specular_color,
                    .unlit = m.unlit,
                    .uv_sets = 0,
                    .uv_linear = {},
                    .uv_offset = {}};
    const auto textures = textures_of(m);
    for (size_t i = 0; i < textures.size(); ++i) {
      row.layers[i] =
          textures[i] == scene::none ? -1 : int32_t(picture_slots_[scene_.textures[textures[i]].picture].layer);
      row.uv_sets |= m.mapping[i].set << i;
      row.uv_linear[i] = m.mapping[i].linear;
      row.uv_offset[i] = m.mapping[i].offset;
    }
    rows.push_back(row);
  }
  materials_ = gpu::upload_table(device_, rows, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "scene.materials");

  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (uint32_t i = 0; i < material_textures; ++i)
    bindings.push_back({.binding = i,
                        .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                        .descriptorCount = 1,
                        .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT});
  VkDescriptorSetLayoutCreateInfo layout{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                         .bindingCount = material_textures,
                                         .pBindings = bindings.data()};
  NF_VK(vkCreateDescriptorSetLayout(device_.handle, &layout, nullptr, &set_layout_));
  const uint32_t count = std::max<uint32_t>(uint32_t(set_keys_.size()), 1);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count * material_textures};
  VkDescriptorPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                  .maxSets = count,
                                  .poolSizeCount = 1,
                                  .pPoolSizes = &size};
  NF_VK(vkCreateDescriptorPool(device_.handle, &pool, nullptr, &pool_));
  for (const auto& key : set_keys_) {
    VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .descriptorPool = pool_,
                                         .descriptorSetCount = 1,
                                         .pSetLayouts = &set_layout_};
    VkDescriptorSet set = VK_NULL_HANDLE;
    NF_VK(vkAllocateDescriptorSets(device_.handle, &allocate, &set));
    VkDescriptorImageInfo infos[material_textures];
    VkWriteDescriptorSet writes[material_textures];
    for (uint32_t i = 0; i < material_textures; ++i) {
      infos[i] = {key[i].second, arrays_[key[i].first].view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
      writes[i] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                   .dstSet = set,
                   .dstBinding = i,
                   .descriptorCount = 1,
                   .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                   .pImageInfo = &infos[i]};
    }
    vkUpdateDescriptorSets(device_.handle, material_textures, writes, 0, nullptr);
    sets_.push_back(set);
  }
}

namespace {

InstanceRow instance_row(const scene::Scene& scene, const DeformTables& deform, uint32_t i) {
  const uint32_t node = scene.instances.node[i];
  const scene::Primitive& p = scene.primitives[scene.instances.primitive[i]];
  return {scene.nodes.world[node],
          scene.nodes.previous_world[node],
          p.material,
          scene.instances.mirrored[i] ? -1.0f : 1.0f,
          p.vertex_offset,
          deform.first_row()[i]};
}

}  // namespace

void SceneTables::upload_instances() {
  changed_at_.assign(scene_.instances.size(), 0);
  instances_.create<InstanceRow>(
      device_, scene_.instances.size(), [&](uint32_t i) { return instance_row(scene_, deform_, i); },
      "scene.instances");
  reflectance_ =
      gpu::upload_table(device_, reflectance_table(), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "lighting.reflectance");
}

void SceneTables::update(const scene::Changes& changes) {
  ++updates_;
  for (const scene::RowRange& range : changes.instances)
    std::fill_n(changed_at_.begin() + range.first, range.count, updates_);
  deform_.update(changes);
  instances_.update<InstanceRow>(changes.instances, [&](uint32_t i) { return instance_row(scene_, deform_, i); });
}

void SceneTables::build_draws(DrawList& list, const scene::Frustum& frustum, glm::vec3 eye, Blending blending) const {
  std::vector<uint32_t> visible;
  scene::cull(frustum, scene_.instances.center, scene_.instances.extent, visible);
  build_draws(list, visible, eye, blending);
}

void SceneTables::build_draws(DrawList& list, std::span<const uint32_t> visible, glm::vec3 eye,
                              Blending blending) const {
  const scene::Instances& instances = scene_.instances;
  struct Keyed {
    uint64_t key;
    uint32_t instance;
  };
  std::vector<Keyed> keyed;
  keyed.reserve(visible.size());
  for (const uint32_t i : visible) {
    const uint32_t material = scene_.primitives[instances.primitive[i]].material;
    const scene::Material& m = scene_.materials[material];
    const glm::vec3 to = instances.center[i] - eye;
    uint32_t distance_bits;
    const float distance = glm::dot(to, to);
    std::memcpy(&distance_bits, &distance, sizeof distance_bits);  // positive floats order as their bits
    const DrawClass draw_class = draw_class_of(m, blending);
    uint64_t batch = uint64_t(draw_class) << 30;
    if (draw_class == DrawClass::Blended)
      distance_bits = ~distance_bits;
    else
      batch |= uint64_t(material_sets_[material]) << 2 | uint64_t(m.double_sided) << 1 |
               uint64_t(instances.mirrored[i] != 0);
    keyed.push_back({batch << 32 | distance_bits, i});
  }
  std::sort(keyed.begin(), keyed.end(),
            [](const Keyed& a, const Keyed& b) { return a.key != b.key ? a.key < b.key : a.instance < b.instance; });

  const uint32_t capacity = std::max<uint32_t>(uint32_t(instances.size()), 1);
  if (list.capacity < capacity) {
    device_.wait_idle();
    destroy(device_, list.commands);
    list.commands = gpu::create_buffer(
        device_, VkDeviceSize(capacity) * gpu::FrameRing::table_sides * sizeof(VkDrawIndexedIndirectCommand),
        VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, gpu::Where::Host, "scene.draws");
    list.capacity = capacity;
  }
  list.region = (list.region + 1) % gpu::FrameRing::table_sides;
  list.batches.clear();
  list.draws = uint32_t(keyed.size());
  const uint32_t base = list.region * list.capacity;
  auto* commands = reinterpret_cast<VkDrawIndexedIndirectCommand*>(list.commands.mapped) + base;
  for (uint32_t n = 0; n < keyed.size(); ++n) {
    const uint32_t i = keyed[n].instance;
    const scene::Primitive& p = scene_.primitives[instances.primitive[i]];
    commands[n] = {.indexCount = p.index_count,
                   .instanceCount = 1,
                   .firstIndex = p.first_index,
                   .vertexOffset = int32_t(p.vertex_offset),
                   .firstInstance = i};
    const scene::Material& m = scene_.materials[p.material];
    const Batch batch{draw_class_of(m, blending), m.double_sided, instances.mirrored[i] != 0,
                      material_sets_[p.material], base + n,       0};
    if (n == 0 || !batch.same_state(list.batches.back())) list.batches.push_back(batch);
    ++list.batches.back().draw_count;
  }
}

void SceneTables::destroy_list(DrawList& list) const {
  destroy(device_, list.commands);
  list = {};
}

void SceneTables::draw(const DrawList& list, DrawClass draw_class, bool with_materials, const graph::Recorder& recorder,
                       Sides sides) const {
  std::array<VkBuffer, 6> buffers;
  for (size_t i = 0; i < buffers.size(); ++i) buffers[i] = streams_[i].handle;
  recorder.bind_vertex_streams(std::span(buffers).first(with_materials ? 6 : 1));
  recorder.bind_indices(indices_.handle);
  for (const Batch& batch : list.batches) {
    if (batch.draw_class != draw_class) continue;
    if (with_materials) recorder.bind_set1(sets_[batch.texture_set]);
    recorder.set_cull(batch.double_sided || sides == Sides::Both ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT,
                      batch.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
    recorder.draw_indexed_indirect(
        list.commands.handle, VkDeviceSize(batch.first_draw) * sizeof(VkDrawIndexedIndirectCommand), batch.draw_count);
  }
}

}  // namespace nf::passes
