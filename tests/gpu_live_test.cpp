// The real frame as it lives: with a five-level a-trous chain behind it under every switch of the executor, under
// validation while the camera moves, and over 200 frames in which the technique is swapped and the size changes.
#include <cstdlib>
#include <fstream>

#include "core/log.h"
#include "gpu_fixture.h"

namespace nf::test {
namespace {

namespace fs = std::filesystem;

#define NF_ATROUS_FIELDS(F) F(Int, spacing)
NF_DECLARE_BLOCK(AtrousBlock, "atrous", NF_ATROUS_FIELDS)

// Edge-avoiding a-trous wavelet (Dammertz et al. 2010): 5x5 B3-spline taps `spacing` apart, weighted by depth.
constexpr const char* atrous_text = R"(#version 460
#include "params/atrous"
layout(local_size_x = 8, local_size_y = 8) in;
uniform texture2D source;
uniform texture2D depth;
layout(rgba16f) uniform writeonly image2D target;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy), size = imageSize(target);
  if (any(greaterThanEqual(p, size))) return;
  const float kernel[3] = {6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0};
  float z = texelFetch(depth, p, 0).r, weights = 0.0;
  vec4 sum = vec4(0.0);
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      ivec2 q = clamp(p + ivec2(x, y) * atrous.spacing, ivec2(0), size - 1);
      float w = kernel[abs(x)] * kernel[abs(y)] * exp(-8.0 * abs(texelFetch(depth, q, 0).r - z));
      sum += texelFetch(source, q, 0) * w;
      weights += w;
    }
  imageStore(target, p, sum / weights);
}
)";

scene::Camera moving(uint32_t frame) {
  const float t = float(frame) * 0.05f;
  return look({-0.7f + 0.1f * std::sin(t), 1.2f, 0.8f - 0.1f * t / (1 + t)}, {0.2f, 0.7f, -0.3f}, 70);
}

passes::FrameView view_of(uint32_t frame, glm::uvec2 size) {
  passes::FrameView view;
  view.camera = moving(frame);
  view.previous_camera = moving(frame ? frame - 1 : 0);
  view.size = size;
  view.frame_index = frame;
  return view;
}

class Live : public GpuTest {};

// Engine shaders and the chain's own in one folder: the frame's pipelines compile both.
class LiveWithChain : public Live {
 protected:
  void SetUp() override {
    const fs::path data = temporary("data");
    fs::create_directories(data / "shaders");
    for (const auto& entry : fs::directory_iterator(fs::path(NF_SOURCE_DIR) / "shaders")) {
      if (entry.is_directory())
        fs::create_directory_symlink(entry.path(), data / "shaders" / entry.path().filename());
      else
        fs::create_symlink(entry.path(), data / "shaders" / entry.path().filename());
    }
    std::ofstream(data / "shaders" / "atrous.comp") << atrous_text;
    setenv("NEARFIELD_DATA_DIR", data.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("NEARFIELD_DATA_DIR");
    Live::TearDown();
  }

  // The picture, and the smoothed indirect light.
  static graph::Graph build(passes::Renderer& renderer, gpu::Pipeline atrous, uint32_t frame, glm::uvec2 size,
                            const passes::FrameSettings& settings) {
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view_of(frame, size), settings);
    graph::Tex light = out.gi.gi;
    for (int level = 0; level < 5; ++level) {
      const graph::Tex next = graph.image("atrous", graph.desc(light));
      graph.compute("atrous", atrous)
          .in("source", light)
          .in("depth", out.gbuffer.depth)
          .out("target", next)
          .params(AtrousBlock{.spacing = 1 << level})
          .over(next);
      light = next;
    }
    graph.readback("smooth", light);
    graph.readback("picture", renderer.add_picture(graph, out, settings, int64_t(frame)));
    return graph;
  }
};

TEST_F(LiveWithChain, SwitchesChangeNothing) {
  using graph::LayoutPolicy;
  using graph::Poison;
  const scene::Scene scene = load(small_room());
  const glm::uvec2 size(96, 54);
  graph::Plan plan;
  passes::FrameSettings settings;
  settings.shadow.resolution = 256;
  settings.shadow.tile_resolution = 64;
  passes::Renderer renderer(device(), scene);
  renderer.pipelines().compiler().add_table(AtrousBlock::table());
  const gpu::Pipeline atrous = renderer.pipelines().compute("atrous.comp");
  const auto bytes = [&](const graph::ExecutorOptions& options) {
    renderer.executor().options = options;
    renderer.executor().invalidate_histories();
    std::vector<std::vector<std::byte>> all;
    for (uint32_t frame = 0; frame < 3; ++frame) {
      renderer.executor().run(build(renderer, atrous, frame, size, settings));
      for (const graph::Readback& r : renderer.executor().take_readbacks()) all.push_back(r.texels);
    }
    plan = renderer.executor().plan();
    return all;
  };
  const auto expected = bytes({});
  std::printf("placed %.3f, max live %.3f, unaliased %.3f MiB: %.2f\n", double(plan.placed_bytes) / 1048576,
              double(plan.max_live_bytes) / 1048576, double(plan.unaliased_bytes) / 1048576,
              double(plan.placed_bytes) / double(plan.unaliased_bytes));
  EXPECT_LE(double(plan.placed_bytes), 0.7 * double(plan.unaliased_bytes));
  EXPECT_EQ(bytes({.alias = false}), expected);
  EXPECT_EQ(plan.placed_bytes, plan.unaliased_bytes);
  EXPECT_EQ(bytes({.layouts = LayoutPolicy::General}), expected);
  EXPECT_EQ(bytes({.merge_barriers = false}), expected);
  EXPECT_EQ(bytes({.poison = Poison::Frame}), expected);
  EXPECT_EQ(bytes({.poison = Poison::Handover}), expected);
  for (uint64_t seed = 1; seed <= 20; ++seed) EXPECT_EQ(bytes({.order_seed = seed}), expected) << "order " << seed;
  // The control: the bytes do depend on what is computed.
  settings.gi.shared.radius = 1;
  EXPECT_NE(bytes({}), expected);
}

// Eight frames with a moving camera are silent; with an alias barrier broken, a frame is not.
TEST_F(LiveWithChain, ValidationIsSilentAndNotDeaf) {
  const scene::Scene scene = load(small_room());
  const glm::uvec2 size(64, 36);
  const passes::FrameSettings settings;
  passes::Renderer renderer(device(), scene);
  renderer.pipelines().compiler().add_table(AtrousBlock::table());
  const gpu::Pipeline atrous = renderer.pipelines().compute("atrous.comp");
  uint32_t frame = 0;
  const auto run = [&](const graph::ExecuteOptions& options) {
    renderer.executor().run(build(renderer, atrous, frame, size, settings), options);
    renderer.executor().finish();
    ++frame;
    return device().take_messages();
  };
  for (int i = 0; i < 8; ++i)
    for (const std::string& message : run({})) ADD_FAILURE() << message;
  const graph::Plan plan = renderer.executor().plan();
  const graph::Graph graph = build(renderer, atrous, frame, size, settings);
  int tried = 0, dropped = 0, loosened = 0, unseen = 0;
  spdlog::set_level(spdlog::level::off);  // the reports are wanted here, not shown
  for (size_t i = 0; i < plan.barriers.size(); ++i) {
    const graph::Barrier& b = plan.barriers[i];
    const auto& owners = plan.resources[b.resource].alias_of;
    const bool taken = !owners.empty() && owners != std::vector<uint16_t>{b.resource};
    if (!taken || b.old_layout != VK_IMAGE_LAYOUT_UNDEFINED) continue;
    ++tried;
    // Layer 1.3.239 does not follow attachments of dynamic rendering: of an image that is drawn to and stays in its
    // layout, only the transition itself is seen.
    const bool seen = plan.cells[plan.resources[b.resource].first_cell].after != b.new_layout;
    const bool reported = !run({.drop_barrier = int(i)}).empty();
    dropped += reported || !seen;
    unseen += !reported && !seen;
    loosened += !run({.loosen_barrier = int(i)}).empty();
  }
  spdlog::set_level(spdlog::level::info);
  std::printf("%d alias barriers: %d reported when dropped, %d when loosened\n", tried, dropped - unseen, loosened);
  EXPECT_GE(tried, 5);
  EXPECT_LE(unseen, 1);
  EXPECT_EQ(dropped, tried);
  EXPECT_EQ(loosened, tried);
}

// As many techniques as plans are kept. After each swap the pictures are those of a fresh start at the same frame:
// nothing of the other technique is left.
TEST_F(Live, SwapsAndAResizeOver200Frames) {
  const scene::Scene scene = load(small_room());
  const auto frame_bytes = [](passes::Renderer& renderer, uint32_t frame, uint32_t since, glm::uvec2 size,
                              const passes::FrameSettings& settings) {
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view_of(frame, size), settings);
    graph.readback("picture", renderer.add_picture(graph, out, settings, int64_t(since)));
    renderer.executor().run(graph);
    return renderer.executor().take_readbacks().at(0).texels;
  };
  passes::Renderer renderer(device(), scene);
  gpu::DeviceCounts early, before_resize, after_resize, late;
  uint64_t replans = 0;
  for (uint32_t frame = 0; frame < 200; ++frame) {
    const glm::uvec2 size = frame < 100 ? glm::uvec2(64, 36) : glm::uvec2(48, 40);
    const uint32_t swap = frame / 10, since = frame % 10;
    passes::FrameSettings settings;
    settings.technique = &passes::find_technique(std::array{"none", "gtao", "vbao", "vbgi"}[swap % 4]);
    settings.shadow.cache = 0;  // kept maps have other graphs while they are stale (gpu_shadow_cache_test)
    const auto picture = frame_bytes(renderer, frame, since, size, settings);
    if (frame == 60) early = device().counts;
    if (frame == 99) before_resize = device().counts;
    if (frame == 160) after_resize = device().counts, replans = renderer.executor().replans();
    if (frame == 199) late = device().counts;
    if (since >= 3) continue;
    // A fresh start, as many frames ago.
    passes::Renderer fresh(device(), scene);
    std::vector<std::byte> expected;
    for (uint32_t n = 0; n <= since; ++n) expected = frame_bytes(fresh, frame - since + n, n, size, settings);
    ASSERT_EQ(picture, expected) << "frame " << frame << ", " << settings.technique->id;
  }
  std::printf("%u images, %u views, %u buffers, %u allocations at the end; %llu plans made\n", late.images, late.views,
              late.buffers, late.allocations, static_cast<unsigned long long>(renderer.executor().replans()));
  EXPECT_EQ(early, before_resize);
  EXPECT_EQ(after_resize, late);
  EXPECT_EQ(renderer.executor().replans(), replans) << "swaps find their plans again";
}

}  // namespace
}  // namespace nf::test
