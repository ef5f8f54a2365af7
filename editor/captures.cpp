#include "captures.h"

#include <algorithm>
#include <ctime>
#include <imgui.h>

#include "capture/csv.h"
#include "capture/trace.h"
#include "cli/measure.h"
#include "core/log.h"
#include "image/image.h"
#include "settings.h"
#include "state.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string file_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", &parts);
  return text;
}

std::string new_file(const std::string& name) {
  fs::create_directories("captures");
  return (fs::path("captures") / name).string();
}

image::Image8 opaque(glm::uvec2 size, std::span<const uint8_t> rgba) {
  image::Image8 out{size.x, size.y, 3, {}};
  for (size_t i = 0; i + 3 < rgba.size(); i += 4) out.pixels.insert(out.pixels.end(), &rgba[i], &rgba[i] + 3);
  return out;
}

void capture_timings(Editor& e, bool validation) {
  capture::Run& run = e.timings.run;
  if (run.frames.empty()) return toast(e, "no frame was timed yet", true);
  const std::string folder = new_file("timing-" + file_time());
  fs::create_directories(folder);
  run.name = run.technique = e.document.settings.technique->id;
  passes::FrameView view;
  view.size = e.picture.size;
  view.seed = e.document.seed;
  run.settings = settings_json({.name = run.name,
                                .settings = e.document.settings,
                                .mode = is_paper_mode(e.document.settings) ? "paper" : "radiometric"},
                               view);
  run.scene = {{"path", e.scene.path}, {"triangles", e.scene.triangles}};
  run.memory = {
      {"placed_bytes", e.graph.placed}, {"max_live_bytes", e.graph.max_live}, {"unaliased_bytes", e.graph.unaliased}};
  const capture::Summary summary = capture::summarise(run);
  capture::Trust trust = capture::judge(
      run, summary,
      {.load = {}, .software_device = e.software, .debug_build = build_info().debug, .validation = validation});
  trust.noisy.push_back("captured in the editor: its own frames ran beside these");
  const std::vector<capture::RunResult> results{{&run, summary, trust}};
  json context = e.device_context;
  context["ui"] = true;
  const json method = {{"timing", "serialize"},
                       {"frames", run.frames.size()},
                       {"warmup_frames", 0},
                       {"settle_frames", 0},
                       {"repeats", 1},
                       {"interleaved", false},
                       {"percentile", "nearest-rank"},
                       {"clock", "gpu-timestamps"},
                       {"frames_in_flight", 1},
                       {"fps", 0},
                       {"path", nullptr}};
  write_atomically(fs::path(folder) / "timing.json",
                   capture::timing_document(context, method, results, true).dump(1) + "\n");
  write_atomically(fs::path(folder) / "summary.csv", capture::summary_csv(results));
  capture::FramesCsv frames(fs::path(folder) / "frames.csv");
  for (const capture::FrameSample& sample : run.frames) frames.add(run, sample);
  capture::Run shifted = run;  // a trace begins near zero
  const int64_t first = run.frames.front().submit_ns;
  for (capture::FrameSample& sample : shifted.frames) sample.submit_ns -= first, sample.gpu_begin_ns = sample.submit_ns;
  write_atomically(fs::path(folder) / "trace.json",
                   capture::trace_document({&shifted}, {{"device", e.device}}, false).dump() + "\n");
  toast(e, "written: " + folder);
}

}  // namespace

void write_window(const std::string& path, const Editor& e, std::span<const std::byte> window, glm::ivec4 part) {
  const glm::ivec2 limit(e.window), low = glm::clamp(glm::ivec2(part), glm::ivec2(0), limit - 1),
                                    high = glm::clamp(glm::ivec2(part) + glm::ivec2(part.z, part.w), low + 1, limit);
  image::Image8 out{uint32_t(high.x - low.x), uint32_t(high.y - low.y), 3, {}};
  for (int y = low.y; y < high.y; ++y)
    for (int x = low.x; x < high.x; ++x)
      for (size_t c = 0; c < 3; ++c)
        out.pixels.push_back(uint8_t(window[(size_t(y) * e.window.x + size_t(x)) * 4 + c]));
  image::write_png(path, out);
}

void write_captures(Editor& e, std::span<const std::byte> window_texels, bool validation) {
  try {
    if (!e.save_preset.empty()) {
      const std::string path = std::exchange(e.save_preset, {});
      write_preset(path, make_preset(e));
      e.preset_path = path;
      toast(e, "saved: " + path);
    }
    const bool window = std::exchange(e.screenshot_window, false),
               viewport = std::exchange(e.screenshot_viewport, false);
    if (window || viewport) {
      const std::string path = new_file(fmt::format("{}-{}.png", window ? "window" : "picture", file_time()));
      if (window)
        write_window(path, e, window_texels, {0, 0, int(e.window.x), int(e.window.y)});
      else if (!e.picture.floats.empty())
        save_pixels(path, e.picture, e.viewport.look);
      else
        image::write_png(path, opaque(e.picture.size, e.pictures->texels(ui::PictureId::Scene)));
      write_preset(fs::path(path).replace_extension(".json"), make_preset(e));
      toast(e, "written: " + path);
    }
    if (std::exchange(e.save_curve, false)) {
      std::string text = "spp,rmse,noise\n";
      for (const ReferenceView::Point& p : e.reference.curve) text += fmt::format("{},{},{}\n", p.spp, p.rmse, p.floor);
      const std::string path = new_file(fmt::format("convergence-{}.csv", file_time()));
      write_atomically(path, text);
      toast(e, "written: " + path);
    }
    if (std::exchange(e.capture_asked, false)) capture_timings(e, validation);
    if (std::exchange(e.slices.save_asked, false) && e.slices.seen) {
      json document = to_json(*e.slices.seen);
      document["params"] = params::to_json(e.document.settings.blocks());
      const std::string path = new_file(fmt::format("inspection-{}.json", file_time()));
      write_atomically(path, document.dump(1) + "\n");
      toast(e, "written: " + path);
    }
    if (std::exchange(e.save_layers, false))
      e.outbox.push_back({live::CommandKind::SaveLayers, new_file(fmt::format("layers-{}.exr", file_time())), {}, {}});
    if (!e.save_texture.empty()) {
      const std::string ending = std::exchange(e.save_texture, {});
      const live::Pixels& p = e.texture.pixels;
      std::string name = p.name;
      std::replace(name.begin(), name.end(), '/', '_');
      const std::string path = new_file(fmt::format("{}-{}{}", name, file_time(), ending));
      save_pixels(path, p, e.texture.look);
      toast(e, "written: " + path);
    }
  } catch (const std::exception& error) {
    toast(e, error.what(), true);
  }
  if (std::exchange(e.copy_command, false)) {
    try {
      const fs::path preset = fs::absolute(new_file(fmt::format("command-{}.json", file_time())));
      write_preset(preset, make_preset(e));
      const std::string command = command_for(e, preset);
      ImGui::SetClipboardText(command.c_str());
      log::info("{}", command);
      toast(e, "copied: " + command);
    } catch (const std::exception& error) {
      toast(e, error.what(), true);
    }
  }
}

}  // namespace nf::editor
