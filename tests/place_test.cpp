// Placement of transients: no two that live together share bytes, quality against the bound, and who owned the bytes
// before.
#include "graph/place.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "graph_values.h"

namespace nf::graph {
namespace {

std::vector<PlaceItem> random_items(uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<PlaceItem> items(5 + engine() % 56);
  for (PlaceItem& item : items) {
    const double u = double(engine() % 10000) / 10000;
    item.size = uint64_t(std::exp(u * std::log(4096.0)) * 4096);  // log-uniform, 4 KiB to 16 MiB
    item.align = uint64_t{1} << (engine() % 17);
    item.first = uint32_t(engine() % items.size());
    item.last = std::min(uint32_t(items.size() - 1), item.first + uint32_t(engine() % (1 + items.size() / 3)));
  }
  return items;
}

bool alive_together(const PlaceItem& a, const PlaceItem& b) {
  return a.first <= b.last && b.first <= a.last;
}

TEST(Place, RandomGraphsNeverShareLiveBytes) {
  double sum = 0, worst = 0;
  int above = 0;
  constexpr int count = 10000;
  for (int seed = 0; seed < count; ++seed) {
    const std::vector<PlaceItem> items = random_items(uint64_t(seed));
    const Placement p = place(items);
    for (size_t i = 0; i < items.size(); ++i) {
      ASSERT_EQ(p.offset[i] % items[i].align, 0u) << "seed " << seed;
      ASSERT_LE(p.offset[i] + items[i].size, p.top) << "seed " << seed;
      for (size_t j = 0; j < i; ++j) {
        const bool apart = p.offset[i] + items[i].size <= p.offset[j] || p.offset[j] + items[j].size <= p.offset[i];
        ASSERT_TRUE(apart || !alive_together(items[i], items[j])) << "seed " << seed << ": " << i << " and " << j;
      }
    }
    const double ratio = double(p.top) / double(max_live(items));
    sum += ratio;
    worst = std::max(worst, ratio);
    above += ratio > 1.10;
  }
  std::printf("placed / max live: mean %.4f, worst %.4f, above 1.10: %d of %d\n", sum / count, worst, above, count);
  EXPECT_LE(sum / count, 1.01);
  EXPECT_LE(above, count / 1000);
}

TEST(Place, EqualSizesReachTheBound) {
  for (uint32_t n = 1; n <= 30; ++n) {
    std::vector<PlaceItem> chain;
    for (uint32_t i = 0; i < n; ++i) chain.push_back({65536, 256, i, i + 1});
    EXPECT_EQ(place(chain).top, max_live(chain)) << n;
    EXPECT_EQ(place(chain).top, uint64_t(n > 1 ? 2 : 1) * 65536);
  }
  EXPECT_EQ(place({}).top, 0u);
}

TEST(Place, SameItemsSameOffsets) {
  const std::vector<PlaceItem> items = random_items(7);
  EXPECT_EQ(place(items).offset, place(items).offset);
}

// Against an array with an owner for each byte, run for two frames.
TEST(Place, PredecessorsGoRoundTheFrame) {
  for (uint64_t seed = 0; seed < 500; ++seed) {
    std::mt19937_64 engine(seed);
    std::vector<PlaceItem> items(2 + engine() % 12);
    for (PlaceItem& item : items) {
      item = {1 + engine() % 20, uint64_t{1} << (engine() % 3), uint32_t(engine() % 15), 0};
      item.last = item.first + uint32_t(engine() % 5);
    }
    const Placement p = place(items);
    const auto got = alias_predecessors(items, p.offset);
    std::vector<int> owner(p.top, -1);
    std::vector<std::vector<uint32_t>> expected(items.size());
    for (int frame = 0; frame < 2; ++frame)
      for (uint32_t position = 0; position < 20; ++position)
        for (uint32_t i = 0; i < items.size(); ++i) {
          if (items[i].first != position) continue;
          std::vector<uint32_t> before;
          for (uint64_t byte = p.offset[i]; byte < p.offset[i] + items[i].size; ++byte) {
            if (owner[byte] >= 0) before.push_back(uint32_t(owner[byte]));
            owner[byte] = int(i);
          }
          std::sort(before.begin(), before.end());
          before.erase(std::unique(before.begin(), before.end()), before.end());
          expected[i] = before;
        }
    ASSERT_EQ(got, expected) << "seed " << seed;
  }
}

// --- in a plan ---

// a -> b -> c -> d, all of one size: a and c can share, b and d can.
struct Chain {
  Shaders shaders;
  gpu::Pipeline source = shaders.make({storage_out("value")});
  gpu::Pipeline step = shaders.make({storage_in("from"), storage_out("value")});
  Graph graph;
  std::vector<Tex> tex;
  Chain() {
    for (const char* name : {"a", "b", "c", "d"}) {
      tex.push_back(graph.image(name, {{64, 32}, VK_FORMAT_R32_SFLOAT}));
      if (tex.size() == 1)
        graph.compute(name, source).out("value", tex[0]).over(tex[0]);
      else
        graph.compute(name, step).in("from", tex[tex.size() - 2]).out("value", tex.back()).over(tex.back());
    }
    graph.readback("out", tex.back());
  }
};

TEST(PlacedPlan, AChainTakesTwoImages) {
  const Chain chain;
  const Plan plan = compile(chain.graph);
  EXPECT_EQ(plan.unaliased_bytes, 4u * 64 * 32 * 4);
  EXPECT_EQ(plan.max_live_bytes, 2u * 64 * 32 * 4);
  EXPECT_EQ(plan.placed_bytes, plan.max_live_bytes);
  ASSERT_EQ(plan.heaps.size(), 1u);
  EXPECT_EQ(plan.resources[0].offset, plan.resources[2].offset);
  EXPECT_EQ(plan.resources[1].offset, plan.resources[3].offset);
  EXPECT_EQ(plan.resources[2].alias_of, std::vector<uint16_t>{0});
  EXPECT_EQ(plan.resources[0].alias_of, std::vector<uint16_t>{2}) << "round the frame";
}

// The first barrier of what takes over waits for the last uses of who was there, and forgets the content.
TEST(PlacedPlan, FirstBarrierWaitsForTheOwnerBefore) {
  const Chain chain;
  const Plan plan = compile(chain.graph);
  const std::vector<Barrier> c = barriers_of(plan, 2, chain.tex[2]);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(c[0].src_stages, compute_stage) << "a is read by the pass b";
  EXPECT_EQ(c[0].src_access, 0u) << "that was a read: an execution dependency is enough";
  EXPECT_EQ(c[0].old_layout, VK_IMAGE_LAYOUT_UNDEFINED);
  const std::vector<Barrier> b = barriers_of(plan, 1, chain.tex[1]);
  ASSERT_EQ(b.size(), 1u);
  EXPECT_EQ(b[0].src_stages, copy_stage) << "d is copied at the end of the frame before";
}

TEST(PlacedPlan, SwitchedOffEverybodyHasBytesOfHisOwn) {
  const Chain chain;
  const Plan plan = compile(chain.graph, {.alias = false});
  EXPECT_EQ(plan.placed_bytes, plan.unaliased_bytes);
  for (uint16_t r = 0; r < 4; ++r) EXPECT_EQ(plan.resources[r].alias_of, std::vector<uint16_t>{r});
}

TEST(PlacedPlan, MemoryTypesAndDedicatedImagesAreKeptApart) {
  const Chain chain;
  int asked = 0;
  const Plan plan =
      compile(chain.graph, {.needs = [&](const ResourceRow&, VkFlags) {
                ++asked;
                return gpu::MemoryNeeds{
                    .size = 1000, .alignment = 256, .type_bits = asked == 1 ? 1u : 2u, .dedicated = asked == 4};
              }});
  ASSERT_EQ(plan.heaps.size(), 2u);
  EXPECT_EQ(plan.resources[3].heap, -1);
  EXPECT_NE(plan.resources[0].heap, plan.resources[2].heap);
  EXPECT_EQ(plan.heaps[1].size, 2024u) << "1000 aligned up, and 1000";
  EXPECT_EQ(plan.placed_bytes, 1000u + 2024 + 1000);
}

}  // namespace
}  // namespace nf::graph
