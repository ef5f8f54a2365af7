// The log: spdlog to stderr (never stdout, which belongs to results), and to a file when asked.
#pragma once

#include <spdlog/spdlog.h>
#include <string>

namespace nf::log {

enum class Level { Quiet, Normal, Verbose };

// Quiet shows errors only, Normal adds warnings and progress notes, Verbose everything. `file` may be empty; throws
// nf::Error (Exit::Output) when it cannot be written.
void init(Level level, const std::string& file = {});

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

}  // namespace nf::log
