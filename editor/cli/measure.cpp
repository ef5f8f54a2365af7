// Blocks of frames in turn.
#include "cli/measure.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "cli/frames.h"
#include "scene/animation.h"

namespace nf::editor {
namespace {

double now_ns() {
  return double(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count());
}

nlohmann::json counts_json(const gpu::PassCounts& counts, graph::PassKind kind) {
  if (kind == graph::PassKind::Compute) return {{"compute_invocations", counts.compute_invocations}};
  return {{"vertices", counts.vertices},
          {"primitives", counts.primitives},
          {"vertex_invocations", counts.vertex_invocations},
          {"clipping_invocations", counts.clipped_in},
          {"clipping_primitives", counts.clipped_out},
          {"fragment_invocations", counts.fragment_invocations}};
}

}  // namespace

Meter::Meter(gpu::Device& device, scene::Scene& scene, passes::Renderer& renderer, const passes::FrameView& view,
             const MeasureOptions& options, const passes::Aov* layer)
    : scene_(scene), renderer_(renderer), view_(view), o_(options), layer_(layer) {
  if (const auto clocks = device.clocks()) clocks_ = *clocks;
}

// Each round gives every subject a block, in turn forwards and backwards: A B C, C B A. What grows slowly over the run
// then weighs on all of them alike.
std::vector<Meter::Block> Meter::order(size_t subjects) const {
  std::vector<Block> blocks;
  const uint32_t block = o_.interleave ? std::min(o_.block, o_.frames) : o_.frames;
  const uint32_t rounds = (o_.frames + block - 1) / block;
  const auto add = [&](size_t subject, uint32_t repeat, uint32_t round) {
    const uint32_t first = round * block;
    blocks.push_back({subject, repeat, first, std::min(block, o_.frames - first), 0, 0});
  };
  bool backwards = false;
  const auto add_round = [&](uint32_t repeat, uint32_t round) {
    for (size_t i = 0; i < subjects; ++i) add(backwards ? subjects - 1 - i : i, repeat, round);
    backwards = !backwards;
  };
  if (o_.interleave)
    for (uint32_t repeat = 0; repeat < o_.repeats; ++repeat)
      for (uint32_t round = 0; round < rounds; ++round) add_round(repeat, round);
  else
    for (size_t subject = 0; subject < subjects; ++subject)
      for (uint32_t repeat = 0; repeat < o_.repeats; ++repeat) add(subject, repeat, 0);
  std::vector<bool> warm(subjects, false);
  for (Block& b : blocks) {
    b.settle = warm[b.subject] ? std::min(o_.warmup, settle_frames) : o_.warmup;
    warm[b.subject] = true;
  }
  std::vector<bool> finished(subjects, false);
  for (auto b = blocks.rbegin(); b != blocks.rend(); ++b) {
    if (!finished[b->subject]) b->finish = std::max(o_.warmup, b->settle + b->count) - b->settle - b->count + 1;
    finished[b->subject] = true;
  }
  return blocks;
}

Measured Meter::run(const std::vector<Subject>& subjects, double timeout) {
  Measured out;
  out.runs.resize(subjects.size());
  out.last.resize(subjects.size());
  for (size_t i = 0; i < subjects.size(); ++i) {
    out.runs[i].name = subjects[i].name;
    out.runs[i].technique = subjects[i].settings.technique->id;
  }
  const std::vector<Block> blocks = order(subjects.size());
  done_ = total_ = 0;
  for (const Block& block : blocks) total_ += block.settle + block.count + block.finish;
  if (start_ns_ == 0) start_ns_ = now_ns();
  const double begin_ns = now_ns();
  for (const Block& block : blocks) {
    capture::Run& run = out.runs[block.subject];
    run_block(block, subjects[block.subject], run);
    const graph::Plan& plan = renderer_.executor().plan();
    run.memory = {{"placed_bytes", plan.placed_bytes},
                  {"max_live_bytes", plan.max_live_bytes},
                  {"unaliased_bytes", plan.unaliased_bytes}};
    if (block.finish && !interrupted()) out.last[block.subject] = take_last();
    if (interrupted()) {
      out.complete = false;
      break;
    }
    if (timeout > 0 && (now_ns() - begin_ns) * 1e-9 > timeout)
      fail(Exit::Gpu,
           "time limit: {} of {} frames after {} s; raise --timeout, or use a smaller --size or fewer frames", done_,
           total_, timeout);
  }
  return out;
}

void Meter::run_block(const Block& block, const Subject& subject, capture::Run& run) {
  renderer_.executor().invalidate_histories();  // another subject's past
  const uint32_t counted = block.settle + block.count, all = counted + block.finish;
  for (uint32_t i = 0; i < all && !interrupted(); ++i) {
    // Frame numbers go on from the warm-up's, and are the same in every repeat.
    const uint32_t n = o_.warmup + block.first + i - block.settle;
    run_frame(subject, n, i >= block.settle && i < counted ? &run : nullptr, block, block.finish && i + 1 == all);
  }
}

void Meter::run_frame(const Subject& subject, uint32_t n, capture::Run* run, const Block& block, bool last) {
  const double start = now_ns(), process_start = capture::own_cpu_seconds();
  const uint32_t counted = n >= o_.warmup ? n - o_.warmup : 0;
  view_.frame_index = n;
  renderer_.update(scene::animate(scene_, o_.time + (o_.fps > 0 ? n / o_.fps : 0)));
  if (o_.path)
    view_.camera = scene::camera_at(*o_.path, counted);
  else if (view_.camera.node != scene::none)
    scene::place(scene_.nodes.world[view_.camera.node], view_.camera);
  if (n == 0) view_.previous_camera = view_.camera;
  graph::Graph graph(renderer_.executor().histories());
  const passes::FrameOutputs outputs = renderer_.build(graph, view_, subject.settings);
  graph.readback("readback.picture", renderer_.add_picture(graph, outputs, subject.settings));
  if (last && layer_) {
    const graph::Tex layer = renderer_.add_layer(graph, outputs, *layer_);
    if (layer) graph.readback("readback.layer", layer);
  }
  const double built_ms = (now_ns() - start) * 1e-6;
  renderer_.executor().run(graph, {.timing = o_.timing,
                                   .counts = o_.counts,
                                   .slow_pass = o_.slow_pass.empty() ? nullptr : o_.slow_pass.c_str(),
                                   .slow_share = o_.slow_share});
  view_.previous_camera = view_.camera;
  const graph::FrameResult result = renderer_.executor().finish();
  if (run) {
    keep(result, built_ms + result.record_ms, block, n - o_.warmup, *run);
    run->frames.back().process_ms = (capture::own_cpu_seconds() - process_start) * 1e3;
  }
  ++done_;
  if (on_progress) on_progress(done_, total_, result.frame_ms);
}

void Meter::keep(const graph::FrameResult& result, double cpu_ms, const Block& block, uint32_t n, capture::Run& run) {
  capture::FrameSample frame{
      .repeat = block.repeat,
      .frame = n,
      .submit_ns = int64_t(result.submit_ns - start_ns_),
      .gpu_begin_ns = int64_t(result.gpu_begin_ns - clocks_.device_ns + clocks_.host_ns - start_ns_),
      .gpu_ms = result.frame_ms,
      .wall_ms = result.wall_ms,
      .cpu_ms = cpu_ms,
      .passes = {}};
  std::map<std::string_view, uint32_t> numbers;
  for (const graph::PassTime& pass : result.passes) {
    const uint32_t row = run.find_pass(pass.name, ++numbers[pass.name], graph::kind_name(pass.kind), pass.description);
    frame.passes.push_back({row, pass.begin_ms, pass.ms, pass.record_ms});
    if (pass.counts) run.passes[row].counts = counts_json(*pass.counts, pass.kind);
  }
  run.frames.push_back(std::move(frame));
  if (on_frame) on_frame(run, run.frames.back());
}

LastFrame Meter::take_last() {
  const std::vector<graph::Readback> readbacks = renderer_.executor().take_readbacks();
  LastFrame last{to_image8(readbacks.front()), {}};
  if (readbacks.size() > 1) last.layer = to_layer(*layer_, readbacks[1]).image;
  return last;
}

}  // namespace nf::editor
