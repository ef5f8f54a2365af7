// Robustness of the whole frame: odd sizes, repeats, validation's negative control, swaps of the technique, empty
// pictures, and golden images as change detectors.
#include "core/log.h"
#include "gpu_fixture.h"
#include "scenes.h"

namespace nf::test {
namespace {

using content::Builder;
using glm::vec3;

class Robust : public GpuTest {};

TEST_F(Robust, OddSizes) {
  const scene::Scene scene = load(small_room());
  for (const glm::uvec2 size :
       {glm::uvec2(1, 1), glm::uvec2(3, 5), glm::uvec2(319, 181), glm::uvec2(2, 1), glm::uvec2(1, 64)}) {
    const Shot shot = shoot(scene, {.size = size, .camera = inside_small_room(), .frames = 2});
    EXPECT_EQ(shot.layer("").width, size.x);
    EXPECT_EQ(shot.layer("").height, size.y);
    float sum = 0;
    for (const float x : shot.layer("depth").pixels) sum += x;
    EXPECT_GT(sum, 0) << size.x << "x" << size.y;
  }
}

TEST_F(Robust, SameInputSameBytes) {
  const scene::Scene scene = load(small_room());
  const Request request{.size = {97, 61}, .camera = inside_small_room(), .frames = 3, .accumulate = true};
  const Shot a = shoot(scene, request), b = shoot(scene, request);
  EXPECT_EQ(a.picture, b.picture);
  for (const auto& [name, image] : a.layers) EXPECT_EQ(image.pixels, b.layer(name).pixels) << name;
  Request other = request;
  other.seed = 2;
  EXPECT_NE(shoot(scene, other).layer("gi").pixels, a.layer("gi").pixels) << "control: the seed must matter";
}

// A barrier that is left out must be reported: without this, silence of the validation layer would prove nothing.
TEST_F(Robust, ValidationReportsAMissingBarrier) {
  const scene::Scene scene = load(small_room());
  const Request request{.size = {64, 36}, .camera = inside_small_room()};
  const graph::Plan plan = shoot(scene, request).plan;
  EXPECT_TRUE(device().take_messages().empty());
  int reported = 0, tried = 0;
  spdlog::set_level(spdlog::level::off);  // the reports are wanted here, not shown
  for (size_t i = 0; i < plan.barriers.size(); ++i) {
    const graph::Barrier& barrier = plan.barriers[i];
    // The hand-over of an attachment to a shader: a hazard and a layout change.
    if (barrier.old_layout != VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL || tried >= 4) continue;
    Request dropped = request;
    dropped.drop_barrier = int(i);
    shoot(scene, dropped);
    ++tried;
    reported += !device().take_messages().empty();
  }
  spdlog::set_level(spdlog::level::info);
  EXPECT_GE(tried, 2);
  EXPECT_EQ(reported, tried);
}

// Transients that share memory give the same bytes as ones that do not.
TEST_F(Robust, AliasingChangesNothing) {
  const scene::Scene scene = load(small_room());
  Request request{.size = {97, 61}, .camera = inside_small_room(), .frames = 3, .scan = false};
  request.settings.shadow.resolution = 512;  // one large image would leave little to share
  const Shot shared = shoot(scene, request);
  request.graph.alias = false;
  const Shot apart = shoot(scene, request);
  EXPECT_LT(double(shared.plan.placed_bytes), 0.95 * double(shared.plan.unaliased_bytes))
      << "nothing was aliased at all";
  EXPECT_EQ(apart.plan.placed_bytes, apart.plan.unaliased_bytes);
  EXPECT_EQ(shared.picture, apart.picture);
  for (const auto& [name, image] : shared.layers) EXPECT_EQ(image.pixels, apart.layer(name).pixels) << name;
  // Nor does what lay in the memory before.
  request.graph = {.poison = graph::Poison::Frame};
  const Shot poisoned = shoot(scene, request);
  EXPECT_EQ(shared.picture, poisoned.picture);
  for (const auto& [name, image] : shared.layers)
    EXPECT_EQ(image.pixels, poisoned.layer(name).pixels) << name << ", poisoned";
  std::printf("placed %.2f, max live %.2f, unaliased %.2f MiB\n", double(shared.plan.placed_bytes) / 1048576,
              double(shared.plan.max_live_bytes) / 1048576, double(shared.plan.unaliased_bytes) / 1048576);
}

TEST_F(Robust, TechniqueSwapsKeepTheRest) {
  const scene::Scene scene = load(small_room());
  passes::FrameSettings with, without;
  without.technique = &passes::find_technique("none");
  const Shot a = shoot(scene, {.size = {64, 36}, .camera = inside_small_room(), .settings = with});
  const Shot b = shoot(scene, {.size = {64, 36}, .camera = inside_small_room(), .settings = without});
  EXPECT_EQ(a.layer("direct").pixels, b.layer("direct").pixels);
  EXPECT_EQ(b.layers.count("gi"), 0u) << "absent, not faked";
  EXPECT_EQ(b.layers.count("visibility"), 0u);
  // Final radiance is the sum of its parts.
  for (size_t i = 0; i < a.layer("").pixels.size(); ++i) {
    if (i % 4 == 3) continue;
    const float sum = a.layer("direct").pixels[i] + a.layer("ambient").pixels[i] + a.layer("indirect").pixels[i] +
                      a.layer("emissive").pixels[i];
    ASSERT_NEAR(a.layer("").pixels[i], sum, 2e-3f * std::max(1.0f, sum));
  }
}

TEST_F(Robust, NothingInSight) {
  const scene::Scene scene = load(small_room());
  const Shot shot = shoot(scene, {.size = {16, 16}, .camera = look({50, 50, 50}, {100, 100, 100}, 60)});
  for (const float depth : shot.layer("depth").pixels) EXPECT_EQ(depth, 0);
  for (const float v : shot.layer("visibility").pixels) EXPECT_EQ(v, 1);
}

// Velocity is now minus before, in pixels, y down.
TEST_F(Robust, VelocityOfAMovedNode) {
  Builder b;
  b.quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, b.material({.base_color = vec3(1)}));
  scene::Scene scene = load(b);
  scene.nodes.translation.back() += vec3(0.1f, 0.2f, 0);
  scene.nodes.local_matrix.back()[3] += glm::vec4(0.1f, 0.2f, 0, 0);
  scene::update_transforms(scene);
  const Shot shot = shoot(scene, {.size = {100, 50}, .camera = look({0, 0, 2}, {0, 0, 0}, 90)});
  // At distance 2 the half height of 25 pixels is 2 m.
  EXPECT_NEAR(shot.value("velocity", {50, 25}, 0), 0.1f * 12.5f, 0.02f);
  EXPECT_NEAR(shot.value("velocity", {50, 25}, 1), -0.2f * 12.5f, 0.02f);
}

// Golden images: they tell that something changed, not that it is right. NEARFIELD_UPDATE_GOLDEN=1 writes them anew.
TEST_F(Robust, GoldenImages) {
  const std::pair<const char*, std::vector<uint8_t>> scenes[] = {
      {"cornell", content::cornell()}, {"fence", content::fence()}, {"furnace", content::furnace()}};
  for (const auto& [name, glb] : scenes) {
    const std::filesystem::path path = temporary(std::string(name) + ".glb");
    std::FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_TRUE(file);
    ASSERT_EQ(std::fwrite(glb.data(), 1, glb.size(), file), glb.size());
    std::fclose(file);
    scene::Scene scene = scene::load_gltf(path);
    const scene::Camera camera = scene::select_view("", scene);
    const Shot shot = shoot(scene, {.size = {160, 90}, .camera = camera, .frames = 8, .accumulate = true});
    image::Image8 now{160, 90, 3, {}};
    for (size_t i = 0; i < shot.picture.size(); ++i)
      if (i % 4 < 3) now.pixels.push_back(uint8_t(shot.picture[i]));
    const std::filesystem::path golden =
        std::filesystem::path(NF_SOURCE_DIR) / "tests" / "golden" / (std::string(name) + ".png");
    if (std::getenv("NEARFIELD_UPDATE_GOLDEN")) {
      image::write_png(golden, now);
      continue;
    }
    const image::Image8 before = image::read_png(golden);
    ASSERT_EQ(before.width, 160u);
    size_t changed = 0;
    for (size_t i = 0; i < now.pixels.size(); ++i) changed += std::abs(int(now.pixels[i]) - int(before.pixels[i])) > 5;
    EXPECT_LE(changed, now.pixels.size() / 1000)
        << name << ": " << changed << " of " << now.pixels.size() << " channel values differ by more than 5/255";
  }
}

}  // namespace
}  // namespace nf::test
