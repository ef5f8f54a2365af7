// glslang behind a small face. The cache key is the text of everything that goes in, so a stale entry cannot be hit.
#include "gpu/shader.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>
#include <unistd.h>

#include "core/log.h"

namespace nf::gpu {
namespace {

namespace fs = std::filesystem;

// Bump when the way of compiling changes: old cache entries are then not found.
constexpr const char* compiler_version = "nearfield-spirv-2";

struct Source {
  std::string name, text;
};

std::string read_file(const fs::path& path, const std::string& name) {
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(Exit::Shader, "cannot read the shader '{}': no such file in {}", name, path.parent_path().string());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// FNV-1a, 64 bit, twice with different offsets: names cache files.
std::string hash_name(const std::string& text) {
  uint64_t a = 14695981039346656037ull, b = 7809847782465536322ull;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    a = (a ^ byte) * 1099511628211ull, b = (b ^ (byte + 1u)) * 1099511628211ull;
  }
  return fmt::format("{:016x}{:016x}", a, b);
}

EShLanguage language_of(const std::string& file) {
  const std::string extension = fs::path(file).extension().string();
  if (extension == ".comp") return EShLangCompute;
  if (extension == ".vert") return EShLangVertex;
  if (extension == ".frag") return EShLangFragment;
  fail(Exit::Shader, "cannot tell the stage of the shader '{}': the extension must be .comp, .vert or .frag", file);
}

VkShaderStageFlagBits stage_of(EShLanguage language) {
  return language == EShLangCompute  ? VK_SHADER_STAGE_COMPUTE_BIT
         : language == EShLangVertex ? VK_SHADER_STAGE_VERTEX_BIT
                                     : VK_SHADER_STAGE_FRAGMENT_BIT;
}

// glslang's preprocessor asks for includes by name; every name is relative to the shader folder, or generated.
class Includer : public glslang::TShader::Includer {
 public:
  explicit Includer(const std::map<std::string, std::string>& texts) : texts_(texts) {}
  IncludeResult* includeLocal(const char* name, const char*, size_t) override { return find(name); }
  IncludeResult* includeSystem(const char* name, const char*, size_t) override { return find(name); }
  void releaseInclude(IncludeResult* result) override { delete result; }

 private:
  IncludeResult* find(const char* name) {
    const auto it = texts_.find(name);
    return it == texts_.end() ? nullptr : new IncludeResult(name, it->second.data(), it->second.size(), nullptr);
  }
  const std::map<std::string, std::string>& texts_;
};

// "ERROR: gi/vbgi.comp:12: 'x' : undeclared" -> "gi/vbgi.comp:12: 'x' : undeclared"
std::string tidy_log(const std::string& log) {
  std::istringstream in(log);
  std::string line, result;
  while (std::getline(in, line)) {
    if (line.rfind("ERROR: ", 0) != 0) continue;
    line = line.substr(7);
    if (line.find("compilation errors") != std::string::npos ||
        line.find("compilation terminated") != std::string::npos)
      continue;
    result += (result.empty() ? "" : "\n") + line;
  }
  return result.empty() ? log : result;
}

void init_glslang() {
  static std::once_flag once;
  std::call_once(once, [] { glslang::InitializeProcess(); });
}

}  // namespace

ShaderCompiler::ShaderCompiler(fs::path folder, fs::path cache, fs::path shipped)
    : folder_(std::move(folder)), cache_(std::move(cache)), shipped_(std::move(shipped)) {
  if (!cache_.empty()) {
    cache_ /= "spirv";
    std::error_code error;
    fs::create_directories(cache_, error);
    if (error) cache_.clear();
  }
}

void ShaderCompiler::add_table(const ParamTable& table) {
  generated_[fmt::format("params/{}", table.prefix)] = params::glsl_block(table);
}

void ShaderCompiler::add_define(std::string name, std::string value) {
  defines_.emplace_back(std::move(name), std::move(value));
}

CompiledProgram ShaderCompiler::compile(const std::vector<std::string>& files, const Defines& defines) const {
  // Everything that can be included from these files, whether or not a condition skips it: the cache key and the
  // dependencies must not depend on preprocessing.
  std::map<std::string, std::string> texts;
  std::function<void(const std::string&, const std::string&, int)> gather = [&](const std::string& name,
                                                                                const std::string& from, int line) {
    if (texts.count(name)) return;
    if (const auto it = generated_.find(name); it != generated_.end())
      texts[name] = it->second;
    else if (fs::exists(folder_ / name))
      texts[name] = read_file(folder_ / name, name);
    else
      fail(Exit::Shader, "{}:{}: cannot find the include \"{}\": it is neither in {} nor a parameter table", from, line,
           name, folder_.string());
    std::istringstream in(texts[name]);
    std::string text_line;
    for (int number = 1; std::getline(in, text_line); ++number) {
      const size_t at = text_line.find_first_not_of(" \t");
      if (at == std::string::npos || text_line.compare(at, 8, "#include") != 0) continue;
      const size_t open = text_line.find('"', at), close = text_line.find('"', open + 1);
      if (open != std::string::npos && close != std::string::npos)
        gather(text_line.substr(open + 1, close - open - 1), name, number);
    }
  };
  for (const std::string& file : files) {
    if (!fs::exists(folder_ / file)) read_file(folder_ / file, file);
    gather(file, file, 0);
  }

  std::string preamble =
      "#extension GL_GOOGLE_include_directive : require\n#extension GL_EXT_scalar_block_layout : require\n"
      "#extension GL_EXT_samplerless_texture_functions : require\n";
  for (const auto& [name, value] : defines_) preamble += fmt::format("#define {} {}\n", name, value);
  for (const auto& [name, value] : defines) preamble += fmt::format("#define {} {}\n", name, value);

  CompiledProgram program;
  for (const auto& [name, text] : texts)
    if (!generated_.count(name)) program.dependencies.push_back(name);

  std::string key = compiler_version + preamble;
  for (const std::string& file : files) key += file + '\0';
  for (const auto& [name, text] : texts) key += name + '\0' + text + '\0';
  const std::string entry = hash_name(key) + ".spv";
  const auto load = [&](const fs::path& from) -> bool {
    if (from.empty()) return false;
    std::ifstream in(from / entry, std::ios::binary);
    std::vector<CompiledStage> stages;
    for (const std::string& file : files) {
      uint32_t words = 0;
      if (!in.read(reinterpret_cast<char*>(&words), sizeof words) || words == 0 || words > (64u << 20)) return false;
      CompiledStage stage{stage_of(language_of(file)), std::vector<uint32_t>(words)};
      if (!in.read(reinterpret_cast<char*>(stage.spirv.data()), std::streamsize(words) * 4)) return false;
      if (stage.spirv[0] != 0x07230203u) return false;
      stages.push_back(std::move(stage));
    }
    program.stages = std::move(stages);
    return true;
  };
  if (load(cache_) || load(shipped_)) {
    program.from_cache = true;
    program.interface = reflect(program.stages);
    return program;
  }

  init_glslang();
  glslang::TProgram linked;
  std::vector<std::unique_ptr<glslang::TShader>> shaders;
  Includer includer(texts);
  for (const std::string& file : files) {
    const EShLanguage language = language_of(file);
    auto& shader = *shaders.emplace_back(std::make_unique<glslang::TShader>(language));
    const char* text = texts[file].c_str();
    const char* name = file.c_str();
    const int length = int(texts[file].size());
    shader.setStringsWithLengthsAndNames(&text, &length, &name, 1);
    shader.setPreamble(preamble.c_str());
    shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
    shader.setAutoMapBindings(true);
    shader.setAutoMapLocations(true);
    const EShMessages messages = EShMessages(EShMsgSpvRules | EShMsgVulkanRules);
    if (!shader.parse(GetDefaultResources(), 460, ENoProfile, false, false, messages, includer))
      fail(Exit::Shader, "{}", tidy_log(shader.getInfoLog()));
    linked.addShader(&shader);
  }
  if (!linked.link(EShMessages(EShMsgSpvRules | EShMsgVulkanRules)) || !linked.mapIO())
    fail(Exit::Shader, "{}: {}", files.front(), tidy_log(linked.getInfoLog()));
  for (const std::string& file : files) {
    const EShLanguage language = language_of(file);
    CompiledStage stage{stage_of(language), {}};
    glslang::SpvOptions options;
    options.disableOptimizer = true;
    glslang::GlslangToSpv(*linked.getIntermediate(language), stage.spirv, &options);
    program.stages.push_back(std::move(stage));
  }
  assign_bindings(program.stages);
  if (!cache_.empty()) {
    // Written aside and renamed, so that two processes never see half a file.
    const fs::path cached = cache_ / entry;
    const fs::path temporary = cached.string() + fmt::format(".{}", ::getpid());
    std::ofstream out(temporary, std::ios::binary);
    for (const CompiledStage& stage : program.stages) {
      const uint32_t words = uint32_t(stage.spirv.size());
      out.write(reinterpret_cast<const char*>(&words), sizeof words);
      out.write(reinterpret_cast<const char*>(stage.spirv.data()), std::streamsize(words) * 4);
    }
    out.close();
    std::error_code error;
    if (out)
      fs::rename(temporary, cached, error);
    else
      fs::remove(temporary, error);
  }
  program.interface = reflect(program.stages);
  return program;
}

std::string ShaderCompiler::text_of(const std::string& file) const {
  if (const auto it = generated_.find(file); it != generated_.end()) return it->second;
  std::error_code error;
  return fs::is_regular_file(folder_ / file, error) ? read_file(folder_ / file, file) : std::string();
}

fs::path find_shader_folder() {
  std::vector<fs::path> candidates;
  if (const char* data = std::getenv("NEARFIELD_DATA_DIR")) candidates.push_back(fs::path(data) / "shaders");
  std::error_code error;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error).parent_path();
  candidates.push_back(binary / "../../shaders");               // build/NAME/nearfield
  candidates.push_back(binary / "../../../shaders");            // build/NAME/tests/*_test
  candidates.push_back(binary / "../share/nearfield/shaders");  // installed
  for (const fs::path& candidate : candidates)
    if (fs::exists(candidate / "common")) return fs::canonical(candidate);
  fail(Exit::Input, "cannot find the shaders: looked in {}; set NEARFIELD_DATA_DIR to the folder that holds shaders/",
       candidates.front().string());
}

fs::path shipped_spirv() {
  return find_shader_folder().parent_path() / "spirv";
}

fs::path cache_folder() {
  fs::path folder;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    folder = fs::path(cache) / "nearfield";
  else if (const char* home = std::getenv("HOME"); home && *home)
    folder = fs::path(home) / ".cache" / "nearfield";
  if (folder.empty()) return {};
  std::error_code error;
  fs::create_directories(folder, error);
  return error ? fs::path() : folder;
}

}  // namespace nf::gpu
