// The picture against another: FLIP in the background is that of `nearfield compare`, and each side's error is its own.
#include <cmath>

#include "gui_fixture.h"
#include "image/file.h"
#include "image/metrics.h"
#include "live_flip.h"

namespace nf {
namespace {

using editor::flip_of;
using editor::LiveFlip;

LiveFlip::Side bytes(uint32_t seed, glm::uvec2 size, uint64_t version) {
  LiveFlip::Side side{.version = version, .rgba = {}, .floats = {}};
  for (uint32_t i = 0; i < size.x * size.y * 4; ++i) side.rgba.push_back(uint8_t((i * 37 + seed * (i % 91)) % 256));
  return side;
}

// Of what waits the newest counts; what was asked for last comes out.
TEST(LiveFlipTest, TheNewestPairIsTheLastResult) {
  const glm::uvec2 size{24, 16};
  LiveFlip flip;
  for (uint32_t i = 1; i <= 6; ++i)
    flip.start({.size = size, .test = bytes(i, size, i), .reference = bytes(0, size, 100)});
  LiveFlip::Result last;
  for (int tries = 0; tries < 2000 && last.test != 6; ++tries) {
    flip.poll(last);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(last.test, 6u);
  EXPECT_EQ(last.reference, 100u);
  EXPECT_EQ(last.colors.size(), size_t(size.x) * size.y * 4);
  EXPECT_FALSE(last.hdr);
  EXPECT_EQ(flip_of({.size = size, .test = bytes(6, size, 6), .reference = bytes(0, size, 100)}).pooled.mean,
            last.pooled.mean);
  EXPECT_NE(flip_of({.size = size, .test = bytes(5, size, 5), .reference = bytes(0, size, 100)}).pooled.mean,
            last.pooled.mean)
      << "the control: another pair has another";
  EXPECT_EQ(flip_of({.size = size, .test = bytes(5, size, 5), .reference = bytes(5, size, 9)}).pooled.max, 0);
}

// Points of matplotlib's table.
TEST(LiveFlipTest, TheColoursAreMagma) {
  const struct {
    float t;
    double rgb[3];
  } points[] = {{0, {0.001462, 0.000466, 0.013866}},
                {64 / 255.0f, {0.316654, 0.071690, 0.485380}},
                {128 / 255.0f, {0.716387, 0.214982, 0.475290}},
                {1, {0.987053, 0.991438, 0.749504}}};
  for (const auto& p : points) {
    const image::Rgb8 c = image::magma_color(p.t);
    EXPECT_NEAR(c.r / 255.0, p.rgb[0], 0.03) << p.t;
    EXPECT_NEAR(c.g / 255.0, p.rgb[1], 0.03) << p.t;
    EXPECT_NEAR(c.b / 255.0, p.rgb[2], 0.03) << p.t;
  }
}

// The picture and a layer; kept, saved, another technique, saved, FLIP. What the key says is what the command says of
// the files.
TEST_F(GuiTest, FlipIsThatOfTheCompareCommand) {
  // One frame a picture: the one that is shown is the one whose layers are saved.
  keep_settings(R"("settle": 1, "moving_scale": 1, "scale_chosen": true, "render_scale": 0.25)");
  const Outcome played = play_in_work(replaced(script_text("flip.jsonl"), "SHOT", out("flip.png")), "960x720");
  ASSERT_EQ(played.code, 0) << played.err;
  std::map<std::string, std::string> shots;  // by technique
  for (const auto& entry : std::filesystem::directory_iterator(captures())) {
    if (entry.path().extension() == ".json") continue;
    const std::string beside = std::filesystem::path(entry.path()).replace_extension(".json");
    const nlohmann::json made = nlohmann::json::parse(bytes_of(beside));
    shots[made["technique"].get<std::string>() + entry.path().extension().string()] = entry.path();
  }
  ASSERT_EQ(shots.size(), 4u);
  const auto measured = [&](const std::string& test, const std::string& reference, const Words& more) {
    Words words = {"compare", shots[test], shots[reference], "--metric", "flip", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words).json()["metrics"]["flip"]["map"];
  };
  const nlohmann::json map = measured("hbil.png", "vbgi.png", {});
  EXPECT_GT(told_number(played, "mean"), 1e-4);
  EXPECT_NEAR(told_number(played, "mean"), map["mean"].get<double>(), 1e-6);
  EXPECT_NEAR(told_number(played, "p95"), map["p95"].get<double>(), 1e-6);
  EXPECT_NEAR(told_number(played, "most"), map["max"].get<double>(), 1e-6);
  EXPECT_EQ(measured("vbgi.png", "vbgi.png", {})["max"], 0) << "the control";
  // A layer is of floats, the file of halves.
  const nlohmann::json layer = measured("hbil.exr", "vbgi.exr", {"--layer", "visibility"});
  EXPECT_GT(told_number(played, "layer mean"), 1e-4);
  EXPECT_NEAR(told_number(played, "layer mean"), layer["mean"].get<double>(), 2e-3 * layer["mean"].get<double>());
  EXPECT_NEAR(told_number(played, "layer p95"), layer["p95"].get<double>(), 5e-3 * layer["p95"].get<double>());
  EXPECT_GT(std::abs(layer["mean"].get<double>() - map["mean"].get<double>()), 0.004 * map["mean"].get<double>())
      << "the control: the picture's is another";
}

TEST_F(GuiTest, EachSideSaysWhatItIsAndHowWrong) {
  keep_settings(R"("settle": 4, "moving_scale": 1, "scale_chosen": true, "render_scale": 0.2)");
  const Outcome played = play(replaced(script_text("errors.jsonl"), "SHOT", out("errors.png")), {}, {}, "1100x760");
  PLAYS(played);
  const double a = told_number(played, "A"), picture = told_number(played, "picture");
  EXPECT_GT(std::abs(a - picture), 0.05 * picture) << "A's is its own: " << a << " and " << picture;
}

}  // namespace
}  // namespace nf
