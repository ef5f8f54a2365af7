// `nearfield bench` as a process: every file it writes, read by something strict. No time is asserted.
#include <cmath>
#include <cstdlib>

#include "capture/trace.h"
#include "cli_process.h"
#include "image/image.h"
#include "strict_csv.h"

namespace nf {
namespace {

using nlohmann::json;

class BenchTest : public CliTest {
 protected:
  Outcome bench(const Words& words, const Words& environment = {}) const {
    Words all = {"bench", scene(), "--size", "48x27", "--frames", "4", "--warmup", "1", "--repeats", "2"};
    all.insert(all.end(), words.begin(), words.end());
    return run(all, environment);
  }
};

TEST_F(BenchTest, WritesEverything) {
  const Outcome outcome =
      bench({"--technique", "none", "--technique", "vbgi", "--block", "3", "--counts", "--json", out("t.json"), "--csv",
             out("csv"), "--trace", out("trace.json"), "--pictures", out("pictures")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("unattributed"), std::string::npos);
  const json doc = json::parse(bytes_of(out("t.json")));
  ASSERT_EQ(schema_fault(doc), "");
  ASSERT_EQ(doc["runs"].size(), 2u);
  EXPECT_EQ(doc["runs"][0]["name"], "none");
  for (const json& run : doc["runs"]) {
    EXPECT_EQ(run["frame"]["gpu_ms"]["count"], 8);
    EXPECT_EQ(run["frame"]["per_repeat_median"].size(), 2u);
    EXPECT_EQ(run["context"]["device"]["software"],
              run["warnings"].dump().find("software device") != std::string::npos);
    for (const json& pass : run["passes"]) {
      EXPECT_EQ(pass["gpu_ms"]["count"], 8) << pass["path"];
      if (pass["path"] == "vbgi.trace") {
        EXPECT_GE(pass["counts"]["compute_invocations"], 48 * 27);
      }
      if (pass["path"] == "tonemap") {
        EXPECT_GE(pass["counts"]["fragment_invocations"], 48 * 27);
        EXPECT_EQ(pass["counts"]["vertices"], 3);
      }
    }
  }
  const image::Image8 none = image::read_png(out("pictures/none.png")),
                      vbgi = image::read_png(out("pictures/vbgi.png"));
  EXPECT_EQ(vbgi.width, 48u);
  EXPECT_NE(none.pixels, vbgi.pixels);

  // A broken document does not pass.
  json bad = doc;
  bad["runs"][0]["passes"][0]["gpu_ms"].erase("median");
  EXPECT_NE(schema_fault(bad).find("'median' is a required property"), std::string::npos);
  bad = doc;
  bad["runs"][0]["extra"] = 1;
  EXPECT_NE(schema_fault(bad), "");

  const auto faults = capture::check_trace(json::parse(bytes_of(out("trace.json"))));
  EXPECT_TRUE(faults.empty()) << faults.front();

  const test::CsvRows summary = test::read_csv(bytes_of(out("csv/summary.csv")));
  EXPECT_EQ(summary.size(), 1 + doc["runs"][0]["passes"].size() + doc["runs"][1]["passes"].size() + 4);
  const test::CsvRows frames = test::read_csv(bytes_of(out("csv/frames.csv")));
  EXPECT_EQ(frames[0], (std::vector<std::string>{"run", "repeat", "frame", "pass", "gpu_ms", "cpu_ms"}));
  EXPECT_EQ(frames.size() - 1, 8 * (doc["runs"][0]["passes"].size() + doc["runs"][1]["passes"].size() + 2));
  // Interleaved: the techniques take turns.
  std::string order;
  for (size_t i = 1; i < frames.size(); ++i)
    if (frames[i][3] == "frame" && (order.empty() || order.back() != frames[i][0][0])) order += frames[i][0][0];
  EXPECT_EQ(order, "nvnvn");
}

// Every pass and the frame against a baseline that is this run's own times a thousand, and a thousandth.
TEST_F(BenchTest, BaselineDecidesTheExitCode) {
  ASSERT_EQ(bench({"--json", out("t.json")}).code, 0);
  const auto scaled = [&](double factor) {
    json doc = json::parse(bytes_of(out("t.json")));
    for (json& run : doc["runs"]) {
      const auto scale = [&](json& of) {
        for (const char* key : {"median", "mad"}) of["gpu_ms"][key] = of["gpu_ms"][key].get<double>() * factor;
        for (json& value : of["per_repeat_median"]) value = value.get<double>() * factor;
      };
      for (json& pass : run["passes"]) scale(pass);
      scale(run["frame"]);
    }
    return input("baseline.json", doc.dump());
  };
  const Outcome faster = bench({"--baseline", scaled(1000)});
  EXPECT_EQ(faster.code, 0) << faster.err;
  EXPECT_NE(faster.out.find("faster"), std::string::npos);
  const Outcome slower = bench({"--baseline", scaled(0.001), "--fail-above", "0.05"});
  EXPECT_EQ(slower.code, 1) << slower.out;
  EXPECT_NE(slower.out.find("REGRESSION"), std::string::npos);
  EXPECT_NE(slower.err.find("on the baseline's"), std::string::npos) << slower.err;
}

TEST_F(BenchTest, PresetSetPathAndOverlap) {
  const std::string path = input("path.json", R"({"schema": "nearfield.path/1", "keys": [
    {"frame": 0, "camera": {"position": [0, 1, 3.2], "target": [0, 1, 0]}},
    {"frame": 3, "camera": {"position": [0.4, 1.2, 2.6], "target": [0, 1, 0]}}]})");
  const Outcome outcome = bench({"--preset-set", "cost", "--path", path, "--timing", "overlap", "--json", "-"});
  const json doc = outcome.json();
  ASSERT_TRUE(doc.is_object()) << outcome.err;
  EXPECT_EQ(schema_fault(doc), "");
  ASSERT_EQ(doc["runs"].size(), 3u);
  EXPECT_EQ(doc["runs"][0]["name"], "vbgi_high");
  EXPECT_EQ(doc["runs"][0]["settings"]["changed"]["gi.slices"], 4);
  EXPECT_EQ(doc["runs"][1]["settings"]["params"]["gi.steps"], 4);
  EXPECT_EQ(doc["runs"][0]["method"]["timing"], "overlap");
  EXPECT_NE(doc["runs"][0]["warnings"].dump().find("overlap"), std::string::npos);
  EXPECT_EQ(doc["runs"][0]["method"]["camera_path"], true);
}

TEST_F(BenchTest, CountsAndTheHookRunCleanUnderValidation) {
  const Outcome outcome = bench({"--validation", "--counts"}, {"NEARFIELD_TEST_SLOW=vbgi.trace:0.3"});
  EXPECT_EQ(outcome.code, 0) << outcome.err.substr(0, 500);
  EXPECT_NE(outcome.out.find("noisy: validation is on"), std::string::npos);
  EXPECT_NE(outcome.err.find("test hook: 30 % of vbgi.trace"), std::string::npos);
}

TEST_F(BenchTest, MistakesAreSaid) {
  const std::string junk = input("junk.json", "{}");
  const std::vector<std::tuple<Words, int, const char*>> cases = {
      {{"--technique", "xyz"}, 3, "unknown technique 'xyz'"},
      {{"--technique", "vbgi", "--technique", "vbgi"}, 2, "measured twice"},
      {{"--preset-set", "nowhere"}, 3, "no presets 'nowhere'"},
      {{"--baseline", junk}, 3, "no nearfield.timing/1 document"},
      {{"--fail-above", "x%"}, 2, "bad --fail-above"},
      {{"--json", out("none/t.json")}, 7, "no folder"},
      {{"--path", junk}, 3, "schema"},
  };
  for (const auto& [words, code, text] : cases) {
    const Outcome outcome = bench(words);
    EXPECT_EQ(outcome.code, code) << text;
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
  }
}

TEST_F(BenchTest, InterruptedItWritesWhatThereIs) {
  const pid_t pid = start({"bench", scene(), "--size", "48x27", "--frames", "100000", "--warmup", "0", "--json",
                           out("t.json"), "--csv", out("csv")});
  ASSERT_TRUE(wait_for_handler(pid));
  for (int i = 0; i < 3000 && bytes_of(out("csv/frames.csv")).size() < 2000; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(pid, SIGINT);
  const Outcome outcome = finish(pid);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const json doc = json::parse(bytes_of(out("t.json")));
  EXPECT_EQ(doc["complete"], false);
  EXPECT_EQ(schema_fault(doc), "");
  EXPECT_GT(doc["runs"][0]["frame"]["gpu_ms"]["count"], 0);
}

// A preset set of tables: ratios of costs, next to those of the figures that the file has from a paper.
TEST_F(BenchTest, PaperTables) {
  const std::string text = R"({"schema": "nearfield.paper_tables/1", "not_made": ["the rest"], "tables": [
    {"id": "t", "title": "Steps", "source": "nobody", "size": "64x36", "over": {"row": "few"}, "unit": "fps",
     "published_without": 50, "base": {"gi.slices": 4},
     "columns": [{"id": "v", "label": "bitmask", "technique": "vbao"}],
     "rows": [{"id": "few", "label": "4", "params": {"gi.steps": 4}, "published": {"v": 25}},
              {"id": "many", "label": "64", "params": {"gi.steps": 64}, "published": {"v": 10}}]},
    {"id": "s", "title": "Stages", "source": "nobody", "size": "64x36", "kind": "stages",
     "form": {"technique": "vbgi", "params": {"denoise.method": "small"}},
     "stages": [{"label": "march", "passes": ["vbgi.trace"], "published": 3},
                {"label": "filter", "passes": ["denoise.prepare", "denoise.level1"], "published": 1}]}]})";
  const auto set = [&](const std::string& name, const std::string& tables) {
    std::filesystem::create_directories(folder / name);
    std::ofstream(folder / name / "tables.json") << tables;
    return out(name);
  };
  const auto measure = [&](const std::string& folder_name, const Words& more = {}) {
    Words words = {"bench", scene(), "--preset-set", folder_name, "--frames", "4", "--warmup", "1", "--repeats", "2"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  const Outcome o = measure(set("good", text), {"--json", out("t.json"), "--markdown", out("t.md")});
  ASSERT_EQ(o.code, 0) << o.err;
  const json tables = json::parse(bytes_of(out("t.json")))["tables"];
  ASSERT_EQ(tables.size(), 2u);
  const json &few = tables[0]["rows"][0]["cells"]["v"], &many = tables[0]["rows"][1]["cells"]["v"];
  EXPECT_EQ(few["ratio"], 1.0);
  // 16 times the samples; (1000 / 10 - 1000 / 50) / (1000 / 25 - 1000 / 50).
  EXPECT_GT(many["ratio"].get<double>(), 3);
  EXPECT_LT(many["ratio"].get<double>(), 30);
  EXPECT_NEAR(many["published_ratio"].get<double>(), 4, 1e-9);
  EXPECT_NEAR(tables[1]["stages"][0]["published_share"].get<double>(), 0.75, 1e-9);
  EXPECT_NEAR(tables[1]["stages"][0]["share"].get<double>() + tables[1]["stages"][1]["share"].get<double>(), 1, 1e-9);
  const std::string page = bytes_of(out("t.md"));
  EXPECT_EQ(o.out, page);
  EXPECT_NE(page.find("| over few | bitmask |"), std::string::npos);
  EXPECT_NE(page.find("(4.00) |"), std::string::npos);
  EXPECT_NE(page.find("- the rest"), std::string::npos);

  const auto fails = [&](int code, const std::string& from, const std::string& to, const std::string& mention) {
    std::string wrong = text;
    wrong.replace(wrong.find(from), from.size(), to);
    const Outcome bad = measure(set("bad", wrong));
    EXPECT_EQ(bad.code, code) << bad.err;
    EXPECT_NE(bad.err.find(mention), std::string::npos) << bad.err;
  };
  fails(3, "gi.steps", "gi.stepps", "gi.stepps");
  fails(3, "\"over\": {\"row\": \"few\"}", "\"over\": {\"row\": \"fewer\"}", "fewer");
  fails(3, "\"label\": \"4\"", "\"lable\": \"4\"", "lable");
  fails(3, "denoise.level1", "denoise.smell", "smell");
  EXPECT_EQ(measure(out("good"), {"--technique", "vbgi"}).code, 2);
  EXPECT_EQ(bench({"--markdown", out("no.md")}).code, 2);
}

// What is shipped is whole: every cell's settings are read before anything is measured.
TEST_F(BenchTest, ShippedTablesAreRead) {
  const Outcome o = run({"bench", "/no/such.glb", "--preset-set", "papers"});
  EXPECT_EQ(o.code, 3);
  EXPECT_NE(o.err.find("/no/such.glb"), std::string::npos) << o.err;
}

}  // namespace
}  // namespace nf
