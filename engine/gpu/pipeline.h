// Pipelines by handle: compiled on first use, kept with their shader interface, cached on disk by the driver's own
// format.
#pragma once

#include <deque>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/handle.h"
#include "gpu/device.h"
#include "gpu/reload.h"
#include "gpu/shader.h"

namespace nf::gpu {

struct PipelineTag;
using PipelineId = Handle<PipelineTag>;

// What a pass holds: the handle, and the interface the graph matches its uses with.
struct Pipeline {
  PipelineId id;
  const ShaderInterface* interface = nullptr;
};

// One vertex attribute, in a buffer of its own: binding = location.
struct VertexStream {
  VkFormat format;
  uint32_t stride;
};

// Cull mode and front face are dynamic. Depth is reverse-Z: greater is nearer.
struct RasterState {
  std::vector<VertexStream> streams;
  bool depth_test = false, depth_write = false;
  VkCompareOp depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  float depth_bias = 0, depth_bias_slope = 0;
  bool over = false;                            // colours are premultiplied and go over what is there
  VkDescriptorSetLayout set1 = VK_NULL_HANDLE;  // a static set beside the pushed one (materials)
};

class Pipelines {
 public:
  // `cache` may be empty: nothing is kept on disk.
  Pipelines(Device& device, ShaderCompiler compiler, std::filesystem::path cache);
  ~Pipelines();
  Pipelines(const Pipelines&) = delete;
  Pipelines& operator=(const Pipelines&) = delete;

  // The same files, defines and state give the same handle. Throw nf::Error (Exit::Shader).
  Pipeline compute(const std::string& file, const Defines& defines = {});
  Pipeline fullscreen(const std::string& fragment_file, const Defines& defines = {});
  Pipeline raster(const std::string& vertex_file, const std::string& fragment_file, const Defines& defines,
                  const RasterState& state);

  // To add tables to before their shaders are compiled.
  ShaderCompiler& compiler() { return compiler_; }

  // Compiles anew every program that reads one of these files (relative to the shader folder; none: every program), and
  // those that failed last time. Handles and the addresses of interfaces stay good; a program that fails goes on as it
  // was. Waits for the device. Graphs built before must not run after: their uses follow the old interfaces. A slot
  // that a program no longer has stays in its interface, as `unused`: so that a line can be commented out.
  Reload reload(std::span<const std::string> changed = {});

  struct Bound {
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipelineBindPoint point = VK_PIPELINE_BIND_POINT_COMPUTE;
  };
  // Created on first use for these attachment formats (empty for compute).
  Bound get(PipelineId id, std::span<const VkFormat> colors = {}, VkFormat depth = VK_FORMAT_UNDEFINED);

  // Fixed samplers, fed to shader slots of these names: linear_clamp, linear_repeat, nearest_clamp, shadow_compare.
  VkSampler sampler(std::string_view name) const;

 private:
  struct Variant {
    std::vector<VkFormat> colors;
    VkFormat depth;
    VkPipeline pipeline;
  };
  struct Row {
    std::vector<std::string> files;
    Defines defines;
    RasterState state;
    CompiledProgram program;
    VkDescriptorSetLayout set0 = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::vector<Variant> variants;
    bool broken = false;  // its last reload failed
  };
  Row build(std::vector<std::string> files, const Defines& defines, const RasterState& state,
            const ShaderInterface* before) const;
  void check_limits(const Row& row) const;
  void replace(Row& row);
  void destroy(Row& row);
  Pipeline add(std::vector<std::string> files, const Defines& defines, const RasterState& state);
  VkPipeline create(Row& row, std::span<const VkFormat> colors, VkFormat depth);

  Device& device_;
  ShaderCompiler compiler_;
  std::filesystem::path cache_file_;
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  std::deque<Row> rows_;  // a deque: interfaces are pointed to
  std::vector<std::pair<std::string, VkSampler>> samplers_;
};

}  // namespace nf::gpu
