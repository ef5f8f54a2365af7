// What the frame graph costs on the CPU: building the real frame's graph, hashing it, and compiling made-up frames of
// 10 to 1,000 passes from cold. Prints figures; nothing is asserted.
#include <benchmark/benchmark.h>
#include <deque>
#include <filesystem>
#include <random>

#include "core/log.h"
#include "frame.h"
#include "graph/hazards.h"
#include "scene/gltf.h"
#include "scene/view.h"

namespace nf::graph {
namespace {

// Each pass reads one to four of the last eight results and writes one; every eighth draws to two targets and depth.
struct MadeUp {
  explicit MadeUp(int passes) : shader{.slots = {}, .color_outputs = {"color0", "color1"}} {
    for (int i = 0; i < 4; ++i)
      shader.slots.push_back({.name = inputs[size_t(i)], .kind = gpu::SlotKind::SampledImage});
    shader.slots.push_back({.name = "out", .kind = gpu::SlotKind::StorageImage, .writeonly = true});
    for (int i = 0; i < passes; ++i) names.push_back("pass" + std::to_string(i));
  }
  Graph build() const {
    Graph graph;
    std::mt19937 random(7);
    const gpu::Pipeline pipeline{gpu::PipelineId{1}, &shader};
    std::vector<Tex> made;
    for (size_t i = 0; i < names.size(); ++i) {
      const char* name = names[i].c_str();
      const uint32_t scale = 1u << random() % 3;
      const ImageDesc desc{{1920 / scale, 1080 / scale},
                           random() % 2 ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32_SFLOAT};
      const Tex out = graph.image(name, desc);
      const bool draws = i % 8 == 0;
      PassBuilder pass = draws ? graph.raster(name, pipeline) : graph.compute(name, pipeline);
      for (size_t k = 0; k < std::min<size_t>(made.size(), 1 + random() % 4); ++k)
        pass.in(inputs[k], made[made.size() - 1 - (random() % std::min<size_t>(made.size(), 8))]);
      if (draws) {
        const Tex second = graph.image(name, desc), depth = graph.image(name, {desc.size, VK_FORMAT_D32_SFLOAT});
        pass.out("color0", out, {0, 0, 0, 0}).out("color1", second, {0, 0, 0, 0}).depth(depth, 0.0f);
        made.push_back(second);
      } else {
        pass.out("out", out).over(out);
      }
      made.push_back(out);
    }
    graph.readback("last", made.back());
    return graph;
  }
  static constexpr const char* inputs[4] = {"in0", "in1", "in2", "in3"};
  gpu::ShaderInterface shader;
  std::deque<std::string> names;
};

void build_graph(benchmark::State& state) {
  const MadeUp frame(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(frame.build());
}
void hash_graph(benchmark::State& state) {
  const Graph graph = MadeUp(int(state.range(0))).build();
  for (auto _ : state) benchmark::DoNotOptimize(topology_hash(graph));
}
void compile_cold(benchmark::State& state) {
  const Graph graph = MadeUp(int(state.range(0))).build();
  Plan plan;
  for (auto _ : state) benchmark::DoNotOptimize(plan = compile(graph));
  state.counters["passes"] = double(plan.passes.size());
  state.counters["barriers"] = double(plan.barriers.size());
  state.counters["placed/bound"] = double(plan.placed_bytes) / double(plan.max_live_bytes);
  state.SetComplexityN(int64_t(plan.passes.size()));
}
void check_hazards(benchmark::State& state) {
  const Graph graph = MadeUp(int(state.range(0))).build();
  const Plan plan = compile(graph);
  for (auto _ : state) benchmark::DoNotOptimize(find_hazards(graph, plan));
}

#define NF_SIZES ->Arg(10)->Arg(40)->Arg(200)->Arg(1000)->Unit(benchmark::kMicrosecond)
BENCHMARK(build_graph) NF_SIZES;
BENCHMARK(hash_graph) NF_SIZES;
BENCHMARK(compile_cold) NF_SIZES->Complexity();
BENCHMARK(check_hazards) NF_SIZES;

// The real frame on the bundled scene: what a frame whose plan is kept costs before recording.
struct Real {
  gpu::Device device{gpu::DeviceOptions{}};
  scene::Scene scene = scene::load_gltf(std::filesystem::path(NF_BINARY_DIR) / "content" / "cornell.glb");
  passes::Renderer renderer{device, scene};
  passes::FrameSettings settings;
  passes::FrameView view;
  Real() {
    view.size = {1920, 1080};
    view.camera = view.previous_camera = scene::select_view("", scene);
  }
  Graph build() {
    Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("picture", renderer.add_picture(graph, out, settings));
    return graph;
  }
};
Real& real() {
  static Real* frame = new Real;  // lives until the process ends: a device must not be destroyed by a static object
  return *frame;
}

void real_build(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(real().build());
}
void real_hash(benchmark::State& state) {
  const Graph graph = real().build();
  for (auto _ : state) benchmark::DoNotOptimize(topology_hash(graph));
}
void real_cached_frame(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(topology_hash(real().build()));
}
void real_compile(benchmark::State& state) {
  const Graph graph = real().build();
  for (auto _ : state) benchmark::DoNotOptimize(real().renderer.executor().plan_for(graph));
}
BENCHMARK(real_build)->Unit(benchmark::kMicrosecond);
BENCHMARK(real_hash)->Unit(benchmark::kMicrosecond);
BENCHMARK(real_cached_frame)->Unit(benchmark::kMicrosecond);
BENCHMARK(real_compile)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace nf::graph

BENCHMARK_MAIN();
