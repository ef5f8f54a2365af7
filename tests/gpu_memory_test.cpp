// A program that renders for hours keeps its size. Under validation.
#include <fstream>
#include <malloc.h>
#include <unistd.h>

#include "gpu_fixture.h"

namespace nf::test {
namespace {

double resident_megabytes() {
  malloc_trim(0);
  std::ifstream in("/proc/self/statm");
  double all = 0, resident = 0;
  in >> all >> resident;
  return resident * double(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

// A floor and a box in the sun, with all that averages frames.
class MemoryTest : public EditedShadersTest {
 protected:
  // Megabytes that the process grows by over 48 frames, after 16 others.
  double growth() {
    content::Builder b;
    const auto white = b.material({.base_color = glm::vec3(0.8f)});
    b.grid({-6, 0, 6}, {6, 0, 6}, {6, 0, -6}, {-6, 0, -6}, 4, 4, white);
    b.box({0, 0.5f, 0}, glm::vec3(0.4f, 0.5f, 0.4f), 0.3f, white);
    b.point_light({1.5f, 1.6f, 1}, 6);
    b.directional_light({0.3f, -1, -0.4f}, 3);
    const scene::Scene scene = load(b);
    passes::Renderer renderer(device(), scene);
    passes::FrameSettings settings;
    settings.reconstruct = true;
    settings.shadow.resolution = settings.shadow.tile_resolution = 64;
    passes::FrameView view;
    view.size = {96, 54};
    view.camera = view.previous_camera = look({0.5f, 1.8f, 4}, {0, 0.6f, 0}, 60);
    double before = 0;
    for (uint32_t n = 0; n < 64; ++n) {
      if (n == 16) before = resident_megabytes();
      view.frame_index = n;
      graph::Graph graph(renderer.executor().histories());
      graph.readback("picture", renderer.add_picture(graph, renderer.build(graph, view, settings), settings));
      renderer.executor().run(graph);
      renderer.executor().take_readbacks();
    }
    return resident_megabytes() - before;
  }
};

TEST_F(MemoryTest, FramesLeaveNothingBehind) {
  EXPECT_LT(growth(), 24);
}

// The control: what shaders/common/bound.glsl is there for is seen, where the driver is the one that needs it.
TEST_F(MemoryTest, ShadersMadeInEveryDrawAreSeen) {
  if (device().info.driver_info.find("Mesa 22.") == std::string::npos) GTEST_SKIP() << device().info.driver_info;
  edit("common/bound.glsl", "return n + int(floatBitsToUint(z) >> 31)", "return n");
  edit("common/bound.glsl", "return n + (floatBitsToUint(z) >> 31)", "return n");
  EXPECT_GT(growth(), 48);
}

}  // namespace
}  // namespace nf::test
