// The graph on the device with small shaders of its own: dispatch and full-screen chains, histories, culling of what
// nobody reads, replans, and the sector masks of the techniques against plain loops.
#include "gpu_fixture.h"

namespace nf::test {
namespace {

#define NF_ADD_FIELDS(F) F(Float, amount) F(Uint, source_valid)
NF_DECLARE_BLOCK(AddBlock, "add", NF_ADD_FIELDS)

class GraphOnDevice : public GpuGraphTest {
 protected:
  void SetUp() override {
    start(
        {{"fill.comp", R"(#version 460
layout(local_size_x = 8, local_size_y = 8) in;
uniform writeonly image2D target;
void main() { imageStore(target, ivec2(gl_GlobalInvocationID.xy), vec4(gl_GlobalInvocationID.x, gl_GlobalInvocationID.y, 7.0, 1.0)); }
)"},
         {"corner.comp", R"(#version 460
layout(local_size_x = 8, local_size_y = 8) in;
uniform writeonly image2D target;
void main() { if (gl_GlobalInvocationID.x < 4) imageStore(target, ivec2(gl_GlobalInvocationID.xy), vec4(7.0)); }
)"},
         {"add.comp", R"(#version 460
#include "params/add"
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f) uniform readonly image2D source;
uniform writeonly image2D target;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  imageStore(target, p, imageLoad(source, p) + add.amount);
}
)"},
         {"sampled.frag", R"(#version 460
uniform texture2D source;
layout(location = 0) out vec4 color;
void main() { color = texelFetch(source, ivec2(gl_FragCoord.xy), 0) * 2.0; }
)"},
         {"masks.comp", R"(#version 460
#include "common/sectors.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(r32ui) uniform writeonly uimage2D target;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (p.x <= 32 && p.y <= 32) imageStore(target, p, uvec4(sector_mask(p.x, p.y)));
}
)"},
         {"broken.comp",
          "#version 460\n#include \"common/sectors.glsl\"\nlayout(local_size_x = 8) in;\nvoid main() {\n  undeclared = "
          "1;\n}\n"}},
        {&AddBlock::table()});
  }
};

constexpr graph::ImageDesc desc{{20, 12}, VK_FORMAT_R32G32B32A32_SFLOAT};

TEST_F(GraphOnDevice, ChainsOfDispatchesAndFullscreenPasses) {
  for (int frame = 0; frame < 4; ++frame) {
    graph::Graph graph(executor_->histories());
    const graph::Tex a = graph.image("a", desc), b = graph.image("b", desc), c = graph.image("c", desc),
                     d = graph.image("d", desc);
    graph.compute("fill", pipelines_->compute("fill.comp")).out("target", a).over(a);
    graph.compute("add", pipelines_->compute("add.comp"))
        .in("source", a)
        .out("target", b)
        .params(AddBlock{.amount = 1})
        .over(b);
    graph.fullscreen("double", pipelines_->fullscreen("sampled.frag")).in("source", b).out("color", c);
    graph.compute("add again", pipelines_->compute("add.comp"))
        .in("source", c)
        .out("target", d)
        .params(AddBlock{.amount = float(frame)})
        .over(d);
    graph.readback("d", d);
    const std::vector<float> out = run(graph);
    for (uint32_t y = 0; y < 12; ++y)
      for (uint32_t x = 0; x < 20; ++x)
        ASSERT_EQ(out[(y * 20 + x) * 4], float(2 * (x + 1)) + float(frame)) << x << "," << y << " frame " << frame;
  }
  EXPECT_EQ(executor_->replans(), 1u) << "parameters never replan";
}

TEST_F(GraphOnDevice, WhatNobodyReadsIsNotRun) {
  graph::Graph graph;
  const graph::Tex a = graph.image("a", desc), unused = graph.image("unused", desc);
  graph.compute("fill", pipelines_->compute("fill.comp")).out("target", a).over(a);
  graph.compute("nobody", pipelines_->compute("add.comp"))
      .in("source", a)
      .out("target", graph.optional(unused))
      .params(AddBlock{})
      .over(unused);
  graph.readback("a", a);
  run(graph);
  const graph::FrameResult result = executor_->finish();
  ASSERT_EQ(result.passes.size(), 2u);
  EXPECT_STREQ(result.passes[0].name, "fill");
  EXPECT_GT(result.passes[0].ms, 0);
}

TEST_F(GraphOnDevice, HistoriesCountFramesAndStartAnewWhenInvalidated) {
  const auto frame = [&] {
    graph::Graph graph(executor_->histories());
    const graph::History count = graph.history("count", desc);
    graph.compute("count", pipelines_->compute("add.comp"))
        .in("source", count.prev)
        .out("target", count.next)
        .params(AddBlock{.amount = 1})
        .over(count.next);
    graph.readback("count", count.next);
    return std::pair(run(graph)[5], count.valid);
  };
  for (int i = 0; i < 5; ++i) {
    const auto [value, valid] = frame();
    EXPECT_EQ(value, float(i + 1)) << "an unwritten history reads as zero";
    EXPECT_EQ(valid, i > 0);
  }
  // Another graph in between, without the history: it is gone, and says so.
  graph::Graph other;
  const graph::Tex a = other.image("a", desc);
  other.compute("fill", pipelines_->compute("fill.comp")).out("target", a).over(a);
  other.readback("a", a);
  run(other);
  EXPECT_EQ(frame(), std::pair(1.0f, false));
  EXPECT_EQ(frame(), std::pair(2.0f, true));
  executor_->invalidate_histories();
  EXPECT_FALSE(frame().second);
}

// Layers that are written in some frames and read in all, by two plans in turn.
TEST_F(GraphOnDevice, KeptLayersStayAsTheyWereDrawn) {
  constexpr graph::ImageDesc two{{20, 12}, VK_FORMAT_R32G32B32A32_SFLOAT, 1, 2};
  uint64_t mark = 0;
  const auto frame = [&](int drawn, float amount) {
    graph::Graph graph(executor_->histories());
    const graph::Tex kept = graph.keep("kept", two), a = graph.image("a", desc), out = graph.image("out", desc);
    mark = graph.mark(kept, 1);
    if (drawn >= 0) {
      graph.compute("fill", pipelines_->compute("fill.comp")).out("target", a).over(a);
      graph.compute("draw", pipelines_->compute("add.comp"))
          .in("source", a)
          .out("target", layer(kept, uint8_t(drawn)))
          .params(AddBlock{.amount = amount})
          .over(a);
      graph.mark(kept, uint32_t(drawn)) = uint64_t(amount);
    }
    graph.fullscreen("see", pipelines_->fullscreen("sampled.frag")).in("source", layer(kept, 1)).out("color", out);
    graph.readback("out", out);
    return run(graph)[2];
  };
  EXPECT_EQ(frame(0, 1), 0) << "a layer that nobody has drawn reads as zeros";
  EXPECT_EQ(mark, 0u);
  EXPECT_EQ(frame(1, 20), 2 * 27);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frame(-1, 0), 2 * 27);
  EXPECT_EQ(mark, 20u);
  EXPECT_EQ(frame(0, 3), 2 * 27) << "the other layer";
  EXPECT_EQ(frame(1, 4), 2 * 11);
  EXPECT_EQ(mark, 20u) << "of the frame before";
  EXPECT_EQ(frame(-1, 0), 2 * 11);
  EXPECT_EQ(mark, 4u);
  // A frame without it.
  graph::Graph other(executor_->histories());
  const graph::Tex a = other.image("a", desc);
  other.compute("fill", pipelines_->compute("fill.comp")).out("target", a).over(a);
  other.readback("a", a);
  run(other);
  EXPECT_EQ(frame(-1, 0), 0);
  EXPECT_EQ(mark, 0u);
  EXPECT_EQ(frame(1, 5), 2 * 12);
  executor_->invalidate_histories();
  EXPECT_EQ(frame(-1, 0), 0);
}

TEST_F(GraphOnDevice, AWrongGraphIsRefusedWithAllItsFaults) {
  graph::Graph graph;
  const graph::Tex a = graph.image("a", desc), b = graph.image("b", {{20, 12}, VK_FORMAT_R32_SFLOAT});
  graph.compute("add", pipelines_->compute("add.comp")).in("sauce", a).out("target", b).over(b);
  graph.readback("b", b);
  try {
    executor_->run(graph);
    FAIL() << "not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.exit(), Exit::Internal);
    for (const char* part : {"sauce", "source", "'add'", "gpu_graph_test.cpp:"})
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << part << " in " << e.what();
  }
}

// The control of poisoning: a pass that leaves texels unwritten shows it.
TEST_F(GraphOnDevice, PoisonShowsWhatWasNotWritten) {
  graph::Graph graph;
  const graph::Tex a = graph.image("a", desc);
  graph.compute("corner", pipelines_->compute("corner.comp")).out("target", a).over(a);
  graph.readback("a", a);
  executor_->options.poison = graph::Poison::Frame;
  executor_->run(graph);
  uint32_t channels = 0;
  const std::vector<float> out = graph::to_floats(executor_->take_readbacks().at(0), channels);
  EXPECT_EQ(out[0], 7);
  EXPECT_TRUE(std::isnan(out[4 * 19])) << out[4 * 19];
}

// techniques.md 3.8: every pair, on the device, against a plain loop.
TEST_F(GraphOnDevice, SectorMasks) {
  graph::Graph graph;
  const graph::Tex masks = graph.image("masks", {{33, 33}, VK_FORMAT_R32_UINT});
  graph.compute("masks", pipelines_->compute("masks.comp")).out("target", masks).over(masks);
  graph.readback("masks", masks);
  executor_->run(graph);
  const graph::Readback out = executor_->take_readbacks().at(0);
  for (int b = 0; b <= 32; ++b)
    for (int a = 0; a <= 32; ++a) {
      uint32_t expected = 0, got;
      for (int bit = 0; bit < 32; ++bit)
        if (bit >= a && bit < b) expected |= 1u << bit;
      std::memcpy(&got, out.texels.data() + size_t(b * 33 + a) * 4, 4);
      ASSERT_EQ(got, expected) << a << ".." << b;
    }
}

TEST_F(GraphOnDevice, ShaderErrorsNameFileAndLine) {
  try {
    pipelines_->compute("broken.comp");
    FAIL() << "compiled";
  } catch (const Error& e) {
    EXPECT_EQ(e.exit(), Exit::Shader);
    EXPECT_NE(std::string(e.what()).find("broken.comp:5:"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("undeclared"), std::string::npos);
  }
  EXPECT_THROW(pipelines_->compute("missing.comp"), Error);
}

TEST_F(GraphOnDevice, TheSameFilesGiveTheSamePipeline) {
  EXPECT_EQ(pipelines_->compute("fill.comp").id, pipelines_->compute("fill.comp").id);
  EXPECT_NE(pipelines_->compute("fill.comp").id, pipelines_->compute("fill.comp", {{"X", "1"}}).id);
}

}  // namespace
}  // namespace nf::test
