// Who this binary is.
#include <fmt/format.h>

#include "cli/options.h"

namespace nf::editor {

std::string version_short() {
  return fmt::format("{} ({})", NF_VERSION, NF_GIT_HASH);
}

std::string version_line() {
#if defined(__clang__)
  const std::string compiler = fmt::format("clang {}", __clang_version__);
#else
  const std::string compiler = fmt::format("gcc {}", __VERSION__);
#endif
  return fmt::format("nearfield {} git {} {} {}", NF_VERSION, NF_GIT_HASH, NF_BUILD_TYPE, compiler);
}

}  // namespace nf::editor
