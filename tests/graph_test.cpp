// compile() on graphs small enough to know the answer: culling, order, lifetimes, barriers, load and store, memory; the
// topology hash; the dump.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "graph/dump.h"
#include "graph_values.h"

namespace nf::graph {
namespace {

using nlohmann::json;
constexpr VkImageLayout undefined = VK_IMAGE_LAYOUT_UNDEFINED, general = VK_IMAGE_LAYOUT_GENERAL,
                        shader_read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                        color_layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
constexpr VkFormat r32 = VK_FORMAT_R32_SFLOAT, d32 = VK_FORMAT_D32_SFLOAT;

class GraphTest : public testing::Test {
 protected:
  Shaders shaders;
  const gpu::Pipeline source = shaders.make({storage_out("value")});                      // writes
  const gpu::Pipeline filter = shaders.make({sampled("from"), storage_out("value")});     // samples one, writes one
  const gpu::Pipeline loader = shaders.make({storage_in("from"), storage_out("value")});  // the same by imageLoad
  const gpu::Pipeline modify = shaders.make({storage_inout("value")});
  const gpu::Pipeline paint = shaders.make({}, {"color"});
  const gpu::Pipeline show = shaders.make({sampled("from")}, {"color"});
  const ImageDesc desc{{64, 32}, r32};
  Graph graph;

  Tex image(const char* name) { return graph.image(name, desc); }
  // Each adds a pass and returns its row.
  uint32_t row() const { return uint32_t(graph.passes.size() - 1); }
  uint32_t add_source(const char* name, Tex to) { return graph.compute(name, source).out("value", to).over(to), row(); }
  uint32_t add_filter(const char* name, Tex from, Tex to) {
    return graph.compute(name, filter).in("from", from).out("value", to).over(to), row();
  }
  uint32_t add_loader(const char* name, Tex from, Tex to) {
    return graph.compute(name, loader).in("from", from).out("value", to).over(to), row();
  }
  uint32_t add_show(const char* name, Tex from, Tex to) {
    return graph.fullscreen(name, show).in("from", from).out("color", to), row();
  }
  uint32_t add_readback(Tex tex) { return graph.readback("readback", tex), row(); }
  Plan plan() const {
    for (const Diagnostic& d : faults(graph)) ADD_FAILURE() << d.text;
    return compile(graph, {.alias = false});
  }
};

TEST_F(GraphTest, NobodyReadsNothingRuns) {
  add_source("a", image("a"));
  const Plan p = plan();
  EXPECT_TRUE(p.passes.empty());
  EXPECT_TRUE(p.culled[0]);
  EXPECT_FALSE(p.resources[0].live);
  EXPECT_EQ(p.unaliased_bytes, 0u);
}

TEST_F(GraphTest, CullsDeadChainsKeepsOrder) {
  const Tex a = image("a"), dead1 = image("dead1"), b = image("b"), dead2 = image("dead2"), c = image("c");
  add_source("a", a);
  add_source("dead1", dead1);
  add_filter("b", a, b);
  add_filter("dead2", dead1, dead2);
  add_filter("c", b, c);
  add_filter("dead3", b, dead2);
  add_readback(c);
  const Plan p = plan();
  EXPECT_EQ(p.culled, (std::vector<bool>{false, true, false, true, false, true, false}));
  std::vector<uint32_t> order;
  for (const PlannedPass& pass : p.passes) order.push_back(pass.pass);
  EXPECT_EQ(order, (std::vector<uint32_t>{0, 2, 4, 6}));
  EXPECT_FALSE(p.resources[dead1.id].live);
}

TEST_F(GraphTest, OneWantedOutputKeepsThePass) {
  const Tex wanted = image("wanted"), byproduct = image("byproduct");
  const gpu::Pipeline two = shaders.make({storage_out("x"), storage_out("y")});
  graph.compute("two", two).out("x", wanted).out("y", byproduct).over(wanted);
  add_readback(wanted);
  const Plan p = plan();
  EXPECT_FALSE(p.culled[0]);
  EXPECT_TRUE(p.resources[byproduct.id].live);  // it is written, so it must be there
}

TEST_F(GraphTest, ReadModifyWriteKeepsTheWriterBefore) {
  const Tex a = image("a");
  add_source("a", a);
  graph.compute("modify", modify).inout("value", a).over(a);
  add_readback(a);
  EXPECT_EQ(plan().culled, (std::vector<bool>{false, false, false}));
}

// A depth test reads what an earlier pass left, although nothing reads the depth image by name.
TEST_F(GraphTest, DepthTestKeepsTheDepthPass) {
  const Tex depth = graph.image("depth", {{64, 32}, d32}), color = image("color");
  graph.raster("prepass", shaders.make({})).depth(depth, 0.0f);
  graph.raster("opaque", paint).out("color", color, {0, 0, 0, 0}).depth(depth);
  add_readback(color);
  const Plan p = plan();
  EXPECT_FALSE(p.culled[0]);
  EXPECT_EQ(p.uses[graph.passes[1].first_use + 1].load, VK_ATTACHMENT_LOAD_OP_LOAD);
}

TEST_F(GraphTest, HistoryKeepsItsWriterAlive) {
  const History h = graph.history("mean", desc);
  const Tex a = image("a"), out = image("out");
  add_source("a", a);
  add_filter("accumulate", a, h.next);
  add_filter("use", h.prev, out);
  add_readback(out);
  EXPECT_EQ(plan().culled, (std::vector<bool>{false, false, false, false}));
}

// What this frame reads first was written by the last frame's later passes.
TEST_F(GraphTest, HistoryKeepsItsWriterWhenTheReaderStandsBefore) {
  const History h = graph.history("mean", desc);
  const Tex a = image("a"), out = image("out");
  add_filter("use", h.prev, out);
  add_readback(out);
  add_source("a", a);
  add_filter("accumulate", a, h.next);
  EXPECT_EQ(plan().culled, (std::vector<bool>{false, false, false, false}));
}

TEST_F(GraphTest, HistoryThroughAnotherHistory) {
  const History first = graph.history("first", desc), second = graph.history("second", desc);
  const Tex out = image("out");
  add_filter("use", second.prev, out);
  add_readback(out);
  add_filter("second", first.prev, second.next);
  add_source("first", first.next);
  EXPECT_EQ(plan().culled, (std::vector<bool>{false, false, false, false}));
}

TEST_F(GraphTest, HistoryNobodyReadsIsCulled) {
  const History h = graph.history("mean", desc);
  const Tex out = image("out");
  add_filter("accumulate", h.prev, h.next);
  add_source("out", out);
  add_readback(out);
  EXPECT_EQ(plan().culled, (std::vector<bool>{true, false, false}));
}

TEST_F(GraphTest, HistoryIsValidWhenTheLastFrameWroteTheSame) {
  const HistoryState states[] = {{"written", desc, 0}, {"resized", {{32, 32}, r32}, 0}};
  Graph g(states);
  EXPECT_TRUE(g.history("written", desc).valid);
  EXPECT_FALSE(g.history("resized", desc).valid);
  EXPECT_FALSE(g.history("unknown", desc).valid);
}

// What is kept may be read without a writer in the frame, and drawn on without a clear: its content is there, and must
// be there for the next frame.
TEST_F(GraphTest, AKeptImageIsLoadedAndStored) {
  const Tex map = graph.keep("map", {{64, 32}, d32}), out = image("out");
  graph.raster("draw", shaders.make({})).depth(map);
  add_show("show", map, out);
  add_readback(out);
  Plan p = plan();
  EXPECT_EQ(p.uses[0].load, VK_ATTACHMENT_LOAD_OP_LOAD);
  EXPECT_EQ(p.uses[0].store, VK_ATTACHMENT_STORE_OP_STORE);
  EXPECT_EQ(p.resources[map.id].heap, -1);
  EXPECT_EQ(p.cells[p.resources[map.id].first_cell].before, shader_read) << "as the frame before has left it";

  graph = Graph();
  const Tex resting = graph.keep("map", {{64, 32}, d32}), seen = image("seen");
  add_show("show", resting, seen);
  add_readback(seen);
  p = plan();
  for (const Barrier& b : p.barriers)
    EXPECT_NE(b.resource, resting.id) << "read frame after frame: nothing to wait for";
}

// One layer is read, both are written: a later frame may read the other.
TEST_F(GraphTest, AKeptImageKeepsAllItsWritersAlive) {
  const Tex map = graph.keep("map", {{64, 32}, r32, 1, 2}), out = image("out");
  graph.compute("first", source).out("value", layer(map, 0)).over(map);
  graph.compute("second", source).out("value", layer(map, 1)).over(map);
  graph.compute("use", filter).in("from", layer(map, 0)).out("value", out).over(out);
  const Tex unread = graph.keep("unread", desc);
  add_source("nobody", graph.optional(unread));
  add_readback(out);
  EXPECT_EQ(plan().culled, (std::vector<bool>{false, false, false, true, false}));
}

TEST_F(GraphTest, AKeptImageBringsItsMarks) {
  const HistoryState states[] = {{"map", {{64, 32}, d32, 1, 2}, 0, {7, 8}}};
  Graph g(states);
  const Tex map = g.keep("map", {{64, 32}, d32, 1, 2});
  EXPECT_EQ(g.mark(map, 0), 7u);
  EXPECT_EQ(g.mark(map, 1), 8u);
  const uint64_t hash = topology_hash(g);
  g.mark(map, 1) = 9;
  EXPECT_EQ(topology_hash(g), hash);
  Graph other(states);
  EXPECT_EQ(other.mark(other.keep("map", {{32, 32}, d32, 1, 2}), 0), 0u) << "another size";
  EXPECT_EQ(other.mark(other.keep("mop", {{64, 32}, d32, 1, 2}), 0), 0u) << "another name";
  Graph forgetful(states);
  forgetful.forget_histories();
  EXPECT_EQ(forgetful.mark(forgetful.keep("map", {{64, 32}, d32, 1, 2}), 0), 7u) << "it is no past, but a store";
}

TEST_F(GraphTest, LifetimesArePositionsOfLivePasses) {
  const Tex dead = image("dead"), a = image("a"), b = image("b"), c = image("c");
  add_source("dead", dead);
  add_source("a", a);
  add_filter("b", a, b);
  add_filter("c", a, c);
  add_readback(c);
  add_readback(b);
  const Plan p = plan();
  const auto life = [&](Tex t) { return std::pair{p.resources[t.id].first, p.resources[t.id].last}; };
  EXPECT_EQ(life(a), std::pair(0u, 2u));
  EXPECT_EQ(life(b), std::pair(1u, 4u));
  EXPECT_EQ(life(c), std::pair(2u, 3u));
  EXPECT_EQ(p.resources[a.id].usage, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
  EXPECT_EQ(p.resources[b.id].usage, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
}

// 64x32: a 8 B a texel = 16384; b 4 B = 8192; c 4 B with mips 64x32, 32x16, 16x8 = 4 * (2048 + 512 + 128) = 10752.
TEST_F(GraphTest, MemoryFiguresByHand) {
  const Tex a = graph.image("a", {{64, 32}, VK_FORMAT_R16G16B16A16_SFLOAT}), b = image("b");
  const Tex c = graph.image("c", {{64, 32}, VK_FORMAT_R8G8B8A8_UNORM, 3});
  const Tex unused = image("unused");
  const History h = graph.history("h", desc);
  add_source("a", a);
  add_filter("b", a, b);
  graph.compute("c", filter).in("from", b).out("value", mip(c, 0)).over(c);
  graph.compute("c1", source).out("value", mip(c, 1)).over(mip(c, 1));
  graph.compute("c2", source).out("value", mip(c, 2)).over(mip(c, 2));
  add_filter("h", c, h.next);
  add_readback(h.next);
  const Plan p = plan();
  EXPECT_EQ(p.resources[a.id].bytes, 16384u);
  EXPECT_EQ(p.resources[b.id].bytes, 8192u);
  EXPECT_EQ(p.resources[c.id].bytes, 10752u);
  EXPECT_EQ(p.resources[h.next.id].bytes, 8192u);
  EXPECT_FALSE(p.resources[unused.id].live);
  EXPECT_EQ(p.unaliased_bytes, 16384u + 8192 + 10752);  // histories are not transients
  EXPECT_EQ(p.max_live_bytes, 16384u + 8192);           // at pass b; at pass c it is 18944
}

TEST_F(GraphTest, ReadGroupHasOneBarrierForAllReaders) {
  const Tex a = image("a"), x = image("x"), y = image("y"), z = image("z");
  const uint32_t write = add_source("a", a);
  const uint32_t read1 = add_filter("x", a, x), read2 = add_show("y", a, y), read3 = add_filter("z", a, z);
  for (const Tex t : {x, y, z}) add_readback(t);
  const Plan p = plan();
  const Barrier b = barrier_of(p, read1, a);
  EXPECT_EQ(b.src_stages, compute_stage);
  EXPECT_EQ(b.src_access, storage_write);
  EXPECT_EQ(b.dst_stages, compute_stage | fragment_stage);
  EXPECT_EQ(b.dst_access, sampled_read);
  EXPECT_EQ(b.old_layout, general);
  EXPECT_EQ(b.new_layout, shader_read);
  EXPECT_TRUE(barriers_of(p, read2, a).empty());
  EXPECT_TRUE(barriers_of(p, read3, a).empty());
  // The next frame's first write waits for every reader, discards the content, and needs nothing made available.
  const Barrier ring = barrier_of(p, write, a);
  EXPECT_EQ(ring.src_stages, compute_stage | fragment_stage);
  EXPECT_EQ(ring.src_access, VkAccessFlags2(0));
  EXPECT_EQ(ring.dst_stages, compute_stage);
  EXPECT_EQ(ring.dst_access, storage_write);
  EXPECT_EQ(ring.old_layout, undefined);
  EXPECT_EQ(ring.new_layout, general);
}

TEST_F(GraphTest, WriteAfterReadNeedsNoSourceAccess) {
  const Tex a = image("a"), x = image("x");
  add_source("a", a);
  add_filter("x", a, x);
  const uint32_t again = add_source("a again", a);
  add_readback(a);
  add_readback(x);
  const Plan p = plan();
  const Barrier b = barrier_of(p, again, a);
  EXPECT_EQ(b.src_stages, compute_stage);
  EXPECT_EQ(b.src_access, VkAccessFlags2(0));
  EXPECT_EQ(b.dst_access, storage_write);
  EXPECT_EQ(b.old_layout, shader_read);
  EXPECT_EQ(b.new_layout, general);
}

TEST_F(GraphTest, WriteAfterWriteIsMadeAvailable) {
  const Tex a = image("a");
  const uint32_t first = add_source("a", a);
  const uint32_t second = (graph.compute("modify", modify).inout("value", a).over(a), row());
  const uint32_t copy = add_readback(a);
  const Plan p = plan();
  EXPECT_EQ(barrier_of(p, second, a).src_access, storage_write);
  EXPECT_EQ(barrier_of(p, second, a).dst_access, storage_read | storage_write);
  EXPECT_EQ(barrier_of(p, second, a).old_layout, general);
  EXPECT_EQ(barrier_of(p, copy, a).dst_stages, copy_stage);
  EXPECT_EQ(barrier_of(p, copy, a).new_layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  EXPECT_EQ(barrier_of(p, first, a).src_stages, copy_stage);  // round the frame
}

TEST_F(GraphTest, StorageAndSampledReadsDifferInLayout) {
  const Tex a = image("a"), x = image("x"), y = image("y"), z = image("z");
  add_source("a", a);
  const uint32_t loads = add_loader("x", a, x), samples = add_filter("y", a, y), loads_again = add_loader("z", a, z);
  for (const Tex t : {x, y, z}) add_readback(t);
  const Plan p = plan();
  EXPECT_EQ(barrier_of(p, loads, a).old_layout, general);
  EXPECT_EQ(barrier_of(p, loads, a).new_layout, general);
  EXPECT_EQ(barrier_of(p, loads, a).dst_access, storage_read);
  EXPECT_EQ(barrier_of(p, samples, a).old_layout, general);
  EXPECT_EQ(barrier_of(p, samples, a).new_layout, shader_read);
  EXPECT_EQ(barrier_of(p, samples, a).src_access, VkAccessFlags2(0));  // a read; the write is available already
  EXPECT_EQ(barrier_of(p, loads_again, a).old_layout, shader_read);
  EXPECT_EQ(barrier_of(p, loads_again, a).new_layout, general);
  EXPECT_EQ(p.cells[p.resources[a.id].first_cell].before, undefined);
  EXPECT_EQ(p.cells[p.resources[a.id].first_cell].after, general);
}

// prev(N+1) is next(N), next(N+1) is prev(N): the ring goes through both.
TEST_F(GraphTest, HistoryRingGoesThroughBothSides) {
  const History h = graph.history("mean", desc);
  const Tex shown = image("shown");
  const uint32_t accumulate = add_filter("accumulate", h.prev, h.next);
  const uint32_t display = add_show("display", h.next, shown);
  add_readback(shown);
  const uint32_t copy = add_readback(h.next);
  const Plan p = plan();
  const Barrier prev = barrier_of(p, accumulate, h.prev), next = barrier_of(p, accumulate, h.next);
  EXPECT_EQ(prev.src_stages, copy_stage);  // the last use of next
  EXPECT_EQ(prev.old_layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  EXPECT_EQ(prev.new_layout, shader_read);
  EXPECT_EQ(prev.dst_access, sampled_read);
  EXPECT_EQ(next.src_stages, compute_stage);  // the last use of prev
  EXPECT_EQ(next.src_access, VkAccessFlags2(0));
  EXPECT_EQ(next.old_layout, undefined);
  EXPECT_EQ(barrier_of(p, display, h.next).old_layout, general);
  EXPECT_EQ(barrier_of(p, copy, h.next).old_layout, shader_read);
}

TEST_F(GraphTest, HistoryHandsItsContentOver) {
  const History h = graph.history("mean", desc);
  const Tex out = image("out");
  const uint32_t use = add_filter("use", h.prev, out);
  add_readback(out);
  const uint32_t write = add_source("write", h.next);
  const Plan p = plan();
  EXPECT_EQ(barrier_of(p, use, h.prev).src_access, storage_write);
  EXPECT_EQ(barrier_of(p, use, h.prev).old_layout, general);
  EXPECT_EQ(barrier_of(p, write, h.next).src_stages, compute_stage);
  EXPECT_EQ(barrier_of(p, write, h.next).src_access, VkAccessFlags2(0));
}

TEST_F(GraphTest, LoadAndStore) {
  const Tex color = image("color"), depth = graph.image("depth", {{64, 32}, d32}), out = image("out");
  const std::array<float, 4> black{0, 0, 0, 1};
  graph.raster("first", paint).out("color", color, black).depth(depth, 0.0f);
  graph.raster("second", paint).out("color", color).depth(depth);
  add_show("show", color, out);
  graph.raster("wipe", paint).out("color", color, black);
  add_readback(out);
  add_readback(color);
  const Plan p = plan();
  const auto use = [&](uint32_t pass, uint32_t i) { return p.uses[graph.passes[pass].first_use + i]; };
  constexpr auto load_dont_care = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  constexpr auto store_dont_care = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  EXPECT_EQ(use(0, 0).load, VK_ATTACHMENT_LOAD_OP_CLEAR);
  EXPECT_EQ(use(0, 1).load, VK_ATTACHMENT_LOAD_OP_CLEAR);
  EXPECT_EQ(use(0, 0).store, VK_ATTACHMENT_STORE_OP_STORE);
  EXPECT_EQ(use(0, 1).store, VK_ATTACHMENT_STORE_OP_STORE);
  EXPECT_EQ(use(1, 0).load, VK_ATTACHMENT_LOAD_OP_LOAD);
  EXPECT_EQ(use(1, 1).load, VK_ATTACHMENT_LOAD_OP_LOAD);
  EXPECT_EQ(use(1, 0).store, VK_ATTACHMENT_STORE_OP_STORE);
  EXPECT_EQ(use(1, 1).store, store_dont_care);  // nobody needs the depth any more
  EXPECT_EQ(use(2, 1).load, load_dont_care);    // first full write
  EXPECT_EQ(use(3, 0).load, VK_ATTACHMENT_LOAD_OP_CLEAR);
  EXPECT_EQ(use(3, 0).store, VK_ATTACHMENT_STORE_OP_STORE);
  // What loads also reads: the barrier says so.
  const Barrier b = barrier_of(p, 1, color);
  EXPECT_EQ(b.src_stages, color_stage);
  EXPECT_EQ(b.src_access, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
  EXPECT_EQ(b.dst_access, VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
  EXPECT_EQ(b.old_layout, color_layout);
  EXPECT_EQ(barrier_of(p, 3, color).dst_access, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
}

TEST_F(GraphTest, AttachmentClearedBeforeAnyReadIsNotStored) {
  const Tex color = image("color");
  graph.raster("first", paint).out("color", color, {0, 0, 0, 0});
  graph.raster("second", paint).out("color", color, {1, 1, 1, 1});
  add_readback(color);
  const Plan p = plan();
  EXPECT_EQ(p.uses[0].store, VK_ATTACHMENT_STORE_OP_DONT_CARE);
  EXPECT_EQ(p.uses[1].store, VK_ATTACHMENT_STORE_OP_STORE);
}

TEST_F(GraphTest, HistoryNextIsAlwaysStored) {
  const History h = graph.history("mean", desc);
  const Tex out = image("out");
  add_show("use", h.prev, out);
  add_readback(out);
  const uint32_t write = (graph.fullscreen("write", paint).out("color", h.next), row());
  const Plan p = plan();
  EXPECT_EQ(p.uses[graph.passes[write].first_use].load, VK_ATTACHMENT_LOAD_OP_DONT_CARE);
  EXPECT_EQ(p.uses[graph.passes[write].first_use].store, VK_ATTACHMENT_STORE_OP_STORE);
}

// A row's own description given for a history, while rows move: what the sanitizers watch.
TEST(GraphValue, ARowsDescriptionMayBeGiven) {
  Graph graph;
  const ImageDesc wanted{{320, 180}, VK_FORMAT_R32_SFLOAT};
  Tex like = graph.image("like", wanted);
  for (int i = 0; i < 200; ++i) {
    const History history = graph.history("history", graph.desc(like));
    EXPECT_EQ(graph.desc(history.prev), wanted);
    EXPECT_EQ(graph.desc(history.next), wanted);
    like = graph.keep("kept", graph.desc(history.next));
    EXPECT_EQ(graph.desc(like), wanted);
  }
}

}  // namespace
}  // namespace nf::graph
