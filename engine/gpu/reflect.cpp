// Reflection of SPIR-V with spirv-cross: the slots of set 0 by name, fragment outputs, workgroup size.
#include <algorithm>
#include <spirv_cross/spirv_cross.hpp>

#include "gpu/shader.h"

namespace nf::gpu {
namespace {

VkFormat format_of(spv::ImageFormat format) {
  switch (format) {
    case spv::ImageFormatR32f:
      return VK_FORMAT_R32_SFLOAT;
    case spv::ImageFormatR32ui:
      return VK_FORMAT_R32_UINT;
    case spv::ImageFormatRgba32f:
      return VK_FORMAT_R32G32B32A32_SFLOAT;
    case spv::ImageFormatRgba16f:
      return VK_FORMAT_R16G16B16A16_SFLOAT;
    case spv::ImageFormatRg16f:
      return VK_FORMAT_R16G16_SFLOAT;
    case spv::ImageFormatRg32f:
      return VK_FORMAT_R32G32_SFLOAT;
    case spv::ImageFormatR16f:
      return VK_FORMAT_R16_SFLOAT;
    case spv::ImageFormatRgba8:
      return VK_FORMAT_R8G8B8A8_UNORM;
    case spv::ImageFormatR8:
      return VK_FORMAT_R8_UNORM;
    case spv::ImageFormatRgb10A2:
      return VK_FORMAT_A2B10G10R10_UNORM_PACK32;
    case spv::ImageFormatR11fG11fB10f:
      return VK_FORMAT_B10G11R11_UFLOAT_PACK32;
    default:
      return VK_FORMAT_UNDEFINED;
  }
}

// The name a slot goes by: of blocks the instance's where there is one, else the block's.
std::string slot_name(const spirv_cross::Compiler& compiler, const spirv_cross::Resource& resource, bool block) {
  const std::string& instance = compiler.get_name(resource.id);
  return block && !instance.empty() ? instance : resource.name;
}

class Reflector {
 public:
  explicit Reflector(ShaderInterface& out) : out_(out) {}

  void add(const CompiledStage& stage) {
    const spirv_cross::Compiler compiler(stage.spirv);
    // Only what the code really uses has a binding; a slot that is declared and not used does not exist.
    const auto resources = compiler.get_shader_resources(compiler.get_active_interface_variables());
    add_all(compiler, resources.uniform_buffers, SlotKind::UniformBlock);
    add_all(compiler, resources.storage_buffers, SlotKind::StorageBuffer);
    add_all(compiler, resources.storage_images, SlotKind::StorageImage);
    add_all(compiler, resources.separate_images, SlotKind::SampledImage);
    add_all(compiler, resources.separate_samplers, SlotKind::Sampler);
    add_all(compiler, resources.sampled_images, SlotKind::CombinedImage);
    if (stage.stage == VK_SHADER_STAGE_FRAGMENT_BIT)
      for (const auto& output : resources.stage_outputs) {
        const uint32_t location = compiler.get_decoration(output.id, spv::DecorationLocation);
        if (out_.color_outputs.size() <= location) out_.color_outputs.resize(location + 1);
        out_.color_outputs[location] = output.name;
      }
    if (stage.stage == VK_SHADER_STAGE_VERTEX_BIT)
      for (const auto& input : resources.stage_inputs)
        out_.vertex_inputs =
            std::max(out_.vertex_inputs, compiler.get_decoration(input.id, spv::DecorationLocation) + 1);
    if (stage.stage == VK_SHADER_STAGE_COMPUTE_BIT)
      for (uint32_t i = 0; i < 3; ++i)
        out_.local_size[i] = compiler.get_execution_mode_argument(spv::ExecutionModeLocalSize, i);
  }

 private:
  void add_all(const spirv_cross::Compiler& compiler, const spirv_cross::SmallVector<spirv_cross::Resource>& resources,
               SlotKind kind) {
    for (const auto& resource : resources) {
      if (compiler.get_decoration(resource.id, spv::DecorationDescriptorSet) != 0) continue;  // set 1 is the materials'
      Slot slot{
          .name = slot_name(compiler, resource, kind == SlotKind::UniformBlock || kind == SlotKind::StorageBuffer),
          .kind = kind,
          .binding = compiler.get_decoration(resource.id, spv::DecorationBinding)};
      const auto& type = compiler.get_type(resource.base_type_id);
      if (type.basetype == spirv_cross::SPIRType::Image || type.basetype == spirv_cross::SPIRType::SampledImage)
        slot.shape = type.image.dim == spv::DimCube ? SlotShape::Cube
                     : type.image.arrayed           ? SlotShape::Array
                                                    : SlotShape::Flat;
      if (kind == SlotKind::UniformBlock) {
        slot.block_size = uint32_t(compiler.get_declared_struct_size(type));
        for (uint32_t i = 0; i < type.member_types.size(); ++i)
          slot.members.emplace_back(compiler.get_member_name(type.self, i),
                                    compiler.type_struct_member_offset(type, i));
      } else if (kind == SlotKind::StorageImage) {
        slot.format = format_of(type.image.format);
        slot.readonly = compiler.has_decoration(resource.id, spv::DecorationNonWritable);
        slot.writeonly = compiler.has_decoration(resource.id, spv::DecorationNonReadable);
      } else if (kind == SlotKind::StorageBuffer) {
        const auto flags = compiler.get_buffer_block_flags(resource.id);
        slot.readonly = flags.get(spv::DecorationNonWritable);
        slot.writeonly = flags.get(spv::DecorationNonReadable);
      }
      const auto same =
          std::find_if(out_.slots.begin(), out_.slots.end(), [&](const Slot& s) { return s.name == slot.name; });
      if (same == out_.slots.end())
        out_.slots.push_back(std::move(slot));
      else if (same->binding != slot.binding || same->kind != slot.kind)
        fail(Exit::Shader, "the slot '{}' is of one kind in one stage and of another in the next", slot.name);
    }
  }
  ShaderInterface& out_;
};

}  // namespace

void assign_bindings(std::vector<CompiledStage>& stages) {
  std::vector<std::string> names;
  for (CompiledStage& stage : stages) {
    const spirv_cross::Compiler compiler(stage.spirv);
    const auto resources = compiler.get_shader_resources(compiler.get_active_interface_variables());
    const auto assign = [&](const auto& list, bool block) {
      for (const spirv_cross::Resource& resource : list) {
        if (compiler.get_decoration(resource.id, spv::DecorationDescriptorSet) != 0) continue;
        const std::string name = slot_name(compiler, resource, block);
        auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) found = names.insert(names.end(), name);
        uint32_t offset = 0;
        const bool decorated = compiler.get_binary_offset_for_decoration(resource.id, spv::DecorationBinding, offset);
        NF_CHECK(decorated, "slot {} has no binding", name);
        stage.spirv[offset] = uint32_t(found - names.begin());
      }
    };
    assign(resources.uniform_buffers, true);
    assign(resources.storage_buffers, true);
    assign(resources.storage_images, false);
    assign(resources.separate_images, false);
    assign(resources.separate_samplers, false);
    assign(resources.sampled_images, false);
  }
}

const Slot* ShaderInterface::find(std::string_view name) const {
  for (const Slot& slot : slots)
    if (slot.name == name) return &slot;
  return nullptr;
}

ShaderInterface reflect(const std::vector<CompiledStage>& stages) {
  ShaderInterface result;
  Reflector reflector(result);
  for (const CompiledStage& stage : stages) reflector.add(stage);
  std::sort(result.slots.begin(), result.slots.end(),
            [](const Slot& a, const Slot& b) { return a.binding < b.binding; });
  return result;
}

}  // namespace nf::gpu
