// Editing shaders while the program runs: which files have changed (ShaderWatch), and what became of compiling them
// again (Pipelines::reload).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace nf::gpu {

// One fault of a shader, where its author wrote it: includes are followed.
struct ReloadError {
  std::string file;               // relative to the shader folder; a "params/..." is a generated block
  uint32_t line = 0, column = 0;  // from 1; 0: not told (a fault of linking, a word that is not in the line)
  std::string message;
  std::string source_line;  // its text; empty: not found
  bool operator==(const ReloadError&) const = default;
};

struct Reload {
  uint32_t recompiled = 0;  // programs that run anew
  double ms = 0;
  // All that is broken now, each fault once: a program that failed is tried again with every reload.
  std::vector<ReloadError> errors;
};

// Which shaders of a folder changed since the last call. No threads: ask between frames. Costs one stat() a file.
class ShaderWatch {
 public:
  explicit ShaderWatch(std::filesystem::path folder, std::chrono::milliseconds quiet = std::chrono::milliseconds(100));
  // Files (.comp .vert .frag .glsl, relative to the folder, sorted) that were written, replaced, added or removed. One
  // that changed less than `quiet` ago may still be being written: it waits for a later call.
  std::vector<std::string> changed();

 private:
  using Clock = std::chrono::steady_clock;
  // All zero: there is no such file. The inode tells a file that was renamed over another.
  struct Stamp {
    int64_t modified_ns = 0;
    uint64_t size = 0, inode = 0;
    bool operator==(const Stamp&) const = default;
  };
  struct File {
    Stamp told, seen;
    Clock::time_point since;  // when `seen` was new
  };
  std::map<std::string, Stamp> scan() const;

  std::filesystem::path folder_;
  std::chrono::milliseconds quiet_;
  std::map<std::string, File> files_;
};

class ShaderCompiler;
// The faults in the text of an nf::Error that ShaderCompiler::compile threw, with their source lines.
std::vector<ReloadError> shader_errors(const ShaderCompiler& compiler, const std::string& text);

}  // namespace nf::gpu
