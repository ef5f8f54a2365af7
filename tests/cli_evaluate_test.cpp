// `nearfield evaluate` as a process: a table, what is absent, and a run that is killed and resumed.
#include <cmath>

#include "cli_process.h"
#include "image/image.h"

namespace nf {
namespace {

using nlohmann::json;

class CliEvaluateTest : public CliTest {
 protected:
  // A box with few samples and frames: what is in the table is tested, not how good it is.
  Words words(const std::string& name, const Words& more = {}) const {
    Words all = {"evaluate", scene(),    "--size",  "64x36",        "--spp",
                 "8",        "--frames", "4",       "--timed",      "1",
                 "-o",       out(name),  "--quiet", "--references", out("references")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  json table(const std::string& name) const {
    return json::parse(bytes_of(folder / name / "evaluation.json"), nullptr, false);
  }
  // What does not depend on how busy the machine is.
  static json numbers(json document) {
    json out = json::array();
    for (json& row : document["rows"]) {
      row.erase("ms");
      out.push_back(row);
    }
    return out;
  }
  std::string preset(const std::string& name, const std::string& params) const {
    return input(name, R"({"schema": "nearfield.preset/1", "params": )" + params + "}");
  }
  size_t cells(const std::string& name) const {
    const std::string text = bytes_of(folder / name / "cells.jsonl");
    return size_t(std::count(text.begin(), text.end(), '\n'));
  }
};

TEST_F(CliEvaluateTest, TableAndItsParts) {
  const std::string sky = input("sky.json", R"({"environment": {"color": [0.5, 0.6, 0.8]}})");
  const Outcome o = run({"evaluate", scene() + "@" + sky, "--size", "64x36", "--spp", "16", "--frames", "8", "--timed",
                         "2", "-o", out("t"), "--techniques", "none,vbgi"});
  ASSERT_EQ(o.code, 0) << o.err;
  const json document = table("t");
  EXPECT_EQ(document["schema"], "nearfield.evaluation/1");
  EXPECT_EQ(document["complete"], true);
  ASSERT_EQ(document["rows"].size(), 2u);
  const json &none = document["rows"][0], &vbgi = document["rows"][1];
  EXPECT_EQ(none["contender"], "none");
  EXPECT_EQ(none["place"], "cornell@sky");
  // Absent is said, never made up.
  for (const char* id : {"visibility", "gi_1", "gi_n"}) {
    EXPECT_FALSE(none["quantities"].contains(id)) << id;
    EXPECT_TRUE(none["absent"].contains(id)) << id;
  }
  EXPECT_EQ(none["ms"]["technique"], 0.0);
  // What each of the samples did, told by the shader itself.
  EXPECT_TRUE(none["samples"].is_null());
  const json& samples = vbgi["samples"];
  const int pixels = samples["pixels"];  // of 64 those that see something
  EXPECT_GT(pixels, 16);
  EXPECT_LE(pixels, 64);
  EXPECT_EQ(samples["samples"], pixels * 2 * 16);  // gi.steps on each side of one slice
  EXPECT_GT(samples["counted"].get<double>(), 0.01);
  EXPECT_GT(samples["nothing new"].get<double>(), 0.01);
  EXPECT_NEAR(samples["idle"].get<double>() + samples["counted"].get<double>(), 1, 1e-9);
  EXPECT_GT(vbgi["ms"]["technique"].get<double>(), 0);
  EXPECT_LE(vbgi["ms"]["technique"].get<double>(), vbgi["ms"]["frame"].get<double>());
  for (const char* id : {"visibility", "gi_1", "gi_n", "ambient"}) {
    const json& q = vbgi["quantities"][id];
    ASSERT_TRUE(q.is_object()) << id;
    EXPECT_NEAR(q["total"]["bias"].get<double>(),
                q["estimator"]["bias"].get<double>() + q["missing"]["bias"].get<double>(), 1e-6)
        << id;
    EXPECT_GT(q["total"]["rmse"].get<double>(), 0) << id;
    EXPECT_GT(q["reference_mean"].get<double>(), 0) << id;
    const image::Image8 picture = image::read_png(folder / "t/pictures" / q["picture"].get<std::string>());
    EXPECT_EQ(picture.width, 3 * 64u + 8) << id;
  }
  // With occlusion the ambient light is nearer to the truth than without.
  EXPECT_LT(vbgi["quantities"]["ambient"]["total"]["rmse"].get<double>(),
            none["quantities"]["ambient"]["total"]["rmse"].get<double>());
  const std::string markdown = bytes_of(folder / "t/evaluation.md"), html = bytes_of(folder / "t/evaluation.html");
  EXPECT_NE(markdown.find("| vbgi |"), std::string::npos);
  EXPECT_NE(html.find("<td>vbgi</td>"), std::string::npos);
  EXPECT_EQ(o.out.substr(0, markdown.size()), markdown);
  // The data in the page is the document.
  const size_t begin = html.find("id=\"data\">") + 10, end = html.find("</script>", begin);
  EXPECT_EQ(json::parse(html.substr(begin, end - begin), nullptr, false), document);
}

// Light of N bounces: paths against the geometric series of a furnace; in the box, the technique with feedback against
// a perfect estimator that gathers what it has found.
TEST_F(CliEvaluateTest, Bounces) {
  const auto measure = [&](const std::string& name, const std::string& place, const Words& more) {
    Words all = {"evaluate", place, "--size", "48x27",   "--spp",   "16",           "--frames", "16",
                 "--timed",  "1",   "-o",     out(name), "--quiet", "--techniques", "vbgi",     "--no-pictures"};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome o = run(all);
    EXPECT_EQ(o.code, 0) << o.err;
    return table(name)["rows"][0];
  };
  constexpr double albedo = 0.8;
  for (const int n : {3, 6}) {
    const json room = measure(fmt::format("room{}", n), NF_BINARY_DIR "/content/furnace.glb",
                              {"--bounces", fmt::format("{}", n), "--set", "gi.radius=100", "--set",
                               "gi.radius_mode=ball"})["quantities"]["gi_n"];
    const double sum = (1 - std::pow(albedo, n)) / (1 - albedo);
    EXPECT_NEAR(room["reference_mean"].get<double>(), sum, 0.02 * sum) << n;
    EXPECT_NEAR(room["last_bounce"].get<double>(), std::pow(albedo, n - 1) / sum, 0.01) << n;
  }
  const json box = measure("box", scene(), {"--markdown", out("box.md")});
  const json &one = box["quantities"]["gi_1"], &many = box["quantities"]["gi_n"];
  const double mean = many["reference_mean"];
  EXPECT_EQ(many["bounces"], 6);
  EXPECT_GT(mean, 1.4 * one["reference_mean"].get<double>());
  EXPECT_GT(many["loop_gain"].get<double>(), 0.2);
  EXPECT_LT(many["loop_gain"].get<double>(), 0.6);
  EXPECT_LT(std::pow(many["loop_gain"].get<double>(), many["settled_after"].get<double>()), 1e-3);
  EXPECT_LT(std::abs(many["estimator"]["bias"].get<double>()), 0.09 * mean);
  EXPECT_NE(bytes_of(folder / "box.md").find("gi, N bounces: estimator"), std::string::npos);
  // The albedo's limit is the technique's and the perfect estimator's alike: at 0 there is one bounce.
  const json dark = measure("dark", scene(), {"--set", "feedback.albedo_limit=0"})["quantities"];
  EXPECT_NEAR(dark["gi_n"]["total"]["bias"].get<double>() + mean,
              one["total"]["bias"].get<double>() + one["reference_mean"].get<double>(), 0.1 * mean);
  EXPECT_LT(std::abs(dark["gi_n"]["estimator"]["bias"].get<double>()), 0.15 * mean);
  const json none = measure("none", scene(), {"--bounces", "0"});
  EXPECT_FALSE(none["quantities"].contains("gi_n"));
  EXPECT_NE(none["absent"]["gi_n"].get<std::string>().find("--bounces"), std::string::npos);
}

// A technique at fewer pixels: full resolution is what there is without asking, and fewer pixels see less of fine
// detail than random rays through the same depth do.
TEST_F(CliEvaluateTest, Resolutions) {
  const auto measure = [&](const std::string& name, const Words& more) {
    Words all = {"evaluate",
                 NF_BINARY_DIR "/content/fence.glb",
                 "--size",
                 "48x27",
                 "--spp",
                 "8",
                 "--frames",
                 "8",
                 "--timed",
                 "1",
                 "-o",
                 out(name),
                 "--quiet",
                 "--references",
                 out("references"),
                 "--techniques",
                 "vbgi",
                 "--bounces",
                 "2",
                 "--set",
                 "shadow.resolution=256",
                 "--no-pictures",
                 "--markdown",
                 out(name + ".md")};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome o = run(all);
    EXPECT_EQ(o.code, 0) << o.err;
    return table(name)["rows"];
  };
  const json rows = measure("modes", {"--resolutions", "full,half"}),
             plain = measure("plain", {"--set", "resolution.gi=quarter"});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(plain[0]["quantities"], rows[0]["quantities"]) << "the parameter alone does nothing";
  EXPECT_EQ(rows[1]["contender"], "vbgi@half");
  EXPECT_EQ(rows[1]["params"]["resolution.gi"], "half");
  const auto error = [&](size_t row, const char* of, const char* part) {
    return rows[row]["quantities"][of][part]["rmse"].get<double>();
  };
  EXPECT_GT(error(1, "visibility", "estimator"), 1.3 * error(0, "visibility", "estimator"));
  for (const char* of : {"visibility", "gi_1", "gi_n"}) EXPECT_NE(error(1, of, "total"), error(0, of, "total")) << of;
  const std::string page = bytes_of(folder / "modes.md");
  EXPECT_NE(page.find("## Resolutions"), std::string::npos);
  EXPECT_NE(page.find(fmt::format("| {:.4f} ({:.2f}) |", error(1, "visibility", "estimator"),
                                  error(1, "visibility", "estimator") / error(0, "visibility", "estimator"))),
            std::string::npos)
      << page;
  EXPECT_EQ(bytes_of(folder / "plain.md").find("## Resolutions"), std::string::npos);

  EXPECT_EQ(run(words("bad", {"--resolutions", "third"})).code, 2);
  EXPECT_EQ(run(words("bad", {"--resolutions", "half", "--temporal"})).code, 2);
}

// Figures of papers from a data file: each variant measured as a cell, its page, and a strip of pictures.
TEST_F(CliEvaluateTest, Figures) {
  const std::string text = R"({"schema": "nearfield.paper_figures/1", "not_made": ["the rest"], "figures": [
    {"id": "one", "title": "Thickness", "source": "nobody", "scene": "fence.glb", "base": {"gi.radius": 1},
     "picture": "visibility", "ring": {"reach": 3, "gap": 0.2},
     "show": ["visibility.total.bias", "visibility.variance", "gi_1.total.rmse", "visibility.ring.bias"],
     "variants": [{"label": "thin", "technique": "vbao", "params": {"gi.thickness": 0.01}},
                  {"label": "thick", "technique": "vbao", "params": {"gi.thickness": 50}}]},
    {"id": "two", "title": "Sums", "source": "nobody", "scene": "fence.glb", "view": "fence.json",
     "show": ["indirect.total.bias", "indirect.share"],
     "variants": [{"label": "none", "technique": "none"},
                  {"label": "all", "technique": "ssao"},
                  {"label": "open", "technique": "ssao", "ambient_of": "none"}]},
    {"id": "turned", "title": "Shading", "source": "nobody", "scene": "fence.glb", "view": "fence_map.json",
     "turned": "fence_turned.json", "base": {"gi.radius": 1}, "show": ["shading.change", "shading.correlation"],
     "variants": [{"label": "none", "technique": "none"},
                  {"label": "static", "technique": "ssao"},
                  {"label": "follows", "technique": "vbao"}]},
    {"id": "three", "title": "Noise", "source": "nobody", "scene": "cornell.glb", "kind": "noise",
     "variants": [{"label": "one", "technique": "hbil"},
                  {"label": "many", "technique": "hbil", "params": {"temporal.enabled": true}, "frames": 8}]},
    {"id": "four", "title": "Holes", "source": "nobody", "scene": "cornell.glb", "kind": "holes",
     "base": {"feedback.reprojection": "scatter", "denoise.method": "atrous"},
     "variants": [{"label": "still", "technique": "hbil"},
                  {"label": "aside", "technique": "hbil", "moved": [0.2, 0, 0]},
                  {"label": "further", "technique": "hbil", "moved": [0.4, 0, 0]}]},
    {"id": "five", "title": "Lamp", "source": "nobody", "scene": "cornell.glb", "view": "cornell_lamp.json",
     "kind": "direct", "picture": "direct",
     "base": {"shadow.tiles": 0, "shadow.screen_samples": 32, "shadow.screen_thickness": 0},
     "variants": [{"label": "open", "technique": "none", "params": {"shadow.enabled": false}},
                  {"label": "short", "technique": "none", "params": {"shadow.screen_length": 0.3}},
                  {"label": "long", "technique": "none", "params": {"shadow.screen_length": 1}},
                  {"label": "map", "technique": "none",
                   "params": {"shadow.tiles": 12, "shadow.screen_samples": 0}}]}]})";
  const auto measure = [&](const std::string& name, const std::string& figures, const Words& more = {}) {
    std::filesystem::create_directories(folder / name);
    std::ofstream(folder / name / "figures.json") << figures;
    Words words = {"evaluate",   NF_BINARY_DIR "/content",
                   "--presets",  out(name),
                   "--size",     "48x27",
                   "--spp",      "8",
                   "--frames",   "4",
                   "--timed",    "1",
                   "-o",         out(name + "-result"),
                   "--markdown", out(name + ".md")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  const Outcome o = measure("good", text);
  ASSERT_EQ(o.code, 0) << o.err;
  const json figures = json::parse(bytes_of(folder / "good-result/figures.json"))["figures"];
  const auto bias = [&](size_t row) {
    return figures[0]["rows"][row]["quantities"]["visibility"]["total"]["bias"].get<double>();
  };
  EXPECT_GT(bias(0), bias(1) + 0.02) << "what is thick hides more";
  const auto ring = [&](size_t row) { return figures[0]["rows"][row]["quantities"]["visibility"]["ring"]; };
  EXPECT_GT(ring(0)["pixels"].get<int>(), 50);
  EXPECT_LT(ring(0)["pixels"].get<int>(), 48 * 27 / 2);
  EXPECT_LT(ring(1)["bias"].get<double>(), bias(1)) << "behind the bars it is darkest";

  const auto sums = [&](size_t row) { return figures[1]["rows"][row]["quantities"]["indirect"]; };
  EXPECT_EQ(sums(0)["share"].get<double>(), 0) << "no bounce";
  EXPECT_GT(sums(1)["share"].get<double>(), 0);
  EXPECT_GT(sums(2)["share"].get<double>(), 0);
  EXPECT_LT(sums(2)["share"].get<double>(), sums(1)["share"].get<double>()) << "the same, in more";
  // What bleeds is on top of what is open: open - none = all - (all's ambient light), so open is the brightest.
  EXPECT_GT(sums(2)["total"]["bias"].get<double>(), sums(0)["total"]["bias"].get<double>());
  EXPECT_GT(sums(0)["total"]["bias"].get<double>(), sums(1)["total"]["bias"].get<double>());

  const auto shading = [&](size_t row) { return figures[2]["rows"][row]["quantities"]["shading"]; };
  EXPECT_LT(shading(0)["change"].get<double>(), 0.01) << "without occlusion there is no shading";
  EXPECT_LT(shading(1)["change"].get<double>(), 0.1) << "AO is the same under any light";
  EXPECT_GT(shading(2)["change"].get<double>(), 0.3);
  EXPECT_GT(shading(2)["correlation"].get<double>(), 0.3);

  const auto noise = [&](size_t row, const char* of) { return figures[3]["rows"][row][of].get<double>(); };
  EXPECT_GT(noise(0, "pixel"), 2 * noise(0, "4x4"));
  EXPECT_GT(noise(0, "pixel"), 2 * noise(1, "pixel"));

  const auto holes = [&](size_t row, const char* of) { return figures[4]["rows"][row][of].get<double>(); };
  EXPECT_EQ(holes(0, "holes"), 0);
  EXPECT_GT(holes(1, "holes"), 0.005);
  EXPECT_GT(holes(2, "holes"), holes(1, "holes"));
  EXPECT_LT(holes(1, "holes"), 0.5);
  EXPECT_EQ(holes(1, "holes left"), 0);
  const json& aside = figures[4]["rows"][2];
  EXPECT_GT(aside["rmse of holes"]["rmse"], aside["rmse of holes"]["floor"]);
  EXPECT_TRUE(figures[4]["rows"][0]["rmse of holes"].is_null()) << "there are none";
  EXPECT_EQ(figures[4]["rows"][0]["rmse of others"]["rmse"].get<double>(), 0);

  const auto lamp = [&](size_t row, const char* of) { return figures[5]["rows"][row][of].get<double>(); };
  EXPECT_EQ(lamp(0, "shadow found"), 0) << "no shadows at all";
  EXPECT_EQ(lamp(0, "shadow made up"), 0);
  EXPECT_GT(lamp(0, "bias"), 0.01);
  EXPECT_GT(lamp(1, "shadow found"), 0.05);
  EXPECT_GT(lamp(2, "shadow found"), lamp(1, "shadow found") + 0.1) << "further from what casts it";
  EXPECT_LT(lamp(2, "bias"), lamp(1, "bias"));
  EXPECT_GT(lamp(3, "shadow found"), 0.8) << "what a shadow map has is the path tracer's";
  EXPECT_LT(lamp(3, "shadow made up"), 0.05);
  const auto rmse = [&](size_t row) { return figures[5]["rows"][row]["rmse"]["rmse"].get<double>(); };
  for (size_t row = 0; row < 3; ++row) EXPECT_LT(rmse(3), rmse(row)) << row;

  const std::string page = bytes_of(folder / "good.md");
  EXPECT_EQ(image::read_png(folder / "pictures/figures/five.png").width, 5 * 52u - 4);
  EXPECT_NE(page.find(fmt::format("| thin | {:+.4f} |", bias(0))), std::string::npos) << page;
  EXPECT_NE(page.find("| – |"), std::string::npos) << "vbao has no light";
  EXPECT_NE(page.find("(pictures/figures/one.png)"), std::string::npos);
  EXPECT_EQ(image::read_png(folder / "pictures/figures/one.png").width, 3 * 52u - 4) << "two variants and the truth";

  const auto fails = [&](const std::string& from, const std::string& to, int code) {
    std::string wrong = text;
    wrong.replace(wrong.find(from), from.size(), to);
    const Outcome bad = measure("bad", wrong);
    EXPECT_EQ(bad.code, code) << bad.err;
    EXPECT_NE(bad.err.find(to), std::string::npos) << bad.err;
  };
  fails("visibility.variance", "visibility.varience", 3);
  fails("gi.thickness", "gi.thikness", 3);
  fails("noise", "voice", 3);
  fails("gap", "gab", 3);
  fails("ambient_of", "ambience", 3);
  fails("label", "lable", 3);
  EXPECT_EQ(measure("set", text, {"--set", "gi.radius=2"}).code, 2);
}

// A kill in the middle loses no finished cell, and the table is the same as without.
TEST_F(CliEvaluateTest, KilledAndResumed) {
  std::string presets = "default";
  for (int i = 1; i <= 5; ++i)
    presets += "," + preset(fmt::format("p{}.json", i), fmt::format(R"({{"gi.slices": {}}})", i));
  const Words more = {"--techniques", "vbgi,none", "--presets", presets, "--no-pictures"};
  ASSERT_EQ(run(words("whole", more)).code, 0);
  const json whole = table("whole");
  ASSERT_EQ(whole["rows"].size(), 12u);

  const pid_t pid = start(words("cut", more));
  for (int i = 0; i < 10000 && !(std::filesystem::exists(folder / "cut/cells.jsonl") && cells("cut") >= 2); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(pid, SIGKILL);
  EXPECT_EQ(finish(pid).code, -SIGKILL);
  const size_t done = cells("cut");
  ASSERT_GE(done, 2u);
  ASSERT_LT(done, 12u);
  // As if the kill had come in the middle of a line.
  std::ofstream(folder / "cut/cells.jsonl", std::ios::app) << R"({"key":"0123)";
  const std::string before = bytes_of(folder / "cut/cells.jsonl");

  Words resume = words("cut", more);
  resume.push_back("--resume");
  resume.erase(std::find(resume.begin(), resume.end(), "--quiet"));
  const Outcome o = run(resume);
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.err.find(fmt::format("12 of 12 cells, {} of them from an earlier run", done)), std::string::npos)
      << o.err;
  EXPECT_NE(o.err.find("0 references made"), std::string::npos) << o.err;
  EXPECT_EQ(numbers(table("cut")), numbers(whole));
  EXPECT_EQ(cells("cut"), 12u);
  // The cells taken over are those that were there, times included.
  size_t kept = 0;
  const json resumed = table("cut");
  for (const json& row : resumed["rows"]) kept += before.find(row["ms"].dump()) != std::string::npos;
  EXPECT_GE(kept, done);

  // Other settings are other cells.
  Words other = resume;
  other.insert(other.end(), {"--set", "gi.radius=0.5"});
  const Outcome changed = run(other);
  EXPECT_EQ(changed.code, 0) << changed.err;
  EXPECT_NE(changed.err.find(", 0 of them from an earlier run"), std::string::npos) << changed.err;
  EXPECT_NE(numbers(table("cut")), numbers(whole));
}

// `reference --same-information` on the device: the CPU's answer to the noise of both.
TEST_F(CliEvaluateTest, MarchesOnTheDevice) {
  const auto march = [&](const std::string& name, const Words& more) {
    Words all = {"reference", scene(), "--size", "48x27", "--spp", "64", "--same-information", "-o", out(name)};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome o = run(all);
    EXPECT_EQ(o.code, 0) << o.err;
    return image::read_exr(out(name));
  };
  const image::ExrFile cpu = march("cpu.exr", {}), gpu = march("gpu.exr", {"--gpu"});
  EXPECT_NE(cpu.header.at("nearfield.device"), gpu.header.at("nearfield.device"));
  const json rmse =
      run({"compare", out("gpu.exr"), out("cpu.exr"), "--layer", "visibility", "--metric", "rmse", "--json", "-"})
          .json();
  EXPECT_LT(rmse["metrics"]["rmse"]["value"].get<double>(), 0.06);
  EXPECT_GT(rmse["metrics"]["rmse"]["value"].get<double>(), 0);
  EXPECT_LT(std::abs(rmse["bias"].get<double>()), 0.004);
}

TEST_F(CliEvaluateTest, Failures) {
  const auto fails = [&](int code, const Words& more, const std::string& mention) {
    const Outcome o = run(words("f", more));
    EXPECT_EQ(o.code, code) << o.err;
    EXPECT_NE(o.err.find(mention), std::string::npos) << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  };
  fails(3, {"--techniques", "nosuch"}, "nosuch");
  fails(2, {"--techniques", "none:paper"}, "no form 'paper'");
  fails(3, {"--presets", "/no/such.json"}, "/no/such.json");
  fails(3, {"--presets", "/proc"}, "no presets '/proc'");
  fails(2, {"--technique", "vbgi"}, "--techniques");
  fails(2, {"--frames", "0"}, "--frames");
  fails(2, {scene()}, "twice");
  fails(3, {"/no/such.glb"}, "/no/such.glb");
  EXPECT_EQ(run({"evaluate", scene(), "-o", "/proc/no"}).code, 7);
}

// What happens over time: the numbers are there and plausible, what is absent is said, and a reconstruction that does
// not look for changed light has the longer ghosts.
TEST_F(CliEvaluateTest, OverTime) {
  const auto measure = [&](const std::string& name, const Words& more) {
    Words all = {"evaluate", scene(), "--temporal", "--size", "48x27", "--frames", "64", "-o", out(name), "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome o = run(all);
    EXPECT_EQ(o.code, 0) << o.err;
    return json::parse(bytes_of(folder / name / "temporal.json"), nullptr, false);
  };
  const json document = measure("time", {"--techniques", "vbgi,none", "--markdown", out("time.md")});
  EXPECT_EQ(document["schema"], "nearfield.temporal/1");
  EXPECT_EQ(document["complete"], true);
  ASSERT_EQ(document["rows"].size(), 2u);
  const json &vbgi = document["rows"][0], &none = document["rows"][1];
  EXPECT_TRUE(none.contains("absent"));
  EXPECT_EQ(vbgi["signal"], "gi");
  for (const char* noise : {"own_noise", "stbn"}) {
    const json& means = vbgi["convergence"][noise];
    EXPECT_LT(means["slope"].get<double>(), -0.35) << noise;
    EXPECT_GT(means["slope"].get<double>(), -1.2) << noise;
    EXPECT_EQ(means["rmse"].back()["frames"], 128);
    EXPECT_LT(means["rmse"].back()["rmse"], means["rmse"][0]["rmse"]);
  }
  EXPECT_NE(vbgi["convergence"]["own_noise"], vbgi["convergence"]["stbn"]);
  const json& raw = vbgi["settling"]["raw"]["errors"];
  EXPECT_EQ(raw.back()["median"], 0.0) << "the whole mean is the mean";
  EXPECT_GT(raw[0]["median"].get<double>(), 0.05);
  EXPECT_EQ(vbgi["jump"]["occluder"], "short");
  EXPECT_GT(vbgi["jump"]["uncovered_pixels"].get<int>(), 20);
  EXPECT_GT(vbgi["pan"]["signal"].get<double>(), 0);
  EXPECT_GT(vbgi["pan"]["picture"].get<double>(), 0);
  const std::string markdown = bytes_of(folder / "time.md");
  EXPECT_EQ(markdown, bytes_of(folder / "time/temporal.md"));
  EXPECT_NE(markdown.find("| vbgi | gi |"), std::string::npos);

  // A mean whose newest frame weighs 1 / N keeps half for ln 2 / -ln(1 - 1 / N) frames.
  for (const double n : {3.0, 8.0}) {
    const std::string frames = fmt::format("temporal.frames={}", n);
    const json plain = measure(fmt::format("plain{}", n),
                               {"--techniques", "vbao", "--set", "temporal.antilag=0", "--set", "temporal.motion=0",
                                "--set", frames, "--set", "denoise.method=off"})["rows"][0];
    EXPECT_EQ(plain["signal"], "visibility");
    EXPECT_GT(plain["jump"]["ghost_pixels"].get<int>(), 20);
    EXPECT_NEAR(plain["jump"]["half_life"].get<double>(), std::log(0.5) / std::log(1 - 1 / n), 0.1 * n) << n;
  }
  const json& settling = vbgi["settling"];
  for (const char* of : {"reconstructed", "reconstructed_to_raw", "picture", "picture_to_raw"})
    EXPECT_EQ(settling[of]["looked_at"], 32) << of;
  const auto after_32 = [&](const char* of) { return settling[of]["errors"].back()["median"].get<double>(); };
  EXPECT_LT(after_32("reconstructed"), raw[5]["median"].get<double>()) << "32 frames: less noise than their mean";
  EXPECT_LT(after_32("picture"), after_32("reconstructed")) << "other light has no noise";

  // Parts, each for itself, and sets of presets.
  const auto part = [&](const std::string& name, const std::string& parts, const Words& more = {}) {
    Words all = {"evaluate", scene(),  "--temporal" + parts, "--techniques", "vbgi",
                 "--size",   "48x27",  "--frames",           "64",           "-o",
                 out(name),  "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  };
  const auto document_of = [&](const std::string& name) {
    return json::parse(bytes_of(folder / name / "temporal.json"), nullptr, false);
  };
  ASSERT_EQ(part("settle", "=settling").code, 0);
  const json alone = document_of("settle")["rows"][0];
  EXPECT_EQ(alone["settling"], settling) << "whatever else is measured";
  EXPECT_FALSE(alone.contains("pan") || alone.contains("jump") || alone.contains("convergence"));
  EXPECT_EQ(bytes_of(folder / "settle/temporal.md").find("flicker"), std::string::npos);
  EXPECT_EQ(part("bad", "=settling,speed").code, 2);
  std::filesystem::create_directories(folder / "set");
  for (const char* passes : {"1", "5"})
    std::ofstream(folder / "set" / (std::string(passes) + ".json"))
        << R"({"schema": "nearfield.preset/1", "params": {"denoise.passes": )" << passes << "}}";
  const Outcome sets = part("sets", "=settling", {"--presets", "default," + out("set")});
  ASSERT_EQ(sets.code, 0) << sets.err;
  const json of_set = document_of("sets")["rows"];
  ASSERT_EQ(of_set.size(), 3u);
  EXPECT_EQ(of_set[0]["settling"], settling);
  EXPECT_EQ(of_set[1]["settling"]["raw"], settling["raw"]) << "raw frames are not denoised";
  const auto noise = [&](size_t row) {
    return of_set[row]["settling"]["reconstructed"]["errors"].back()["median"].get<double>();
  };
  EXPECT_LT(noise(2), noise(1)) << "a wider filter leaves less noise";
  EXPECT_EQ(part("none", "=settling", {"--presets", out("nosuch")}).code, 3);

  const json nobody = measure("nobody", {"--techniques", "vbgi", "--occluder", "nobody"})["rows"][0];
  EXPECT_TRUE(nobody["jump"].contains("absent"));
  EXPECT_EQ(nobody["pan"], vbgi["pan"]) << "the occluder is back, and the same command gives the same numbers";
}

}  // namespace
}  // namespace nf
