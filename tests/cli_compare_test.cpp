// `nearfield compare` as a process: numbers, limits and their exit codes, layers, masks, pictures.
#include <cmath>

#include "cli_process.h"
#include "image/image.h"

namespace nf {
namespace {

class CliCompareTest : public CliTest {
 protected:
  static image::Image flat(float value, uint32_t channels = 3) {
    return {32, 24, channels, std::vector<float>(size_t(32) * 24 * channels, value)};
  }
  std::string exr(const std::string& name, const std::vector<image::Layer>& layers) const {
    const std::string path = (base_ / "in" / name).string();
    image::write_exr(path, layers, {}, image::Precision::Float);
    return path;
  }
  std::string exr(const std::string& name, const image::Image& image) const {
    return exr(name, std::vector<image::Layer>{{"", "RGB", image}});
  }
  std::string png(const std::string& name, uint8_t value) const {
    const std::string path = (base_ / "in" / name).string();
    image::write_png(path, {32, 24, 3, std::vector<uint8_t>(32 * 24 * 3, value)});
    return path;
  }
  void fails(int code, const Words& words, const std::string& mention) const {
    Words all = {"compare"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome o = run(all);
    EXPECT_EQ(o.code, code) << o.err;
    EXPECT_NE(o.err.find(mention), std::string::npos) << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  }
};

TEST_F(CliCompareTest, NumbersAreRight) {
  const std::string a = exr("a.exr", flat(1.5f)), b = exr("b.exr", flat(1));
  const Outcome o = run({"compare", a, b, "--json", "-"});
  ASSERT_EQ(o.code, 0) << o.err;
  const nlohmann::json d = o.json();
  EXPECT_EQ(d["schema"], "nearfield.compare/1");
  EXPECT_DOUBLE_EQ(d["metrics"]["mae"]["value"], 0.5);
  EXPECT_DOUBLE_EQ(d["metrics"]["mse"]["value"], 0.25);
  EXPECT_DOUBLE_EQ(d["metrics"]["rmse"]["value"], 0.5);
  EXPECT_NEAR(d["metrics"]["relmse"]["value"].get<double>(), 0.25 / 1.01, 1e-9);
  EXPECT_NEAR(d["metrics"]["psnr"]["value"].get<double>(), 6.0206, 1e-3);
  EXPECT_DOUBLE_EQ(d["bias"], 0.5);
  EXPECT_EQ(d["flip_kind"], "hdr");
  EXPECT_EQ(d["pixels"], 32 * 24);
  EXPECT_EQ(d["passed"], true);
  const Outcome text = run({"compare", a, b, "--metric", "rmse,mae"});
  EXPECT_NE(text.out.find("rmse"), std::string::npos);
  EXPECT_EQ(text.out.find("flip"), std::string::npos);
}

TEST_F(CliCompareTest, EqualFilesAreEqual) {
  const std::string a = exr("a.exr", flat(0.5f));
  const Outcome o = run({"compare", a, a, "--json", "-", "--max-rmse", "0", "--max-flip", "0", "--max-abs", "0",
                         "--min-ssim", "1", "--min-psnr", "100"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.json()["metrics"]["psnr"]["value"], "inf");
  EXPECT_EQ(o.json()["checks"].size(), 5u);
}

TEST_F(CliCompareTest, LimitsDecideTheExitCode) {
  const std::string a = exr("a.exr", flat(1.5f)), b = exr("b.exr", flat(1));
  EXPECT_EQ(run({"compare", a, b, "--max-mae", "0.51", "--min-psnr", "6"}).code, 0);
  fails(1, {a, b, "--max-mae", "0.49"}, "mae is 0.5");
  fails(1, {a, b, "--metric", "mae", "--max-rmse", "0.49"}, "rmse is 0.5");
  fails(1, {a, b, "--min-psnr", "7"}, "psnr");
  fails(1, {a, b, "--min-ssim", "0.999"}, "ssim");
  fails(1, {a, b, "--max-abs", "0.4"}, "largest difference");
  EXPECT_EQ(run({"compare", a, b, "--max-abs", "0.6"}).code, 0);
  // What failed is in the document too.
  const Outcome o = run({"compare", a, b, "--max-mae", "0.1", "--json", "-"});
  EXPECT_EQ(o.code, 1);
  EXPECT_EQ(o.json()["passed"], false);
  EXPECT_EQ(o.json()["checks"][0]["name"], "mae");
}

TEST_F(CliCompareTest, AShareOfPixelsMayFail) {
  image::Image off = flat(1);
  for (uint32_t x = 0; x < 6; ++x) off.at(x, 3, 1) = 2;  // 6 of 768 pixels: 0.0078
  const std::string a = exr("a.exr", off), b = exr("b.exr", flat(1));
  EXPECT_EQ(run({"compare", a, b, "--max-abs", "0.5", "--max-fail-fraction", "0.0079"}).code, 0);
  fails(1, {a, b, "--max-abs", "0.5", "--max-fail-fraction", "0.0077"}, "share of pixels");
  fails(2, {a, b, "--max-fail-fraction", "0.1"}, "--max-abs");
}

TEST_F(CliCompareTest, NanIsNeverWithinALimit) {
  image::Image bad = flat(1);
  bad.at(5, 5, 0) = std::nanf("");
  const std::string a = exr("a.exr", bad), b = exr("b.exr", flat(1));
  fails(1, {a, b, "--max-mae", "1e30"}, "mae is inf");
  fails(1, {a, b, "--max-abs", "1e30"}, "inf");
}

TEST_F(CliCompareTest, PngsAreDecoded) {
  // sRGB 188 is linear 0.5029.
  const std::string a = png("a.png", 188), b = png("b.png", 0), c = exr("c.exr", flat(0.502886f));
  const nlohmann::json d = run({"compare", a, b, "--json", "-"}).json();
  EXPECT_NEAR(d["metrics"]["mae"]["value"].get<double>(), 0.502886, 1e-5);
  EXPECT_EQ(d["flip_kind"], "ldr");
  EXPECT_EQ(run({"compare", a, c, "--max-abs", "1e-5"}).code, 0);
  const nlohmann::json white = run({"compare", png("w.png", 255), b, "--json", "-"}).json();
  EXPECT_NEAR(white["metrics"]["flip"]["value"].get<double>(), 0.967, 5e-4);
}

TEST_F(CliCompareTest, LayersByName) {
  const std::string a =
      exr("a.exr", {{"", "RGB", flat(1)}, {"gi", "RGB", flat(2)}, {"visibility", "V", flat(0.5f, 1)}});
  const std::string single = exr("s.exr", {{"ao", "V", flat(0.25f, 1)}});
  EXPECT_EQ(run({"compare", a, a, "--layer", "gi", "--json", "-"}).json()["reference_mean"], 2);
  // The only layer of a file stands for any name.
  EXPECT_DOUBLE_EQ(run({"compare", a, single, "--layer", "visibility", "--json", "-"}).json()["bias"], 0.25);
  EXPECT_DOUBLE_EQ(
      run({"compare", a, a, "--layer", "gi", "--reference-layer", "visibility", "--json", "-"}).json()["bias"], 1.5);
  fails(3, {a, a, "--layer", "nosuch"}, "'visibility'");
  fails(3, {png("p.png", 3), a, "--layer", "gi"}, "only EXR");
}

TEST_F(CliCompareTest, MasksAndBlocks) {
  image::Image off = flat(1), mask = flat(1, 1);
  for (uint32_t y = 0; y < 24; ++y)
    for (uint32_t x = 0; x < 8; ++x) off.at(x, y, 0) = 100, mask.at(x, y, 0) = 0;
  const std::string a = exr("a.exr", off), b = exr("b.exr", flat(1));
  const std::string m = exr("m.exr", {{"mask", "V", mask}}), none = exr("n.exr", {{"", "RGB", flat(0)}});
  const nlohmann::json d = run({"compare", a, b, "--mask", m, "--json", "-", "--max-abs", "0"}).json();
  EXPECT_EQ(d["metrics"]["mae"]["value"], 0);
  EXPECT_EQ(d["pixels"], 24 * 24);
  const nlohmann::json blocks = run({"compare", a, b, "--mask", m, "--block", "8", "--json", "-"}).json();
  EXPECT_EQ(blocks["size"], nlohmann::json({4, 3}));
  EXPECT_EQ(blocks["pixels"], 9);
  fails(3, {a, b, "--mask", none}, "leaves no pixel");
  fails(3, {a, b, "--block", "100"}, "no block");
}

TEST_F(CliCompareTest, WritesPictures) {
  const std::string a = exr("a.exr", flat(1.5f)), b = exr("b.exr", flat(1));
  const Outcome o = run({"compare", a, b, "--heatmap", out("h.png"), "--diff", out("d.png"), "--json", out("c.json")});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(written(), (std::set<std::string>{"h.png", "d.png", "c.json"}));
  EXPECT_EQ(image::read_png(out("h.png")).width, 32u);
  EXPECT_GT(image::read_png(out("h.png")).height, 24u);  // the bar
  EXPECT_EQ(image::read_png(out("d.png")).pixels[0], 255);
  EXPECT_EQ(image::read_png(out("d.png")).pixels[1], 0);
  EXPECT_NE(o.out.find(out("h.png")), std::string::npos);
}

// total = estimator + missing, as numbers and as three maps with one scale.
TEST_F(CliCompareTest, SplitsTheError) {
  const std::string test = exr("t.exr", flat(0.7f)), same = exr("s.exr", flat(0.4f)), truth = exr("r.exr", flat(0.5f));
  const Outcome o = run(
      {"compare", test, truth, "--same-information", same, "--split", out("p.png"), "--metric", "rmse", "--json", "-"});
  ASSERT_EQ(o.code, 0) << o.err;
  const nlohmann::json split = o.json()["split"];
  EXPECT_NEAR(split["total"]["bias"].get<double>(), 0.2, 1e-3);
  EXPECT_NEAR(split["estimator"]["bias"].get<double>(), 0.3, 1e-3);
  EXPECT_NEAR(split["missing"]["bias"].get<double>(), -0.1, 1e-3);
  EXPECT_NEAR(split["missing"]["rmse"].get<double>(), 0.1, 1e-3);
  const image::Image8 picture = image::read_png(out("p.png"));
  EXPECT_EQ(picture.width, 3 * flat(0).width + 8);
  const Outcome text = run({"compare", test, truth, "--same-information", same});
  EXPECT_NE(text.out.find("estimator"), std::string::npos) << text.out;
  EXPECT_TRUE(run({"compare", test, truth, "--json", "-"}).json()["split"].is_null());
  fails(2, {test, truth, "--split", out("q.png")}, "--same-information");
  fails(3, {test, truth, "--same-information", "/no/such.exr"}, "/no/such.exr");
}

TEST_F(CliCompareTest, BadInputs) {
  const std::string a = exr("a.exr", flat(1));
  const std::string small = (base_ / "in/s.png").string();
  image::write_png(small, {3, 2, 3, std::vector<uint8_t>(18)});
  fails(2, {a}, "REFERENCE");
  fails(2, {a, a, "--metric", "mae,nosuch"}, "nosuch");
  fails(2, {a, a, "--block", "0"}, "--block");
  fails(3, {a, "/no/such.exr"}, "/no/such.exr");
  fails(3, {a, small}, "3x2");
  fails(3, {a, input("x.jpg", "x")}, ".exr, .png or .hdr");
  fails(3, {a, input("x.exr", "x")}, "x.exr");
  fails(7, {a, a, "--heatmap", out("no/h.png")}, "no");
}

TEST_F(CliCompareTest, HelpTeaches) {
  const Outcome o = run({"compare", "--help"});
  EXPECT_EQ(o.code, 0);
  for (const char* word : {"relmse", "--max-flip", "--min-ssim", "--mask", "--block", "Examples:", "exit code"})
    EXPECT_NE(o.out.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace nf
