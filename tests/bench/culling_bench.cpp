// What a frame's work on the scene tables costs on the CPU: culling of 1k, 10k and 100k boxes (objects per ms), and the
// transform update of as many moving ones.
#include <benchmark/benchmark.h>
#include <cmath>

#include "scene/animation.h"
#include "scene/camera.h"
#include "scene/culling.h"

namespace {

using namespace nf::scene;

// Boxes on a square lattice around the origin, a node each.
Scene lattice(uint32_t count) {
  Scene scene;
  scene.geometry.position = {vec3(0)};
  scene.primitives.push_back({.bounds = {vec3(-0.3f), vec3(0.3f)}});
  const uint32_t side = uint32_t(std::ceil(std::sqrt(float(count))));
  Nodes& nodes = scene.nodes;
  for (uint32_t i = 0; i < count; ++i) {
    const vec3 at = vec3(float(i % side), 0, float(i / side)) - vec3(float(side) / 2, 0, float(side) / 2);
    nodes.parent.push_back(none);
    nodes.translation.push_back(at);
    nodes.rotation.emplace_back(1, 0, 0, 0);
    nodes.scale.emplace_back(1);
    nodes.local_matrix.push_back(compose(at, nodes.rotation[i], vec3(1)));
    nodes.name.emplace_back();
    scene.instances.node.push_back(i);
    scene.instances.primitive.push_back(0);
    scene.instances.skin.push_back(none);
  }
  nodes.world.resize(count);
  nodes.previous_world.resize(count);
  nodes.first_weight.resize(count);
  nodes.weight_count.resize(count);
  nodes.touched.resize(count);
  nodes.moved.resize(count);
  scene.instances.center.resize(count);
  scene.instances.extent.resize(count);
  scene.instances.mirrored.resize(count);
  update_transforms(scene);
  return scene;
}

Frustum middle_frustum() {
  Camera camera;
  camera.position = vec3(0, 5, 0);
  camera.forward = glm::normalize(vec3(1, -0.3f, 0.4f));
  return frustum_from_clip(clip_from_view(camera, {1280, 720}) * view_from_world(camera));
}

void report(benchmark::State& state, double objects) {
  state.counters["objects/ms"] =
      benchmark::Counter(objects * double(state.iterations()) / 1000, benchmark::Counter::kIsRate);
}

void cull_boxes(benchmark::State& state) {
  const Scene scene = lattice(uint32_t(state.range(0)));
  const Frustum frustum = middle_frustum();
  std::vector<uint32_t> visible;
  for (auto _ : state) {
    visible.clear();
    cull(frustum, scene.instances.center, scene.instances.extent, visible);
    benchmark::DoNotOptimize(visible.data());
  }
  state.counters["visible"] = double(visible.size());
  report(state, double(scene.instances.size()));
}

void turn(Scene& scene, uint32_t step, uint32_t frame) {
  const quat rotation = glm::angleAxis(0.01f * float(frame), vec3(0, 1, 0));
  for (uint32_t i = 0; i < scene.nodes.size(); i += step) {
    set_local(scene.nodes, i, scene.nodes.translation[i], rotation, vec3(1));
  }
}

// range(1): every how many boxes one moves.
void move_boxes(benchmark::State& state) {
  Scene scene = lattice(uint32_t(state.range(0)));
  uint32_t frame = 0;
  for (auto _ : state) {
    turn(scene, uint32_t(state.range(1)), ++frame);
    benchmark::DoNotOptimize(update(scene));
  }
  report(state, double(scene.instances.size()));
}

void move_and_cull(benchmark::State& state) {
  Scene scene = lattice(uint32_t(state.range(0)));
  const Frustum frustum = middle_frustum();
  std::vector<uint32_t> visible;
  uint32_t frame = 0;
  for (auto _ : state) {
    turn(scene, 1, ++frame);
    update(scene);
    visible.clear();
    cull(frustum, scene.instances.center, scene.instances.extent, visible);
    benchmark::DoNotOptimize(visible.data());
  }
  report(state, double(scene.instances.size()));
}

BENCHMARK(cull_boxes)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK(move_boxes)->Args({10000, 1})->Args({10000, 100})->Args({100000, 1})->Unit(benchmark::kMicrosecond);
BENCHMARK(move_and_cull)->Arg(10000)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
