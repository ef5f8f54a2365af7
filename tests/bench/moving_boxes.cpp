// CPU time of a frame of 10,000 (or argv[1]) moving boxes, part by part: transforms, table writes, culling and draw
// lists, planning and recording. The frame itself is small and without GI.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <unistd.h>

#include "builder.h"
#include "capture/statistics.h"
#include "frame.h"
#include "scene/animation.h"
#include "scene/gltf.h"

namespace {

using namespace nf;
using glm::vec3;

scene::Scene boxes(uint32_t count) {
  content::Builder b;
  const auto grey = b.material({.base_color = vec3(0.5f)});
  const uint32_t side = uint32_t(std::ceil(std::sqrt(float(count))));
  const auto at = [&](uint32_t i) {
    return content::Placement{.translation =
                                  vec3(float(i % side), 0, float(i / side)) - 0.5f * vec3(float(side), 0, float(side))};
  };
  const auto first = b.object("box", at(0));
  b.box(vec3(0), vec3(0.3f), 0, grey);
  for (uint32_t i = 1; i < count; ++i) b.copy("box", first, at(i));
  b.directional_light({0.3f, -1, 0.2f}, 3);
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("nf_moving_boxes_{}.glb", getpid());
  b.save(path);
  scene::Scene scene = scene::load_gltf(path);
  std::filesystem::remove(path);
  return scene;
}

}  // namespace

int main(int argc, char** argv) try {
  const uint32_t count = argc > 1 ? uint32_t(std::max(std::atoi(argv[1]), 1)) : 10000;
  constexpr int frames = 40, warmup = 5;
  scene::Scene scene = boxes(count);
  gpu::Device device({});
  passes::Renderer renderer(device, scene);
  passes::FrameSettings settings;
  settings.technique = &passes::find_technique("none");
  settings.shadow.resolution = 64;
  passes::FrameView view;
  view.size = {64, 36};
  view.camera.position = vec3(0, 0.5f * std::sqrt(float(count)), 0.7f * std::sqrt(float(count)));
  view.camera.forward = -glm::normalize(view.camera.position);
  view.previous_camera = view.camera;

  const char* const parts[] = {"transforms (update)", "tables (Renderer::update)", "culling, draw lists, graph (build)",
                               "plan, record, submit (run)"};
  std::vector<double> times[std::size(parts) + 1];
  for (int frame = 0; frame < frames + warmup; ++frame) {
    view.frame_index = uint32_t(frame);
    const glm::quat turned = glm::angleAxis(0.01f * float(frame), vec3(0, 1, 0));
    for (uint32_t i = 0; i < scene.nodes.size(); ++i)
      scene::set_local(scene.nodes, i, scene.nodes.translation[i], turned, vec3(1));
    double total = 0;
    size_t part = 0;
    const auto timed = [&](const auto& work) {
      const auto start = std::chrono::steady_clock::now();
      work();
      const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      total += ms;
      if (frame >= warmup) times[part].push_back(ms);
      ++part;
    };
    scene::Changes changes;
    graph::Graph graph(renderer.executor().histories());
    timed([&] { changes = scene::update(scene); });
    timed([&] { renderer.update(changes); });
    timed([&] {
      const passes::FrameOutputs outputs = renderer.build(graph, view, settings);
      graph.readback("readback", renderer.add_picture(graph, outputs, settings));
    });
    timed([&] { renderer.executor().run(graph, {.timing = gpu::Timing::Overlap}); });
    renderer.executor().finish();
    if (frame >= warmup) times[std::size(parts)].push_back(total);
  }
  std::printf(
      "%u moving boxes, %u drawn in %zu batches for the camera, and for the shadow maps; median ms of %d frames\n",
      count, renderer.draws(), renderer.batches(), frames);
  for (size_t i = 0; i <= std::size(parts); ++i) {
    const capture::Statistics s = capture::statistics(times[i]);
    std::printf("  %-36s %8.3f  mad %.3f\n", i < std::size(parts) ? parts[i] : "all", s.median, s.mad);
  }
  return 0;
} catch (const nf::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return int(e.exit());
}
