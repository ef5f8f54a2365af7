// Cameras kept in presets, and what the mouse and the keys make of the camera.
#include "gui_fixture.h"

namespace nf {
namespace {

TEST_F(GuiTest, APresetKeepsTheBookmarks) {
  keep_settings(R"("settle": 2, "moving_scale": 1, "scale_chosen": true, "render_scale": 0.25)");
  const std::string preset = out("kept.json");
  const Outcome played = play(replaced(script_text("bookmarks.jsonl"), "PRESET", preset), {}, {}, "960x720");
  PLAYS(played);
  const double two = told_number(played, "two"), nine = told_number(played, "nine");
  EXPECT_GT(std::abs(two - nine), 0.01);
  const nlohmann::json kept = nlohmann::json::parse(bytes_of(preset))["bookmarks"];
  EXPECT_EQ(kept.size(), 2u);
  EXPECT_TRUE(kept.contains("2") && kept.contains("9"));
  // The same surface before and after the orbit; another after a turn on the spot.
  const double picked = told_number(played, "picked");
  EXPECT_GT(picked, 0.1);
  EXPECT_NEAR(told_number(played, "orbited"), picked, 0.015 * picked);
  EXPECT_GT(std::abs(told_number(played, "turned") - picked), 0.03 * picked) << "the control";

  // Another user's window: none of them is in the settings.
  std::filesystem::remove_all(config());
  const std::string recall =
      "{\"wait\": \"scene_frames >= 1\"}\n{\"key\": \"9\"}\n{\"tell\": \"nine\", \"of\": \"camera.forward.0\"}\n";
  EXPECT_EQ(told_number(play(recall), "nine"), two) << "the control: it stays where the file's camera is";
  std::filesystem::remove_all(config());
  EXPECT_NEAR(told_number(play(recall, {"--preset", preset}), "nine"), nine, 1e-5);
  std::filesystem::remove_all(config());
  EXPECT_NEAR(told_number(play("{\"wait\": \"scene_frames >= 1\"}\n{\"drop\": \"" + preset +
                               "\"}\n{\"wait\": \"preset contains kept\"}\n" + recall),
                          "nine"),
              nine, 1e-5);
  // Commands take the preset as it is, and are not moved by what they have no use for.
  nlohmann::json without = nlohmann::json::parse(bytes_of(preset));
  without.erase("bookmarks");
  const auto render = [&](const std::string& file, const std::string& picture) {
    const Outcome rendered =
        run({"render", scene(), "--preset", file, "--size", "32x18", "--frames", "1", "-o", out(picture)});
    EXPECT_EQ(rendered.code, 0) << rendered.err;
    return bytes_of(out(picture));
  };
  EXPECT_EQ(render(preset, "with.png"), render(input("without.json", without.dump()), "without.png"));
}

}  // namespace
}  // namespace nf
