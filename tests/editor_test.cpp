// Parts of the editor that need no window: the action table, chords, undo, conditions of scripts, timing histories.
#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

#include "actions.h"
#include "camera.h"
#include "document.h"
#include "gi/param_sources.h"
#include "live/pixel_images.h"
#include "pixel.h"
#include "ui/script.h"

namespace nf::editor {
namespace {

// A parameter that was renamed takes its place in the paper along.
TEST(Params, EverySourceIsOfAParameterThatThereIs) {
  passes::FrameSettings settings;
  std::set<std::string> ids, sourced;
  for (const ParamBlock& block : settings.blocks())
    for (const Param& row : block.table->params) {
      ids.insert(fmt::format("{}.{}", block.table->prefix, row.name));
      if (!passes::param_source(block.table->prefix, row.name).empty())
        sourced.insert(fmt::format("{}.{}", block.table->prefix, row.name));
    }
  for (const passes::ParamSource& source : passes::param_sources()) {
    EXPECT_TRUE(ids.count(std::string(source.id))) << source.id;
    EXPECT_FALSE(source.place.empty()) << source.id;
    EXPECT_TRUE(sourced.count(std::string(source.id))) << source.id;
  }
  EXPECT_EQ(sourced.size(), passes::param_sources().size()) << "none twice";
  EXPECT_LT(sourced.size(), ids.size());
  EXPECT_EQ(passes::param_source("gi", "noise"), "");
  EXPECT_EQ(passes::param_source("g", "i.radius"), "") << "the dot is where it is";
}

TEST(Actions, NoTwoHaveTheSameKeys) {
  EXPECT_EQ(find_conflict(), "");
  for (const Action& action : actions()) {
    EXPECT_NE(action.run, nullptr) << action.id;
    if (!*action.keys) continue;
    const std::string name = ui::chord_name(ui::parse_chord(action.keys));
    EXPECT_NE(name.back(), '?') << action.id;
    EXPECT_NE(name, "F12") << "taken by other tools";
  }
}

TEST(Actions, LettersBelongToTextFieldsWhileOneHasTheFocus) {
  Editor editor;
  const auto* before = editor.document.settings.technique;
  const auto press = [&](const char* keys, Focus focus) {
    const ui::Chord chord = ui::parse_chord(keys);
    return run_shortcut(editor, chord.key, chord.mods, focus);
  };
  EXPECT_FALSE(press("n", Focus::Text));
  EXPECT_EQ(editor.document.settings.technique, before);
  EXPECT_TRUE(press("n", Focus::Nothing));
  EXPECT_NE(editor.document.settings.technique, before);
  // What is typed is undone by the field, not the document.
  editor.undo.start(editor.document);
  editor.document.seed = 7;
  editor.undo.watch(editor.document, false);
  for (const char* keys : {"ctrl+z", "ctrl+y", "ctrl+shift+z", "ctrl+a", "ctrl+v"})
    EXPECT_FALSE(press(keys, Focus::Text)) << keys;
  EXPECT_EQ(editor.document.seed, 7u);
  EXPECT_TRUE(press("ctrl+z", Focus::Nothing));
  EXPECT_EQ(editor.document.seed, 1u);
  EXPECT_TRUE(press("ctrl+s", Focus::Text)) << "what no text field does";
}

TEST(Actions, KeysGoToWhatHasTheFocus) {
  Editor editor;
  const ui::Chord space = ui::parse_chord("space"), escape = ui::parse_chord("escape");
  EXPECT_FALSE(run_shortcut(editor, space.key, 0, Focus::Widget));
  EXPECT_FALSE(editor.wanted.playing);
  EXPECT_TRUE(run_shortcut(editor, space.key, ui::mod_ctrl, Focus::Widget)) << "freezes";
  EXPECT_TRUE(run_shortcut(editor, space.key, 0, Focus::Nothing));
  EXPECT_TRUE(editor.wanted.playing);
  // The help's own search has the focus when it opens: one Escape closes it all the same.
  EXPECT_FALSE(run_shortcut(editor, escape.key, 0, Focus::Text));
  editor.show_help = true;
  EXPECT_TRUE(run_shortcut(editor, escape.key, 0, Focus::Text));
  EXPECT_FALSE(editor.show_help);
}

// Ctrl flies slowly: what it makes of S and W is no shortcut then.
TEST(Actions, AFlightKeepsItsKeys) {
  Editor editor;
  const ui::Chord save = ui::parse_chord("ctrl+s"), freeze = ui::parse_chord("ctrl+space"), next = ui::parse_chord("n");
  EXPECT_FALSE(run_shortcut(editor, save.key, save.mods, Focus::Flight));
  EXPECT_FALSE(run_shortcut(editor, next.key, next.mods, Focus::Flight));
  EXPECT_FALSE(editor.show_save);
  EXPECT_TRUE(run_shortcut(editor, freeze.key, freeze.mods, Focus::Flight)) << "which steers nothing";
  EXPECT_TRUE(run_shortcut(editor, save.key, save.mods, Focus::Nothing));
  EXPECT_TRUE(editor.show_save);
}

CameraControl some_camera() {
  CameraControl c;
  c.camera.position = {1, 2, 3};
  c.camera.forward = glm::normalize(glm::vec3(0.3f, -0.2f, -1));
  c.camera.up = {0, 1, 0};
  c.target = c.camera.position + 4.0f * c.camera.forward;
  c.speed = 2;
  return c;
}

TEST(Camera, ShiftIsFourTimesAsFastAndCtrlAFourth) {
  const auto way = [](bool fast, bool slow) {
    CameraControl c = some_camera();
    const glm::vec3 before = c.camera.position, target = c.target;
    fly(c, {.ahead = 1, .fast = fast, .slow = slow}, 0.5f);
    EXPECT_TRUE(c.moved);
    EXPECT_LT(glm::distance(c.target - target, c.camera.position - before), 1e-6f);
    return glm::dot(c.camera.position - before, c.camera.forward);
  };
  EXPECT_NEAR(way(false, false), 1, 1e-6);
  EXPECT_NEAR(way(true, false), 4, 1e-6);
  EXPECT_NEAR(way(false, true), 0.25, 1e-6);
  CameraControl still = some_camera();
  fly(still, {.slow = true}, 1);
  EXPECT_FALSE(still.moved);
}

// The pivot stays where it is in the picture, and as far; another point does not.
TEST(Camera, AnOrbitKeepsItsPivotInPlace) {
  const auto seen = [](const CameraControl& c, glm::vec3 point) {
    const glm::vec3 f = glm::normalize(c.camera.forward), r = glm::normalize(glm::cross(f, c.camera.up)),
                    u = glm::cross(r, f), to = point - c.camera.position;
    return glm::vec3(glm::dot(to, r), glm::dot(to, u), glm::dot(to, f));
  };
  const glm::vec3 pivot(2, 1, 0.5f), other(0, 0, 0);
  CameraControl c = some_camera();
  const glm::vec3 before = seen(c, pivot), beside = seen(c, other), target = seen(c, c.target);
  orbit(c, pivot, 0.4f, -0.3f);
  orbit(c, pivot, -1.1f, 0.1f);
  EXPECT_LT(glm::distance(seen(c, pivot), before), 1e-4f);
  EXPECT_GT(glm::distance(seen(c, other), beside), 0.1f) << "the control";
  EXPECT_LT(glm::distance(seen(c, c.target), target), 1e-4f) << "the target goes round with the camera";
  EXPECT_GT(glm::distance(c.camera.position, some_camera().camera.position), 0.5f);
  EXPECT_NEAR(c.camera.up.y, 1, 1e-6) << "upright";
}

TEST(Camera, ThePickedPointIsOrbited) {
  Editor editor;
  editor.view = some_camera();
  editor.picking.values.layers = {{"depth", "V", {2.5f}}, {"position", "XYZ", {7, 8, 9}}};
  EXPECT_EQ(orbit_pivot(editor), editor.view.target) << "nothing is picked";
  editor.picking.locked = true;
  EXPECT_EQ(orbit_pivot(editor), glm::vec3(7, 8, 9));
  editor.picking.values.layers[0].values = {0};
  EXPECT_EQ(orbit_pivot(editor), editor.view.target) << "the sky";
}

TEST(Actions, OneFileDialogAtATime) {
  Editor editor;
  find_action("file.open")->run(editor);
  editor.prompt = "typed.glb";
  find_action("file.save")->run(editor);
  EXPECT_TRUE(editor.show_open);
  EXPECT_FALSE(editor.show_save);
  EXPECT_EQ(editor.prompt, "typed.glb");
}

TEST(Chords, AreReadAndNamed) {
  EXPECT_EQ(ui::chord_name(ui::parse_chord("ctrl+shift+z")), "Ctrl+Shift+Z");
  EXPECT_EQ(ui::chord_name(ui::parse_chord("f5")), "F5");
  EXPECT_THROW(ui::parse_chord("hyper+q"), Error);
  EXPECT_THROW(ui::parse_chord(""), Error);
}

TEST(Undo, AGestureIsOneStep) {
  Document document;
  UndoStack undo;
  undo.start(document);
  for (int i = 0; i < 10; ++i) {
    document.settings.gi.shared.radius = 1.0f + float(i);
    undo.watch(document, true);
  }
  undo.watch(document, false);
  EXPECT_EQ(undo.undos(), 1u);
  EXPECT_TRUE(undo.undo(document));
  EXPECT_EQ(document.settings.gi.shared.radius, Document().settings.gi.shared.radius);
  EXPECT_FALSE(undo.undo(document));
  EXPECT_TRUE(undo.redo(document));
  EXPECT_EQ(document.settings.gi.shared.radius, 10.0f);
  // A new change forgets what could be done again.
  undo.undo(document);
  document.seed = 5;
  undo.watch(document, false);
  EXPECT_EQ(undo.redos(), 0u);
}

TEST(Undo, SeesEveryPartOfTheDocument) {
  Document a, b;
  EXPECT_TRUE(same(a, b));
  b.lights.punctual.push_back({});
  EXPECT_FALSE(same(a, b));
  b = a;
  b.bookmarks[3] = scene::Camera{};
  EXPECT_FALSE(same(a, b));
  b = a;
  b.settings.technique = &passes::find_technique("gtao");
  EXPECT_FALSE(same(a, b));
  for (ParamBlock block : Document().settings.blocks()) {
    for (const Param& row : block.table->params) {
      Document c;
      for (ParamBlock own : c.settings.blocks())
        if (own.table == block.table)
          params::set(*own.table, own.data, row, row.default_value == row.min ? row.max : row.min);
      EXPECT_FALSE(same(a, c)) << block.table->prefix << "." << row.name;
    }
  }
}

TEST(Mode, PaperAndBack) {
  passes::FrameSettings settings;
  for (const passes::Technique& technique : passes::techniques()) {
    if (technique.paper_mode.empty()) continue;
    settings.technique = &technique;
    EXPECT_FALSE(is_paper_mode(settings)) << technique.id;
    set_mode(settings, true);
    EXPECT_TRUE(is_paper_mode(settings)) << technique.id;
    set_mode(settings, false);
    passes::FrameSettings fresh;
    fresh.technique = &technique;
    EXPECT_TRUE(same(settings, fresh)) << technique.id;
  }
}

TEST(Pixel, IsReadFromATypedPair) {
  glm::uvec2 pixel{7, 7};
  for (const char* text : {"412,233", "412 233", " 412 , 233 ", "412,  233"}) {
    EXPECT_EQ(parse_pixel(text, {640, 360}, pixel), "") << text;
    EXPECT_EQ(pixel, glm::uvec2(412, 233));
    pixel = {7, 7};
  }
  for (const char* text : {"", "412", "412,,233", "a,b", "-1,3", "1.5,2", "1,2,3", "1,2x"})
    EXPECT_NE(parse_pixel(text, {640, 360}, pixel).find("two numbers"), std::string::npos) << text;
  for (const char* text : {"640,3", "3,360", "99999999999,3"})
    EXPECT_EQ(parse_pixel(text, {640, 360}, pixel), "outside the picture, whose last pixel is 639,359") << text;
  EXPECT_EQ(pixel, glm::uvec2(7, 7));
}

TEST(Pixel, TheTexelOfAnImageOfAnotherSize) {
  using live::covering_texel;
  const glm::uvec2 at(100, 71), picture(155, 111);
  EXPECT_EQ(covering_texel(at, picture, {0, 0}, picture), at);
  EXPECT_EQ(covering_texel(at, picture, {0, 0}, {78, 56}), glm::uvec2(50, 35));  // halves, rounded up
  EXPECT_EQ(covering_texel(at, picture, {0, 0}, {77, 55}), glm::uvec2(50, 35));  // or down
  EXPECT_EQ(covering_texel({154, 110}, picture, {0, 0}, {77, 55}), glm::uvec2(76, 54));
  EXPECT_EQ(covering_texel(at, picture, {0, 0}, {39, 28}), glm::uvec2(25, 17));
  EXPECT_EQ(covering_texel(at, picture, {0, 0}, {1, 1}), glm::uvec2(0, 0));
  // Rendered with a border, but cut off again.
  EXPECT_EQ(covering_texel(at, picture, {8, 6}, {171, 123}), at + glm::uvec2(8, 6));
  EXPECT_EQ(covering_texel(at, picture, {8, 6}, picture), at);
  EXPECT_EQ(covering_texel(at, picture, {8, 6}, {86, 62}), glm::uvec2(54, 38));
  // In proportion.
  EXPECT_EQ(covering_texel({50, 10}, {100, 100}, {0, 0}, {64, 64}), glm::uvec2(32, 6));
}

TEST(Pixel, JsonHasAllDigitsAndNumbersThatAreNone) {
  live::Picked picked;
  picked.made_with.settings = {};
  picked.layers.push_back({.name = "gi", .channels = "RGB", .values = {0.1f, NAN, -INFINITY}});
  live::ImageValue image{.name = "gbuffer.normal", .format = "R32_UINT", .pass = "gbuffer.opaque"};
  image.numbers = {0xfffffffeu};
  image.meaning = "view-space direction";
  image.unpacked = {0, 1, 0};
  picked.images = {image};
  image.of_view = false;
  picked.images.push_back(image);
  const nlohmann::json document = nlohmann::json::parse(to_json(picked).dump());
  EXPECT_EQ(document["layers"]["gi"][0].get<float>(), 0.1f);
  EXPECT_EQ(document["layers"]["gi"][1], "nan");
  EXPECT_EQ(document["layers"]["gi"][2], "-inf");
  EXPECT_EQ(document["images"][0]["values"][0], 4294967294u);
  EXPECT_EQ(document["images"][0]["unpacked"]["values"][1], 1);
  EXPECT_FALSE(document["images"][1].contains("values"));
  EXPECT_EQ(text_of(std::vector<float>{0.1f, 16777217.0f}), "0.1  16777216");
}

TEST(Conditions, PathsMayHoldDots) {
  const nlohmann::json state = {
      {"params", {{"gi.radius", 2.0}}}, {"list", {{{"x", "a b"}}}}, {"text", "true"}, {"n", "0.50"}};
  const std::map<std::string, nlohmann::json> kept = {{"was", 2.0}};
  EXPECT_TRUE(ui::holds("params.gi.radius == 2", state, kept));
  EXPECT_TRUE(ui::holds("params.gi.radius == $was && n == 0.5", state, kept));
  EXPECT_FALSE(ui::holds("params.gi.radius > 2", state, kept));
  EXPECT_TRUE(ui::holds("list.0.x contains b", state, kept));
  EXPECT_TRUE(ui::holds("text == true", state, kept));
  EXPECT_TRUE(ui::holds("nothing.here == null", state, kept));
  EXPECT_FALSE(ui::holds("list.7.x == a", state, kept));
  EXPECT_THROW(ui::holds("params", state, kept), Error);
  EXPECT_THROW(ui::holds("n == $gone", state, kept), Error);
}

TEST(Timings, APassThatComesLaterHasNoPast) {
  TimingHistory history;
  live::Published frame;
  frame.passes = {{.name = "a", .ms = 1}};
  frame.frame_ms = 1;
  history.add(frame);
  frame.passes.push_back({.name = "b", .ms = 2});
  history.add(frame);
  ASSERT_EQ(history.rows.size(), 2u);
  EXPECT_TRUE(std::isnan(history.rows[1].ms[0]));
  EXPECT_EQ(history.rows[1].ms[1], 2);
  for (size_t i = 0; i < TimingHistory::limit + 5; ++i) {
    frame.passes = {{.name = "b", .ms = 2}};
    history.add(frame);
  }
  EXPECT_EQ(history.frame_ms.size(), TimingHistory::limit);
  EXPECT_EQ(history.rows.size(), 1u) << "a has left the window";
  EXPECT_EQ(history.run.frames.size(), TimingHistory::limit);
  history.paused = true;
  history.add(frame);
  EXPECT_EQ(history.frame_ms.size(), TimingHistory::limit);
}

TEST(Timings, AreOfFramesOfOneKind) {
  TimingHistory history;
  live::Published frame;
  frame.passes = {{.name = "a", .ms = 1}};
  frame.frame_ms = 3;
  frame.made_with.size = {64, 36};
  frame.made_with.settings.technique = &passes::find_technique("gtao");
  EXPECT_TRUE(history.add(frame));
  frame.made_with.size = {21, 12};
  frame.reduced = true;
  EXPECT_FALSE(history.add(frame)) << "smaller, because something moves";
  EXPECT_EQ(history.frame_ms.size(), 1u);
  frame.reduced = false;
  EXPECT_TRUE(history.add(frame));
  EXPECT_EQ(history.frame_ms.size(), 1u) << "another size begins anew";
  frame.made_with.history = 1;
  frame.made_with.settings.technique = &passes::find_technique("vbgi");
  EXPECT_TRUE(history.add(frame));
  EXPECT_EQ(history.run.frames.size(), 1u) << "and so do other settings";
  EXPECT_STREQ(history.made_with.settings.technique->id, "vbgi");
  frame.frame_ms = 5;
  history.add(frame);
  EXPECT_EQ(history.left_ms, (std::deque<float>{2, 4})) << "of each frame what its passes leave";
  history.paused = true;
  frame.made_with.settings.technique = &passes::find_technique("gtao");
  EXPECT_FALSE(history.add(frame));
  EXPECT_STREQ(history.made_with.settings.technique->id, "vbgi") << "what is kept was made with that";
}

TEST(Timings, RowsStandInTheOrderOfThePasses) {
  TimingHistory history;
  live::Published frame;
  const auto run = [&](const std::vector<std::string>& names) {
    frame.passes.clear();
    for (const std::string& name : names) frame.passes.push_back({.name = name, .ms = 1});
    history.add(frame);
    std::string all;
    for (const TimingHistory::Row& row : history.rows) all += row.name + " ";
    return all;
  };
  EXPECT_EQ(run({"b", "readback"}), "b readback ");
  EXPECT_EQ(run({"a", "b", "c", "d", "readback"}), "a b c d readback ");
  EXPECT_EQ(run({"a", "b", "readback"}), "a b c d readback ");
  EXPECT_EQ(run({"a", "e", "readback"}), "a e b c d readback ");
  for (const TimingHistory::Row& row : history.rows) EXPECT_EQ(row.ms.size(), 4u) << row.name;
}

}  // namespace
}  // namespace nf::editor
