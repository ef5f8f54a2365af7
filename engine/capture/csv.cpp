// CSV.
#include "capture/csv.h"

#include <fmt/format.h>

#include "core/error.h"

namespace nf::capture {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string summary_csv(const std::vector<RunResult>& results) {
  std::string out = "run,technique,pass,count,min_ms,median_ms,p95_ms,p99_ms,max_ms,mean_ms,stddev_ms,mad_ms\r\n";
  for (const RunResult& result : results) {
    const auto row = [&](const std::string& pass, const Statistics& s) {
      out += fmt::format("{},{},{},{}", csv_field(result.run->name), csv_field(result.run->technique), csv_field(pass),
                         s.count);
      for (const double value : {s.min, s.median, s.p95, s.p99, s.max, s.mean, s.stddev, s.mad})
        out += s.count ? fmt::format(",{:.6f}", value) : ",";
      out += "\r\n";
    };
    for (size_t p = 0; p < result.run->passes.size(); ++p)
      row(result.run->passes[p].path, result.summary.passes[p].gpu);
    row("unattributed", result.summary.unattributed);
    row("frame", result.summary.frame.gpu);
  }
  return out;
}

FramesCsv::FramesCsv(const std::filesystem::path& path) : path_(path), out_(path, std::ios::binary) {
  out_ << "run,repeat,frame,pass,gpu_ms,cpu_ms\r\n" << std::flush;
  if (!out_) fail(Exit::Output, "cannot write '{}': is the folder there and writable?", path.string());
}

void FramesCsv::add(const Run& run, const FrameSample& frame) {
  const std::string start = fmt::format("{},{},{}", csv_field(run.name), frame.repeat, frame.frame);
  std::string text;
  for (const PassSample& sample : frame.passes)
    text += fmt::format("{},{},{:.6f},{:.6f}\r\n", start, csv_field(run.passes[sample.pass].path), sample.gpu_ms,
                        sample.record_ms);
  text += fmt::format("{},frame,{:.6f},{:.6f}\r\n", start, frame.gpu_ms, frame.cpu_ms);
  out_ << text << std::flush;
  if (!out_) fail(Exit::Output, "cannot write '{}': is the disk full?", path_.string());
}

}  // namespace nf::capture
