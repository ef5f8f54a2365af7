// A timing capture as rows: what was measured frame by frame, its summary, and why it may not be trusted. All times are
// in milliseconds.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capture/host.h"
#include "capture/statistics.h"

namespace nf::capture {

struct PassSample {
  uint32_t pass = 0;    // row of Run::passes
  double begin_ms = 0;  // after the frame's first timestamp
  double gpu_ms = 0, record_ms = 0;
};

struct FrameSample {
  uint32_t repeat = 0, frame = 0;
  int64_t submit_ns = 0, gpu_begin_ns = 0;  // on the host's clock, from the start of the capture
  double gpu_ms = 0;                        // from the first pass's begin to the last one's end
  double wall_ms = 0;                       // from submission to the moment the host knew that the frame was done
  double cpu_ms = 0;                        // building, planning and recording
  std::vector<PassSample> passes;
  double process_ms = 0;  // CPU time of all of this process's threads, from building to the end
};

struct PassInfo {
  std::string path;  // unique in a run: the pass's name, with #2, #3 ... where a frame has several of that name
  std::string kind, description;
  nlohmann::json counts;  // pipeline statistics of the last frame, where they were asked for; else null
};

// One thing that was measured. The JSON members are written as they are.
struct Run {
  std::string name, technique;
  nlohmann::json scene, settings, memory;
  std::string picture;  // file of the last frame, relative to the document; may be empty
  std::vector<PassInfo> passes;
  std::vector<FrameSample> frames;

  // The row of this pass, which is added where it is new. `number` counts passes of that name within a frame, from 1.
  uint32_t find_pass(const std::string& pass, uint32_t number, const char* kind, const char* description);
};

struct PassSummary {
  Statistics gpu, record;
  std::vector<double> per_repeat;  // medians
};

struct Summary {
  std::vector<PassSummary> passes;  // by row of Run::passes
  PassSummary frame;                // record: all CPU work of a frame
  Statistics wall, unattributed;    // unattributed: of the frame's GPU time, what no pass accounts for
};
Summary summarise(const Run& run);

// How a run was made, as far as it bears on trust.
struct Circumstances {
  HostLoad load;
  bool software_device = false, debug_build = false, validation = false, overlap = false, timestamps = true;
};

// A pass with less of its frame is not compared: neither with a baseline nor its repeats with each other.
inline constexpr double compared_share = 0.01;

// `noisy` holds the reasons to distrust the figures; a software device is a warning and no such reason.
struct Trust {
  std::vector<std::string> warnings, noisy;
};
Trust judge(const Run& run, const Summary& summary, const Circumstances& circumstances);

// The document nearfield.timing/1: content/schema/timing-1.json says what is in it.
struct RunResult {
  const Run* run;
  Summary summary;
  Trust trust;
};
nlohmann::json timing_document(const nlohmann::json& context, const nlohmann::json& method,
                               const std::vector<RunResult>& results, bool complete);
nlohmann::json to_json(const Statistics& statistics);

}  // namespace nf::capture
