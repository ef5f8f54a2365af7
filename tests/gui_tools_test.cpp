// What the window records, tells and explains: captures, the validation layer's messages, where parameters come from.

#include "gui_fixture.h"

namespace nf {
namespace {

// By the folder's time.
std::vector<nlohmann::json> captured(const std::string& folder) {
  std::map<std::filesystem::file_time_type, std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    found[std::filesystem::last_write_time(entry.path() / "timing.json")] = entry.path();
  std::vector<nlohmann::json> out;
  for (const auto& [time, path] : found) {
    std::ifstream in(path / "timing.json");
    out.push_back(nlohmann::json::parse(in));
  }
  return out;
}

// The renderer has two frames and stops: it goes on to five. Of a thousand it is asked to write what there is.
TEST_F(GuiTest, ACaptureRecordsAsManyFramesAsAreWanted) {
  keep_settings(R"("settle": 2, "capture_frames": 5, "scale_chosen": true, "render_scale": 0.25)");
  const Outcome played = play_in_work(replaced(script_text("capture.jsonl"), "SHOT", out("capture.png")));
  PLAYS(played);
  EXPECT_GE(told_number(played, "frames"), 5);
  const std::vector<nlohmann::json> documents = captured(captures());
  ASSERT_EQ(documents.size(), 2u);
  for (const nlohmann::json& document : documents) EXPECT_EQ(schema_fault(document), "");
  EXPECT_EQ(documents[0]["runs"][0]["method"]["frames"], 5);
  EXPECT_EQ(documents[0]["runs"][0]["frame"]["gpu_ms"]["count"], 5);
  EXPECT_GE(documents[1]["runs"][0]["method"]["frames"], 5);
  EXPECT_LT(documents[1]["runs"][0]["method"]["frames"], 900);
}

// Of more frames than are wanted the last ones count.
TEST_F(GuiTest, ACaptureHasTheLastFrames) {
  keep_settings(R"("settle": 7, "capture_frames": 3, "scale_chosen": true, "render_scale": 0.25)");
  const Outcome played = play_in_work(
      "{\"wait\": \"idle == true\"}\n{\"key\": \"ctrl+t\"}\n"
      "{\"wait\": \"widgets.captured.folder.value contains timing-\"}\n{\"expect\": \"settled == 7\"}\n");
  PLAYS(played);
  const std::vector<nlohmann::json> documents = captured(captures());
  ASSERT_EQ(documents.size(), 1u);
  EXPECT_EQ(documents[0]["runs"][0]["method"]["frames"], 3);
  EXPECT_EQ(schema_fault(documents[0]), "");
}

TEST_F(GuiTest, ValidationIsToldWithItsPass) {
  keep_settings(R"("settle": 2, "scale_chosen": true, "render_scale": 0.25)");
  const Outcome played = play(replaced(script_text("validation.jsonl"), "SHOT", out("validation.png")));
  EXPECT_EQ(played.code, 1) << "a message is a failure: " << played.err;
  EXPECT_NE(played.err.find("validation messages"), std::string::npos) << "and there is no other: " << played.err;
  const std::string line = played.out.substr(0, played.out.find('\n')), before = "validation [";
  const size_t at = line.find(before), end = line.find(']', at);
  ASSERT_TRUE(at != std::string::npos && end != std::string::npos) << line;
  // A message of the command buffer has its label, one of the recording what the thread was at.
  std::string pass = line.substr(at + before.size(), end - at - before.size());
  if (const std::string doing = "recording the pass "; pass.starts_with(doing)) pass.erase(0, doing.size());
  const Outcome graph = run({"graph", scene(), "--format", "json", "--size", "64x36"});
  ASSERT_EQ(graph.code, 0) << graph.err;
  bool known = false;
  const nlohmann::json document = graph.json();
  for (const auto& row : document["passes"]) known |= row["name"] == pass;
  EXPECT_TRUE(known) << pass;
}

TEST_F(GuiTest, LightsAreMoved) {
  keep_settings(R"("settle": 4, "moving_scale": 1, "scale_chosen": true, "render_scale": 0.25)");
  // 4 x 2 texels of one colour; too narrow to be run-length coded.
  std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
  for (int i = 0; i < 8; ++i) sky += "\x80\x90\xc0\x81";
  PLAYS(play(replaced(script_text("lights.jsonl"), "SKY", input("sky.hdr", sky))));
}

TEST_F(GuiTest, ATooltipNamesThePaper) {
  PLAYS(
      play("{\"wait\": \"scene_frames >= 1\"}\n{\"hover\": \"vbgi.emitter\"}\n"
           "{\"wait\": \"widgets.tooltip.param.value contains Algorithm 1, line 23\"}\n"
           "{\"expect\": \"widgets.tooltip.param.value contains vbgi.emitter\"}\n{\"screenshot\": \"" +
           out("tip.png") +
           "\"}\n"
           "{\"click\": \"technique.search\"}\n{\"type\": \"noise\"}\n{\"hover\": \"gi.noise\"}\n"
           "{\"wait\": \"widgets.tooltip.param.value == \\\"gi.noise \\\"\"}\n"));
  const Outcome info = run({"info", "--params", "vbgi", "--json"});
  std::map<std::string, std::string> sources;
  const nlohmann::json document = info.json();
  for (const auto& row : document["params"])
    if (row.contains("source")) sources[row["id"]] = row["source"];
  EXPECT_NE(sources["vbgi.emitter"].find("line 23"), std::string::npos);
  EXPECT_EQ(sources.count("gi.noise"), 0u);
  EXPECT_NE(run({"info", "--params", "vbgi"}).out.find(sources["vbgi.emitter"]), std::string::npos);
}

}  // namespace
}  // namespace nf
