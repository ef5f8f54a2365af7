// Shaders: every parameter block in SPIR-V against its table, every shader of the engine compiles for both ways to
// fetch, the cache gives the same words.
#include <fstream>

#include "gpu_fixture.h"

namespace nf::test {
namespace {

std::vector<const ParamTable*> all_tables() {
  passes::FrameSettings settings;
  std::vector<const ParamTable*> tables = passes::inner_tables();
  for (const ParamBlock& block : settings.blocks()) tables.push_back(block.table);
  return tables;
}

// One shader a table, which uses every member, so that none is optimised away.
TEST(Shaders, ParameterBlocksHaveTheOffsetsOfTheirTables) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("nearfield-offsets-{}", getpid());
  std::filesystem::create_directories(folder);
  for (const ParamTable* table : all_tables()) {
    std::string uses;
    for (const Param& p : table->params) {
      const bool matrix = p.type == ParamType::Mat4;
      uses += fmt::format("  sum += float({}.{}{});\n", table->prefix, p.name,
                          matrix ? "[0][0]"
                          : p.type == ParamType::Vec2 || p.type == ParamType::Vec3 || p.type == ParamType::Vec4 ||
                                  p.type == ParamType::IVec2 || p.type == ParamType::UVec2
                              ? ".x"
                              : "");
    }
    std::ofstream(folder / "block.comp") << "#version 460\n#include \"params/" << table->prefix
                                         << "\"\nlayout(local_size_x = 8) in;\nuniform writeonly image2D target;\n"
                                         << "void main() {\n  float sum = 0.0;\n"
                                         << uses << "  imageStore(target, ivec2(0), vec4(sum));\n}\n";
    gpu::ShaderCompiler compiler(folder, {});
    compiler.add_table(*table);
    const gpu::CompiledProgram program = compiler.compile({"block.comp"}, {});
    const gpu::Slot* slot = program.interface.find(table->prefix);
    ASSERT_TRUE(slot) << table->prefix;
    EXPECT_EQ(slot->block_size, table->size) << table->prefix;
    ASSERT_EQ(slot->members.size(), table->params.size()) << table->prefix;
    for (size_t i = 0; i < table->params.size(); ++i) {
      EXPECT_EQ(slot->members[i].first, table->params[i].name);
      EXPECT_EQ(slot->members[i].second, table->params[i].offset) << table->prefix << "." << table->params[i].name;
    }
  }
  std::filesystem::remove_all(folder);
}

gpu::ShaderCompiler engine_compiler(bool storage, const std::filesystem::path& cache,
                                    const std::filesystem::path& shipped = {}) {
  gpu::ShaderCompiler compiler(std::filesystem::path(NF_SOURCE_DIR) / "shaders", cache, shipped);
  for (const ParamTable* table : all_tables()) compiler.add_table(*table);
  if (storage) compiler.add_define("NF_FETCH_STORAGE", "1");
  return compiler;
}

gpu::Defines vbgi_defines() {
  const passes::GiParams shared;
  const passes::VbgiParams own;
  return passes::GiPipelines::defines({{"GI", shared.table(), &shared}, {"BITMASK", own.table(), &own}},
                                      {passes::whole_step_exponent(shared)});
}

TEST(Shaders, BothWaysToFetchCompile) {
  for (const bool storage : {true, false}) {
    const gpu::ShaderCompiler compiler = engine_compiler(storage, {});
    const gpu::CompiledProgram program = compiler.compile({"gi/vbgi.comp"}, vbgi_defines());
    ASSERT_TRUE(program.interface.find("depth"));
    EXPECT_EQ(program.interface.find("depth")->kind,
              storage ? gpu::SlotKind::StorageImage : gpu::SlotKind::SampledImage);
    for (const char* file : {"direct.frag", "composite.frag"})
      EXPECT_FALSE(compiler.compile({"common/fullscreen.vert", file}, {}).interface.slots.empty());
    const gpu::Defines map = {{"ENVIRONMENT_MAP", "1"}, {"HAS_VISIBILITY", "1"}, {"HAS_BENT", "1"}};
    EXPECT_TRUE(compiler.compile({"common/fullscreen.vert", "composite.frag"}, map).interface.find("environment_map"));
  }
}

TEST(Shaders, TheCacheGivesTheSameWordsAndIgnoresDamage) {
  const std::filesystem::path cache =
      std::filesystem::temp_directory_path() / fmt::format("nearfield-cache-{}", getpid());
  std::filesystem::create_directories(cache);
  const gpu::ShaderCompiler compiler = engine_compiler(true, cache);
  const gpu::CompiledProgram first = compiler.compile({"gi/vbgi.comp"}, vbgi_defines()),
                             second = compiler.compile({"gi/vbgi.comp"}, vbgi_defines());
  EXPECT_FALSE(first.from_cache);
  EXPECT_TRUE(second.from_cache);
  EXPECT_EQ(first.stages[0].spirv, second.stages[0].spirv);
  gpu::Defines others = vbgi_defines();
  others.emplace_back("OTHER", "1");
  EXPECT_FALSE(compiler.compile({"gi/vbgi.comp"}, others).from_cache) << "defines are part of the key";
  EXPECT_GE(first.dependencies.size(), 5u);
  // What is shipped is read where the cache has nothing.
  const gpu::ShaderCompiler elsewhere = engine_compiler(true, {}, cache / "spirv");
  EXPECT_TRUE(elsewhere.compile({"gi/vbgi.comp"}, vbgi_defines()).from_cache);
  EXPECT_FALSE(elsewhere.compile({"common/fullscreen.vert", "direct.frag"}, {}).from_cache);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(cache))
    if (entry.is_regular_file()) std::filesystem::resize_file(entry.path(), 100);
  const gpu::CompiledProgram third = compiler.compile({"gi/vbgi.comp"}, vbgi_defines());
  EXPECT_FALSE(third.from_cache);
  EXPECT_EQ(third.stages[0].spirv, first.stages[0].spirv);
  std::filesystem::remove_all(cache);
}

TEST(Shaders, StagesShareBindingsByName) {
  const gpu::ShaderCompiler compiler = engine_compiler(true, {});
  const gpu::CompiledProgram program = compiler.compile({"gbuffer.vert", "gbuffer.frag"}, {});
  std::vector<uint32_t> bindings;
  for (const gpu::Slot& slot : program.interface.slots) bindings.push_back(slot.binding);
  std::sort(bindings.begin(), bindings.end());
  EXPECT_EQ(std::adjacent_find(bindings.begin(), bindings.end()), bindings.end()) << "two slots share a binding";
  EXPECT_TRUE(program.interface.find("instances"));
  EXPECT_TRUE(program.interface.find("materials"));
}

}  // namespace
}  // namespace nf::test
