// CSV files of captures: RFC 4180, a header line, '.' decimals, nothing else.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "capture/timing.h"

namespace nf::capture {

// A field in quotes where it needs them.
std::string csv_field(const std::string& text);

// run,technique,pass,count,min_ms,median_ms,p95_ms,p99_ms,max_ms,mean_ms,stddev_ms,mad_ms; the frame and what no pass
// accounts for are rows as well.
std::string summary_csv(const std::vector<RunResult>& results);

// run,repeat,frame,pass,gpu_ms,cpu_ms: a row for each pass and one for the frame, written when the frame is done, so
// that a crash loses nothing.
class FramesCsv {
 public:
  explicit FramesCsv(const std::filesystem::path& path);
  void add(const Run& run, const FrameSample& frame);

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace nf::capture
