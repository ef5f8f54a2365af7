// Progress reporting.
#include "cli/progress.h"

#include <cstdio>
#include <unistd.h>

namespace nf::editor {
namespace {

ProgressMode mode_of(const CommonOptions& o) {
  if (o.progress == "bar") return ProgressMode::Bar;
  if (o.progress == "plain") return ProgressMode::Plain;
  if (o.progress == "json") return ProgressMode::Json;
  if (o.progress == "none" || o.quiet) return ProgressMode::None;
  return isatty(STDERR_FILENO) ? ProgressMode::Bar : ProgressMode::Plain;
}

}  // namespace

Progress::Progress(std::string label, uint64_t total, const CommonOptions& options)
    : label_(std::move(label)), total_(total), mode_(mode_of(options)), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (mode_ == ProgressMode::Bar && shown_) std::fputs("\r\033[K", stderr);
}

void Progress::update(uint64_t done, const std::string& note) {
  if (mode_ == ProgressMode::None || (total_ < 2 && done == total_)) return;
  const Clock::time_point now = Clock::now();
  const double since = std::chrono::duration<double>(now - last_).count();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const bool last = done == total_;
  // At most 10 a second on a terminal; elsewhere at 10 % steps or every 10 s, and short work stays silent.
  if (mode_ == ProgressMode::Bar && since < 0.1 && !last) return;
  if (mode_ != ProgressMode::Bar &&
      !(since >= 10 || (since >= 1 && (done - last_done_) * 10 >= total_) || (last && elapsed > 2)))
    return;
  last_ = now;
  last_done_ = done;
  shown_ = true;
  const std::string left =
      done ? fmt::format(" ETA {:.0f} s", elapsed * double(total_ - done) / double(done)) : std::string();
  if (mode_ == ProgressMode::Json) {
    fmt::print(stderr, "{{\"progress\":\"{}\",\"done\":{},\"total\":{},\"seconds\":{:.3f}}}\n", label_, done, total_,
               elapsed);
  } else if (mode_ == ProgressMode::Plain) {
    fmt::print(stderr, "{} {}/{} {}{}\n", label_, done, total_, note, left);
  } else {
    const int width = 24, filled = int(done * width / total_);
    fmt::print(stderr, "\r\033[K{} [{}{}] {}/{} {}{}", label_, std::string(size_t(filled), '#'),
               std::string(size_t(width - filled), '.'), done, total_, note, left);
    std::fflush(stderr);
  }
}

}  // namespace nf::editor
