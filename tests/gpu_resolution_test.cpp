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

// Linear radiance as shown, pixel by pixel.
std::vector<vec3> shown(const Shot& shot) {
  const image::Image& lit = shot.layer("");
  std::vector<vec3> out;
  for (size_t i = 0; i < lit.pixels.size(); i += lit.channels)
    out.emplace_back(lit.pixels[i], lit.pixels[i + 1], lit.pixels[i + 2]);
  return out;
}

// Pixels to the nearest border of a picture, from the pixel's centre.
float to_border(uvec2 size, size_t pixel) {
  const glm::vec2 at(float(pixel % size.x) + 0.5f, float(pixel / size.x) + 0.5f),
      off = glm::min(at, glm::vec2(size) - at);
  return std::min(off.x, off.y);
}

// At the border the picture is the one without a technique, further in it is the technique's to the bit, and between it
// is mixed of both by one weight: nothing is counted twice. Whatever the technique gives, under an even and an uneven
// sky.
TEST_F(Resolutions, EdgeFadeMixesThePicturesWithAndWithout) {
  content::Builder b = small_room();
  b.quad({-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, b.material({.base_color = vec3(0.6f)}));
  scene::Scene scene = load(b);
  const uvec2 size(96, 54);
  const float band = 0.2f * 54;
  const scene::Environment even{.color = vec3(0.5f, 0.7f, 1)}, uneven{.kind = scene::EnvironmentKind::Gradient,
                                                                      .zenith = vec3(0, 1, 4),
                                                                      .horizon = vec3(2),
                                                                      .ground = vec3(1, 0, 0)};
  for (const auto& [technique, sky] :
       {std::pair("vbgi", &uneven), {"vbgi", &even}, {"vbao", &uneven}, {"ssao", &uneven}, {"gtao", &even}}) {
    scene.environment = *sky;
    Request request{.size = size, .camera = look({-0.9f, 2.6f, 3}, {0.2f, 0.7f, -0.3f}, 60), .settings = stages(false)};
    request.settings.technique = &passes::find_technique(technique);
    request.settings.material.lambert = technique != std::string_view("ssao");
    const Shot plain = shoot(scene, request);
    request.settings.resolution.edge_fade = 20;
    const Shot faded = shoot(scene, request);
    request.settings.technique = &passes::find_technique("none");
    const std::vector<vec3> without = shown(shoot(scene, request)), with = shown(plain), got = shown(faded);
    float worst = 0, difference = 0, changed = 0;
    for (size_t i = 0; i < got.size(); ++i) {
      const float t = std::clamp(to_border(size, i) / band, 0.0f, 1.0f), known = t * t * (3 - 2 * t);
      const vec3 expected = glm::mix(without[i], with[i], known);
      if (t >= 1) {
        EXPECT_EQ(got[i], with[i]) << technique << ", pixel " << i;
      }
      for (int c = 0; c < 3; ++c) {
        worst = std::max(worst, std::abs(got[i][c] - expected[c]) / std::max(expected[c], 0.1f));
        if (t < 1) difference = std::max(difference, std::abs(with[i][c] - without[i][c]));
        changed += t < 1 && got[i] != with[i];
      }
    }
    std::printf("%s: %.2g off the mix of pictures that are %.2f apart\n", technique, double(worst), double(difference));
    EXPECT_LT(worst, 4e-3f) << technique;
    EXPECT_GT(difference, 0.05f) << technique << ", control: with and without are not the same";
    EXPECT_GT(changed, 100) << technique;
    // What the technique lacks is not made up.
    for (const char* layer : {"gi", "visibility", "bent"})
      EXPECT_EQ(faded.layers.count(layer), plain.layers.count(layer)) << technique << ", " << layer;
  }
}

// The band begins where rendering ends: what overscan has room for is not to be seen.
TEST_F(Resolutions, EdgeFadeBeginsBehindOverscan) {
  const scene::Scene scene = load(small_room());
  const uvec2 size(64, 36);
  Request request{.size = size, .camera = inside_small_room(), .settings = stages(false), .scan = false};
  passes::ResolutionParams& r = request.settings.resolution;
  r.overscan = 20;  // 13 x 8 pixels
  const std::vector<vec3> wide = shown(shoot(scene, request));
  r.edge_fade = 22;  // 7.92 pixels
  EXPECT_EQ(shown(shoot(scene, request)), wide);
  r.edge_fade = 40;  // 14.4: the outermost 2 columns and 7 rows
  const std::vector<vec3> faded = shown(shoot(scene, request));
  size_t inner = 0, outer = 0;
  for (size_t i = 0; i < wide.size(); ++i) {
    const uvec2 at(i % size.x, i / size.x), off = glm::min(at, size - 1u - at);
    const bool outside = off.x < 2 || off.y < 7;
    (outside ? outer : inner) += faded[i] != wide[i];
  }
  EXPECT_EQ(inner, 0u);
  EXPECT_GT(outer, 100u);
}

// A camera that turns slowly: in the border's band the picture changes less from frame to frame, elsewhere as before.
TEST_F(Resolutions, EdgeFadeCalmsTheBorder) {
  const scene::Scene scene = load(small_room());
  const uvec2 size(96, 54);
  const auto deviation = [&](float fade) {
    passes::Renderer renderer(device(), scene);
    passes::FrameSettings settings = stages(true);
    settings.resolution.edge_fade = fade;
    passes::FrameView view;
    view.size = size;
    std::vector<std::vector<float>> frames;
    for (uint32_t n = 0; n < 30; ++n) {
      const float turn = 0.002f * float(n);
      view.camera = look({-0.7f, 1.2f, 0.8f}, {0.2f + turn, 0.7f, -0.3f + turn}, 70);
      if (n == 0) view.previous_camera = view.camera;
      view.frame_index = n;
      graph::Graph graph(renderer.executor().histories());
      const passes::FrameOutputs out = renderer.build(graph, view, settings);
      graph.readback("indirect", renderer.add_layer(graph, out, passes::find_aov("indirect")));
      renderer.executor().run(graph);
      uint32_t channels = 0;
      const std::vector<float> texels = graph::to_floats(renderer.executor().take_readbacks().at(0), channels);
      frames.emplace_back();
      for (size_t i = 1; i < texels.size(); i += channels) frames.back().push_back(texels[i]);
      view.previous_camera = view.camera;
    }
    // Second differences over time, of the outermost 3 pixels and of what is no part of a band of 20 %.
    double sums[2] = {}, counts[2] = {};
    for (size_t n = 16; n + 2 < frames.size(); ++n)
      for (size_t i = 0; i < frames[n].size(); ++i) {
        const float off = to_border(size, i);
        if (off > 3 && off < 11) continue;
        const double change = double(frames[n][i] - 2 * frames[n + 1][i] + frames[n + 2][i]);
        sums[off > 3] += change * change;
        ++counts[off > 3];
      }
    return std::pair(std::sqrt(sums[0] / counts[0] / 6), std::sqrt(sums[1] / counts[1] / 6));
  };
  const auto [border, inside] = deviation(0);
  const auto [calm, same] = deviation(20);
  std::printf("deviation from frame to frame: border %.5f, with the fade %.5f; inside %.5f and %.5f\n", border, calm,
              inside, same);
  EXPECT_LT(calm, 0.3 * border);
  EXPECT_EQ(inside, same);
}

}  // namespace
}  // namespace nf::test
