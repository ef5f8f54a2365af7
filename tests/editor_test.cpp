// Parts of the editor that need no window: the action table, chords, undo, conditions of scripts, timing histories.
#include <gtest/gtest.h>

#include "actions.h"
#include "document.h"
#include "ui/script.h"

namespace nf::editor {
namespace {

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
