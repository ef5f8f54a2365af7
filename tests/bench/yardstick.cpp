// Times the frame of a scene and the yardstick pass in one process, interleaved frame by frame, and prints medians and
// multiples: yardstick SCENE [VIEW.json] [FRAMES]. Not a test: it asserts nothing.
#include <cstdio>
#include <map>

#include "capture/statistics.h"
#include "frame.h"
#include "scene/gltf.h"
#include "scene/view.h"

using namespace nf;

int main(int argc, char** argv) try {
  if (argc < 2) fail(Exit::Usage, "usage: yardstick SCENE [VIEW.json] [FRAMES]");
  scene::Scene scene = scene::load_gltf(argv[1]);
  passes::FrameView view;
  view.size = {1280, 720};
  view.camera = view.previous_camera = scene::select_view(argc > 2 ? argv[2] : "", scene);
  const int frames = argc > 3 ? std::atoi(argv[3]) : 15, warmup = 3;

  gpu::Device device({});
  passes::Renderer renderer(device, scene);
  const passes::FrameSettings settings;
  gpu::Pipelines pipelines(device, gpu::ShaderCompiler(NF_SOURCE_DIR "/tests/bench", {}), {});
  const gpu::Pipeline fill = pipelines.compute("fill.comp"), read = pipelines.compute("yardstick.comp");
  graph::Executor executor(device, pipelines);

  std::map<std::string, std::vector<double>> times;
  std::vector<std::string> order;
  const auto note = [&](const graph::FrameResult& result) {
    for (const graph::PassTime& pass : result.passes) {
      if (!times.count(pass.name)) order.emplace_back(pass.name);
      times[pass.name].push_back(pass.ms);
    }
  };
  for (int i = 0; i < frames + warmup; ++i) {
    view.frame_index = uint32_t(i);
    graph::Graph frame(renderer.executor().histories());
    const passes::FrameOutputs outputs = renderer.build(frame, view, settings);
    frame.readback("readback", renderer.add_picture(frame, outputs, settings));
    renderer.executor().run(frame);
    const graph::FrameResult a = renderer.executor().finish();

    graph::Graph stick;
    const graph::Tex source = stick.image("source", {{1280, 720}, VK_FORMAT_R32_SFLOAT}),
                     target = stick.image("target", {{1280, 720}, VK_FORMAT_R32_SFLOAT});
    stick.compute("yardstick.fill", fill).out("target", source).over(source);
    stick.compute("yardstick", read).in("source", source).out("target", target).over(target);
    stick.readback("yardstick.readback", target);
    executor.run(stick);
    const graph::FrameResult b = executor.finish();
    if (i >= warmup) note(a), note(b);
  }
  const double unit = capture::statistics(times["yardstick"]).median;
  std::printf("%s, 1280x720, %d frames, wall ms of passes (%s)\n", device.info.name.c_str(), frames,
              device.facts.software ? "CPU device" : "GPU");
  for (const std::string& name : order) {
    const capture::Statistics s = capture::statistics(times[name]);
    std::printf("  %-24s median %9.3f  mad %7.3f  = %6.2f yardsticks\n", name.c_str(), s.median, s.mad,
                s.median / unit);
  }
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return int(e.exit());
}
