// The editor driven by scripts, without a window: each script's own conditions are the checks.
#include "capture/trace.h"
#include "gui_fixture.h"
#include "image/image.h"

namespace nf {
namespace {

TEST_F(GuiTest, SwapsThroughAllTechniques) {
  PLAYS(play(script_text("swap.jsonl")));
}
TEST_F(GuiTest, UndoTakesBackAGesture) {
  PLAYS(play(script_text("undo.jsonl")));
}
TEST_F(GuiTest, ComparesWithWhatWasKept) {
  PLAYS(play(script_text("compare.jsonl")));
}
TEST_F(GuiTest, WhatHasTheFocusGetsItsKeys) {
  PLAYS(play(script_text("keys.jsonl")));
}
TEST_F(GuiTest, APixelIsReadInEveryImage) {
  keep_settings(R"("settle": 4, "moving_scale": 1, "scale_chosen": true, "render_scale": 0.25)");
  PLAYS(play(replaced(script_text("pixel.jsonl"), "SHOT", out("pixel"))));
}
TEST_F(GuiTest, PartsOfTheRendererStandStill) {
  keep_settings(R"("settle": 32, "moving_scale": 1, "scale_chosen": true, "render_scale": 0.2)");
  PLAYS(play(replaced(script_text("freeze.jsonl"), "SHOT", out("freeze"))));
}
// Where there is little room, rows of the grid are seen, and no name lies under its widget.
TEST_F(GuiTest, SmallWindowsShowWhatTheyMust) {
  PLAYS(play(replaced(script_text("small.jsonl"), "SHOT", out("small")), {"--ui-state", out("state")}, {}, "1280x720"));
  const nlohmann::json state = nlohmann::json::parse(bytes_of(out("state")));
  const auto edge = [&](const char* id) {
    const nlohmann::json& rect = state["widgets"][id]["rect"];
    return rect[0].get<double>() + rect[2].get<double>();
  };
  EXPECT_EQ(state["window"][0], 800);
  EXPECT_LT(edge("technique.changed_only"), edge("region.technique"));
}
TEST_F(GuiTest, EveryPanelShowsSomething) {
  PLAYS(play(script_text("panels.jsonl")));
}
TEST_F(GuiTest, SurvivesSizesScalesAndALostDevice) {
  PLAYS(play(replaced(script_text("window.jsonl"), "FENCE", NF_BINARY_DIR "/content/fence.glb")));
}

// Window and renderer on one device, which software devices only have when they are told to.
TEST_F(GuiTest, OneDeviceServesBoth) {
  const std::string shared =
      "{\"wait\": \"scene_frames >= 1\"}\n"
      "{\"expect\": \"shared_queues >= 1 && picture_kind == image && host_bytes == 0\"}\n";
  const Words words = {"--device-sharing", "shared"};
  PLAYS(play(shared + script_text("swap.jsonl"), words));
  PLAYS(play(shared + script_text("compare.jsonl"), words));
  PLAYS(play(shared + replaced(script_text("window.jsonl"), "FENCE", NF_BINARY_DIR "/content/fence.glb") +
                 "{\"expect\": \"shared_queues >= 1 && picture_kind == image\"}\n",
             words));
}

// Bit by bit: the picture, the one compared with, the wipe; to a byte's step the difference of the two.
TEST_F(GuiTest, AHandedOverPictureIsShownAsACopiedOne) {
  for (const char* form : {"separate", "shared"}) {
    keep_settings(R"("settle": 4, "moving_scale": 1)");
    const std::string kind = std::string(form) == "shared" ? "image" : "bytes";
    const Outcome played = play(replaced(replaced(script_text("sharing.jsonl"), "KIND", kind), "SHOT", out(form)),
                                {"--device-sharing", form}, {}, "720x480");
    ASSERT_EQ(played.code, 0) << form << ": " << played.err;
  }
  std::set<std::string> different;
  for (const char* shot : {"-picture.png", "-other.png", "-wipe.png", "-difference.png"}) {
    const std::string copied = bytes_of(out("separate" + std::string(shot)));
    EXPECT_FALSE(copied.empty());
    if (std::string(shot) == "-difference.png") {
      // Each shader rounds its own way where a colour lies half way between two bytes.
      const Outcome near =
          run({"compare", out("separate-difference.png"), out("shared-difference.png"), "--max-abs", "0.01"});
      EXPECT_EQ(near.code, 0) << near.out << near.err;
    } else {
      EXPECT_TRUE(copied == bytes_of(out("shared" + std::string(shot)))) << shot;
    }
    different.insert(copied);
  }
  EXPECT_EQ(different.size(), 4u) << "the control: the four are not the same picture";
}

TEST_F(GuiTest, ABrokenShaderIsShownAndThePictureGoesOn) {
  const std::filesystem::path data = base_ / "data";
  std::filesystem::create_directories(data);
  std::filesystem::copy(NF_SOURCE_DIR "/shaders", data / "shaders", std::filesystem::copy_options::recursive);
  PLAYS(play(replaced(script_text("shader.jsonl"), "SHADERS", (data / "shaders").string()), {},
             {"NEARFIELD_DATA_DIR=" + data.string()}));
}

// The records that the window exports, summed here: what the shader has, bit by bit.
TEST_F(GuiTest, ThePixelTakenApartAddsUp) {
  const std::filesystem::path work = base_ / "work";
  const Outcome played = play_in_work(script_text("slices.jsonl"));
  ASSERT_EQ(played.code, 0) << played.err;
  std::filesystem::path written;
  for (const auto& entry : std::filesystem::directory_iterator(work / "captures")) written = entry.path();
  const nlohmann::json seen = nlohmann::json::parse(bytes_of(written));
  EXPECT_EQ(seen["schema"], "nearfield.inspection/1");
  double visibility = 0, gi = 0, bits = 0, taken = 0;
  for (const auto& slice : seen["slices"]) visibility += slice["base"].get<double>();
  for (const auto& sample : seen["samples"]) {
    const double factor = seen["slices"][sample["slice"].get<size_t>()]["factor"];
    visibility -= factor * sample["taken"].get<double>();
    gi += factor * sample["light"][0].get<double>();
    taken += sample["taken"].get<double>();
    bits += __builtin_popcountll(std::stoull(sample["fresh"].get<std::string>(), nullptr, 16));
  }
  const double shader = seen["shader"]["visibility"], light = seen["shader"]["gi"][0];
  EXPECT_LT(shader, 0.98) << "a pixel that sees something";
  EXPECT_NEAR(visibility, shader, 0.01 * std::abs(shader));
  EXPECT_NEAR(gi, light, 0.01 * light + 1e-5);
  EXPECT_EQ(bits, taken) << "each new sector counts once";
}

// A panel taken out of its tabs is moved, resized and put back; one that is out is still out in the next run, and the
// tab that was open is open again.
TEST_F(GuiTest, PanelsStandInWindowsOfTheirOwn) {
  PLAYS(play(script_text("floating.jsonl") +
             "{\"click\": \"bottom.Memory\"}\n{\"wait\": \"widgets.bottom.Memory.value == open\"}\n"));
  PLAYS(
      play("{\"wait\": \"widgets.floating.Scene.value != null && widgets.inspector.Scene.value == null\"}\n"
           "{\"wait\": \"widgets.bottom.Memory.value == open\"}\n"
           "{\"key\": \"ctrl+shift+l\"}\n"
           "{\"wait\": \"widgets.floating.Scene.value == null && widgets.inspector.Scene.value != null\"}\n"));
}

TEST_F(GuiTest, AFailedExpectationFails) {
  const Outcome outcome = play("{\"wait\": \"scene_frames >= 1\"}\n{\"expect\": \"technique == gtao\"}\n");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("script.jsonl:2"), std::string::npos) << outcome.err;
  EXPECT_EQ(play("{\"wait\": \"technique == gtao\", \"timeout\": 0.2}\n").code, 1);
  EXPECT_EQ(play("{\"wait\": \"scene_frames\"}\n").code, 1);
  EXPECT_EQ(play("nonsense\n").code, 3);
  EXPECT_EQ(play("{\"quit\": true}\n", {"--size", "13x13"}).code, 2) << "no such flag here";
  // `edit` may be left away.
  EXPECT_EQ(
      run({scene(), "--offscreen", "--ui-script", input("quit.jsonl", "{\"wait\": \"scene contains cornell\"}\n")},
          {"XDG_CONFIG_HOME=" + config()})
          .code,
      0);
}

TEST_F(GuiTest, TheReferenceRefinesInTheBackground) {
  PLAYS(play(script_text("reference.jsonl")));
}

// 20 clicks, the pointer gone at once, while a frame of the scene takes a second or more on the software device.
TEST_F(GuiTest, NoClickIsLost) {
  keep_settings(R"("render_scale": 1, "moving_scale": 1, "scale_chosen": true)");
  std::string text =
      "{\"wait\": \"scene_frames >= 2\"}\n{\"click\": \"inspector.Scene\"}\n{\"key\": \"space\"}\n"
      "{\"tell\": \"scene ms\", \"of\": \"scene_ms\"}\n";
  for (int i = 1; i <= 20; ++i) text += "{\"click\": \"scene.step\", \"leave\": true, \"frames\": 0}\n";
  text +=
      "{\"wait\": \"steps == 20\", \"timeout\": 20}\n{\"tell\": \"window median\", \"of\": \"ui_frames_ms.median\"}\n"
      "{\"tell\": \"window p95\", \"of\": \"ui_frames_ms.p95\"}\n";
  const Outcome played = play(text, {"--set", "gi.slices=16"});
  PLAYS(played);
  fmt::print("a frame of the scene: {:.0f} ms; of the window: median {:.0f} ms, p95 {:.0f} ms\n",
             told_number(played, "scene ms"), told_number(played, "window median"), told_number(played, "window p95"));
}

// What the window saves, a command renders: the same picture, but for the noise of another number of frames.
TEST_F(GuiTest, ASavedPresetRendersTheSamePicture) {
  const std::string preset = out("mine.json"), shot = out("shot.png"), again = out("again.png");
  const std::string text = fmt::format(
      "{{\"wait\": \"scene_frames >= 1\"}}\n{{\"click\": \"technique.search\"}}\n{{\"type\": \"radius\"}}\n{{\"drag\": "
      "\"gi.radius\", \"by\": [30, 0]}}\n{{\"wait\": \"undo == "
      "1\"}}\n"
      "{{\"drag\": \"viewport.picture\", \"by\": [30, 10], \"button\": 1}}\n{{\"wait\": \"idle == true\"}}\n"
      "{{\"key\": \"ctrl+s\"}}\n{{\"click\": \"file.path\"}}\n{{\"key\": \"ctrl+a\"}}\n{{\"type\": \"{}\"}}\n"
      "{{\"click\": \"file.ok\"}}\n{{\"wait\": \"toasts.0 contains saved\"}}\n{{\"key\": \"f9\"}}\n"
      "{{\"wait\": \"toasts.1 contains written\"}}\n",
      preset);
  const std::filesystem::path work = base_ / "work";
  const Outcome played = play_in_work(text, "960x720", {"--set", "gi.steps=5"});
  ASSERT_EQ(played.code, 0) << played.err;
  for (const auto& entry : std::filesystem::directory_iterator(work / "captures"))
    if (entry.path().extension() == ".png") std::filesystem::copy(entry.path(), shot);
  const Outcome rendered = run({"render", scene(), "--preset", preset, "-o", again, "--frames", "64", "--fps", "0"});
  ASSERT_EQ(rendered.code, 0) << rendered.err;
  const Outcome same = run({"compare", shot, again, "--metric", "rmse,psnr", "--json", "-"});
  ASSERT_EQ(same.code, 0) << same.err;
  EXPECT_LT(same.json()["metrics"]["rmse"]["value"].get<double>(), 0.01) << same.out;
  // Without the technique the picture is another: the limit above means something.
  const Outcome other =
      run({"render", scene(), "--preset", preset, "--technique", "none", "-o", again, "--frames", "2"});
  ASSERT_EQ(other.code, 0) << other.err;
  EXPECT_GT(
      run({"compare", shot, again, "--metric", "rmse", "--json", "-"}).json()["metrics"]["rmse"]["value"].get<double>(),
      0.02);
}

TEST_F(GuiTest, APresetBringsBackTheLightsAndTheSky) {
  const std::string sky = out("sky.exr"), again = out("again.png");
  ASSERT_EQ(run({"render", scene(), "-o", sky, "--size", "32x16", "--frames", "1"}).code, 0);
  keep_settings(R"("settle": 4, "moving_scale": 1)");
  const Outcome played = play_in_work(replaced(script_text("preset.jsonl"), "SKY", sky), "960x720");
  ASSERT_EQ(played.code, 0) << played.err;
  std::string preset, shot;
  for (const auto& entry : std::filesystem::directory_iterator(base_ / "work/captures")) {
    if (entry.path().extension() == ".png") shot = entry.path();
    if (entry.path().filename().string().starts_with("command")) preset = entry.path();
  }
  const Outcome rendered = run({"render", scene(), "--preset", preset, "-o", again, "--frames", "4", "--fps", "0"});
  ASSERT_EQ(rendered.code, 0) << rendered.err;
  const Outcome same = run({"compare", shot, again, "--metric", "rmse", "--json", "-"});
  EXPECT_LT(same.json()["metrics"]["rmse"]["value"].get<double>(), 0.02) << same.out;
}

// Looking into a frozen picture takes no change of it, and the split starts though all frames came before its scene.
TEST_F(GuiTest, AStillPictureIsLookedInto) {
  keep_settings(R"("settle": 4)");
  PLAYS(play(
      "{\"wait\": \"settled >= 4\"}\n{\"key\": \"ctrl+space\"}\n{\"wait\": \"paused == true\"}\n"
      "{\"click\": \"viewport.picture\", \"at\": [0.3, 0.88]}\n{\"wait\": \"widgets.pixel.layer.depth.value > 0\"}\n"
      "{\"key\": \"i\"}\n{\"wait\": \"widgets.slices.visibility.value != null\"}\n{\"key\": \"i\"}\n"
      "{\"key\": \"ctrl+space\"}\n{\"wait\": \"idle == true\"}\n{\"key\": \"r\"}\n"
      "{\"wait\": \"widgets.reference.spp.value >= 2\"}\n{\"wait\": \"idle == true\"}\n{\"click\": "
      "\"reference.split\"}\n"
      "{\"wait\": \"widgets.reference.split.spp.value >= 2\"}\n"));
}

TEST_F(GuiTest, ABrokenSettingsFileIsPutAside) {
  std::filesystem::create_directories(config() + "/nearfield");
  std::ofstream(config() + "/nearfield/editor.json") << "{ nonsense";
  PLAYS(play("{\"wait\": \"toasts.0 contains .bad\"}\n{\"key\": \"ctrl+=\"}\n{\"wait\": \"scale == 1.25\"}\n"));
  EXPECT_TRUE(std::filesystem::exists(config() + "/nearfield/editor.json.bad"));
  PLAYS(play("{\"wait\": \"scene_frames >= 1\"}\n{\"expect\": \"scale == 1.25\"}\n"));
  PLAYS(play("{\"wait\": \"scene_frames >= 1\"}\n{\"expect\": \"scale == 1\"}\n", {"--reset-settings"}));
}

// The frames after a swap, called what they are; and the document that `bench` would have written.
TEST_F(GuiTest, CapturesPassTheSchema) {
  ASSERT_EQ(play_inside(
                "{\"wait\": \"settled >= 6\"}\n{\"click\": \"technique.combo\"}\n{\"click\": "
                "\"technique.combo/gtao\"}\n{\"wait\": \"technique == gtao && settled >= 3\"}\n"
                "{\"wait\": \"widgets.timings.row.gtao.trace.value > 0\"}\n"
                "{\"expect\": \"widgets.timings.row.vbgi.trace.value == null\"}\n"
                "{\"expect\": \"widgets.timings.row.unattributed.value > 0\"}\n"
                "{\"click\": \"timings.pause\"}\n{\"key\": \"n\"}\n{\"wait\": \"technique != gtao && settled >= 2\"}\n"
                "{\"key\": \"ctrl+t\"}\n{\"wait\": \"toasts.0 contains captures\"}\n"),
            "");
  std::filesystem::path written_to;
  for (const auto& entry : std::filesystem::directory_iterator(captures())) written_to = entry.path();
  const nlohmann::json timing = nlohmann::json::parse(bytes_of(written_to / "timing.json"));
  EXPECT_EQ(schema_fault(timing), "");
  const nlohmann::json& run = timing["runs"][0];
  EXPECT_EQ(run["technique"], "gtao") << "what was timed, not what is chosen by now";
  EXPECT_EQ(run["settings"]["technique"], "gtao");
  std::string order;
  for (const auto& pass : run["passes"]) order += pass["path"].get<std::string>() + " ";
  EXPECT_NE(order.find("gtao.trace"), std::string::npos) << order;
  EXPECT_EQ(order.find("vbgi"), std::string::npos) << order;
  EXPECT_TRUE(order.ends_with("readback ")) << order;
  const nlohmann::json preset = nlohmann::json::parse(bytes_of(written_to / "preset.json"));
  EXPECT_EQ(preset["technique"], "gtao");
  EXPECT_TRUE(capture::check_trace(nlohmann::json::parse(bytes_of(written_to / "trace.json"))).empty());
}

// Each picture with its preset, program and device beside it; none takes another's place; a preset it is, still.
TEST_F(GuiTest, EveryPictureSaysWhatMadeIt) {
  ASSERT_EQ(play_inside(script_text("pictures.jsonl")), "");
  std::map<std::string, int> pictures;
  std::string last;
  for (const auto& entry : std::filesystem::directory_iterator(captures())) {
    const std::filesystem::path path = entry.path();
    if (path.extension() == ".json") continue;
    ++pictures[path.filename().string().substr(0, 6)];
    const std::string beside = std::filesystem::path(path).replace_extension(".json");
    const nlohmann::json made = nlohmann::json::parse(bytes_of(beside))["made"];
    EXPECT_EQ(made["file"], path.filename().string());
    EXPECT_GE(made["app"]["git"].get<std::string>().size(), 4u);
    EXPECT_EQ(made["device"]["type"].get<std::string>().empty(), false);
    last = beside;
  }
  EXPECT_EQ(pictures, (std::map<std::string, int>{{"layers", 2}, {"pictur", 2}, {"window", 1}}));
  const Outcome rendered = run({"render", scene(), "--preset", last, "--size", "32x18", "-o", out("again.png")});
  EXPECT_EQ(rendered.code, 0) << rendered.err;
}

// "As it is shown": false colours, and what lies outside the range, as the window has them.
// What a picture of the window and a saved file have in common, by the file's texels.
struct Alike {
  double same = 0, coloured = 0, blue = 0;  // shares
};
Alike alike(const std::string& shown, const std::string& saved) {
  const image::Image8 window = image::read_png(shown), file = image::read_png(saved);
  EXPECT_GE(window.width, 2 * file.width) << "texels as squares, or nothing can be compared";
  Alike out;
  for (uint32_t y = 0; y < file.height; ++y)
    for (uint32_t x = 0; x < file.width; ++x) {
      const size_t a = size_t(y * file.width + x) * 3,
                   b = (size_t((y + 0.5) * window.height / file.height) * window.width +
                        size_t((x + 0.5) * window.width / file.width)) *
                       3;
      int apart = 0;
      for (size_t c = 0; c < 3; ++c) apart = std::max(apart, std::abs(file.pixels[a + c] - window.pixels[b + c]));
      out.same += apart <= 2;
      out.coloured += file.pixels[a] != file.pixels[a + 1];
      out.blue += file.pixels[a] == 0 && file.pixels[a + 1] == 51 && file.pixels[a + 2] == 255;
    }
  const double all = double(file.width) * file.height;
  return {out.same / all, out.coloured / all, out.blue / all};
}

TEST_F(GuiTest, ATextureIsSavedAsItIsShown) {
  keep_settings(R"("settle": 4, "moving_scale": 1, "scale_chosen": true, "render_scale": 0.25)");
  ASSERT_EQ(play_inside(replaced(script_text("texture.jsonl"), "SHOT", out("shown"))), "");
  std::map<std::string, std::string> saved;
  for (const auto& entry : std::filesystem::directory_iterator(captures()))
    if (entry.path().extension() == ".png") {
      const std::string name = entry.path().filename().string();
      saved[name.substr(0, name.find('-'))] = entry.path().string();
    }
  ASSERT_EQ(saved.size(), 4u);
  std::set<std::string> different;
  for (const auto& [name, path] : saved) {
    const Alike found = alike(out("shown-" + name + ".png"), path);
    EXPECT_GT(found.same, 0.98) << name;
    if (name != "gbuffer.albedo") {
      EXPECT_GT(found.coloured, 0.5) << name;
    }
    if (name == "vbgi.visibility") {
      EXPECT_GT(found.blue, 0.02) << "below the range";
      EXPECT_LT(found.blue, 0.98);
    }
    different.insert(bytes_of(path));
  }
  EXPECT_EQ(different.size(), 4u);
  EXPECT_TRUE(bytes_of(out("shown-denoise.visibility.png")) == bytes_of(out("shown-moved.png"))) << "it is frozen";
  EXPECT_LT(alike(out("shown-vbgi.visibility.png"), saved["denoise.visibility"]).same, 0.5) << "the control";
}

}  // namespace
}  // namespace nf
