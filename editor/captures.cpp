#include "captures.h"

#include <algorithm>
#include <ctime>
#include <imgui.h>
#include <set>

#include "capture/csv.h"
#include "capture/trace.h"
#include "cli/measure.h"
#include "core/log.h"
#include "image/image.h"
#include "look.h"
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

// A path that nothing stands at yet, nor beside it what tells how it was made, nor was it given before: two shots in a
// second are two files.
std::string new_file(const std::string& stem, const std::string& ending) {
  static std::set<std::string> given;
  fs::create_directories("captures");
  for (int n = 1;; ++n) {
    const fs::path base =
        fs::path("captures") / fmt::format("{}-{}{}", stem, file_time(), n > 1 ? fmt::format("-{}", n) : "");
    const std::string path = base.string() + ending;
    if (!fs::exists(path) && !fs::exists(base.string() + ".json") && given.insert(base.string()).second) return path;
  }
}

// The preset of frames that are seen now, whatever the panels say by now.
Preset preset_of(Editor& e, const live::MadeWith& made_with) {
  Preset preset = make_preset(e);
  passes::FrameSettings settings = made_with.settings;
  preset.technique = settings.technique->id;
  preset.params = params::to_json(settings.blocks());
  preset.size = fmt::format("{}x{}", made_with.size.x, made_with.size.y);
  preset.seed = made_with.seed;
  if (auto* view = preset.view ? std::get_if<scene::View>(&*preset.view) : nullptr) view->camera = made_with.camera;
  return preset;
}

// Beside a picture: the preset, and what made it.
void write_sidecar(const Editor& e, const fs::path& path, Preset preset, json more = json::object()) {
  const BuildInfo build = build_info();
  more["file"] = path.filename().string();
  more["date"] = capture::utc_date();
  more["frame"] = e.scene_frames;
  if (e.freeze.any()) more["frozen"] = text_of(e.freeze);
  more["app"] = {{"version", build.version}, {"git", build.git}, {"build", build.type}, {"compiler", build.compiler}};
  if (const auto device = e.device_context.find("device"); device != e.device_context.end()) more["device"] = *device;
  preset.made = std::move(more);
  write_preset(fs::path(path).replace_extension(".json"), preset);
}

image::Image8 opaque(glm::uvec2 size, std::span<const uint8_t> rgba) {
  image::Image8 out{size.x, size.y, 3, {}};
  for (size_t i = 0; i + 3 < rgba.size(); i += 4) out.pixels.insert(out.pixels.end(), &rgba[i], &rgba[i] + 3);
  return out;
}

// The last frames, and the passes that they have in the order they run: one that came later was added behind the
// others.
capture::Run last_frames(const TimingHistory& history, size_t most) {
  capture::Run run = history.run;
  if (run.frames.size() > most) run.frames.erase(run.frames.begin(), run.frames.end() - long(most));
  std::vector<uint32_t> moved_to(run.passes.size(), 0);
  std::set<uint32_t> seen;
  for (const capture::FrameSample& frame : run.frames)
    for (const capture::PassSample& pass : frame.passes) seen.insert(pass.pass);
  run.passes.clear();
  for (const TimingHistory::Row& row : history.rows)
    for (uint32_t p = 0; p < history.run.passes.size(); ++p)
      if (seen.count(p) && history.run.passes[p].path == row.name) {
        moved_to[p] = uint32_t(run.passes.size());
        run.passes.push_back(history.run.passes[p]);
      }
  for (capture::FrameSample& frame : run.frames)
    for (capture::PassSample& pass : frame.passes) pass.pass = moved_to[pass.pass];
  return run;
}

void capture_timings(Editor& e, bool validation) {
  const TimingHistory& t = e.timings;
  if (t.run.frames.empty()) return toast(e, "no frame was timed yet", true);
  const std::string folder = new_file("timing", "");
  fs::create_directories(folder);
  capture::Run run = last_frames(t, size_t(e.preferences.capture_frames));
  passes::FrameSettings settings = t.made_with.settings;
  run.name = run.technique = settings.technique->id;
  passes::FrameView view;
  view.size = t.made_with.size;
  view.seed = t.made_with.seed;
  run.settings = settings_json(
      {.name = run.name, .settings = settings, .mode = is_paper_mode(settings) ? "paper" : "radiometric"}, view);
  const std::string preset = (fs::path(folder) / "preset.json").string();
  write_preset(preset, preset_of(e, t.made_with));
  run.scene = scene_json(e.scene.path, preset, e.scene.triangles, t.made_with.lights);
  const capture::HostLoad load = t.load.load();
  const capture::Summary summary = capture::summarise(run);
  capture::Trust trust = capture::judge(
      run, summary,
      {.load = load, .software_device = e.software, .debug_build = build_info().debug, .validation = validation});
  trust.noisy.push_back("captured in the editor: its own frames ran beside these");
  const std::vector<capture::RunResult> results{{&run, summary, trust}};
  json context = e.device_context;
  context["ui"] = true;
  context["date"] = capture::utc_date();
  context["host"]["load_avg_start"] = load.average_start;
  context["host"]["load_avg_end"] = load.average_end;
  context["host"]["other_processes_cores"] = load.others;
  const json method = method_json({.frames = uint32_t(run.frames.size()),
                                   .warmup = 0,
                                   .repeats = 1,
                                   .interleave = false,
                                   .fps = 0,
                                   .path = {},
                                   .slow_pass = {}});
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
  e.captured = fs::absolute(folder).string();
  toast(e, "written: " + folder);
}

// The renderer goes on until there are as many frames as are wanted. Asked once more, or where no frame will come, what
// there is has to do.
void record_timings(Editor& e, bool validation) {
  const bool asked = std::exchange(e.capture_asked, false),
             still = e.timings.paused || e.wanted.paused || e.device_lost;
  if (!asked && !e.recording) return;
  const bool enough = e.timings.run.frames.size() >= size_t(e.preferences.capture_frames);
  if (!enough && !still && !(asked && e.recording)) {
    e.recording = true;
    return;
  }
  e.recording = false;
  capture_timings(e, validation);
}

}  // namespace

void take_saved(Editor& e, const std::string& path, const live::MadeWith& made_with) {
  try {
    write_sidecar(e, path, preset_of(e, made_with));
    toast(e, "written: " + path);
  } catch (const std::exception& error) {
    toast(e, error.what(), true);
  }
}

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
      const std::string path = new_file(window ? "window" : "picture", ".png");
      if (window)
        write_window(path, e, window_texels, {0, 0, int(e.window.x), int(e.window.y)});
      else if (!e.picture.floats.empty())
        save_pixels(path, e.picture, e.viewport.look);
      else
        image::write_png(path, opaque(e.picture.size, e.pictures->texels(ui::PictureId::Scene)));
      write_sidecar(e, path, preset_of(e, e.shown_with), {{"layer", e.viewport.layer}});
      toast(e, "written: " + path);
    }
    if (std::exchange(e.save_curve, false)) {
      std::string text = "spp,rmse,noise\n";
      for (const ReferenceView::Point& p : e.reference.curve) text += fmt::format("{},{},{}\n", p.spp, p.rmse, p.floor);
      const std::string path = new_file("convergence", ".csv");
      write_atomically(path, text);
      toast(e, "written: " + path);
    }
    record_timings(e, validation);
    if (std::exchange(e.slices.save_asked, false) && e.slices.seen) {
      json document = to_json(*e.slices.seen);
      document["params"] = params::to_json(e.document.settings.blocks());
      const std::string path = new_file("inspection", ".json");
      write_atomically(path, document.dump(1) + "\n");
      toast(e, "written: " + path);
    }
    if (std::exchange(e.save_layers, false))
      e.outbox.push_back({live::CommandKind::SaveLayers, new_file("layers", ".exr"), {}, {}});
    if (!e.save_texture.empty()) {
      const std::string ending = std::exchange(e.save_texture, {});
      const live::Pixels& p = e.texture.pixels;
      std::string name = p.name;
      std::replace(name.begin(), name.end(), '/', '_');
      const std::string path = new_file(name, ending);
      save_pixels(path, p, e.texture.look);
      const live::ProbeWanted& w = e.texture.of;
      write_sidecar(
          e, path, preset_of(e, e.texture.made_with),
          {{"resource", p.name}, {w.before ? "before" : "after", w.pass}, {"mip", w.mip}, {"layer", w.layer}});
      toast(e, "written: " + path);
    }
  } catch (const std::exception& error) {
    toast(e, error.what(), true);
  }
  if (std::exchange(e.copy_command, false)) {
    try {
      const fs::path preset = fs::absolute(new_file("command", ".json"));
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
