// Captures without a device: summaries, trust, traces, CSV, baselines, fronts; each rule with a case that breaks it.
#include <gtest/gtest.h>

#include "capture/baseline.h"
#include "capture/csv.h"
#include "capture/pareto.h"
#include "capture/trace.h"
#include "core/error.h"
#include "strict_csv.h"

namespace nf::capture {
namespace {

using nlohmann::json;

// `frames` frames of passes a (2 ms) and b (6 ms) with 0.5 ms between them, and a little deterministic noise.
Run make_run(uint32_t frames, uint32_t repeats, double b_ms = 6, double noise = 0.01) {
  capture::Run run;
  run.name = "x";
  run.technique = "x";
  run.scene = {{"path", "s.glb"}, {"camera", "0"}};
  run.settings = {{"size", {64, 36}}};
  run.memory = {{"placed_bytes", 1 << 20}};
  int64_t now = 1000000;
  for (uint32_t r = 0; r < repeats; ++r)
    for (uint32_t f = 0; f < frames; ++f) {
      const double wobble = noise * (int(f * 7 % 5) - 2);
      const uint32_t a = run.find_pass("a", 1, "compute", ""), b = run.find_pass("b", 1, "raster", "");
      FrameSample frame{.repeat = r,
                        .frame = f,
                        .submit_ns = now,
                        .gpu_begin_ns = now + 5000,
                        .gpu_ms = 2.5 + b_ms + wobble,
                        .wall_ms = 2.6 + b_ms + wobble,
                        .cpu_ms = 0.2,
                        .passes = {}};
      frame.passes = {{a, 0, 2, 0.01}, {b, 2.5, b_ms + wobble, 0.02}};
      run.frames.push_back(frame);
      now += int64_t((3 + b_ms) * 1e6) + 300000;
    }
  return run;
}

json document_of(const Run& run, const std::string& device = "d") {
  const json context = {{"device", {{"name", device}}}, {"app", {{"build", "Release"}}}};
  return timing_document(context, {{"timing", "serialize"}}, {{&run, summarise(run), {}}}, true);
}

TEST(CaptureTest, SummaryAddsUp) {
  const capture::Run run = make_run(20, 3);
  const Summary s = summarise(run);
  ASSERT_EQ(s.passes.size(), 2u);
  EXPECT_EQ(s.passes[0].gpu.count, 60u);
  EXPECT_DOUBLE_EQ(s.passes[0].gpu.median, 2);
  EXPECT_DOUBLE_EQ(s.passes[1].gpu.median, 6);
  EXPECT_EQ(s.passes[1].per_repeat.size(), 3u);
  EXPECT_NEAR(s.unattributed.median, 0.5, 1e-9);
  EXPECT_NEAR(s.frame.gpu.median, 8.5, 1e-9);
}

// A pass that is there only in some frames has a smaller count, and a second one of a name a row of its own.
TEST(CaptureTest, PassesThatComeAndGo) {
  capture::Run run = make_run(4, 1);
  run.frames[2].passes.push_back({run.find_pass("a", 2, "compute", ""), 8.5, 1, 0});
  const Summary s = summarise(run);
  EXPECT_EQ(run.passes[2].path, "a#2");
  EXPECT_EQ(s.passes[2].gpu.count, 1u);
  EXPECT_EQ(s.passes[0].gpu.count, 4u);
  EXPECT_TRUE(to_json(statistics({}))["median"].is_null());
}

TEST(CaptureTest, TrustNamesEveryReason) {
  const capture::Run run = make_run(20, 3);
  const Summary s = summarise(run);
  const Circumstances quiet{.load = {.cores = 2, .average_start = 0.9, .average_end = 2, .others = 0.02},
                            .software_device = true};
  EXPECT_TRUE(judge(run, s, quiet).noisy.empty());
  EXPECT_EQ(judge(run, s, quiet).warnings.size(), 1u);  // the device, which is no reason
  const auto reason = [&](auto change) {
    Circumstances c = quiet;
    change(c);
    const Trust trust = judge(run, s, c);
    return trust.noisy.size() == 1 ? trust.noisy[0] : std::string("?");
  };
  EXPECT_NE(reason([](Circumstances& c) { c.load.average_start = 1.1; }).find("load average"), std::string::npos);
  EXPECT_NE(reason([](Circumstances& c) { c.load.others = 0.4; }).find("other processes"), std::string::npos);
  EXPECT_NE(reason([](Circumstances& c) { c.debug_build = true; }).find("debug"), std::string::npos);
  EXPECT_NE(reason([](Circumstances& c) { c.validation = true; }).find("validation"), std::string::npos);

  capture::Run wild = make_run(20, 1);
  for (size_t i = 0; i < 4; ++i) wild.frames[i].passes[1].gpu_ms *= 2;
  const Trust trust = judge(wild, summarise(wild), quiet);
  ASSERT_EQ(trust.noisy.size(), 1u);
  EXPECT_EQ(trust.noisy[0], "p95/median = 2.00 in b");
  capture::Run drift = make_run(20, 2);
  for (size_t i = 20; i < 40; ++i) drift.frames[i].gpu_ms += 0.5;
  const Trust drifted = judge(drift, summarise(drift), quiet);
  ASSERT_EQ(drifted.noisy.size(), 1u);
  EXPECT_NE(drifted.noisy[0].find("the repeats' medians of the frame differ"), std::string::npos);
  // A pass may drift where the frame's own scatter hides it; both passes make one reason, the worse one's.
  capture::Run uneven = make_run(20, 2);
  for (size_t i = 20; i < 40; ++i) {
    uneven.frames[i].passes[0].gpu_ms *= 1.1;
    uneven.frames[i].passes[1].gpu_ms *= 1.3;
  }
  const Trust passes = judge(uneven, summarise(uneven), quiet);
  ASSERT_EQ(passes.noisy.size(), 1u);
  EXPECT_NE(passes.noisy[0].find("of b differ"), std::string::npos) << passes.noisy[0];
  EXPECT_NE(passes.noisy[0].find("and 1 more"), std::string::npos) << passes.noisy[0];
}

// --- traces
TEST(TraceTest, OfARunKeepsTheRules) {
  const capture::Run run = make_run(5, 2), other = make_run(3, 1);
  for (const bool calibrated : {true, false}) {
    const json trace = trace_document({&run, &other}, {}, calibrated);
    const auto faults = check_trace(trace);
    EXPECT_TRUE(faults.empty()) << faults.front();
    size_t passes = 0;
    for (const json& event : trace["traceEvents"]) passes += event.value("cat", "") == "gpu,pass";
    EXPECT_EQ(passes, 13u * 2);
    EXPECT_EQ(json::parse(trace.dump()), trace);
  }
}

// Passes that overlap on the device, of no length, or beyond their frame.
TEST(TraceTest, OverlappingPassesAreCut) {
  capture::Run run = make_run(3, 1);
  run.frames[0].passes[1].begin_ms = 1;  // begins before a ends
  run.frames[1].passes[0].gpu_ms = 0;
  run.frames[1].passes[1].begin_ms = 0;
  run.frames[2].passes[0].gpu_ms = 50;
  run.frames[2].passes[1].begin_ms = -3;
  const json trace = trace_document({&run}, {}, true);
  const auto faults = check_trace(trace);
  EXPECT_TRUE(faults.empty()) << faults.front();
  size_t cut = 0;
  for (const json& event : trace["traceEvents"]) cut += event.value("args", json::object()).contains("measured_us");
  EXPECT_GE(cut, 3u);
}

TEST(TraceTest, TheCheckerFindsWhatIsWrong) {
  const capture::Run run = make_run(2, 1);
  const json good = trace_document({&run}, {}, true);
  const auto first = [&](auto change) {
    json trace = good;
    change(trace);
    const auto faults = check_trace(trace);
    return faults.empty() ? std::string("nothing") : faults.front();
  };
  const auto find = [](json& trace, const char* category, size_t number = 0) -> json& {
    for (json& event : trace["traceEvents"])
      if (event.value("cat", "") == category && number-- == 0) return event;
    throw std::out_of_range(category);
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(has(first([](json& t) { t = t["traceEvents"]; }), "no object"));
  EXPECT_TRUE(has(first([](json& t) { t.erase("traceEvents"); }), "no list"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass")["tid"] = "100"; }), "'tid' is no integer"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass")["pid"] = "1"; }), "'pid' is no integer"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass")["ts"] = -1.0; }), "out of range"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass").erase("dur"); }), "'dur' is no number"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass")["dur"] = 1.00005; }), "three decimals"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass")["dur"] = 3000.0; }), "overlaps"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass")["ts"] = find(t, "gpu,frame")["ts"]; }), "begins where"));
  EXPECT_TRUE(has(first([&](json& t) { find(t, "gpu,pass", 1)["dur"] = 6001.0; }), "overlaps"));  // leaves its frame
  EXPECT_TRUE(has(first([&](json& t) { std::swap(find(t, "gpu,pass"), find(t, "gpu,pass", 2)); }), "not sorted"));
  EXPECT_TRUE(has(first([&](json& t) {
                    for (json& event : t["traceEvents"])
                      if (event["ph"] != "M") event["ts"] = event["ts"].get<double>() + 1e9;
                  }),
                  "near 0"));
}

// --- CSV
TEST(CsvTest, SummaryIsStrict) {
  capture::Run run = make_run(4, 1);
  run.name = "a \"b\", c";
  const test::CsvRows rows = test::read_csv(summary_csv({{&run, summarise(run), {}}}));
  ASSERT_EQ(rows.size(), 5u);  // header, two passes, unattributed, frame
  EXPECT_EQ(rows[0][0], "run");
  EXPECT_EQ(rows[1][0], run.name);
  EXPECT_EQ(rows[1][2], "a");
  EXPECT_DOUBLE_EQ(std::stod(rows[1][5]), 2);
  EXPECT_EQ(rows[4][2], "frame");
}
TEST(CsvTest, TheReaderIsStrict) {
  for (const char* bad : {"a,b\n1,2\n", "a,b\r\n1\r\n", "a,b\r\n1,\"2\r\n", "a,b\r\n1,2\"\r\n", "a,b\r\n1,2"})
    EXPECT_THROW(test::read_csv(bad), std::runtime_error) << bad;
}

// --- baselines
const Change& change_of(const std::vector<Change>& changes, const std::string& pass) {
  for (const Change& c : changes)
    if (c.pass == pass) return c;
  throw std::out_of_range(pass);
}

TEST(BaselineTest, FlagsAPassThatIsSlowerBeyondTheNoise) {
  const json before = document_of(make_run(30, 3));
  EXPECT_EQ(change_of(compare_timings(before, before, 0.05), "frame").verdict, Verdict::Same);
  const auto slowed = compare_timings(before, document_of(make_run(30, 3, 6 * 1.3)), 0.05);
  EXPECT_EQ(change_of(slowed, "b").verdict, Verdict::Regression);
  EXPECT_EQ(change_of(slowed, "a").verdict, Verdict::Same);
  EXPECT_EQ(change_of(slowed, "frame").verdict, Verdict::Regression);
  EXPECT_NEAR(change_of(slowed, "b").percent(), 30, 0.1);
  EXPECT_EQ(change_of(compare_timings(before, document_of(make_run(30, 3, 6 * 1.03)), 0.05), "b").verdict,
            Verdict::Slower);
  EXPECT_EQ(change_of(compare_timings(before, document_of(make_run(30, 3, 5)), 0.05), "b").verdict, Verdict::Faster);
}

// The same 30 % drown in runs whose repeats drift by as much.
TEST(BaselineTest, NoiseIsNoRegression) {
  capture::Run drifting = make_run(30, 3);
  for (FrameSample& frame : drifting.frames) frame.passes[1].gpu_ms *= 1 + 0.3 * frame.repeat;
  const auto changes = compare_timings(document_of(drifting), document_of(make_run(30, 3, 6 * 1.4)), 0.05);
  EXPECT_EQ(change_of(changes, "b").verdict, Verdict::Same) << change_of(changes, "b").noise;
}

TEST(BaselineTest, WhatCannotBeComparedIsSaid) {
  const json before = document_of(make_run(5, 1));
  EXPECT_THROW(compare_timings(before, document_of(make_run(5, 1), "another"), 0.05), Error);
  EXPECT_THROW(compare_timings(json::object(), before, 0.05), Error);
  capture::Run other = make_run(5, 1);
  other.name = "y";
  EXPECT_THROW(compare_timings(before, document_of(other), 0.05), Error);
  capture::Run less = make_run(5, 1);
  less.passes[0].path = "c";
  const auto changes = compare_timings(before, document_of(less), 0.05);
  EXPECT_EQ(change_of(changes, "c").verdict, Verdict::New);
  EXPECT_EQ(change_of(changes, "a").verdict, Verdict::Gone);
}

// --- fronts
TEST(ParetoTest, ByHand) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<CostAndError> rows = {{3, 3}, {1, 5},     {2, 4},   {2, 4},  {4, 3},
                                          {5, 1}, {2.5, 4.5}, {1, inf}, {0, NAN}};
  EXPECT_EQ(pareto_front(rows), (std::vector<size_t>{1, 2, 0, 5}));
  EXPECT_TRUE(pareto_front({}).empty());
}

}  // namespace
}  // namespace nf::capture
