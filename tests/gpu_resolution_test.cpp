// Every resolution mode at odd sizes: finite, validation silent, nothing of the grid to be seen in the picture.
#include "gpu_fixture.h"

namespace nf::test {
namespace {

using glm::ivec2;
using glm::uvec2;
using glm::vec3;

constexpr const char* mode_names[] = {"full", "half", "quarter", "checkerboard", "interleaved2", "interleaved4"};

class Resolutions : public GpuTest {
 protected:
  static passes::FrameSettings stages(bool reconstructed) {
    passes::FrameSettings settings;
    settings.reconstruct = true;
    if (!reconstructed) settings.switch_off_reconstruction();
    settings.taa.enabled = 0;
    settings.shadow.resolution = 256;
    settings.shadow.tile_resolution = 64;
    return settings;
  }
};

// The smallest pictures, all stages on: finite, and as large as asked.
TEST_F(Resolutions, SmallestSizes) {
  const scene::Scene scene = load(small_room());
  passes::Renderer renderer(device(), scene);
  for (const uvec2 size : {uvec2(1, 1), uvec2(2, 2), uvec2(3, 5)})
    for (int mode = 0; mode < 6; ++mode) {
      passes::FrameSettings settings = stages(true);
      settings.taa.enabled = 1;
      settings.resolution.gi = mode;
      settings.resolution.overscan = mode % 2 ? 10 : 0;
      settings.feedback.reprojection = mode % 3;
      for (uint32_t frame = 0; frame < 2; ++frame) {
        passes::FrameView view = view_of_small_room(size, frame);
        graph::Graph graph(renderer.executor().histories());
        const passes::FrameOutputs out = renderer.build(graph, view, settings);
        for (const char* layer : {"", "gi", "visibility"})
          graph.readback(layer, renderer.add_layer(graph, out, passes::find_aov(layer)));
        renderer.executor().run(graph);
        for (const graph::Readback& readback : renderer.executor().take_readbacks()) {
          EXPECT_EQ(readback.desc.size, (graph::Size{size.x, size.y}));
          uint32_t channels = 0;
          double sum = 0;
          for (const float x : graph::to_floats(readback, channels)) sum += double(x);
          EXPECT_TRUE(std::isfinite(sum)) << readback.name << " " << size.x << "x" << size.y << " " << mode_names[mode];
          if (*readback.name != 'g') {
            EXPECT_GT(sum, 0) << readback.name;
          }
        }
      }
    }
}

// Nothing hides an open floor: every pixel reads 1, up to the border of pictures that no block divides.
TEST_F(Resolutions, AnOpenFloorIsOpenUpToTheBorder) {
  content::Builder b;
  b.quad({-50, 0, 50}, {50, 0, 50}, {50, 0, -50}, {-50, 0, -50}, b.material({.base_color = vec3(0.5f)}));
  const scene::Scene scene = load(b);
  Request request{.camera = look({0, 2.5f, 3}, {0, 0, -1}, 50), .settings = stages(false)};
  request.settings.gi.shared.steps = 6;
  for (const uvec2 size : {uvec2(319, 181), uvec2(321, 179)})
    for (int mode = 0; mode < 6; ++mode) {
      request.size = size;
      request.settings.resolution.gi = mode;
      const Shot shot = shoot(scene, request);
      const image::Image& open = shot.layer("visibility");
      ASSERT_EQ(open.pixels.size(), size_t(size.x) * size.y * open.channels);
      float least = 2, most = 0;
      for (size_t i = 0; i < open.pixels.size(); i += open.channels) {
        least = std::min(least, open.pixels[i]);
        most = std::max(most, open.pixels[i]);
      }
      std::printf("%ux%u %s: visibility %.5f to %.5f\n", size.x, size.y, mode_names[mode], least, most);
      EXPECT_NEAR(least, 1, 1e-3) << mode_names[mode];
      EXPECT_NEAR(most, 1, 1e-3) << mode_names[mode];
    }
}

// A floor lit by a wall: the reconstructed light of every row and column of pixels, the outermost too, is that of full
// resolution.
TEST_F(Resolutions, NoLineAndNoBorderOnAPlane) {
  content::Builder b;
  b.quad({-50, 0, 50}, {50, 0, 50}, {50, 0, -50}, {-50, 0, -50}, b.material({.base_color = vec3(0.5f)}));
  b.quad({-50, 1.5f, -3}, {50, 1.5f, -3}, {50, 4, -3}, {-50, 4, -3},
         b.material({.base_color = vec3(0), .emissive = vec3(1)}));
  const scene::Scene scene = load(b);
  Request request{.camera = look({0, 2.5f, 3}, {0, 1, -2}, 60), .settings = stages(true)};
  request.settings.gi.shared.radius = 10;
  request.settings.gi.shared.steps = 8;
  request.scan = false;
  const ivec2 size(319, 181);
  const int first = 120;  // rows of floor a texel of quarter resolution from the wall, whose nearest light it loses
  request.size = uvec2(size);
  std::vector<double> full;
  for (int mode = 0; mode < 6; ++mode) {
    request.settings.resolution.gi = mode;
    request.frames = mode == 2 ? 16 : mode == 1 ? 8 : 4;  // the fewer pixels a frame, the more of them
    const Shot shot = shoot(scene, request);
    std::vector<double> lines(size_t(size.x + size.y - first));  // columns, then rows
    for (int y = first; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const double light = double(shot.value("gi", {x, y}));
        lines[size_t(x)] += light / (size.y - first);
        lines[size_t(size.x + y - first)] += light / size.x;
      }
    if (mode == 0) full = lines;
    double worst = 0;
    for (size_t i = 0; i < lines.size(); ++i) worst = std::max(worst, std::abs(lines[i] / full[i] - 1));
    const auto at = [&](size_t line) { return lines[line] / full[line]; };
    const double left = at(0), right = at(size_t(size.x) - 1), bottom = at(lines.size() - 1);
    std::printf("%s: left %.3f, right %.3f, bottom %.3f of full resolution's light; worst line off by %.3f\n",
                mode_names[mode], left, right, bottom, worst);
    const double tolerance = 0.06;
    for (const double border : {left, right, bottom}) EXPECT_NEAR(border, 1, tolerance) << mode_names[mode];
    EXPECT_LT(worst, tolerance) << mode_names[mode];
  }
}

// The picture within the border is the picture without one: what is seen by the camera alone is the same.
TEST_F(Resolutions, OverscanKeepsThePicture) {
  const scene::Scene scene = load(small_room());
  passes::FrameSettings settings = stages(false);
  Request request{.size = {64, 36}, .camera = inside_small_room(), .settings = settings};
  const Shot plain = shoot(scene, request);
  request.settings.resolution.overscan = 12.5f;
  const Shot wide = shoot(scene, request);
  size_t off = 0;
  for (size_t i = 0; i < plain.layer("depth").pixels.size(); ++i)
    off += std::abs(plain.layer("depth").pixels[i] - wide.layer("depth").pixels[i]) > 1e-3f;
  EXPECT_LE(off, 20u) << "edges may fall on other pixels by rounding";
  EXPECT_NE(plain.layer("gi_raw").pixels, wide.layer("gi_raw").pixels) << "control: the border lights the picture";
}

}  // namespace
}  // namespace nf::test
