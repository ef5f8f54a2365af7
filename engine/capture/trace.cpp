// Writing traces. Times are whole nanoseconds inside, so that nesting is exact; files have microseconds.
#include "capture/trace.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nf::capture {

using nlohmann::json;

namespace {

constexpr int cpu_track = 1, gpu_track = 100;

double microseconds(int64_t ns) {
  return double(ns) / 1000.0;
}
int64_t nanoseconds(double ms) {
  return std::llround(ms * 1e6);
}

class Writer {
 public:
  explicit Writer(bool calibrated) : calibrated_(calibrated) {}

  void name_tracks(int pid, const Run& run) {
    const auto meta = [&](const char* name, int tid, json args) {
      events_.push_back(
          {{"ph", "M"}, {"pid", pid}, {"tid", tid}, {"ts", 0}, {"name", name}, {"args", std::move(args)}});
    };
    meta("process_name", cpu_track, {{"name", run.name}});
    meta("thread_name", cpu_track, {{"name", "CPU main"}});
    meta("thread_name", gpu_track, {{"name", "GPU queue"}});
    meta("thread_sort_index", gpu_track, {{"sort_index", -1}});
  }

  void add_frame(int pid, const Run& run, const FrameSample& frame) {
    const int64_t submit = std::max(frame.submit_ns, nanoseconds(frame.cpu_ms));
    const int64_t record = std::max(submit - nanoseconds(frame.cpu_ms), cpu_end_ + 1);
    const std::string name = fmt::format("frame {}", frame.frame);
    slice(pid, cpu_track, "cpu", "record " + name, record, std::max(submit, record + 2),
          {{"frame", frame.frame}, {"repeat", frame.repeat}});
    cpu_end_ = std::max(submit, record + 2);
    flow(pid, cpu_track, "s", cpu_end_ - 1);

    const int64_t measured = calibrated_ ? frame.gpu_begin_ns : cpu_end_;
    const int64_t begin = std::max({measured, gpu_end_ + 1, cpu_end_});
    const int64_t passes = int64_t(frame.passes.size());
    const int64_t end = begin + std::max(nanoseconds(frame.gpu_ms), 2 * passes + 2);
    slice(pid, gpu_track, "gpu,frame", name, begin, end,
          {{"frame", frame.frame}, {"repeat", frame.repeat}, {"clock", calibrated_ ? "calibrated" : "guessed"}});
    flow(pid, gpu_track, "f", begin);
    add_passes(pid, run, frame, begin, end);
    gpu_end_ = end;
    if (run.memory.contains("placed_bytes"))
      events_.push_back({{"ph", "C"},
                         {"pid", pid},
                         {"tid", gpu_track},
                         {"ts", microseconds(begin)},
                         {"name", "transient MiB"},
                         {"args", {{"MiB", run.memory["placed_bytes"].get<double>() / 1048576}}}});
    ++flows_;
  }

  json finish(json other_data) {
    // Parents come before their children: a frame's slice was added before those of its passes.
    std::stable_sort(events_.begin(), events_.end(), [](const json& a, const json& b) {
      const bool meta_a = a["ph"] == "M", meta_b = b["ph"] == "M";
      if (meta_a != meta_b) return meta_a;
      return a["ts"].get<double>() < b["ts"].get<double>();
    });
    other_data["schema"] = "nearfield.trace/1";
    return {{"displayTimeUnit", "ms"}, {"otherData", std::move(other_data)}, {"traceEvents", std::move(events_)}};
  }

 private:
  void slice(int pid, int tid, const char* category, const std::string& name, int64_t begin, int64_t end, json args) {
    events_.push_back({{"ph", "X"},
                       {"pid", pid},
                       {"tid", tid},
                       {"cat", category},
                       {"name", name},
                       {"ts", microseconds(begin)},
                       {"dur", microseconds(end - begin)},
                       {"args", std::move(args)}});
  }
  void flow(int pid, int tid, const char* phase, int64_t at) {
    json event = {{"ph", phase},           {"pid", pid},       {"tid", tid},
                  {"cat", "submit"},       {"name", "submit"}, {"id", flows_},
                  {"ts", microseconds(at)}};
    if (*phase == 'f') event["bp"] = "e";
    events_.push_back(event);
  }
  void add_passes(int pid, const Run& run, const FrameSample& frame, int64_t begin, int64_t end) {
    int64_t free = begin + 1;  // from here on nothing has been placed
    int64_t left = int64_t(frame.passes.size());
    for (const PassSample& pass : frame.passes) {
      const int64_t from = begin + nanoseconds(pass.begin_ms), to = from + nanoseconds(pass.gpu_ms);
      // A nanosecond is kept for each pass that is still to come.
      const int64_t last = end - 1 - (left - 1);
      const int64_t placed_from = std::clamp(from, free, last - 1), placed_to = std::clamp(to, placed_from + 1, last);
      const PassInfo& info = run.passes[pass.pass];
      json args = {{"frame", frame.frame}, {"path", info.path}};
      if (std::abs(placed_from - from) > 1 || std::abs(placed_to - to) > 2)
        args["measured_us"] = {microseconds(from), microseconds(to)};
      slice(pid, gpu_track, "gpu,pass", info.path, placed_from, placed_to, args);
      free = placed_to;
      --left;
    }
  }

  bool calibrated_;
  std::vector<json> events_;
  int64_t cpu_end_ = -1, gpu_end_ = -1;
  uint64_t flows_ = 0;
};

}  // namespace

json trace_document(const std::vector<const Run*>& runs, const json& other_data, bool calibrated) {
  Writer writer(calibrated);
  std::vector<std::pair<int, const FrameSample*>> frames;
  for (size_t i = 0; i < runs.size(); ++i) {
    writer.name_tracks(int(i) + 1, *runs[i]);
    for (const FrameSample& frame : runs[i]->frames) frames.emplace_back(int(i) + 1, &frame);
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const auto& a, const auto& b) { return a.second->submit_ns < b.second->submit_ns; });
  for (const auto& [pid, frame] : frames) writer.add_frame(pid, *runs[size_t(pid) - 1], *frame);
  return writer.finish(other_data);
}

}  // namespace nf::capture
