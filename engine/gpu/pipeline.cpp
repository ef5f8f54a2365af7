// Creation of pipelines, their layouts from reflection, and the driver's pipeline cache on disk.
#include "gpu/pipeline.h"

#include <algorithm>
#include <fstream>
#include <unistd.h>

#include "core/log.h"

namespace nf::gpu {
namespace {

VkDescriptorType descriptor_type(SlotKind kind) {
  switch (kind) {
    case SlotKind::UniformBlock:
      return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case SlotKind::StorageBuffer:
      return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case SlotKind::StorageImage:
      return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case SlotKind::SampledImage:
      return VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
    case SlotKind::Sampler:
      return VK_DESCRIPTOR_TYPE_SAMPLER;
    case SlotKind::CombinedImage:
      return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  }
  return VK_DESCRIPTOR_TYPE_MAX_ENUM;
}

VkSampler create_sampler(Device& device, VkFilter filter, VkSamplerAddressMode address, bool compare) {
  VkSamplerCreateInfo create{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                             .magFilter = filter,
                             .minFilter = filter,
                             .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                             .addressModeU = address,
                             .addressModeV = address,
                             .addressModeW = address,
                             .compareEnable = compare,
                             .compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL,
                             .maxLod = VK_LOD_CLAMP_NONE};
  VkSampler sampler = VK_NULL_HANDLE;
  NF_VK(vkCreateSampler(device.handle, &create, nullptr, &sampler));
  return sampler;
}

bool same(const RasterState& a, const RasterState& b) {
  return a.streams.size() == b.streams.size() && a.depth_test == b.depth_test && a.depth_write == b.depth_write &&
         a.depth_compare == b.depth_compare && a.depth_bias == b.depth_bias &&
         a.depth_bias_slope == b.depth_bias_slope && a.over == b.over && a.set1 == b.set1 &&
         std::equal(
             a.streams.begin(), a.streams.end(), b.streams.begin(),
             [](const VertexStream& x, const VertexStream& y) { return x.format == y.format && x.stride == y.stride; });
}

}  // namespace

Pipelines::Pipelines(Device& device, ShaderCompiler compiler, std::filesystem::path cache)
    : device_(device), compiler_(std::move(compiler)) {
  std::vector<char> old;
  if (!cache.empty()) {
    std::string id;
    for (const uint8_t byte : device.properties.pipelineCacheUUID) id += fmt::format("{:02x}", byte);
    cache_file_ =
        cache / fmt::format("pipelines-{:x}-{:x}-{}.bin", device.properties.vendorID, device.properties.deviceID, id);
    std::ifstream in(cache_file_, std::ios::binary);
    old.assign(std::istreambuf_iterator<char>(in), {});
  }
  // The driver checks the header and ignores a foreign or damaged cache.
  VkPipelineCacheCreateInfo create{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO, .initialDataSize = old.size(), .pInitialData = old.data()};
  if (vkCreatePipelineCache(device_.handle, &create, nullptr, &cache_) != VK_SUCCESS) {
    create.initialDataSize = 0;
    NF_VK(vkCreatePipelineCache(device_.handle, &create, nullptr, &cache_));
  }
  const auto clamp = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, repeat = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  samplers_ = {{"linear_clamp", create_sampler(device, VK_FILTER_LINEAR, clamp, false)},
               {"linear_repeat", create_sampler(device, VK_FILTER_LINEAR, repeat, false)},
               {"nearest_clamp", create_sampler(device, VK_FILTER_NEAREST, clamp, false)},
               {"shadow_compare", create_sampler(device, VK_FILTER_LINEAR, clamp, true)}};
}

Pipelines::~Pipelines() {
  if (!cache_file_.empty()) {
    size_t size = 0;
    vkGetPipelineCacheData(device_.handle, cache_, &size, nullptr);
    std::vector<char> data(size);
    if (vkGetPipelineCacheData(device_.handle, cache_, &size, data.data()) == VK_SUCCESS) {
      // Two of one process may do this at one time.
      const std::filesystem::path temporary =
          cache_file_.string() + fmt::format(".{}-{}", ::getpid(), static_cast<const void*>(this));
      std::ofstream out(temporary, std::ios::binary);
      out.write(data.data(), std::streamsize(size));
      out.close();
      std::error_code error;
      if (out)
        std::filesystem::rename(temporary, cache_file_, error);
      else
        std::filesystem::remove(temporary, error);
    }
  }
  for (Row& row : rows_) destroy(row);
  for (const auto& [name, sampler] : samplers_) vkDestroySampler(device_.handle, sampler, nullptr);
  vkDestroyPipelineCache(device_.handle, cache_, nullptr);
}

Pipeline Pipelines::compute(const std::string& file, const Defines& defines) {
  return add({file}, defines, {});
}

Pipeline Pipelines::fullscreen(const std::string& fragment_file, const Defines& defines) {
  return add({"common/fullscreen.vert", fragment_file}, defines, {});
}

Pipeline Pipelines::raster(const std::string& vertex_file, const std::string& fragment_file, const Defines& defines,
                           const RasterState& state) {
  return fragment_file.empty() ? add({vertex_file}, defines, state) : add({vertex_file, fragment_file}, defines, state);
}

Pipeline Pipelines::add(std::vector<std::string> files, const Defines& defines, const RasterState& state) {
  for (size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].files == files && rows_[i].defines == defines && same(rows_[i].state, state))
      return {PipelineId{uint16_t(i)}, &rows_[i].program.interface};
  rows_.push_back(build(std::move(files), defines, state, nullptr));
  return {PipelineId{uint16_t(rows_.size() - 1)}, &rows_.back().program.interface};
}

void Pipelines::destroy(Row& row) {
  for (const Variant& variant : row.variants) vkDestroyPipeline(device_.handle, variant.pipeline, nullptr);
  vkDestroyPipelineLayout(device_.handle, row.layout, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle, row.set0, nullptr);
}

// What compiles and still cannot run here: said before the driver sees it.
void Pipelines::check_limits(const Row& row) const {
  const ShaderInterface& interface = row.program.interface;
  const std::string& file = row.files.back();
  if (interface.slots.size() > device_.facts.max_push_descriptors)
    fail(Exit::Shader, "{}: {} slots, but {} takes {} push descriptors", file, interface.slots.size(),
         device_.info.name, device_.facts.max_push_descriptors);
  for (const Slot& slot : interface.slots)
    if (slot.kind == SlotKind::Sampler && !sampler(slot.name))
      fail(Exit::Shader,
           "{}: no sampler is named '{}'; there are linear_clamp, linear_repeat, nearest_clamp, "
           "shadow_compare",
           file, slot.name);
  if (interface.vertex_inputs > row.state.streams.size())
    fail(Exit::Shader, "{}: reads the vertex input of location {}, but its pass feeds {} streams", row.files.front(),
         interface.vertex_inputs - 1, row.state.streams.size());
  const VkPhysicalDeviceLimits& limits = device_.properties.limits;
  const uint32_t* local = interface.local_size;
  if (local[0] > limits.maxComputeWorkGroupSize[0] || local[1] > limits.maxComputeWorkGroupSize[1] ||
      local[2] > limits.maxComputeWorkGroupSize[2] ||
      uint64_t(local[0]) * local[1] * local[2] > limits.maxComputeWorkGroupInvocations)
    fail(Exit::Shader, "{}: a workgroup of {}x{}x{}, but {} takes {} invocations and {}x{}x{}", file, local[0],
         local[1], local[2], device_.info.name, limits.maxComputeWorkGroupInvocations,
         limits.maxComputeWorkGroupSize[0], limits.maxComputeWorkGroupSize[1], limits.maxComputeWorkGroupSize[2]);
}

// Slots of `before` that the program no longer has are kept as unused ones, behind its own.
Pipelines::Row Pipelines::build(std::vector<std::string> files, const Defines& defines, const RasterState& state,
                                const ShaderInterface* before) const {
  Row row{.files = std::move(files), .defines = defines, .state = state};
  row.program = compiler_.compile(row.files, defines);
  ShaderInterface& interface = row.program.interface;
  if (before)
    for (const Slot& slot : before->slots)
      if (!interface.find(slot.name) && interface.slots.size() < device_.facts.max_push_descriptors) {
        uint32_t binding = 0;
        for (const Slot& other : interface.slots) binding = std::max(binding, other.binding + 1);
        interface.slots.push_back(slot);
        interface.slots.back().binding = binding;
        interface.slots.back().unused = true;
      }
  check_limits(row);

  VkShaderStageFlags stages = 0;
  for (const CompiledStage& stage : row.program.stages) stages |= stage.stage;
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const Slot& slot : interface.slots)
    bindings.push_back({.binding = slot.binding,
                        .descriptorType = descriptor_type(slot.kind),
                        .descriptorCount = 1,
                        .stageFlags = stages});
  VkDescriptorSetLayoutCreateInfo set_create{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                             .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
                                             .bindingCount = uint32_t(bindings.size()),
                                             .pBindings = bindings.data()};
  NF_VK(vkCreateDescriptorSetLayout(device_.handle, &set_create, nullptr, &row.set0));
  const VkDescriptorSetLayout sets[] = {row.set0, state.set1};
  VkPipelineLayoutCreateInfo layout_create{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                           .setLayoutCount = state.set1 ? 2u : 1u,
                                           .pSetLayouts = sets};
  NF_VK(vkCreatePipelineLayout(device_.handle, &layout_create, nullptr, &row.layout));
  return row;
}

Pipelines::Bound Pipelines::get(PipelineId id, std::span<const VkFormat> colors, VkFormat depth) {
  Row& row = rows_[id.id];
  const auto point = row.program.stages.front().stage == VK_SHADER_STAGE_COMPUTE_BIT ? VK_PIPELINE_BIND_POINT_COMPUTE
                                                                                     : VK_PIPELINE_BIND_POINT_GRAPHICS;
  for (const Variant& variant : row.variants)
    if (variant.depth == depth &&
        std::equal(variant.colors.begin(), variant.colors.end(), colors.begin(), colors.end()))
      return {variant.pipeline, row.layout, point};
  const VkPipeline pipeline = create(row, colors, depth);
  row.variants.push_back({{colors.begin(), colors.end()}, depth, pipeline});
  return {pipeline, row.layout, point};
}

VkPipeline Pipelines::create(Row& row, std::span<const VkFormat> colors, VkFormat depth) {
  const Doing doing("creating the pipeline of " + row.files.back());
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  for (const CompiledStage& stage : row.program.stages) {
    VkShaderModuleCreateInfo create{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                    .codeSize = stage.spirv.size() * 4,
                                    .pCode = stage.spirv.data()};
    VkShaderModule module = VK_NULL_HANDLE;
    NF_VK(vkCreateShaderModule(device_.handle, &create, nullptr, &module));
    stages.push_back({.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                      .stage = stage.stage,
                      .module = module,
                      .pName = "main"});
  }
  VkPipeline pipeline = VK_NULL_HANDLE;
  VkResult result = VK_SUCCESS;
  if (stages[0].stage == VK_SHADER_STAGE_COMPUTE_BIT) {
    VkComputePipelineCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .stage = stages[0], .layout = row.layout};
    result = vkCreateComputePipelines(device_.handle, cache_, 1, &create, nullptr, &pipeline);
  } else {
    std::vector<VkVertexInputBindingDescription> bindings;
    std::vector<VkVertexInputAttributeDescription> attributes;
    for (uint32_t i = 0; i < row.state.streams.size(); ++i) {
      bindings.push_back(
          {.binding = i, .stride = row.state.streams[i].stride, .inputRate = VK_VERTEX_INPUT_RATE_VERTEX});
      attributes.push_back({.location = i, .binding = i, .format = row.state.streams[i].format, .offset = 0});
    }
    VkPipelineVertexInputStateCreateInfo vertex{.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
                                                .vertexBindingDescriptionCount = uint32_t(bindings.size()),
                                                .pVertexBindingDescriptions = bindings.data(),
                                                .vertexAttributeDescriptionCount = uint32_t(attributes.size()),
                                                .pVertexAttributeDescriptions = attributes.data()};
    VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const bool bias = row.state.depth_bias != 0 || row.state.depth_bias_slope != 0;
    VkPipelineRasterizationStateCreateInfo raster{.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                                                  .polygonMode = VK_POLYGON_MODE_FILL,
                                                  .depthBiasEnable = bias,
                                                  .depthBiasConstantFactor = row.state.depth_bias,
                                                  .depthBiasSlopeFactor = row.state.depth_bias_slope,
                                                  .lineWidth = 1};
    VkPipelineMultisampleStateCreateInfo samples{.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                 .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    VkPipelineDepthStencilStateCreateInfo depth_state{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = row.state.depth_test,
        .depthWriteEnable = row.state.depth_write,
        .depthCompareOp = row.state.depth_compare};
    const VkPipelineColorBlendAttachmentState blend_one{.blendEnable = row.state.over,
                                                        .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
                                                        .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                                        .colorBlendOp = VK_BLEND_OP_ADD,
                                                        .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                                        .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                                        .alphaBlendOp = VK_BLEND_OP_ADD,
                                                        .colorWriteMask = 0xf};
    const std::vector<VkPipelineColorBlendAttachmentState> blends(colors.size(), blend_one);
    VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                              .attachmentCount = uint32_t(blends.size()),
                                              .pAttachments = blends.data()};
    const VkDynamicState dynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR, VK_DYNAMIC_STATE_CULL_MODE,
                                      VK_DYNAMIC_STATE_FRONT_FACE};
    VkPipelineDynamicStateCreateInfo dynamics{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                              .dynamicStateCount = uint32_t(std::size(dynamic)),
                                              .pDynamicStates = dynamic};
    VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                            .colorAttachmentCount = uint32_t(colors.size()),
                                            .pColorAttachmentFormats = colors.data(),
                                            .depthAttachmentFormat = depth};
    VkGraphicsPipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                        .pNext = &rendering,
                                        .stageCount = uint32_t(stages.size()),
                                        .pStages = stages.data(),
                                        .pVertexInputState = &vertex,
                                        .pInputAssemblyState = &assembly,
                                        .pViewportState = &viewport,
                                        .pRasterizationState = &raster,
                                        .pMultisampleState = &samples,
                                        .pDepthStencilState = &depth_state,
                                        .pColorBlendState = &blend,
                                        .pDynamicState = &dynamics,
                                        .layout = row.layout};
    result = vkCreateGraphicsPipelines(device_.handle, cache_, 1, &create, nullptr, &pipeline);
  }
  for (const auto& stage : stages) vkDestroyShaderModule(device_.handle, stage.module, nullptr);
  if (result == VK_ERROR_INVALID_SHADER_NV || result == VK_ERROR_UNKNOWN)
    fail(Exit::Shader, "{}: {} does not take the shader ({})", row.files.back(), device_.info.name,
         result_name(result));
  check(result, "vkCreatePipelines", __FILE__, __LINE__);
  return pipeline;
}

VkSampler Pipelines::sampler(std::string_view name) const {
  for (const auto& [sampler_name, sampler] : samplers_)
    if (sampler_name == name) return sampler;
  return VK_NULL_HANDLE;
}

}  // namespace nf::gpu
