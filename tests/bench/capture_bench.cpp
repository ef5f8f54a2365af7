// How far timestamps can be trusted: a pass with a loop of known length against its time (least squares), the frame's
// GPU time against submit-to-fence wall time, and what no pass accounts for: capture_bench [FRAMES]. Not a test.
#include <algorithm>
#include <cstdio>
#include <map>

#include "capture/host.h"
#include "capture/statistics.h"
#include "graph/executor.h"

using namespace nf;

#define NF_LOOP_PARAMS(P) P(Int, iterations, 100, 0, 1000000, "", "Rounds of the loop")
NF_DECLARE_PARAMS(LoopParams, "loop", NF_LOOP_PARAMS)

int main(int argc, char** argv) try {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 60;
  gpu::Device device({});
  gpu::ShaderCompiler compiler(NF_SOURCE_DIR "/tests/bench", {});
  compiler.add_table(LoopParams::table());
  gpu::Pipelines pipelines(device, std::move(compiler), {});
  const gpu::Pipeline loop = pipelines.compute("loop.comp");
  graph::Executor executor(device, pipelines);
  const std::vector<int> steps = {50, 100, 200, 300, 400, 600, 800};
  std::map<int, std::vector<double>> times;
  std::vector<double> rest, gap;
  const capture::LoadWatch watch;
  for (int frame = -5; frame < frames; ++frame) {
    graph::Graph graph;
    for (const int iterations : steps) {
      const graph::Tex target = graph.image("target", {{640, 360}, VK_FORMAT_R32_SFLOAT});
      graph.compute("loop", loop).out("target", target).params(LoopParams{.iterations = iterations}).over(target);
      graph.readback("readback", target);
    }
    executor.run(graph);
    const graph::FrameResult result = executor.finish();
    if (frame < 0) continue;
    double sum = 0;
    size_t step = 0;
    for (const graph::PassTime& pass : result.passes) {
      sum += pass.ms;
      if (pass.kind == graph::PassKind::Compute) times[steps[step++]].push_back(pass.ms);
    }
    rest.push_back(100 * (result.frame_ms - sum) / result.frame_ms);
    gap.push_back(100 * (result.wall_ms - result.frame_ms) / result.wall_ms);
  }
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (const auto& [iterations, samples] : times) {
    const double x = iterations, y = capture::statistics(samples).median;
    std::printf("  %4d rounds  median %8.3f ms\n", iterations, y);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y;
  }
  const double cov = n * sxy - sx * sy, slope = cov / (n * sxx - sx * sx);
  std::printf("ms = %.5f * rounds %+.3f, R2 = %.6f\n", slope, (sy - slope * sx) / n,
              cov * cov / ((n * sxx - sx * sx) * (n * syy - sy * sy)));
  const capture::Statistics r = capture::statistics(rest), g = capture::statistics(gap);
  std::printf("unattributed: median %.2f %% of the frame, p95 %.2f %%\n", r.median, r.p95);
  std::printf("submit to fence against GPU time: median %.2f %%, p95 %.2f %%\n", g.median, g.p95);
  std::printf("%d frames on %s; other processes used %.2f cores\n", frames, device.info.name.c_str(),
              watch.load().others);
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return int(e.exit());
}
