// Runs the editor without a window, driven by scripts, under validation of both devices.
#pragma once

#include <cmath>

#include "cli_process.h"

namespace nf {

class GuiTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::filesystem::create_directories(base_ / "work");
  }
  static std::string script_text(const std::string& name) {
    return bytes_of(std::string(NF_SOURCE_DIR "/tests/gui/") + name);
  }
  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
    return text;
  }
  // Runs a script's text; the program's own folder for settings and captures is a new one.
  Outcome play(const std::string& text, const Words& more = {}, const Words& environment = {},
               const std::string& window = "1280x720") {
    Words words = {"edit", scene(),      "--offscreen", "--validation", "--window",
                   window, "--log-file", out("log"),    "--ui-script",  input("script.jsonl", text)};
    words.insert(words.end(), more.begin(), more.end());
    Words all = {"XDG_CONFIG_HOME=" + config()};
    all.insert(all.end(), environment.begin(), environment.end());
    return run(words, all);
  }
  // Captures go to base_/work/captures.
  Outcome play_in_work(const std::string& text, const std::string& window = "1280x720", const Words& more = {}) {
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(base_ / "work");
    const Outcome played = play(text, more, {}, window);
    std::filesystem::current_path(before);
    return played;
  }
  void keep_settings(const std::string& preferences) const {
    std::filesystem::create_directories(config() + "/nearfield");
    std::ofstream(config() + "/nearfield/editor.json")
        << R"({"schema": "nearfield.editor/1", "preferences": {)" << preferences << "}}";
  }
  // The same; what went wrong comes back.
  std::string play_inside(const std::string& text) {
    const Outcome played = play_in_work(text);
    return played.code || played.err.find("validation:") != std::string::npos
               ? fmt::format("exit {}: {}", played.code, played.err)
               : "";
  }
  std::string captures() const { return (base_ / "work" / "captures").string(); }
  std::string config() const { return (base_ / "config").string(); }
};

// What a script told of a value: a number, or a widget's text.
inline double told_number(const Outcome& played, const std::string& name) {
  const size_t at = played.out.find(name + ": ");
  if (at == std::string::npos) return std::nan("");
  const char* text = played.out.c_str() + at + name.size() + 2;
  return std::strtod(*text == '"' ? text + 1 : text, nullptr);
}

// What is left when a device goes is told too late for the exit code.
#define PLAYS(outcome)                                                              \
  do {                                                                              \
    const Outcome outcome_ = (outcome);                                             \
    EXPECT_EQ(outcome_.code, 0) << outcome_.err;                                    \
    EXPECT_EQ(outcome_.err.find("validation:"), std::string::npos) << outcome_.err; \
  } while (false)

}  // namespace nf
