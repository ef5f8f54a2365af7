// Read-backs put in between the passes of a graph, and what texels are as floats.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "graph/hazards.h"
#include "graph/probe.h"
#include "graph_values.h"
#include "random_graph.h"

namespace nf::graph {
namespace {

constexpr VkFormat r32 = VK_FORMAT_R32_SFLOAT;

class ProbeTest : public testing::Test {
 protected:
  Shaders shaders;
  const gpu::Pipeline source = shaders.make({storage_out("value")});
  const gpu::Pipeline filter = shaders.make({sampled("from"), storage_out("value")});
  const gpu::Pipeline modify = shaders.make({storage_inout("value")});
  const ImageDesc desc{{64, 32}, r32, 2, 1};
  Graph graph;
  Tex a, b, dead, imported;
  gpu::Image outside;
  // Rows: 0 a.0, 1 a.1, 2 modify, 3 dead, 4 b, 5 readback.
  void SetUp() override {
    outside.info = {.extent = {4, 4}, .format = r32};
    a = graph.image("a", desc);
    b = graph.image("b", {{64, 32}, r32});
    dead = graph.image("dead", {{64, 32}, r32});
    imported = graph.import("outside", outside);
    graph.compute("a.0", source).out("value", mip(a, 0)).over(mip(a, 0));
    graph.compute("a.1", source).out("value", mip(a, 1)).over(mip(a, 1));
    graph.compute("modify", modify).inout("value", mip(a, 0)).over(mip(a, 0));
    graph.compute("dead", source).out("value", graph.optional(dead)).over(dead);
    graph.compute("b", filter).in("from", a).out("value", b).over(b);
    graph.readback("b", b);
  }
  std::string fault(uint32_t pass, bool before, Tex tex, uint8_t mip = 0, uint8_t layer = 0) const {
    return probe_fault(graph, {.pass = pass, .before = before, .resource = tex.id, .mip = mip, .layer = layer});
  }
};

TEST_F(ProbeTest, AResourceNeedsContentThere) {
  EXPECT_EQ(fault(0, true, a), "'a' has no content in mip 0 of layer 0 before 'a.0': nothing has written it yet");
  EXPECT_EQ(fault(0, false, a), "");
  EXPECT_EQ(fault(0, false, a, 1), "'a' has no content in mip 1 of layer 0 after 'a.0': nothing has written it yet");
  EXPECT_EQ(fault(1, true, a), "");
  EXPECT_EQ(fault(1, false, a, 1), "");
  EXPECT_EQ(fault(4, true, b), "'b' has no content before 'b': nothing has written it yet");
  EXPECT_EQ(fault(4, false, b), "");
  EXPECT_EQ(fault(3, false, a), "'dead' is culled: nothing in the frame needs it");
  EXPECT_EQ(fault(4, false, dead), "'dead' has no content after 'b': 'dead', which would write it, is culled");
  EXPECT_EQ(fault(4, false, imported),
            "'outside' belongs to the scene and lies outside the frame: it is only read here");
  EXPECT_EQ(fault(4, false, a, 2), "'a' has 2 mips and 1 layers: there is no mip 2 of layer 0");
  EXPECT_EQ(fault(4, false, a, 0, 1), "'a' has 2 mips and 1 layers: there is no mip 0 of layer 1");
  EXPECT_EQ(fault(6, false, a), "there is no pass 6: the frame has 6");
  EXPECT_EQ(probe_fault(graph, {.pass = 0, .resource = 99}), "there is no resource 99: the frame has 4");
}

TEST_F(ProbeTest, ItIsARowLikeAnyOther) {
  const size_t uses = graph.uses.size();
  const uint64_t hash = topology_hash(graph);
  EXPECT_NE(add_probe(graph, {.pass = 0, .before = true, .resource = a.id}), "");
  EXPECT_EQ(topology_hash(graph), hash) << "a fault leaves the graph as it was";
  ASSERT_EQ(add_probe(graph, {.pass = 2, .resource = a.id, .name = "late"}), "");
  ASSERT_EQ(add_probe(graph, {.pass = 2, .before = true, .resource = a.id, .name = "early"}), "");
  EXPECT_NE(topology_hash(graph), hash);
  EXPECT_EQ(graph.readbacks, 3u);
  EXPECT_EQ(graph.uses.size(), uses + 2);
  std::vector<std::string> names;
  for (const PassRow& pass : graph.passes) names.push_back(pass.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a.0", "a.1", "early", "modify", "late", "dead", "b", "b"}));
  // Every pass still has its own uses.
  uint32_t next = 0;
  for (const PassRow& pass : graph.passes) {
    EXPECT_EQ(pass.first_use, next) << pass.name;
    next += pass.use_count;
  }
  EXPECT_EQ(graph.uses_of(graph.passes[6])[1].resource, b.id);
  for (const Diagnostic& d : faults(graph)) ADD_FAILURE() << d.text;
  const Plan plan = compile(graph);
  EXPECT_EQ(find_hazards(graph, plan), std::vector<std::string>{});
  // Each read-back waits for what was written just before, and what comes after waits for it.
  for (const uint32_t probe : {2u, 4u}) {
    const Barrier barrier = barrier_of(plan, probe, a);
    EXPECT_EQ(barrier.src_stages, compute_stage);
    EXPECT_EQ(barrier.src_access, storage_write);
    EXPECT_EQ(barrier.new_layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    EXPECT_EQ(barrier.part, (Part{0, 1, 0, 1}));
  }
  EXPECT_EQ(barrier_of(plan, 3, a).src_stages, copy_stage);
}

TEST_F(ProbeTest, OneTexelIsCheckedAndMovesWithoutAnotherPlan) {
  const auto with = [&](uint32_t x, uint32_t y, uint8_t mip) {
    return Probe{.pass = 2, .resource = a.id, .mip = mip, .texel = Texel{x, y}};
  };
  EXPECT_EQ(probe_fault(graph, with(63, 31, 0)), "");
  EXPECT_EQ(probe_fault(graph, with(64, 31, 0)), "'a' is 64x32 there: it has no texel 64, 31");
  EXPECT_EQ(probe_fault(graph, with(31, 16, 1)), "'a' is 32x16 there: it has no texel 31, 16");
  Graph here = graph, there = graph, whole = graph;
  ASSERT_EQ(add_probe(here, with(1, 2, 0)), "");
  ASSERT_EQ(add_probe(there, with(3, 4, 0)), "");
  ASSERT_EQ(add_probe(whole, {.pass = 2, .resource = a.id}), "");
  EXPECT_EQ(topology_hash(here), topology_hash(there));
  EXPECT_NE(topology_hash(here), topology_hash(whole));
}

// Each mip after its own last writer; what is culled or lies outside is left out, and so are later rows.
TEST_F(ProbeTest, LastStates) {
  const std::vector<Probe> all = last_states(graph, graph.resources.size());
  std::vector<std::tuple<uint32_t, uint16_t, uint8_t>> seen;
  for (const Probe& probe : all) seen.emplace_back(probe.pass, probe.resource, probe.mip);
  EXPECT_EQ(seen, (std::vector<std::tuple<uint32_t, uint16_t, uint8_t>>{{1, a.id, 1}, {2, a.id, 0}, {4, b.id, 0}}));
  EXPECT_EQ(last_states(graph, 1).size(), 2u);
  const History history = graph.history("kept", {{64, 32}, r32});
  graph.compute("next", filter).in("from", history.prev).out("value", history.next).over(history.next);
  graph.readback("out", history.next);
  const std::vector<Probe> more = last_states(graph, graph.resources.size());
  ASSERT_EQ(more.size(), 5u) << "what the frame only reads has content, too";
  EXPECT_EQ(more[3].resource, history.prev.id);
  EXPECT_EQ(more[3].pass, 6u);
}

// Wherever a probe is allowed in graphs of all kinds of rows, the graph is valid and its plan has no hazard.
TEST(Probe, RandomGraphsStayValid) {
  uint32_t put = 0, refused = 0;
  for (uint32_t seed = 1; seed <= 60; ++seed) {
    const RandomGraph random(seed);
    const Graph& base = random.graph;
    for (uint32_t i = 0; i < 12; ++i) {
      Graph graph = base;
      const Probe probe{.pass = (seed * 7 + i * 5) % uint32_t(graph.passes.size()),
                        .before = i % 2 == 0,
                        .resource = uint16_t((seed * 3 + i * 11) % graph.resources.size())};
      if (!add_probe(graph, probe).empty()) {
        ++refused;
        continue;
      }
      ++put;
      for (const Diagnostic& d : faults(graph)) ADD_FAILURE() << "seed " << seed << ": " << d.text;
      for (const std::string& hazard : find_hazards(graph, compile(graph)))
        ADD_FAILURE() << "seed " << seed << ": " << hazard;
    }
  }
  std::printf("%u probes put in, %u refused\n", put, refused);
  EXPECT_GT(put, 50u);
  EXPECT_GT(refused, 50u);
}

template <class T>
std::vector<float> floats(VkFormat format, std::initializer_list<T> words, uint32_t width) {
  Readback readback{"", {{width, 1}, format}, std::vector<std::byte>(words.size() * sizeof(T))};
  std::memcpy(readback.texels.data(), std::data(words), readback.texels.size());
  uint32_t channels = 0;
  std::vector<float> out = to_floats(readback, channels);
  EXPECT_EQ(out.size(), size_t(channels) * width);
  return out;
}

TEST(Texels, EveryFormatAsFloats) {
  using F = std::vector<float>;
  using u8 = uint8_t;
  using u16 = uint16_t;
  EXPECT_EQ(floats(VK_FORMAT_R32_SFLOAT, {1.5f, -2.0f}, 2), (F{1.5f, -2}));
  EXPECT_EQ(floats(VK_FORMAT_R32G32_SFLOAT, {1.5f, -2.0f}, 1), (F{1.5f, -2}));
  EXPECT_EQ(floats(VK_FORMAT_R32G32B32A32_SFLOAT, {1.0f, 2.0f, 3.0f, 4.0f}, 1), (F{1, 2, 3, 4}));
  EXPECT_EQ(floats(VK_FORMAT_D32_SFLOAT, {0.25f}, 1), (F{0.25f}));
  EXPECT_EQ(floats(VK_FORMAT_D16_UNORM, {u16(0), u16(0xffff)}, 2), (F{0, 1}));
  EXPECT_EQ(floats(VK_FORMAT_R16_SFLOAT, {u16(0x3c00), u16(0xc000)}, 2), (F{1, -2}));
  EXPECT_EQ(floats(VK_FORMAT_R16G16_SFLOAT, {u16(0x3c00), u16(0xc000)}, 1), (F{1, -2}));
  EXPECT_EQ(floats(VK_FORMAT_R16G16B16A16_SFLOAT, {u16(0x3c00), u16(0x3800), u16(0), u16(0x7bff)}, 1),
            (F{1, 0.5f, 0, 65504}));
  EXPECT_EQ(floats(VK_FORMAT_R16G16B16A16_UNORM, {u16(0xffff), u16(0), u16(0x3333), u16(0)}, 1), (F{1, 0, 0.2f, 0}));
  EXPECT_EQ(floats(VK_FORMAT_R8_UNORM, {u8(0), u8(51), u8(255)}, 3), (F{0, 0.2f, 1}));
  EXPECT_EQ(floats(VK_FORMAT_R8G8_UNORM, {u8(51), u8(255)}, 1), (F{0.2f, 1}));
  EXPECT_EQ(floats(VK_FORMAT_R8G8B8A8_UNORM, {u8(51), u8(255), u8(0), u8(102)}, 1), (F{0.2f, 1, 0, 0.4f}));
  EXPECT_EQ(floats(VK_FORMAT_R32_UINT, {0u, 7u, 1u << 31}, 3), (F{0, 7, 2147483648.0f}));
  // sRGB 188 is 0.5029 (IEC 61966-2-1); alpha is linear.
  const F srgb = floats(VK_FORMAT_R8G8B8A8_SRGB, {u8(0), u8(188), u8(255), u8(51)}, 1);
  EXPECT_EQ(srgb[0], 0);
  EXPECT_NEAR(srgb[1], 0.5029f, 2e-4f);
  EXPECT_NEAR(srgb[2], 1, 1e-6f);
  EXPECT_NEAR(srgb[3], 0.2f, 1e-6f);
  // From the lowest bit: red, green, blue, then two bits of alpha.
  const F ten = floats(VK_FORMAT_A2B10G10R10_UNORM_PACK32, {1023u | 0u << 10 | 341u << 20 | 1u << 30}, 1);
  EXPECT_EQ(ten[0], 1);
  EXPECT_EQ(ten[1], 0);
  EXPECT_NEAR(ten[2], 1 / 3.0f, 1e-6f);
  EXPECT_NEAR(ten[3], 1 / 3.0f, 1e-6f);
  // 5 bits of exponent, bias 15; red and green 6 bits of mantissa, blue 5: 1.5, 2^-14 / 64 (subnormal), 64512
  // (largest).
  EXPECT_EQ(floats(VK_FORMAT_B10G11R11_UFLOAT_PACK32, {(15u << 6 | 32u) | 1u << 11 | (30u << 5 | 31u) << 22}, 1),
            (F{1.5f, std::ldexp(1.0f, -20), 64512}));
  EXPECT_TRUE(std::isinf(floats(VK_FORMAT_B10G11R11_UFLOAT_PACK32, {31u << 6}, 1)[0]));
  EXPECT_TRUE(std::isnan(floats(VK_FORMAT_B10G11R11_UFLOAT_PACK32, {31u << 6 | 1u}, 1)[0]));
  EXPECT_THROW(floats(VK_FORMAT_UNDEFINED, {1.0f}, 1), Error);
}

}  // namespace
}  // namespace nf::graph
