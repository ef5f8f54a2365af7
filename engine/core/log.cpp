// Set-up of the process-wide log.
#include "core/log.h"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "core/error.h"

namespace nf::log {

void init(Level level, const std::string& file) {
  auto console = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  console->set_pattern("%^%l%$: %v");
  console->set_level(level == Level::Quiet    ? spdlog::level::err
                     : level == Level::Normal ? spdlog::level::info
                                              : spdlog::level::debug);
  auto logger = std::make_shared<spdlog::logger>("nearfield", console);
  logger->set_level(spdlog::level::debug);
  // Before the file is opened: that it cannot be is said here, not on stdout as spdlog does by itself.
  spdlog::set_default_logger(logger);
  if (file.empty()) return;
  try {
    auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file, true);
    sink->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
    logger->sinks().push_back(sink);
  } catch (const spdlog::spdlog_ex& e) {
    fail(Exit::Output, "cannot write the log file '{}': {}; choose another with --log-file", file, e.what());
  }
}

}  // namespace nf::log
