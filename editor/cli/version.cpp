// Who this binary is.
#include <fmt/format.h>

#include "cli/options.h"

namespace nf::editor {

std::string version_short() {
  return fmt::format("{} ({})", NF_VERSION, NF_GIT_HASH);
}

BuildInfo build_info() {
#if defined(__clang__)
  const std::string compiler = fmt::format("clang {}", __clang_version__);
#else
  const std::string compiler = fmt::format("gcc {}", __VERSION__);
#endif
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__)
  const bool debug = false;
#else
  const bool debug = true;
#endif
  return {NF_VERSION, NF_GIT_HASH, NF_BUILD_TYPE, compiler, debug};
}

std::string version_line() {
  const BuildInfo info = build_info();
  return fmt::format("nearfield {} git {} {} {}", info.version, info.git, info.type, info.compiler);
}

}  // namespace nf::editor
