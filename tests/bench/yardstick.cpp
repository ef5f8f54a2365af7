// Times passes and the yardstick pass in one process, interleaved frame by frame, and prints medians and multiples:
//   yardstick SCENE [VIEW.json|"" [WxH [FRAMES [VARIANT...]]]]
// Without variants: all passes of the default frame. A variant is a technique and settings, as in
// "gtao,gi.slices=2,gtao.bent=false": only the technique's own passes are printed. Not a test: it asserts nothing.
#include <cstdio>
#include <map>
#include <sstream>

#include "capture/host.h"
#include "capture/statistics.h"
#include "frame.h"
#include "scene/gltf.h"
#include "scene/view.h"

using namespace nf;

namespace {

struct Variant {
  std::string label;
  passes::FrameSettings settings;
};

double cpu_ms() {
  return capture::own_cpu_seconds() * 1e3;
}

Variant parse_variant(const std::string& text) {
  Variant variant{text, {}};
  std::stringstream words(text);
  std::string word;
  std::getline(words, word, ',');
  variant.settings.technique = &passes::find_technique(word);
  while (std::getline(words, word, ',')) params::assign(variant.settings.blocks(), word);
  return variant;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) fail(Exit::Usage, "usage: yardstick SCENE [VIEW.json [WxH [FRAMES [VARIANT...]]]]");
  scene::Scene scene = scene::load_gltf(argv[1]);
  passes::FrameView view;
  view.size = {1280, 720};
  if (argc > 3 && std::sscanf(argv[3], "%ux%u", &view.size.x, &view.size.y) != 2) fail(Exit::Usage, "bad size");
  view.camera = view.previous_camera = scene::select_view(argc > 2 ? argv[2] : "", scene);
  const int frames = argc > 4 ? std::atoi(argv[4]) : 15, warmup = 3;

  gpu::Device device({});
  passes::Renderer renderer(device, scene);
  std::vector<Variant> variants;
  for (int i = 5; i < argc; ++i) variants.push_back(parse_variant(argv[i]));
  const bool whole_frame = variants.empty();
  variants.push_back(whole_frame ? Variant{"", {}} : parse_variant("none"));
  gpu::Pipelines pipelines(device, gpu::ShaderCompiler(NF_SOURCE_DIR "/tests/bench", {}), {});
  const gpu::Pipeline fill = pipelines.compute("fill.comp"), read = pipelines.compute("yardstick.comp");
  graph::Executor executor(device, pipelines);

  std::map<std::string, std::vector<double>> times;
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> cpu;  // of whole frames
  const auto note = [&](const graph::FrameResult& result, const std::string& label) {
    for (const graph::PassTime& pass : result.passes) {
      const bool own = label.empty() || label.substr(0, label.find(',')) + ".trace" == pass.name;
      if (!own) continue;
      const std::string name = label.empty() ? std::string(pass.name) : label;
      if (!times.count(name)) order.emplace_back(name);
      times[name].push_back(pass.ms);
    }
  };
  for (int i = 0; i < frames + warmup; ++i) {
    view.frame_index = uint32_t(i);
    for (const Variant& variant : variants) {
      const double before = cpu_ms();
      graph::Graph frame(renderer.executor().histories());
      const passes::FrameOutputs outputs = renderer.build(frame, view, variant.settings);
      frame.readback("readback", renderer.add_picture(frame, outputs, variant.settings));
      renderer.executor().run(frame);
      const graph::FrameResult result = renderer.executor().finish();
      if (i >= warmup) note(result, variant.label), cpu[variant.label].push_back(cpu_ms() - before);
    }
    const double before = cpu_ms();
    graph::Graph stick;
    const graph::Tex source = stick.image("source", {{view.size.x, view.size.y}, VK_FORMAT_R32_SFLOAT}),
                     target = stick.image("target", {{view.size.x, view.size.y}, VK_FORMAT_R32_SFLOAT});
    stick.compute("yardstick.fill", fill).out("target", source).over(source);
    stick.compute("yardstick", read).in("source", source).out("target", target).over(target);
    stick.readback("yardstick.readback", target);
    executor.run(stick);
    const graph::FrameResult result = executor.finish();
    if (i >= warmup) note(result, ""), cpu["yardstick"].push_back(cpu_ms() - before);
  }
  const capture::Statistics unit = capture::statistics(times["yardstick"]);
  std::printf("%s, %ux%u, %d frames, wall ms of passes (%s)\n", device.info.name.c_str(), view.size.x, view.size.y,
              frames, device.facts.software ? "CPU device" : "GPU");
  for (const std::string& name : order) {
    const capture::Statistics s = capture::statistics(times[name]);
    std::printf("  %-64s median %9.3f  mad %7.3f  = %6.2f yardsticks; least %9.3f = %6.2f\n", name.c_str(), s.median,
                s.mad, s.median / unit.median, s.min, s.min / unit.min);
  }
  if (!whole_frame) {
    const double rest = capture::statistics(cpu["none"]).median, stick = capture::statistics(cpu["yardstick"]).median;
    std::printf("CPU time per frame beyond that of `none`, in yardsticks of CPU time (%.1f ms):\n", stick);
    for (const Variant& variant : variants)
      std::printf("  %-64s %6.2f\n", variant.label.c_str(),
                  (capture::statistics(cpu[variant.label]).median - rest) / stick);
  }
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return int(e.exit());
}
