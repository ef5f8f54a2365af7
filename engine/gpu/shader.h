// Run-time GLSL to SPIR-V: includes, generated parameter blocks, #define variants, a cache on disk, and reflection.
// Shaders give no binding numbers: they are assigned here and found again by name.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/params.h"
#include "gpu/vulkan.h"

namespace nf::gpu {

using Defines = std::vector<std::pair<std::string, std::string>>;

enum class SlotKind : uint8_t { UniformBlock, StorageBuffer, StorageImage, SampledImage, Sampler, CombinedImage };

// Of images: one layer, several, or the six of a cube.
enum class SlotShape : uint8_t { Flat, Array, Cube };

// One descriptor of set 0 as the shader declares it. A uniform block's name is its instance's ("vbgi").
struct Slot {
  std::string name;
  SlotKind kind = SlotKind::UniformBlock;
  uint32_t binding = 0;
  SlotShape shape = SlotShape::Flat;
  bool readonly = false, writeonly = false;               // storage images and buffers
  VkFormat format = VK_FORMAT_UNDEFINED;                  // storage images that name one
  uint32_t block_size = 0;                                // uniform blocks: bytes
  std::vector<std::pair<std::string, uint32_t>> members;  // uniform blocks: name, byte offset
  bool unused = false;                                    // a reload took it away: it may be fed, and need not be
  bool operator==(const Slot&) const = default;
};

// What a pipeline's shaders expect: the graph matches it with a pass's uses by name.
struct ShaderInterface {
  std::vector<Slot> slots;                 // set 0, all stages
  std::vector<std::string> color_outputs;  // fragment outputs by location
  uint32_t local_size[3] = {1, 1, 1};
  uint32_t vertex_inputs = 0;  // locations 0 to this - 1
  uint32_t generation = 0;     // another one after a reload that changed the interface in place
  uint32_t revision = 0;       // another one after every reload of the program: what it drew before may be out of date
  bool operator==(const ShaderInterface&) const = default;
  const Slot* find(std::string_view name) const;
};

struct CompiledStage {
  VkShaderStageFlagBits stage;
  std::vector<uint32_t> spirv;
};

struct CompiledProgram {
  std::vector<CompiledStage> stages;
  ShaderInterface interface;
  std::vector<std::string> dependencies;  // files read, relative to the shader folder
  bool from_cache = false;
};

// Compiles programs of one shader folder. `cache` may be empty (no cache); `shipped` is a folder with such entries that
// is only read.
class ShaderCompiler {
 public:
  ShaderCompiler(std::filesystem::path folder, std::filesystem::path cache, std::filesystem::path shipped = {});
  // `#include "params/<prefix>"` yields the table's uniform block.
  void add_table(const ParamTable& table);
  // Defines given to every shader (device facts).
  void add_define(std::string name, std::string value);
  // One file a stage; the stage is told by the extension: .comp .vert .frag. Throws nf::Error (Exit::Shader) with
  // "file:line: message" lines.
  CompiledProgram compile(const std::vector<std::string>& files, const Defines& defines) const;
  const std::filesystem::path& folder() const { return folder_; }
  // Of a file of the folder or a generated block; empty when there is none.
  std::string text_of(const std::string& file) const;

 private:
  std::filesystem::path folder_, cache_, shipped_;
  std::map<std::string, std::string> generated_;  // "params/vbgi" -> text
  Defines defines_;
};

// The folder with the GLSL files: NEARFIELD_DATA_DIR/shaders, beside the binary (build tree: the source's), or
// installed.
std::filesystem::path find_shader_folder();
// What an installation brings precompiled, beside its shaders (editor/precompile.cmake); need not exist.
std::filesystem::path shipped_spirv();
// $XDG_CACHE_HOME/nearfield or ~/.cache/nearfield; empty when neither can be made.
std::filesystem::path cache_folder();

// Gives the slots of set 0 binding numbers by name, the same in all stages (glslang numbers each stage for itself).
void assign_bindings(std::vector<CompiledStage>& stages);
ShaderInterface reflect(const std::vector<CompiledStage>& stages);

}  // namespace nf::gpu
