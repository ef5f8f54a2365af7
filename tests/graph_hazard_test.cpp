// The hazard checker on random graphs, with and without aliasing, in other orders and layouts: it finds nothing. Then
// everything a plan says is removed, weakened or moved, one thing at a time, and it must object to each: a mutation
// that it lets through is either a hole in the checker or a redundancy that compile() should not have emitted.
#include <gtest/gtest.h>

#include "graph/hazards.h"
#include "random_graph.h"

namespace nf::graph {
namespace {

CompileOptions options_for(uint64_t seed) {
  CompileOptions options{.alias = seed % 4 != 0};
  if (seed % 3 == 0) options.layouts = LayoutPolicy::General;
  if (seed % 5 == 0) options.order_seed = seed;
  options.needs = [](const ResourceRow& row, VkFlags) { return device_needs(row, false); };
  return options;
}

std::string describe(const Graph& graph, const Plan& plan, uint64_t seed, const Barrier& b, size_t row) {
  std::string pass;
  for (const PlannedPass& p : plan.passes)
    if (row >= p.first_barrier && row < p.first_barrier + p.barrier_count) pass = graph.passes[p.pass].name;
  return fmt::format(
      "seed {}: barrier {} of {}{} mips {}+{} layers {}+{} before {}: stages {:#x} -> {:#x}, access {:#x} -> {:#x}, "
      "layout {} -> {}",
      seed, row, graph.resources[b.resource].name,
      graph.resources[b.resource].lifetime == Lifetime::HistoryPrev ? ".prev" : "", b.part.mip, b.part.mips,
      b.part.layer, b.part.layers, pass, b.src_stages, b.dst_stages, b.src_access, b.dst_access, int(b.old_layout),
      int(b.new_layout));
}

bool live_together(const PlannedResource& a, const PlannedResource& b) {
  return a.live && b.live && a.heap >= 0 && a.heap == b.heap && a.first <= b.last && b.first <= a.last;
}

TEST(Hazards, RandomGraphsHaveNone) {
  size_t passes = 0, culled = 0, barriers = 0, shared = 0, parts = 0, buffers = 0;
  for (uint64_t seed = 1; seed <= 10000; ++seed) {
    const RandomGraph random(seed);
    const Graph& graph = random.graph;
    const auto wrong = faults(graph);
    ASSERT_TRUE(wrong.empty()) << "seed " << seed << ": " << wrong[0].text;
    CompileOptions options = options_for(seed);
    const bool padded = seed % 7 == 0;
    options.needs = [padded](const ResourceRow& row, VkFlags) { return device_needs(row, padded); };
    const Plan plan = compile(graph, options);
    const auto hazards = find_hazards(graph, plan);
    ASSERT_TRUE(hazards.empty()) << "seed " << seed << ": " << hazards[0];
    for (uint16_t a = 0; a < plan.resources.size(); ++a) {
      const PlannedResource& x = plan.resources[a];
      if (!x.live || x.heap < 0) continue;
      ASSERT_EQ(x.offset % device_needs(graph.resources[a], padded).alignment, 0u) << "seed " << seed;
      ASSERT_LE(x.offset + x.bytes, plan.heaps[size_t(x.heap)].size) << "seed " << seed;
      for (uint16_t b = 0; b < a; ++b) {
        const PlannedResource& y = plan.resources[b];
        const bool apart = x.offset + x.bytes <= y.offset || y.offset + y.bytes <= x.offset;
        ASSERT_TRUE(apart || !live_together(x, y)) << "seed " << seed << ": " << a << " and " << b;
        shared += !apart && y.live && y.heap == x.heap;
      }
    }
    passes += plan.passes.size();
    culled += graph.passes.size() - plan.passes.size();
    barriers += plan.barriers.size();
    for (const Barrier& b : plan.barriers) {
      buffers += graph.resources[b.resource].is_buffer;
      parts += cell_count(graph.resources[b.resource]) > uint32_t(b.part.mips) * b.part.layers;
    }
  }
  std::printf(
      "10000 graphs: %zu passes, %zu culled, %zu barriers (%zu of buffers, %zu of parts), %zu pairs share bytes\n",
      passes, culled, barriers, buffers, parts, shared);
  EXPECT_GT(culled, 10000u);
  EXPECT_GT(buffers, 10000u);
  EXPECT_GT(parts, 10000u);
  EXPECT_GT(shared, 10000u);
}

// Counts of a kind of mutation, and the first few that nobody noticed.
class Mutations : public testing::Test {
 protected:
  static constexpr uint64_t graphs = 400;
  template <class F>
  void for_each_plan(F&& f) {
    for (seed_ = 1; seed_ <= graphs; ++seed_) {
      const RandomGraph random(seed_);
      Plan plan = compile(random.graph, options_for(seed_));
      f(random.graph, plan);
    }
  }
  void expect_objection(const Graph& graph, const Plan& plan, const std::string& what) {
    ++tried_;
    if (!find_hazards(graph, plan, 1).empty()) return;
    if (++survived_ <= 5) ADD_FAILURE() << "not noticed: " << what;
  }
  void expect_barrier_objection(const Graph& graph, const Plan& plan, size_t row) {
    expect_objection(graph, plan, describe(graph, plan, seed_, plan.barriers[row], row));
  }
  void TearDown() override {
    std::printf("%zu of %zu noticed: %.3f %%\n", tried_ - survived_, tried_,
                100 * double(tried_ - survived_) / double(tried_));
    EXPECT_GT(tried_, 500u);
    EXPECT_EQ(survived_, 0u);
  }
  uint64_t seed_ = 0;
  size_t tried_ = 0, survived_ = 0;
};

TEST_F(Mutations, EveryRemovedBarrierIsMissed) {
  for_each_plan([&](const Graph& graph, const Plan& plan) {
    for (size_t i = 0; i < plan.barriers.size(); ++i) {
      Plan changed = plan;
      changed.barriers.erase(changed.barriers.begin() + ptrdiff_t(i));
      for (PlannedPass& pass : changed.passes) {
        if (i < pass.first_barrier)
          --pass.first_barrier;
        else if (i < pass.first_barrier + pass.barrier_count)
          --pass.barrier_count;
      }
      expect_objection(graph, changed, describe(graph, plan, seed_, plan.barriers[i], i));
    }
  });
}

TEST_F(Mutations, EveryStageAndAccessBitIsNeeded) {
  for_each_plan([&](const Graph& graph, Plan& plan) {
    for (size_t i = 0; i < plan.barriers.size(); ++i) {
      Barrier& b = plan.barriers[i];
      for (VkFlags64* scope : {&b.src_stages, &b.dst_stages, &b.src_access, &b.dst_access}) {
        const VkFlags64 whole = *scope;
        for (VkFlags64 rest = whole; rest; rest &= rest - 1) {
          *scope = whole & ~(rest & (~rest + 1));
          expect_barrier_objection(graph, plan, i);
        }
        *scope = whole;
      }
    }
  });
}

TEST_F(Mutations, EveryLayoutMatters) {
  for_each_plan([&](const Graph& graph, Plan& plan) {
    for (size_t i = 0; i < plan.barriers.size(); ++i) {
      Barrier& b = plan.barriers[i];
      if (graph.resources[b.resource].is_buffer) continue;
      const VkImageLayout old_layout = b.old_layout, new_layout = b.new_layout;
      b.new_layout = VK_IMAGE_LAYOUT_PREINITIALIZED;  // one that nothing uses
      expect_barrier_objection(graph, plan, i);
      b.new_layout = new_layout;
      // A first use must discard: the content would be another's, and compression data with it.
      const PlannedResource& planned = plan.resources[b.resource];
      if (old_layout == VK_IMAGE_LAYOUT_UNDEFINED)
        b.old_layout =
            plan.cells[planned.first_cell + b.part.layer * graph.resources[b.resource].desc.mips + b.part.mip].after;
      else
        b.old_layout = VK_IMAGE_LAYOUT_PREINITIALIZED;
      expect_barrier_objection(graph, plan, i);
      b.old_layout = old_layout;
    }
  });
}

TEST_F(Mutations, EveryMipAndLayerOfABarrierIsNeeded) {
  for_each_plan([&](const Graph& graph, Plan& plan) {
    for (size_t i = 0; i < plan.barriers.size(); ++i) {
      Barrier& b = plan.barriers[i];
      const Part whole = b.part;
      std::vector<Part> smaller;
      if (whole.mips > 1) {
        smaller.push_back({whole.mip, uint8_t(whole.mips - 1), whole.layer, whole.layers});
        smaller.push_back({uint8_t(whole.mip + 1), uint8_t(whole.mips - 1), whole.layer, whole.layers});
      }
      if (whole.layers > 1) {
        smaller.push_back({whole.mip, whole.mips, whole.layer, uint8_t(whole.layers - 1)});
        smaller.push_back({whole.mip, whole.mips, uint8_t(whole.layer + 1), uint8_t(whole.layers - 1)});
      }
      for (const Part& part : smaller) {
        b.part = part;
        expect_barrier_objection(graph, plan, i);
      }
      b.part = whole;
    }
  });
}

TEST_F(Mutations, EveryOverlapWithALiveResourceIsSeen) {
  for_each_plan([&](const Graph& graph, Plan& plan) {
    for (uint16_t a = 0; a < plan.resources.size(); ++a)
      for (uint16_t b = 0; b < plan.resources.size(); ++b) {
        PlannedResource& moved = plan.resources[a];
        const PlannedResource& other = plan.resources[b];
        if (a == b || !live_together(moved, other)) continue;
        const uint64_t offset = moved.offset;
        for (const uint64_t to : {other.offset, other.offset + other.bytes - 1}) {  // all of it; its last byte
          moved.offset = to;
          expect_objection(
              graph, plan,
              fmt::format("seed {}: {} moved onto {}", seed_, graph.resources[a].name, graph.resources[b].name));
        }
        moved.offset = offset;
      }
  });
}

TEST_F(Mutations, EveryLoadAndStoreIsNeeded) {
  for_each_plan([&](const Graph& graph, Plan& plan) {
    for (const PlannedPass& planned : plan.passes) {
      const PassRow& pass = graph.passes[planned.pass];
      for (uint32_t u = pass.first_use; u < pass.first_use + pass.use_count; ++u) {
        const PlannedUse whole = plan.uses[u];
        if (whole.store == VK_ATTACHMENT_STORE_OP_STORE) {
          plan.uses[u].store = VK_ATTACHMENT_STORE_OP_DONT_CARE;
          expect_objection(graph, plan, fmt::format("seed {}: store of {}", seed_, pass.name));
        }
        plan.uses[u] = whole;
        if (whole.load == VK_ATTACHMENT_LOAD_OP_LOAD) {
          plan.uses[u].load = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
          expect_objection(graph, plan, fmt::format("seed {}: load of {}", seed_, pass.name));
        }
        plan.uses[u] = whole;
      }
    }
  });
}

TEST(Hazards, OrdersAreLegalAndDiffer) {
  size_t different = 0;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    const RandomGraph random(seed);
    const auto order = [&](uint64_t order_seed) {
      const Plan plan = compile(random.graph, {.order_seed = order_seed});
      EXPECT_TRUE(find_hazards(random.graph, plan).empty()) << "seed " << seed << ", order " << order_seed;
      std::vector<uint32_t> passes;
      for (const PlannedPass& p : plan.passes) passes.push_back(p.pass);
      return passes;
    };
    EXPECT_EQ(order(7), order(7));
    different += order(7) != order(8);
    std::vector<uint32_t> sorted = order(7);
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, order(0)) << "the same passes";
  }
  EXPECT_GT(different, 150u);
}

// A wrong order is seen although every barrier fits it.
TEST(Hazards, AnIllegalOrderIsSeen) {
  Shaders shaders;
  const gpu::Pipeline source = shaders.make({storage_out("value")});
  const gpu::Pipeline filter = shaders.make({sampled("from"), storage_out("value")});
  const ImageDesc desc{{8, 8}, VK_FORMAT_R32_SFLOAT};
  const auto build = [&](bool wrong) {
    Graph graph;
    const Tex a = graph.image("a", desc), b = graph.image("b", desc);
    graph.compute("first", source).out("value", a).over(a);
    if (wrong) graph.compute("second", source).out("value", a).over(a);
    graph.compute("read", filter).in("from", a).out("value", b).over(b);
    if (!wrong) graph.compute("second", source).out("value", a).over(a);
    graph.readback("a", a);
    graph.readback("b", b);
    return graph;
  };
  // The plan of a graph in which `read` follows `second`, for one in which it comes before.
  const Graph right = build(false);
  Plan plan = compile(build(true));
  EXPECT_TRUE(find_hazards(build(true), plan).empty());
  std::swap(plan.passes[1].pass, plan.passes[2].pass);
  const auto found = find_hazards(right, plan);
  ASSERT_FALSE(found.empty());
  EXPECT_NE(found[0].find("pass read, resource 'a'"), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("second"), std::string::npos) << found[0];
}

}  // namespace
}  // namespace nf::graph
