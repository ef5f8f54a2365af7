// The rules of a trace.
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "capture/trace.h"

namespace nf::capture {

using nlohmann::json;

namespace {

struct Slice {
  std::string name;
  int64_t begin, end;
};

class Checker {
 public:
  std::vector<std::string> faults;

  void check(const json& trace) {
    if (!trace.is_object()) return fault("the file is no object");
    if (!trace.contains("traceEvents") || !trace["traceEvents"].is_array()) return fault("no list 'traceEvents'");
    for (const json& event : trace["traceEvents"]) {
      ++number_;
      check_event(event);
    }
    if (first_ > 60'000'000'000) fault("times do not start near 0");
  }

 private:
  void fault(const std::string& text) { faults.push_back(number_ ? fmt::format("event {}: {}", number_, text) : text); }

  // Microseconds with at most three decimals, as nanoseconds; -1 when it is not that.
  int64_t time(const json& event, const char* key) {
    if (!event.contains(key) || !event[key].is_number()) return fault(fmt::format("'{}' is no number", key)), -1;
    const double us = event[key].get<double>(), ns = us * 1000;
    if (!(us >= 0) || us > 1e12) return fault(fmt::format("'{}' is out of range: {}", key, us)), -1;
    if (std::abs(ns - std::round(ns)) > 1e-3) return fault(fmt::format("'{}' has more than three decimals", key)), -1;
    return std::llround(ns);
  }

  void check_event(const json& event) {
    if (!event.is_object() || !event.contains("ph") || !event["ph"].is_string()) return fault("no 'ph'");
    const std::string phase = event["ph"];
    for (const char* key : {"pid", "tid"})
      if (!event.contains(key) || !event[key].is_number_integer()) return fault(fmt::format("'{}' is no integer", key));
    if (!event.contains("name") || !event["name"].is_string()) return fault("no 'name'");
    if (phase == "M") return;
    const int64_t ts = time(event, "ts");
    if (ts < 0) return;
    if (first_ < 0) first_ = ts;
    if (ts < last_) fault("events are not sorted by 'ts'");
    last_ = ts;
    if (phase == "X") check_slice(event, ts);
  }

  void check_slice(const json& event, int64_t ts) {
    const int64_t duration = time(event, "dur");
    if (duration < 0) return;
    const Slice slice{event["name"], ts, ts + duration};
    std::vector<Slice>& open = open_[{event["pid"].get<int64_t>(), event["tid"].get<int64_t>()}];
    while (!open.empty() && open.back().end <= ts) open.pop_back();
    if (!open.empty() && open.back().begin == ts)
      fault(fmt::format("'{}' begins where '{}' does, in which it lies", slice.name, open.back().name));
    else if (!open.empty() && slice.end >= open.back().end)
      fault(fmt::format("'{}' overlaps '{}'", slice.name, open.back().name));
    open.push_back(slice);
  }

  size_t number_ = 0;
  int64_t first_ = -1, last_ = -1;
  std::map<std::pair<int64_t, int64_t>, std::vector<Slice>> open_;  // by process and thread
};

}  // namespace

std::vector<std::string> check_trace(const json& trace) {
  Checker checker;
  checker.check(trace);
  return checker.faults;
}

}  // namespace nf::capture
