// Every way in which a graph can be wrong is found, and said with pass, slot, resource and both source lines.
#include <gtest/gtest.h>

#include "graph_values.h"

namespace nf::graph {
namespace {

using Kind = Diagnostic::Kind;
constexpr VkFormat r32 = VK_FORMAT_R32_SFLOAT;

#define NF_TINT_PARAMS(P) P(Float, strength, 1.0f, 0.0f, 4.0f, "", "Strength") P(Int, steps, 1, 0, 4, "", "Steps")
NF_DECLARE_PARAMS(TintParams, "tint", NF_TINT_PARAMS)
#define NF_TOLD_FIELDS(F) F(Float, weight) F(Uint, before_valid)
NF_DECLARE_BLOCK(ToldBlock, "told", NF_TOLD_FIELDS)

std::string line_of(const Location& at) {
  return fmt::format("tests/graph_validate_test.cpp:{}", at.line);
}

class ValidateTest : public testing::Test {
 protected:
  Shaders shaders;
  const gpu::Slot block{
      .name = "tint", .kind = gpu::SlotKind::UniformBlock, .block_size = 8, .members = {{"strength", 0}, {"steps", 4}}};
  const gpu::Slot told{.name = "told",
                       .kind = gpu::SlotKind::UniformBlock,
                       .block_size = 8,
                       .members = {{"weight", 0}, {"before_valid", 4}}};
  const gpu::Pipeline source = shaders.make({storage_out("value")});
  const gpu::Pipeline filter = shaders.make({sampled("from"), storage_out("value")});
  const gpu::Pipeline tinted = shaders.make({storage_out("value"), block});
  const gpu::Pipeline paint = shaders.make({}, {"color"});
  const ImageDesc desc{{64, 32}, r32};
  const gpu::Buffer buffer{.size = 16};
  Graph graph;
  // Where resources of the fault at hand are declared and used: two lines that nothing else stands on.
  const Location declared = Location::current();
  const Location used = Location::current();

  Tex image(const char* name) { return graph.image(name, desc, declared); }
  Tex written(const char* name, const ImageDesc& d) {
    const Tex tex = graph.image(name, d, declared);
    graph.compute("write", source).out("value", tex).over(tex);
    return tex;
  }
  Tex written(const char* name) { return written(name, desc); }

  // Exactly one diagnostic, of this kind, with these words in its text.
  void expect(Kind kind, const std::vector<std::string>& words) const {
    const bool careless = kind == Kind::WrittenNeverRead || kind == Kind::ValidityIgnored;
    const auto found = careless ? validate(graph) : faults(graph);
    ASSERT_EQ(found.size(), 1u) << (found.size() > 1 ? found[0].text + "\n" + found[1].text : "");
    EXPECT_EQ(found[0].kind, kind) << found[0].text;
    for (const std::string& word : words)
      EXPECT_NE(found[0].text.find(word), std::string::npos) << "no '" << word << "' in: " << found[0].text;
    EXPECT_EQ(found[0].text.find('\n'), std::string::npos);
  }
  std::vector<std::string> words(const char* pass, const char* slot, const char* resource) const {
    return {pass, fmt::format("'{}'", slot), fmt::format("'{}'", resource), line_of(used), line_of(declared)};
  }
};

TEST_F(ValidateTest, CorrectGraphReportsNothing) {
  const Tex a = written("a"), sum = written("sum"), b = image("b"), color = image("color");
  const Tex depth = graph.image("depth", {{64, 32}, VK_FORMAT_D32_SFLOAT});
  const History h = graph.history("mean", desc);
  const gpu::Pipeline everything =
      shaders.make({sampled("from"),
                    storage_in("before", r32),
                    storage_out("value", r32),
                    storage_inout("sum"),
                    {.name = "lights", .kind = gpu::SlotKind::StorageBuffer, .readonly = true},
                    {.name = "linear_clamp", .kind = gpu::SlotKind::Sampler},
                    block,
                    told});
  graph.share(TintParams{});
  graph.compute("everything", everything)
      .in("from", a)
      .in("before", h.prev)
      .in("lights", graph.import("lights", buffer))
      .params(ToldBlock{})
      .out("value", h.next)
      .inout("sum", sum)
      .over(a);
  graph.raster("draw", paint).out("color", color, {0, 0, 0, 0}).depth(depth, 0.0f);
  graph.fullscreen("again", paint).out("color", color);
  graph.compute("tinted", tinted).out("value", b).params(TintParams{}).over(b);
  graph.readback("color", color);
  graph.readback("b", b);
  graph.readback("sum", sum);
  for (const Diagnostic& d : validate(graph)) ADD_FAILURE() << d.text;
}

TEST_F(ValidateTest, SlotMissing) {
  const Tex a = written("a"), b = image("b");
  graph.compute("filter", filter).in("from", a).in("normal", a, used).out("value", b).over(b);
  auto wanted = words("filter", "normal", "a");
  wanted.insert(wanted.end(), {"from", "value"});  // what there is
  expect(Kind::SlotMissing, wanted);
}

TEST_F(ValidateTest, OutputMissing) {
  const Tex a = image("a"), b = image("b");
  graph.fullscreen("paint", paint).out("color", a).out("bright", b, used);
  expect(Kind::SlotMissing, words("paint", "bright", "b"));
}

TEST_F(ValidateTest, ParameterBlockMissing) {
  const Tex a = image("a");
  graph.compute("write", source).out("value", a).params(TintParams{}, used).over(a);
  expect(Kind::SlotMissing, {"write", "'tint'", line_of(used)});
}

TEST_F(ValidateTest, SlotNotFed) {
  const Tex b = image("b");
  graph.compute("filter", filter, "", used).out("value", b).over(b);
  expect(Kind::SlotNotFed, {"filter", "'from'", line_of(used)});
}

TEST_F(ValidateTest, OutputAndBlockNotFed) {
  const Tex a = image("a");
  graph.fullscreen("two", shaders.make({}, {"color", "bright"}), "", used).out("color", a);
  expect(Kind::SlotNotFed, {"two", "'bright'", line_of(used)});
  graph = Graph();
  const Tex c = graph.image("c", desc);
  graph.compute("tinted", tinted, "", used).out("value", c).over(c);
  expect(Kind::SlotNotFed, {"tinted", "'tint'", line_of(used)});
}

TEST_F(ValidateTest, InputOfAWriteonlyImage) {
  const Tex a = written("a"), b = image("b");
  graph.compute("copy", shaders.make({storage_out("from"), storage_out("value")}))
      .in("from", a, used)
      .out("value", b)
      .over(b);
  expect(Kind::Direction, words("copy", "from", "a"));
}

TEST_F(ValidateTest, OutputOfAReadonlyImage) {
  const Tex b = image("b");
  graph.compute("copy", shaders.make({storage_in("value")})).out("value", b, used).over(b);
  expect(Kind::Direction, words("copy", "value", "b"));
}

TEST_F(ValidateTest, OutputOfAnImageThatIsReadToo) {
  const Tex b = image("b");
  graph.compute("copy", shaders.make({storage_inout("value")})).out("value", b, used).over(b);
  expect(Kind::Direction, words("copy", "value", "b"));
}

TEST_F(ValidateTest, InoutOfAnImageUsedOneWay) {
  for (const gpu::Slot& slot : {storage_in("value"), storage_out("value")}) {
    graph = Graph();
    const Tex a = written("a");
    graph.compute("modify", shaders.make({slot})).inout("value", a, used).over(a);
    expect(Kind::Direction, words("modify", "value", "a"));
  }
}

TEST_F(ValidateTest, AnotherKindOfDescriptor) {
  const Tex a = written("a"), b = image("b");
  const gpu::Slot buffer_slot{.name = "from", .kind = gpu::SlotKind::StorageBuffer, .readonly = true};
  graph.compute("filter", shaders.make({buffer_slot, storage_out("value")}))
      .in("from", a, used)
      .out("value", b)
      .over(b);
  expect(Kind::Direction, words("filter", "from", "a"));
  graph = Graph();
  const Tex c = graph.image("c", desc);
  graph.compute("filter", filter).in("from", graph.import("lights", buffer, declared), used).out("value", c).over(c);
  expect(Kind::Direction, words("filter", "from", "lights"));
}

TEST_F(ValidateTest, BufferThatTheShaderWrites) {
  const Tex a = image("a");
  const gpu::Pipeline writer =
      shaders.make({storage_out("value"), {.name = "lights", .kind = gpu::SlotKind::StorageBuffer}});
  graph.compute("light", writer)
      .in("lights", graph.import("light table", buffer, declared), used)
      .out("value", a)
      .over(a);
  expect(Kind::Direction, words("light", "lights", "light table"));
}

TEST_F(ValidateTest, HistoryPrevIsNotWritten) {
  const History h = graph.history("mean", desc, declared);
  graph.compute("keep", source).out("value", h.next).over(h.next);
  graph.compute("write", source).out("value", h.prev, used).over(h.prev);
  expect(Kind::Direction, words("write", "value", "mean"));
}

TEST_F(ValidateTest, HistoryThatNobodyWrites) {
  const History h = graph.history("mean", desc, declared);
  const Tex out = image("out");
  graph.compute("show", shaders.make({storage_in("from"), storage_out("value")}))
      .in("from", h.prev, used)
      .out("value", out)
      .over(out);
  expect(Kind::ReadBeforeWrite, words("show", "from", "mean"));
}

TEST_F(ValidateTest, SlotFedTwice) {
  const Tex a = written("a"), b = image("b");
  const Tex c = written("c");
  graph.compute("show", shaders.make({storage_in("from"), storage_out("value")}))
      .in("from", c)
      .in("from", a, used)
      .out("value", b)
      .over(b);
  expect(Kind::UsedTwice, words("show", "from", "a"));
}

TEST_F(ValidateTest, FormatMismatch) {
  const Tex a = image("a");
  graph.compute("write", shaders.make({storage_out("value", VK_FORMAT_R16_SFLOAT)})).out("value", a, used).over(a);
  auto wanted = words("write", "value", "a");
  wanted.insert(wanted.end(), {gpu::format_name(VK_FORMAT_R16_SFLOAT), gpu::format_name(r32)});
  expect(Kind::FormatMismatch, wanted);
}

TEST_F(ValidateTest, AttachmentsOfDifferentSize) {
  const Tex a = image("a"), depth = graph.image("depth", {{32, 32}, VK_FORMAT_D32_SFLOAT}, declared);
  graph.raster("draw", paint).out("color", a).depth(depth, used);
  expect(Kind::SizeMismatch, {"draw", "'depth'", "32x32", "64x32", "'a'", line_of(used), line_of(declared)});
}

TEST_F(ValidateTest, OutputOfAnotherSizeThanTheThreads) {
  const Tex a = image("a"), small = graph.image("small", {{16, 8}, r32});
  graph.compute("write", source).out("value", a, used).over(small);
  auto wanted = words("write", "value", "a");
  wanted.insert(wanted.end(), {"64x32", "16x8"});
  expect(Kind::SizeMismatch, wanted);
}

TEST_F(ValidateTest, ComputeWithoutThreads) {
  graph.compute("write", source, "", used).out("value", image("a"));
  expect(Kind::SizeMismatch, {"write", "over()", line_of(used)});
}

TEST_F(ValidateTest, ReadBeforeWrite) {
  const Tex a = image("a"), b = image("b");
  graph.compute("filter", filter).in("from", a, used).out("value", b).over(b);
  graph.compute("late", source).out("value", a).over(a);
  expect(Kind::ReadBeforeWrite, words("filter", "from", "a"));
}

TEST_F(ValidateTest, ReadBeforeWriteOfInoutReadbackAndNext) {
  const Tex a = image("a");
  graph.compute("modify", shaders.make({storage_inout("value")})).inout("value", a, used).over(a);
  expect(Kind::ReadBeforeWrite, words("modify", "value", "a"));
  graph = Graph();
  graph.readback("copy", graph.image("b", desc, declared), used);
  expect(Kind::ReadBeforeWrite, {"copy", "'b'", line_of(used), line_of(declared)});
  graph = Graph();
  const History h = graph.history("mean", desc, declared);
  graph.readback("copy", h.next, used);
  expect(Kind::ReadBeforeWrite, {"copy", "'mean'", line_of(used), line_of(declared)});
}

TEST_F(ValidateTest, UsedTwice) {
  const Tex a = written("a");
  graph.compute("filter", filter).in("from", a).out("value", a, used).over(a);
  auto wanted = words("filter", "value", "a");
  wanted.push_back("'from'");
  expect(Kind::UsedTwice, wanted);
}

TEST_F(ValidateTest, UsedTwiceInTwoLayouts) {
  const Tex a = written("a"), b = image("b");
  const gpu::Pipeline both = shaders.make({sampled("from"), storage_in("load"), storage_out("value")});
  graph.compute("both", both).in("from", a).in("load", a, used).out("value", b).over(b);
  expect(Kind::UsedTwice, words("both", "load", "a"));
}

TEST_F(ValidateTest, TwoReadsOfOneKindAreFine) {
  const Tex a = written("a"), b = image("b");
  graph.compute("both", shaders.make({sampled("x"), sampled("y"), storage_out("value")}))
      .in("x", a)
      .in("y", a)
      .out("value", b)
      .over(b);
  EXPECT_TRUE(faults(graph).empty());
}

TEST_F(ValidateTest, StaleHandle) {
  const Tex b = image("b");
  graph.compute("filter", filter).in("from", Tex{77}, used).out("value", b).over(b);
  expect(Kind::StaleHandle, {"filter", "'from'", line_of(used)});
  graph = Graph();
  const Tex c = graph.image("c", desc);
  graph.compute("filter", filter).in("from", Tex{}, used).out("value", c).over(c);
  expect(Kind::StaleHandle, {"filter", "'from'", line_of(used)});
  graph = Graph();
  graph.readback("copy", Tex{3}, used);
  expect(Kind::StaleHandle, {"copy", line_of(used)});
  graph = Graph();
  const Tex d = graph.image("d", desc);
  graph.compute("write", source, "", used).out("value", d).over(Tex{9});
  expect(Kind::StaleHandle, {"write", "over()", line_of(used)});
}

TEST_F(ValidateTest, BlockOfAnotherSize) {
  const Tex a = image("a");
  gpu::Slot longer = block;
  longer.block_size = 12;
  graph.compute("tinted", shaders.make({storage_out("value"), longer}))
      .out("value", a)
      .params(TintParams{}, used)
      .over(a);
  expect(Kind::BlockMismatch, {"tinted", "'tint'", "12", "8", line_of(used)});
}

// The same size, but the members stand in another order: values would arrive in the wrong variables.
TEST_F(ValidateTest, BlockOfAnotherOrder) {
  const Tex a = image("a");
  gpu::Slot turned = block;
  turned.members = {{"steps", 0}, {"strength", 4}};
  graph.compute("tinted", shaders.make({storage_out("value"), turned}))
      .out("value", a)
      .params(TintParams{}, used)
      .over(a);
  expect(Kind::BlockMismatch, {"tinted", "'tint'", line_of(used)});
}

// One of each of five kinds in five passes, and the lines are the callers' own without being passed.
TEST_F(ValidateTest, CollectsEveryFault) {
  const Tex a = graph.image("a", desc), b = graph.image("b", desc), small = graph.image("small", {{8, 8}, r32});
  graph.compute("one", source).out("value", a).out("extra", b).over(a);                 // SlotMissing
  graph.compute("two", filter).out("value", a).over(a);                                 // SlotNotFed
  graph.compute("three", shaders.make({storage_in("value")})).out("value", a).over(a);  // Direction
  const Location at = Location::current();
  graph.compute("four", source).out("value", small).over(a);                   // SizeMismatch
  graph.compute("five", filter).in("from", Tex{500}).out("value", a).over(a);  // StaleHandle
  const auto found = faults(graph);
  std::vector<Kind> kinds;
  for (const Diagnostic& d : found) kinds.push_back(d.kind);
  EXPECT_EQ(kinds, (std::vector<Kind>{Kind::SlotMissing, Kind::SlotNotFed, Kind::Direction, Kind::SizeMismatch,
                                      Kind::StaleHandle}));
  ASSERT_EQ(found.size(), 5u);
  EXPECT_NE(found[3].text.find(fmt::format("graph_validate_test.cpp:{},", at.line + 1)), std::string::npos)
      << found[3].text;
  EXPECT_NE(found[3].text.find(fmt::format("graph_validate_test.cpp:{})", at.line - 4)), std::string::npos)
      << found[3].text;
}

// Several faults of one pass are all there, too.
TEST_F(ValidateTest, CollectsFaultsOfOnePass) {
  const Tex a = image("a"), b = image("b");
  graph.compute("bad", filter).in("from", a).in("no such", a).out("value", b);
  EXPECT_EQ(faults(graph).size(), 4u);  // the missing slot, no threads, two reads of what nobody wrote
}

// --- what nobody reads, and who is not told ---

TEST_F(ValidateTest, WrittenNeverRead) {
  const Tex a = image("a");
  graph.compute("write", source).out("value", a, used).over(a);
  expect(Kind::WrittenNeverRead, words("write", "value", "a"));
  graph.optional(a);
  EXPECT_TRUE(validate(graph).empty()) << "a by-product";
}

TEST_F(ValidateTest, WrittenNeverReadIsSaidOnceAndOfBuffersAndHistoriesToo) {
  const Buf b = graph.buffer("b", 64, declared);
  const Tex size = written("size");
  graph.readback("size", size);
  const gpu::Slot out{.name = "list", .kind = gpu::SlotKind::StorageBuffer, .writeonly = true};
  graph.compute("first", shaders.make({out})).out("list", b, used).over(size);
  graph.compute("second", shaders.make({out})).out("list", b).over(size);
  expect(Kind::WrittenNeverRead, words("first", "list", "b"));
  graph = Graph();
  const History h = graph.history("mean", desc, declared);
  graph.compute("write", source).out("value", h.next, used).over(h.next);
  expect(Kind::WrittenNeverRead, words("write", "value", "mean"));
}

TEST_F(ValidateTest, DepthIsReadByItsTest) {
  const Tex color = image("color"), depth = graph.image("depth", {{64, 32}, VK_FORMAT_D32_SFLOAT});
  graph.raster("draw", paint).out("color", color, {0, 0, 0, 0}).depth(depth, 0.0f);
  graph.readback("color", color);
  EXPECT_TRUE(validate(graph).empty());
}

TEST_F(ValidateTest, HistoryReadWithoutItsValid) {
  const History h = graph.history("mean", desc, declared);
  const gpu::Pipeline deaf = shaders.make({sampled("before"), storage_out("value")});
  graph.compute("mix", deaf).in("before", h.prev, used).out("value", h.next).over(h.next);
  graph.readback("mean", h.next);
  auto wanted = words("mix", "before", "mean");
  wanted.push_back("'before_valid'");
  expect(Kind::ValidityIgnored, wanted);
}

// The graph writes the parameter, whichever of slot and block is given first.
TEST_F(ValidateTest, ShadersAreToldWhetherAHistoryIsValid) {
  const gpu::Pipeline mix = shaders.make({sampled("before"), storage_out("value"), told});
  const HistoryState states[] = {{"mean", desc, 0}};
  for (const bool valid : {false, true})
    for (const bool params_first : {false, true}) {
      Graph g(valid ? std::span<const HistoryState>(states) : std::span<const HistoryState>());
      const History h = g.history("mean", desc);
      EXPECT_EQ(h.valid, valid);
      PassBuilder pass = g.compute("mix", mix);
      if (params_first) pass.params(ToldBlock{.weight = 2, .before_valid = 7});
      pass.in("before", h.prev).out("value", h.next).over(h.next);
      if (!params_first) pass.params(ToldBlock{.weight = 2, .before_valid = 7});
      g.readback("mean", h.next);
      EXPECT_TRUE(validate(g).empty());
      ToldBlock got;
      std::memcpy(&got, g.param_bytes.data() + g.params[0].offset, sizeof got);
      EXPECT_EQ(got.before_valid, uint32_t(valid));
      EXPECT_EQ(got.weight, 2);
    }
}

TEST_F(ValidateTest, ForgottenHistoriesAreNotValid) {
  const HistoryState states[] = {{"mean", desc, 0}, {"list", {}, 64}};
  Graph g(states);
  EXPECT_TRUE(g.history("mean", desc).valid);
  EXPECT_TRUE(g.buffer_history("list", 64).valid);
  EXPECT_FALSE(g.buffer_history("list", 128).valid);
  g.forget_histories();
  EXPECT_FALSE(g.history("mean", desc).valid);
}

TEST_F(ValidateTest, TwoHistoriesOfOneName) {
  graph.history("mean", desc, declared);
  graph.history("mean", {{8, 8}, r32}, used);
  expect(Kind::UsedTwice, {"'mean'", line_of(used), line_of(declared)});
}

TEST_F(ValidateTest, HandleOfAnotherGraph) {
  Graph yesterday;
  const Tex old = yesterday.image("old", desc);
  const Tex a = written("a"), b = image("b");  // `old` has the number of a row that this graph has, too
  graph.compute("filter", filter).in("from", old, used).out("value", b).over(b);
  expect(Kind::StaleHandle, {"filter", "'from'", line_of(used)});
  EXPECT_EQ(graph.desc(old).format, VK_FORMAT_UNDEFINED) << "no crash";
  EXPECT_EQ(graph.desc(a).format, r32);
  const Graph copy = graph;  // a copied graph keeps its handles
  EXPECT_EQ(copy.desc(a).format, r32);
}

// --- parts ---

TEST_F(ValidateTest, PartThatIsNotThere) {
  const Tex a = graph.image("a", {{64, 32}, r32, 3, 2}, declared);
  graph.compute("write", source).out("value", layer(mip(a, 3), 0), used).over(a);
  auto wanted = words("write", "value", "a");
  wanted.push_back("3 mips and 2 layers");
  expect(Kind::SizeMismatch, wanted);
  graph = Graph();
  const Tex b = graph.image("b", {{64, 32}, r32, 3, 2}, declared);
  graph.compute("write", source).out("value", layer(mip(b, 0), 2), used).over(b);
  expect(Kind::SizeMismatch, words("write", "value", "b"));
}

TEST_F(ValidateTest, PartsThatAShaderSlotCannotTake) {
  const Tex a = graph.image("a", {{64, 32}, r32, 3, 2}, declared);
  graph.compute("write", source).out("value", layer(a, 0), used).over(a);
  expect(Kind::SizeMismatch, words("write", "value", "a"));  // a storage image is one mip
  graph = Graph();
  const Tex b = graph.image("b", {{64, 32}, r32, 1, 2}, declared);
  graph.compute("write", source).out("value", b, used).over(b);
  expect(Kind::SizeMismatch, words("write", "value", "b"));  // one layer
  graph = Graph();
  gpu::Slot cube = storage_out("value");
  cube.shape = gpu::SlotShape::Cube;
  const Tex c = graph.image("c", {{32, 32}, r32, 1, 4}, declared);
  graph.compute("write", shaders.make({cube})).out("value", c, used).over(c);
  expect(Kind::SizeMismatch, words("write", "value", "c"));
}

TEST_F(ValidateTest, AttachmentsAreOneMipOfOneLayer) {
  const Tex a = graph.image("a", {{64, 32}, r32, 3, 2}, declared);
  graph.raster("draw", paint).out("color", a, {0, 0, 0, 0}, used);
  expect(Kind::SizeMismatch, words("draw", "color", "a"));
}

TEST_F(ValidateTest, AMipThatNobodyWrote) {
  const Tex a = graph.image("a", {{64, 32}, r32, 3}, declared), b = image("b");
  for (const uint8_t m : {uint8_t(0), uint8_t(2)})
    graph.compute("write", source).out("value", mip(a, m)).over(mip(a, m));
  graph.compute("filter", filter).in("from", a, used).out("value", b).over(b);
  auto wanted = words("filter", "from", "a");
  wanted.push_back("all the mips");
  expect(Kind::ReadBeforeWrite, wanted);
}

TEST_F(ValidateTest, OneMipIntoTheNextIsFine) {
  const Tex a = graph.image("a", {{64, 32}, r32, 3});
  graph.compute("write", source).out("value", mip(a, 0)).over(a);
  for (uint8_t m = 1; m < 3; ++m)
    graph.compute("down", filter).in("from", mip(a, uint8_t(m - 1))).out("value", mip(a, m)).over(mip(a, m));
  graph.readback("top", mip(a, 2));
  for (const Diagnostic& d : validate(graph)) ADD_FAILURE() << d.text;
  // The same mip twice is not.
  graph.compute("bad", filter).in("from", a).out("value", mip(a, 1), used).over(mip(a, 1));
  EXPECT_EQ(validate(graph).at(0).kind, Kind::UsedTwice);
}

// --- buffers, copies, arguments ---

TEST_F(ValidateTest, BuffersHaveADirection) {
  const Tex size = written("size");
  const auto slot = [&](bool readonly, bool writeonly) {
    return shaders.make(
        {{.name = "list", .kind = gpu::SlotKind::StorageBuffer, .readonly = readonly, .writeonly = writeonly}});
  };
  const Buf b = graph.buffer("list", 64, declared);
  graph.compute("out", slot(true, false)).out("list", b, used).over(size);
  expect(Kind::Direction, words("out", "list", "list"));
  graph.passes.back().pipeline = slot(false, false);
  expect(Kind::Direction, words("out", "list", "list"));
  graph.passes.back().pipeline = slot(false, true);
  EXPECT_TRUE(faults(graph).empty());
  graph.compute("in", slot(false, true)).in("list", b, used).over(size);
  expect(Kind::Direction, words("in", "list", "list"));
  graph.passes.back().pipeline = slot(false, false);
  expect(Kind::Direction, words("in", "list", "list"));
  graph.passes.back().pipeline = slot(true, false);
  EXPECT_TRUE(faults(graph).empty());
  graph.compute("inout", slot(true, false)).inout("list", b, used).over(size);
  expect(Kind::Direction, words("inout", "list", "list"));
}

TEST_F(ValidateTest, ImportsAreOnlyRead) {
  const Tex size = written("size");
  const Buf b = graph.import("lights", buffer, declared);
  graph.compute("out", shaders.make({{.name = "list", .kind = gpu::SlotKind::StorageBuffer, .writeonly = true}}))
      .out("list", b, used)
      .over(size);
  expect(Kind::Direction, words("out", "list", "lights"));
}

TEST_F(ValidateTest, ImportedImagesAreSampledWhole) {
  const gpu::Image flat{.whole = gpu::WholeView::Flat, .info = {.extent = {64, 32}, .format = r32, .mips = 3}};
  const gpu::Image cube{.whole = gpu::WholeView::Cube, .info = {.extent = {8, 8}, .format = r32, .layers = 6}};
  const auto sky = [&](const gpu::Image& lent) {
    graph = Graph();
    return graph.import("sky", lent, declared);
  };
  const auto sample = [&](TexPart sky_part, gpu::SlotShape shape) {
    gpu::Slot slot = sampled("from");
    slot.shape = shape;
    const Tex size = image("size");
    graph.compute("light", shaders.make({slot, storage_out("value")}))
        .in("from", sky_part, used)
        .out("value", size)
        .over(size);
  };
  sample(sky(flat), gpu::SlotShape::Flat);
  EXPECT_TRUE(faults(graph).empty());
  EXPECT_EQ(graph.resources[0].desc.mips, 3);
  sample(sky(cube), gpu::SlotShape::Cube);
  EXPECT_TRUE(faults(graph).empty());
  sample(sky(cube), gpu::SlotShape::Array);
  expect(Kind::SizeMismatch, words("light", "from", "sky"));
  sample(mip(sky(flat), 1), gpu::SlotShape::Flat);
  expect(Kind::SizeMismatch, words("light", "from", "sky"));
  const Tex read_back = sky(flat);
  graph.readback("out", read_back, used);
  expect(Kind::Direction, words("out", "(copy)", "sky"));
  const gpu::Image single{.whole = gpu::WholeView::Flat, .info = {.extent = {64, 32}, .format = r32}};
  const Tex loaded = sky(single), size = image("size");
  graph.compute("load", shaders.make({storage_in("from"), storage_out("value")}))
      .in("from", loaded, used)
      .out("value", size)
      .over(size);
  expect(Kind::Direction, words("load", "from", "sky"));
  const Tex target = sky(flat);
  graph.fullscreen("paint", paint).out("color", target, used);
  EXPECT_FALSE(faults(graph).empty());
}

TEST_F(ValidateTest, CopiesFit) {
  const Tex a = written("a"), small = graph.image("small", {{8, 8}, r32}, declared);
  graph.copy("copy", a, small, used);
  expect(Kind::SizeMismatch, words("copy", "(copy)", "small"));
  graph = Graph();
  const Tex b = written("b"), half = graph.image("half", {{64, 32}, VK_FORMAT_R16_SFLOAT}, declared);
  graph.copy("copy", b, half, used);
  expect(Kind::FormatMismatch, words("copy", "(copy)", "half"));
  graph = Graph();
  const Buf large = graph.buffer("large", 128, declared);
  graph.copy("copy", graph.import("lights", buffer), large, used);
  expect(Kind::SizeMismatch, words("copy", "(copy)", "large"));
}

TEST_F(ValidateTest, ThreadsComeFromOneSide) {
  const gpu::Buffer arguments{.size = 12};
  const Tex a = image("a");
  graph.compute("write", source, "", used).out("value", a).indirect(graph.import("arguments", arguments)).over(a);
  expect(Kind::SizeMismatch, {"write", "over()", "indirect()", line_of(used)});
  graph = Graph();
  const Tex b = image("b");
  graph.compute("write", source).out("value", b).indirect(graph.import("arguments", arguments));
  EXPECT_TRUE(faults(graph).empty());
  graph = Graph();
  const Tex d = image("d");
  graph.compute("write", source).out("value", d).over(64);
  EXPECT_TRUE(faults(graph).empty());
  graph.compute("write", source, "", used).out("value", d).over(64).over(d);
  expect(Kind::SizeMismatch, {"write", "over()", line_of(used)});
  graph = Graph();
  const Tex c = image("c");
  graph.compute("write", source, "", used).out("value", c).over(mip(c, 4));
  expect(Kind::SizeMismatch, {"write", "over()", line_of(used)});
}

TEST_F(ValidateTest, IndicesAndArgumentsWhereTheyMakeSense) {
  const Tex a = image("a");
  const Buf b = graph.import("table", buffer, declared);
  graph.compute("write", source).out("value", a).indices(b, used).over(a);
  expect(Kind::Direction, words("write", "(indices)", "table"));
  graph = Graph();
  const Tex c = image("c");
  graph.fullscreen("paint", paint).out("color", c).indirect(graph.import("table", buffer, declared), 0, used);
  expect(Kind::Direction, words("paint", "(indirect)", "table"));
}

}  // namespace
}  // namespace nf::graph
