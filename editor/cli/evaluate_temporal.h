// `nearfield evaluate --temporal`: what techniques do over time, by a fixed clock and a scripted camera.
#pragma once

#include "cli/evaluate.h"

namespace nf::editor {

// How long each part of a measurement is, in frames.
struct TemporalLengths {
  uint32_t own_mean;           // the technique's own mean, which frames are held against
  uint32_t convergence = 128;  // of each of `seeds` independent means; a power of two
  uint32_t seeds = 8;
  uint32_t before_jump = 48, after_jump = 48;
  uint32_t pan_warmup = 24, pan = 24;
  float pan_pixels = 0.1f;  // of a frame
};
TemporalLengths temporal_lengths(const EvaluateOptions& options);
// What is measured: "all", or a list. Throws nf::Error (Exit::Usage).
std::vector<std::string> temporal_parts(const std::string& list);

class Sequence;
// A place made ready.
class TemporalStage {
 public:
  TemporalStage(gpu::Device& device, const EvaluateOptions& options, const TemporalLengths& lengths, const Place& place,
                Notice notice);
  ~TemporalStage();
  TemporalStage(const TemporalStage&) = delete;
  TemporalStage& operator=(const TemporalStage&) = delete;
  // The row of a technique; null when interrupted.
  nlohmann::json measure(const Contender& contender);

 private:
  const EvaluateOptions& options_;
  const Place& place_;
  std::unique_ptr<Sequence> sequence_;
};

nlohmann::json temporal_json(const EvaluateOptions& options, const TemporalLengths& lengths,
                             const std::vector<nlohmann::json>& rows, const gpu::DeviceInfo& device, bool complete);
std::string temporal_markdown(const nlohmann::json& document);

}  // namespace nf::editor
