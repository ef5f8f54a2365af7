// Traces for Perfetto and chrome://tracing, in the JSON form that both read.
#pragma once

#include <string>
#include <vector>

#include "capture/timing.h"

namespace nf::capture {

// One process a run, with a CPU and a GPU track. Passes lie strictly inside their frame and never overlap: where the
// device's timestamps do, a pass is cut to begin at the end of the one before, and its own interval is in its args.
// `calibrated` says whether GPU and CPU times are on one clock; else each frame begins where it was submitted.
nlohmann::json trace_document(const std::vector<const Run*>& runs, const nlohmann::json& other_data, bool calibrated);

// What is wrong with a trace by the rules that keep viewers from dropping or misplacing events; empty = nothing.
std::vector<std::string> check_trace(const nlohmann::json& trace);

}  // namespace nf::capture
