// `nearfield sweep` and `report` as processes: no cell is lost or measured twice, whoever hands out the work.
#include <cstdlib>

#include "cli_process.h"
#include "strict_csv.h"

namespace nf {
namespace {

using nlohmann::json;

class SweepTest : public CliTest {
 protected:
  // none and vbgi with `slices`; 1 + slices x 2 cells.
  std::string spec(json slices, const json& more = json::object()) const {
    json s = {{"schema", "nearfield.sweep/1"},
              {"scene", scene()},
              {"size", {32, 18}},
              {"reference", {{"spp", 4}}},
              {"repeats", 1},
              {"warmup", 1},
              {"frames", 2},
              {"group", 2}};
    s["runs"] = {{{"technique", "none"}},
                 {{"name", "v"}, {"technique", "vbgi"}, {"permute", {{"gi.slices", slices}, {"gi.steps", {2, 6}}}}}};
    s.update(more);
    return input("spec.json", s.dump());
  }
  static std::vector<json> lines_of(const std::filesystem::path& file) {
    std::vector<json> rows;
    std::istringstream in(bytes_of(file));
    for (std::string line; std::getline(in, line);) rows.push_back(json::parse(line));
    return rows;
  }
  static std::multiset<std::string> ids_of(const std::filesystem::path& file) {
    std::multiset<std::string> ids;
    for (const json& row : lines_of(file)) ids.insert(row["id"].get<std::string>());
    return ids;
  }
  const std::multiset<std::string> five = {"cornell/none", "cornell/v/gi.slices=1,gi.steps=2",
                                           "cornell/v/gi.slices=1,gi.steps=6", "cornell/v/gi.slices=3,gi.steps=2",
                                           "cornell/v/gi.slices=3,gi.steps=6"};
};

TEST_F(SweepTest, MeasuresEveryCellAndAnswersABudget) {
  const Outcome outcome = run({"sweep", spec({1, 3}), "-o", out("s"), "--budget", "100000ms"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(ids_of(out("s/cells.jsonl")), five);
  for (const json& cell : lines_of(out("s/cells.jsonl"))) {
    EXPECT_EQ(cell["gpu_ms"]["count"], 2);
    const double technique = cell["technique_ms"]["median"];
    if (cell["technique"] == "none")
      EXPECT_EQ(technique, 0);
    else
      EXPECT_TRUE(technique > 0 && technique < cell["gpu_ms"]["median"].get<double>()) << cell["id"];
    EXPECT_GT(cell["errors"]["relmse"], 0) << cell["id"];
    EXPECT_TRUE(std::filesystem::exists(out("s") + "/" + cell["picture"].get<std::string>()));
  }
  EXPECT_EQ(test::read_csv(bytes_of(out("s/summary.csv"))).size(), 6u);
  const json preset = json::parse(bytes_of(out("s/budget.json")));
  render({"-o", out("a.png"), "--preset", out("s/budget.json")});
  // The budget that no cell keeps.
  const Outcome none = run({"sweep", spec({1, 3}), "-o", out("s"), "--resume", "--budget", "0.0001"});
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("nothing within 0.0001 ms"), std::string::npos) << none.err;
  EXPECT_EQ(ids_of(out("s/cells.jsonl")), five);
  // Over what there is nothing is written without --resume, nor into another sweep's folder.
  EXPECT_EQ(run({"sweep", spec({1, 3}), "-o", out("s")}).code, 2);
  EXPECT_EQ(run({"sweep", spec({2}), "-o", out("s"), "--resume"}).code, 3);

  // The report is one file that loads nothing and holds the data.
  const std::string page = bytes_of(out("s/report.html"));
  std::string rest = page;
  for (size_t at; (at = rest.find("http://www.w3.org/2000/svg")) != std::string::npos;) rest.erase(at, 26);
  EXPECT_EQ(rest.find("http"), std::string::npos);
  EXPECT_EQ(rest.find(" src=\"/"), std::string::npos);
  const std::string mark = "id=\"data\">";
  const size_t begin = page.find(mark) + mark.size();
  const json data = json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  EXPECT_EQ(data["sweeps"][0]["cells"].size(), 5u);
  EXPECT_EQ(data["pictures"].size(), 6u);
}

TEST_F(SweepTest, ATechniquesOwnPassesAreACost) {
  const Outcome outcome = run({"sweep", spec({1}, {{"cost", "technique"}}), "-o", out("s"), "--budget", "0.0001"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("within 0.0001 ms: none takes 0.000 ms"), std::string::npos) << outcome.out;
  EXPECT_EQ(run({"sweep", spec({1}, {{"cost", "gpu"}}), "-o", out("t")}).code, 3);
}

TEST_F(SweepTest, KilledAndResumedItLosesNothing) {
  const pid_t pid = start({"sweep", spec({1, 3}, {{"group", 1}, {"frames", 30}}), "-o", out("s")});
  for (int i = 0; i < 6000 && bytes_of(out("s/cells.jsonl")).empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  kill(pid, SIGKILL);
  EXPECT_EQ(finish(pid).code, -SIGKILL);
  const std::string before = bytes_of(out("s/cells.jsonl"));
  ASSERT_FALSE(before.empty());
  const size_t done = ids_of(out("s/cells.jsonl")).size();
  EXPECT_LT(done, five.size());
  // As if it had been killed while writing a line.
  std::ofstream(out("s/cells.jsonl"), std::ios::app | std::ios::binary) << R"({"schema":"nearfield.cell/1","id":"corn)";
  const Outcome outcome = run({"sweep", spec({1, 3}, {{"group", 1}, {"frames", 30}}), "-o", out("s"), "--resume"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(ids_of(out("s/cells.jsonl")), five);
  EXPECT_TRUE(bytes_of(out("s/cells.jsonl")).starts_with(before));
}

TEST_F(SweepTest, NarrowingLooksBetweenNeighbours) {
  const Outcome outcome = run({"sweep", spec({1, 9}, {{"narrow", {{"rounds", 1}, {"settings", 3}}}}), "-o", out("s")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json plan = json::parse(bytes_of(out("s/sweep.json")));
  ASSERT_EQ(plan["rounds"].size(), 1u);
  ASSERT_FALSE(plan["rounds"][0].empty());
  EXPECT_LE(plan["rounds"][0].size(), 3u);
  for (const json& row : plan["rounds"][0]) {
    const bool slices = row["params"]["gi.slices"] == 5, steps = row["params"]["gi.steps"] == 4;
    EXPECT_TRUE(slices != steps) << row;  // one value in the middle, the other as it was
  }
  EXPECT_EQ(lines_of(out("s/cells.jsonl")).size(), 5 + plan["rounds"][0].size());
}

// What make and Slurm run is the same cells: the scripts are run here as those would run them.
TEST_F(SweepTest, OtherProgramsCanHandOutTheWork) {
  const std::string environment =
      "NEARFIELD_DATA_DIR=" NF_SOURCE_DIR " XDG_CACHE_HOME=" NF_BINARY_DIR "/cli_test_cache ";
  const auto shell = [&](const std::string& command) {
    return std::system((environment + command + " > " + out("shell.log") + " 2>&1").c_str());
  };
  ASSERT_EQ(run({"sweep", spec({1, 3}), "--emit", "make", out("m")}).code, 0);
  ASSERT_EQ(shell("make -C " + out("m")), 0) << bytes_of(out("shell.log"));
  EXPECT_EQ(ids_of(out("m/cells.jsonl")), five);

  ASSERT_EQ(run({"sweep", spec({1, 3}), "--emit", "slurm", out("j")}).code, 0);
  const std::string script = bytes_of(out("j/cells.sbatch"));
  EXPECT_NE(script.find("#SBATCH --array=0-2\n"), std::string::npos) << script;
  EXPECT_NE(bytes_of(out("j/submit.sh")).find("--dependency=afterok:$first cells.sbatch"), std::string::npos);
  ASSERT_EQ(shell("bash " + out("j/references.sbatch")), 0) << bytes_of(out("shell.log"));
  EXPECT_FALSE(std::filesystem::is_empty(out("j/references")));
  for (const char* task : {"2", "0"})
    ASSERT_EQ(shell(fmt::format("SLURM_ARRAY_TASK_ID={} bash {}", task, out("j/cells.sbatch"))), 0)
        << bytes_of(out("shell.log"));
  const Outcome early = run({"sweep", "--merge", out("j")});
  EXPECT_EQ(early.code, 1);
  EXPECT_NE(early.err.find("2 cells are missing"), std::string::npos) << early.err;
  ASSERT_EQ(shell(fmt::format("SLURM_ARRAY_TASK_ID=1 bash {}", out("j/cells.sbatch"))), 0);
  EXPECT_EQ(run({"sweep", "--merge", out("j"), "--quiet"}).code, 0);
  EXPECT_EQ(ids_of(out("j/cells.jsonl")), five);
}

TEST_F(SweepTest, DryRunMeasuresAFewFramesOnly) {
  const Outcome outcome = run({"sweep", spec({1, 3}), "-o", out("s"), "--dry-run"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("cornell/v/gi.slices=3,gi.steps=6\n"), std::string::npos);
  EXPECT_NE(outcome.out.find("5 cells, 0 of them done; about "), std::string::npos) << outcome.out;
  EXPECT_TRUE(written().empty());
}

TEST_F(SweepTest, MistakesAreSaid) {
  const std::vector<std::tuple<json, int, const char*>> cases = {
      {{{"sizes", {1, 1}}}, 3, "unknown key 'sizes'"},
      {{{"frames", 0}}, 3, "'frames' must be a whole number"},
      {{{"runs", {{{"technique", "xyz"}}}}}, 3, "unknown technique 'xyz'"},
      {{{"runs", {{{"technique", "vbgi"}, {"base", {{"gi.nothing", 1}}}}}}}, 3, "gi.nothing"},
      {{{"runs", {{{"technique", "vbgi"}, {"permute", {{"gi.slices", 3}}}}}}},
       3,
       "'runs[0].permute.gi.slices' must be a list"},
      {{{"metrics", {"psnr"}}}, 3, "'metrics' has 'psnr'"},
      {{{"layer", "nothing"}}, 3, "nothing"},
      {{{"reference", "none.exr"}}, 3, "there is no reference"},
      {{{"scene", "none.glb"}}, 3, "none.glb"},
  };
  for (const auto& [change, code, text] : cases) {
    const Outcome outcome = run({"sweep", spec({1}, change), "-o", out("s")});
    EXPECT_EQ(outcome.code, code) << text;
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(run({"sweep", spec({1})}).code, 2);
  EXPECT_EQ(run({"sweep", spec({1}), "-o", out("s"), "--budget", "20s"}).code, 2);
  EXPECT_EQ(run({"sweep", spec({1}), "-o", out("s"), "--cells", "4-8"}).code, 2);
  EXPECT_EQ(run({"sweep", spec({1}), "--emit", "cron", out("c")}).code, 2);
  EXPECT_EQ(run({"report", input("x.json", "{}"), "-o", out("r.html")}).code, 3);
}

}  // namespace
}  // namespace nf
