// Summaries of runs, and reasons to distrust them.
#include "capture/timing.h"

#include <algorithm>
#include <fmt/format.h>

namespace nf::capture {
namespace {

// A pass below this share of the frame is too short for its spread to say anything about the run.
constexpr double smallest_share = 0.05;

PassSummary summarise_rows(const std::vector<const FrameSample*>& frames, const std::vector<double>& gpu,
                           const std::vector<double>& record) {
  PassSummary out{statistics(gpu), statistics(record), {}};
  uint32_t repeats = 0;
  for (const FrameSample* frame : frames) repeats = std::max(repeats, frame->repeat + 1);
  for (uint32_t r = 0; r < repeats; ++r) {
    std::vector<double> of_repeat;
    for (size_t i = 0; i < frames.size(); ++i)
      if (frames[i]->repeat == r) of_repeat.push_back(gpu[i]);
    if (!of_repeat.empty()) out.per_repeat.push_back(statistics(of_repeat).median);
  }
  return out;
}

void judge_load(const Circumstances& c, Trust& trust) {
  const HostLoad& load = c.load;
  if (load.average_start > load.cores / 2.0)
    trust.noisy.push_back(
        fmt::format("the load average was {:.2f} on {} cores at the start", load.average_start, load.cores));
  // What others compute slows a software device down directly.
  const double most = c.software_device ? 0.05 * load.cores : 0.5 * load.cores;
  if (load.others > most)
    trust.noisy.push_back(fmt::format("other processes used {:.2f} of {} cores", load.others, load.cores));
}

// The worst of the passes that have the same fault, and how many there are.
struct Worst {
  double degree = 0;
  std::string text;
  uint32_t count = 0;
  void add(double how_bad, std::string said) {
    ++count;
    if (how_bad <= degree) return;
    degree = how_bad;
    text = std::move(said);
  }
  void tell(Trust& trust) const {
    if (count > 1) trust.noisy.push_back(fmt::format("{}, and {} more like it", text, count - 1));
    if (count == 1) trust.noisy.push_back(text);
  }
};

void judge_spread(const Statistics& s, const std::string& what, double frame, Worst& worst) {
  if (s.count > 1 && s.median >= smallest_share * frame && s.p95 > 1.5 * s.median)
    worst.add(s.p95 / s.median, fmt::format("p95/median = {:.2f} in {}", s.p95 / s.median, what));
}

// The medians of the repeats of one run should agree.
void judge_repeats(const PassSummary& pass, const std::string& what, double frame, Worst& worst) {
  if (pass.per_repeat.size() < 2 || pass.gpu.median < compared_share * frame) return;
  const auto [low, high] = std::minmax_element(pass.per_repeat.begin(), pass.per_repeat.end());
  if (*high - *low > 3 * pass.gpu.mad && *high > 1.02 * *low)
    worst.add((*high - *low) / *low,
              fmt::format("the repeats' medians of {} differ: {:.3f} to {:.3f} ms, mad {:.3f} ms", what, *low, *high,
                          pass.gpu.mad));
}

}  // namespace

uint32_t Run::find_pass(const std::string& pass, uint32_t number, const char* kind, const char* description) {
  const std::string path = number > 1 ? fmt::format("{}#{}", pass, number) : pass;
  for (uint32_t i = 0; i < passes.size(); ++i)
    if (passes[i].path == path) return i;
  passes.push_back({path, kind, description, nullptr});
  return uint32_t(passes.size() - 1);
}

Summary summarise(const Run& run) {
  Summary out;
  for (uint32_t p = 0; p < run.passes.size(); ++p) {
    std::vector<const FrameSample*> frames;
    std::vector<double> gpu, record;
    for (const FrameSample& frame : run.frames)
      for (const PassSample& sample : frame.passes)
        if (sample.pass == p) {
          frames.push_back(&frame);
          gpu.push_back(sample.gpu_ms);
          record.push_back(sample.record_ms);
        }
    out.passes.push_back(summarise_rows(frames, gpu, record));
  }
  std::vector<const FrameSample*> frames;
  std::vector<double> gpu, cpu, wall, rest;
  for (const FrameSample& frame : run.frames) {
    double sum = 0;
    for (const PassSample& sample : frame.passes) sum += sample.gpu_ms;
    frames.push_back(&frame);
    gpu.push_back(frame.gpu_ms);
    cpu.push_back(frame.cpu_ms);
    wall.push_back(frame.wall_ms);
    rest.push_back(frame.gpu_ms - sum);
  }
  out.frame = summarise_rows(frames, gpu, cpu);
  out.wall = statistics(wall);
  out.unattributed = statistics(rest);
  return out;
}

Trust judge(const Run& run, const Summary& summary, const Circumstances& c) {
  Trust trust;
  if (c.software_device) trust.warnings.emplace_back("software device: these are CPU times");
  if (c.overlap)
    trust.warnings.emplace_back(
        c.software_device ? "overlap mode on a software device: time can be booked on a neighbouring pass"
                          : "overlap mode: passes may overlap, so their times need not add up to the frame's");
  if (!c.timestamps) trust.warnings.emplace_back("the device has no timestamps: there are no GPU times");
  if (c.debug_build) trust.noisy.emplace_back("debug build");
  if (c.validation) trust.noisy.emplace_back("validation is on");
  judge_load(c, trust);
  const double frame = summary.frame.gpu.median;
  Worst spread, repeats;
  judge_spread(summary.frame.gpu, "the frame", frame, spread);
  judge_repeats(summary.frame, "the frame", frame, repeats);
  for (size_t p = 0; p < summary.passes.size(); ++p) {
    judge_spread(summary.passes[p].gpu, run.passes[p].path, frame, spread);
    judge_repeats(summary.passes[p], run.passes[p].path, frame, repeats);
  }
  spread.tell(trust);
  repeats.tell(trust);
  return trust;
}

}  // namespace nf::capture
