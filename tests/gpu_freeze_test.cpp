// Parts of the renderer that stand still: histories that a frame reads and does not keep, noise and jitter of the frame
// before, culling by another camera. Under validation.
#include "gpu_fixture.h"

namespace nf::test {
namespace {

class FreezeTest : public GpuTest {
 protected:
  // Frames one after the other, as a program renders them: the camera moves on with each.
  struct Frames {
    passes::Renderer renderer;
    passes::FrameView view;
    passes::FrameSettings settings;
    uint32_t kept = 0;

    explicit Frames(const scene::Scene& scene) : renderer(device(), scene), view(view_of_small_room({64, 36}, 0)) {
      settings.reconstruct = true;
      settings.shadow.resolution = settings.shadow.tile_resolution = 32;
    }
    std::vector<std::byte> next(uint32_t index, bool hold) {
      view.frame_index = index;
      if (index > 0) view.previous_frame_index = kept;
      view.camera = inside_small_room();
      view.camera.position.x += 0.01f * float(index);
      if (index == 0) view.previous_camera = view.camera;
      graph::Graph graph(renderer.executor().histories());
      const passes::FrameOutputs out = renderer.build(graph, view, settings);
      graph.readback("picture", renderer.add_picture(graph, out, settings));
      renderer.executor().run(graph, {.hold_histories = hold});
      held = renderer.executor().held();
      if (!held) {
        view.previous_camera = view.camera;
        kept = index;
      }
      return renderer.executor().take_readbacks().at(0).texels;
    }
    bool held = false;
  };
};

TEST_F(FreezeTest, HeldFramesLeaveNothingBehind) {
  const scene::Scene scene = load(small_room());
  Frames plain(scene), holding(scene), going(scene);
  for (uint32_t i = 0; i < 3; ++i) {
    const std::vector<std::byte> expected = plain.next(i, false);
    EXPECT_EQ(holding.next(i, false), expected) << i;
    going.next(i, false);
  }
  const std::vector<std::byte> fourth = plain.next(3, false), fifth = plain.next(4, false);
  EXPECT_EQ(holding.next(3, true), fourth) << "it reads what the third frame left";
  EXPECT_TRUE(holding.held);
  const std::vector<std::byte> other = holding.next(7, true);
  EXPECT_NE(other, fourth);
  EXPECT_EQ(holding.next(7, true), other) << "again and again";
  EXPECT_EQ(holding.next(3, true), fourth);
  EXPECT_EQ(holding.next(3, false), fourth) << "and goes on from there";
  EXPECT_FALSE(holding.held);
  EXPECT_EQ(holding.next(4, false), fifth);
  // The control: a frame in between that is not held is seen.
  going.next(7, false);
  EXPECT_NE(going.next(3, false), fourth);
}

TEST_F(FreezeTest, AFrameWithoutHistoryDoesNotHold) {
  const scene::Scene scene = load(small_room());
  Frames plain(scene), holding(scene);
  const std::vector<std::byte> first = plain.next(0, false), second = plain.next(1, false);
  EXPECT_EQ(holding.next(0, true), first);
  EXPECT_FALSE(holding.held) << "there would be nothing to read";
  EXPECT_EQ(holding.next(1, true), second);
  EXPECT_TRUE(holding.held);
  EXPECT_EQ(holding.next(1, true), second);
}

TEST_F(FreezeTest, AnotherCameraCulls) {
  const scene::Scene scene = load(small_room());
  Frames frames(scene);
  frames.settings.reconstruct = false;
  const std::vector<std::byte> all = frames.next(0, false);
  const uint32_t draws = frames.renderer.draws();
  EXPECT_GT(draws, 0u);
  frames.view.culling_camera = look({0, 1, 50}, {0, 1, 60}, 40);
  const std::vector<std::byte> nothing = frames.next(0, false);
  EXPECT_EQ(frames.renderer.draws(), 0u) << "it looks away from everything";
  EXPECT_NE(nothing, all);
  frames.view.culling_camera = look({0, 1, 50}, {0, 1, 0}, 40);
  EXPECT_EQ(frames.next(0, false), all) << "it sees all of the room";
  EXPECT_GE(frames.renderer.draws(), draws);
}

}  // namespace
}  // namespace nf::test
