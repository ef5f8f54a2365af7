// Progress of long work on stderr: a bar on a terminal, plain lines elsewhere, JSON lines for wrappers.
#pragma once

#include <chrono>
#include <string>

#include "cli/options.h"

namespace nf::editor {

class Progress {
 public:
  Progress(std::string label, uint64_t total, const CommonOptions& options);
  ~Progress();
  void update(uint64_t done, const std::string& note = {});

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  uint64_t total_;
  ProgressMode mode_;
  Clock::time_point start_, last_;
  uint64_t last_done_ = 0;
  bool shown_ = false;
};

}  // namespace nf::editor
