// The topology hash, and graphs and plans as JSON and text.
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

#include "graph/dump.h"
#include "graph/hazards.h"
#include "graph_values.h"

namespace nf::graph {
namespace {

using nlohmann::json;
constexpr VkFormat r32 = VK_FORMAT_R32_SFLOAT;

#define NF_TINT_PARAMS(P) P(Float, strength, 1.0f, 0.0f, 4.0f, "", "Strength")
NF_DECLARE_PARAMS(TintParams, "tint", NF_TINT_PARAMS)

// What a graph may differ in.
struct Variant {
  Size size{64, 32};
  VkFormat format = r32;
  uint8_t mips = 1, layers = 1;
  const char *slot = "from", *pass = "filter", *resource = "b";
  std::array<float, 4> clear{0, 0, 0, 1};
  bool cleared = true, history = false, swapped = false, second_pipeline = false, show = true;
  float strength = 1;
  uint64_t callback = 1;
};

class GraphValueTest : public testing::Test {
 protected:
  Shaders shaders;
  const gpu::Slot block{
      .name = "tint", .kind = gpu::SlotKind::UniformBlock, .block_size = 4, .members = {{"strength", 0}}};
  const gpu::Pipeline source = shaders.make({storage_out("value")});
  const gpu::Pipeline filter = shaders.make({sampled("from"), sampled("other"), storage_out("value"), block});
  const gpu::Pipeline twin = shaders.make({sampled("from"), sampled("other"), storage_out("value"), block});
  const gpu::Pipeline show = shaders.make({sampled("from")}, {"color"});

  Graph make(const Variant& v = {}) {
    Graph graph;
    const ImageDesc desc{v.size, v.format, v.mips, v.layers};
    const Tex a = graph.image("a", desc);
    const Tex b = v.history ? graph.history(v.resource, desc).next : graph.image(v.resource, desc);
    const Tex c = graph.image("c", desc);
    graph.compute("source", source).out("value", a).over(v.swapped ? b : a);
    TintParams params;
    params.strength = v.strength;
    graph.compute(v.pass, v.second_pipeline ? twin : filter).in(v.slot, a).out("value", b).params(params).over(b);
    auto last = v.show ? graph.fullscreen("show", show) : graph.raster("show", show);
    last.in("from", b);
    v.cleared ? last.out("color", c, v.clear) : last.out("color", c);
    last.draw([callback = v.callback](const Recorder&) { (void)callback; });
    graph.readback("out", c);
    return graph;
  }
};

TEST_F(GraphValueTest, HashLeavesValuesOut) {
  const uint64_t hash = topology_hash(make());
  EXPECT_EQ(hash, topology_hash(make()));
  EXPECT_EQ(hash, topology_hash(make({.strength = 3})));
  EXPECT_EQ(hash, topology_hash(make({.callback = 2})));
}

TEST_F(GraphValueTest, HashTellsTopologiesApart) {
  const std::pair<const char*, Variant> variants[] = {
      {"none", {}},
      {"width", {.size = {65, 32}}},
      {"height", {.size = {64, 33}}},
      {"turned", {.size = {32, 64}}},
      {"format", {.format = VK_FORMAT_R16_SFLOAT}},
      {"mips", {.mips = 2}},
      {"layers", {.layers = 2}},
      {"slot", {.slot = "other"}},
      {"pass", {.pass = "blur"}},
      {"resource", {.resource = "bb"}},
      {"clear", {.clear = {0, 0, 0, 0.5f}}},
      {"clear red", {.clear = {1, 0, 0, 1}}},
      {"uncleared", {.cleared = false}},
      {"uncleared, colour zero", {.clear = {0, 0, 0, 0}}},
      {"lifetime", {.history = true}},
      {"threads", {.swapped = true}},
      {"pipeline", {.second_pipeline = true}},
      {"kind", {.show = false}},
  };
  std::set<uint64_t> seen;
  for (const auto& [what, variant] : variants) EXPECT_TRUE(seen.insert(topology_hash(make(variant))).second) << what;
}

TEST_F(GraphValueTest, HashSeesWhoReadsWhat) {
  const auto graph = [&](bool swapped) {
    Graph g;
    const Tex a = g.image("a", {{4, 4}, r32}), b = g.image("b", {{4, 4}, r32}), c = g.image("c", {{4, 4}, r32});
    g.compute("a", source).out("value", a).over(a);
    g.compute("b", source).out("value", b).over(b);
    g.compute("c", filter).in("from", swapped ? b : a).in("other", swapped ? a : b).out("value", c).over(c);
    g.readback("out", c);
    return topology_hash(g);
  };
  EXPECT_NE(graph(false), graph(true));
}

class GraphDumpTest : public GraphValueTest {
 protected:
  // source -> a; (dead) -> d; accumulate: a, h.prev, scene buffer -> h.next; show: h.next -> c; read back.
  GraphDumpTest() {
    const ImageDesc desc{{64, 32}, VK_FORMAT_R16G16B16A16_SFLOAT};
    const Tex a = graph.image("a", desc), d = graph.image("d", desc), c = graph.image("c", {{64, 32}, r32});
    const History h = graph.history("mean", desc);
    const Buf lights = graph.import("lights", buffer);
    graph.compute("source", source, "Makes a").out("value", a).over(a);
    graph.compute("dead", source).out("value", d).over(d);
    graph.compute("accumulate", mix)
        .in("from", a)
        .in("before", h.prev)
        .in("lights", lights)
        .out("value", h.next)
        .over(h.next);
    graph.fullscreen("show", show).in("from", h.next).out("color", c);
    graph.readback("out", c);
    for (const Diagnostic& fault : faults(graph)) ADD_FAILURE() << fault.text;
    plan = compile(graph);
  }
  const gpu::Pipeline mix = shaders.make({sampled("from"),
                                          storage_in("before"),
                                          storage_out("value"),
                                          {.name = "lights", .kind = gpu::SlotKind::StorageBuffer, .readonly = true}});
  const gpu::Buffer buffer{.size = 160};
  Graph graph;
  Plan plan;
};

TEST_F(GraphDumpTest, JsonHasTheSchema) {
  const json doc = json::parse(to_json(graph, plan).dump());
  EXPECT_EQ(doc["schema"], "nearfield.graph/1");
  ASSERT_EQ(doc["passes"].size(), 5u);
  for (const json& pass : doc["passes"]) {
    for (const char* key : {"name", "label", "kind", "culled", "uses", "barriers"})
      EXPECT_TRUE(pass.contains(key)) << key;
    for (const json& use : pass["uses"])
      for (const char* key : {"resource", "use", "slot", "mip"}) EXPECT_TRUE(use.contains(key)) << key;
  }
  ASSERT_EQ(doc["resources"].size(), 6u);  // the two sides of the history are two rows
  std::set<std::string> names;
  for (const json& resource : doc["resources"]) {
    names.insert(resource["name"]);
    for (const char* key :
         {"name", "kind", "format", "size", "bytes", "first", "last", "heap", "offset", "transient", "alias_of"})
      EXPECT_TRUE(resource.contains(key)) << key;
  }
  EXPECT_EQ(names.size(), 6u);
  for (const char* key : {"placed_bytes", "max_live_bytes", "unaliased_bytes"})
    EXPECT_TRUE(doc["memory"][key].is_number_unsigned()) << key;
  EXPECT_EQ(doc["memory"]["unaliased_bytes"], 64 * 32 * (8 + 4));
  EXPECT_EQ(doc["memory"]["max_live_bytes"], 64 * 32 * 8);
  EXPECT_EQ(doc["histories"].size(), 1u);
  EXPECT_EQ(doc["histories"][0]["name"], "mean");
}

// Passes may share a name, which groups their times, and images one; labels tell them apart.
TEST_F(GraphDumpTest, LabelsTellNamesakesApart) {
  Graph g;
  for (int i = 0; i < 3; ++i) {
    const Tex a = g.image("tile", {{4, 4}, r32});
    g.compute("tile", source).out("value", a).over(a);
    g.readback("out", a);
  }
  const json doc = to_json(g, compile(g));
  std::vector<std::string> passes, images;
  for (const json& pass : doc["passes"])
    if (pass["name"] == "tile") passes.push_back(pass["label"]);
  for (const json& resource : doc["resources"]) images.push_back(resource["name"]);
  EXPECT_EQ(passes, (std::vector<std::string>{"tile", "tile #2", "tile #3"}));
  EXPECT_EQ(images, passes);
}

TEST_F(GraphDumpTest, JsonTellsWhatHappens) {
  const json doc = to_json(graph, plan);
  const json& passes = doc["passes"];
  EXPECT_EQ(passes[0]["name"], "source");
  EXPECT_EQ(passes[0]["kind"], "compute");
  EXPECT_EQ(passes[0]["culled"], false);
  EXPECT_EQ(passes[1]["culled"], true);
  EXPECT_TRUE(passes[1]["barriers"].empty());
  EXPECT_EQ(passes[3]["kind"], "fullscreen");
  EXPECT_EQ(passes[4]["kind"], "readback");
  const json& uses = passes[2]["uses"];
  ASSERT_EQ(uses.size(), 4u);
  EXPECT_EQ(uses[0], json({{"resource", "a"},
                           {"use", "sampled"},
                           {"reads", true},
                           {"writes", false},
                           {"slot", "from"},
                           {"mip", 0},
                           {"mips", 1},
                           {"layer", 0},
                           {"layers", 1}}));
  EXPECT_EQ(uses[1]["resource"], "mean.prev");
  EXPECT_EQ(uses[2]["resource"], "lights");
  EXPECT_EQ(uses[2]["use"], "buffer_read");
  EXPECT_EQ(uses[3]["use"], "storage_write");
  EXPECT_EQ(uses[3]["writes"], true);
  EXPECT_EQ(passes[4]["uses"][0]["slot"], nullptr);
  size_t barriers = 0;
  for (const json& pass : passes) barriers += pass["barriers"].size();
  EXPECT_EQ(barriers, plan.barriers.size());
  ASSERT_EQ(passes[3]["barriers"].size(), 2u);  // what it samples, what it draws to: by row of the resource
  for (const json& barrier : passes[3]["barriers"])
    for (const char* key : {"resource", "src", "dst", "from", "to"}) EXPECT_TRUE(barrier[key].is_string()) << key;
  EXPECT_EQ(passes[3]["barriers"][1], json({{"resource", "mean"},
                                            {"mip", 0},
                                            {"mips", 1},
                                            {"layer", 0},
                                            {"layers", 1},
                                            {"src", "compute"},
                                            {"dst", "fragment"},
                                            {"from", "general"},
                                            {"to", "shader_read"}}));
  const json& dead = doc["resources"][1];
  EXPECT_EQ(dead["name"], "d");
  EXPECT_TRUE(dead["first"].is_null());
  EXPECT_EQ(doc["resources"][0]["first"], 0);
  EXPECT_EQ(doc["resources"][0]["last"], 1);
  EXPECT_EQ(doc["resources"][0]["size"], json({64, 32}));
  EXPECT_EQ(doc["resources"][0]["transient"], true);
  EXPECT_EQ(doc["resources"][3]["transient"], false);
  EXPECT_EQ(doc["resources"][5]["kind"], "buffer");
  EXPECT_EQ(doc["resources"][5]["bytes"], 160);
}

TEST_F(GraphDumpTest, TextNamesEverything) {
  const std::string text = to_text(graph, plan);
  for (const char* word : {"source", "dead", "accumulate", "show", "out", "culled", "mean.prev", "lights", "64x32",
                           "unused", "(history)", "fullscreen", "memory:"})
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  EXPECT_NE(text.find(fmt::format("{} barriers", plan.barriers.size())), std::string::npos) << text;
}

// a -> b, and a -> c beside it when `both`.
struct Small {
  Shaders shaders;
  gpu::Pipeline source = shaders.make({storage_out("value")});
  gpu::Pipeline step = shaders.make({storage_in("from"), storage_out("value")});
  Graph graph;
  Plan plan;
  explicit Small(bool both) {
    const ImageDesc desc{{64, 32}, VK_FORMAT_R32_SFLOAT};
    const Tex a = graph.image("a", desc), b = graph.image("b", desc), c = graph.image("c", desc);
    graph.compute("make a", source).out("value", a).over(a);
    graph.compute("make b", step).in("from", a).out("value", b).over(b);
    graph.compute("make c", step).in("from", a).out("value", c).over(c);
    graph.readback("out b", b);
    if (both) graph.readback("out c", c);
    plan = compile(graph);
  }
};

TEST(Dump, DotNamesEverythingAndGreysWhatIsCulled) {
  const Small small(false);
  const std::string dot = to_dot(small.graph, small.plan);
  EXPECT_EQ(dot.find("digraph"), 0u);
  for (const char* part : {"label=\"make a\"", "p0 -> r0", "r0 -> p1", "p1 -> r1", "r1 -> p3"})
    EXPECT_NE(dot.find(part), std::string::npos) << part;
  EXPECT_NE(dot.find("label=\"make c\", shape=box, color=grey"), std::string::npos);
  EXPECT_EQ(std::count(dot.begin(), dot.end(), '{'), std::count(dot.begin(), dot.end(), '}'));
}

TEST(Dump, ImportedImagesAreMarkedAndTakeNoMemory) {
  Shaders shaders;
  const gpu::Image sky{.whole = gpu::WholeView::Flat,
                       .info = {.extent = {64, 32}, .format = VK_FORMAT_R16G16B16A16_SFLOAT}};
  Graph graph;
  const Tex lent = graph.import("sky", sky), out = graph.image("out", {{8, 8}, VK_FORMAT_R32_SFLOAT});
  graph.compute("light", shaders.make({sampled("from"), storage_out("value")}))
      .in("from", lent)
      .out("value", out)
      .over(out);
  graph.readback("back", out);
  EXPECT_TRUE(faults(graph).empty());
  const Plan plan = compile(graph);
  EXPECT_TRUE(find_hazards(graph, plan).empty());
  const nlohmann::json row = to_json(graph, plan)["resources"][0];
  EXPECT_EQ(row["kind"], "image");
  EXPECT_EQ(row["imported"], true);
  EXPECT_EQ(row["transient"], false);
  EXPECT_EQ(row["heap"], nullptr);
  EXPECT_EQ(row["bytes"], 64 * 32 * 8);
  EXPECT_EQ(plan.unaliased_bytes, 8u * 8 * 4);
  EXPECT_NE(to_text(graph, plan).find("(imported)"), std::string::npos);
  EXPECT_EQ(to_dot(graph, plan).find("sky"), std::string::npos);
  for (const Barrier& b : plan.barriers) EXPECT_NE(b.resource, lent.id);
  // The replay objects to a barrier for it, and to any use that is not sampling.
  Plan moved = plan;
  moved.barriers[0].resource = lent.id;
  EXPECT_FALSE(find_hazards(graph, moved).empty());
  graph.uses[0].use = Use::StorageImageRead;
  EXPECT_FALSE(find_hazards(graph, plan).empty());
}

TEST(Dump, DiffSaysWhatComesAndGoes) {
  const Small one(false), two(true);
  const std::string there = diff_text(one.graph, one.plan, two.graph, two.plan);
  EXPECT_NE(there.find("+ pass make c"), std::string::npos) << there;
  EXPECT_NE(there.find("+ pass out c"), std::string::npos);
  EXPECT_EQ(there.find("- pass"), std::string::npos);
  const std::string back = diff_text(two.graph, two.plan, one.graph, one.plan);
  EXPECT_NE(back.find("- pass make c"), std::string::npos) << back;
  const std::string same = diff_text(one.graph, one.plan, one.graph, one.plan);
  EXPECT_EQ(same.find("pass "), std::string::npos) << same;
}

}  // namespace
}  // namespace nf::graph
