// The NaN detector: texels poisoned by a shader that the test has changed are counted and found, image by image.
#include "gpu_fixture.h"
#include "graph/probe.h"

namespace nf::test {
namespace {

class NanScan : public EditedShadersTest {
 protected:
  // By name of the image. What a frame of `technique` says about itself.
  std::map<std::string, passes::NonFiniteTexels> scan(const char* technique, bool asked = true) {
    const scene::Scene scene = load(small_room());
    passes::Renderer renderer(device(), scene);
    passes::FrameSettings settings;
    settings.technique = &passes::find_technique(technique);
    settings.debug.nan_scan = asked;
    passes::FrameView view = view_of_small_room({61, 37});  // no multiple of a workgroup
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("picture", renderer.add_picture(graph, out, settings));
    if (out.nan_scan.found) graph.readback("nan_scan", out.nan_scan.found);
    renderer.executor().run(graph);
    const std::vector<graph::Readback> all = renderer.executor().take_readbacks();
    const graph::Readback* found = graph::find_readback(all, "nan_scan");
    EXPECT_EQ(found != nullptr, asked);
    std::map<std::string, passes::NonFiniteTexels> result;
    if (found)
      for (const passes::NonFiniteTexels& image : read_nan_scan(out.nan_scan, *found)) result[image.image] = image;
    return result;
  }
};

TEST_F(NanScan, AHealthyFrameHasNone) {
  const auto images = scan("vbgi");
  EXPECT_GE(images.size(), 8u);
  for (const char* name : {"gbuffer.depth", "gbuffer.emissive", "direct.diffuse"})
    EXPECT_TRUE(images.count(name)) << name;
  for (const auto& [name, image] : images) {
    EXPECT_FALSE(image.any()) << name << " at " << image.first.x << "," << image.first.y;
    EXPECT_EQ(image.size.width, 61u) << name;
  }
  EXPECT_TRUE(scan("vbgi", false).empty());
}

// Channels one by one, both signs; the first in reading order, which is not the first written; the last texel too.
TEST_F(NanScan, PoisonIsCountedAndFound) {
  edit("composite.frag", "void main() {", "void composite() {");
  write("composite.frag", text_of("composite.frag") + R"(
void main() {
  composite();
  ivec2 p = ivec2(gl_FragCoord.xy);
  if (p == ivec2(13, 21)) lit.r = uintBitsToFloat(0x7FC00000u);
  if (p == ivec2(40, 20)) lit.g = uintBitsToFloat(0xFFC00001u);
  if (p == ivec2(60, 36)) lit.b = uintBitsToFloat(0x7F800000u);
  if (p == ivec2(0, 30)) lit.rb = vec2(uintBitsToFloat(0xFF800000u), uintBitsToFloat(0x7FC00000u));
}
)");
  const auto images = scan("none");
  ASSERT_TRUE(images.count("composite.lit"));
  for (const auto& [name, image] : images) {
    const bool poisoned = name == "composite.lit";
    EXPECT_EQ(image.nan, poisoned ? 3u : 0u) << name << ": a texel with both counts as NaN";
    EXPECT_EQ(image.inf, poisoned ? 1u : 0u) << name;
    EXPECT_EQ(image.first, poisoned ? glm::uvec2(40, 20) : glm::uvec2(0)) << name;
  }
}

// It is told where it begins, not only where it ends.
TEST_F(NanScan, TheFirstImageThatHasIt) {
  edit("gbuffer.frag", "emissive = vec4(p.emission, 1.0);",
       "emissive = vec4(p.emission, 1.0);\n  if (ivec2(gl_FragCoord.xy) == ivec2(30, 18)) emissive.g = "
       "uintBitsToFloat(0x7FC00000u);");
  const auto images = scan("none");
  ASSERT_TRUE(images.count("gbuffer.emissive"));
  EXPECT_EQ(images.at("gbuffer.emissive").nan, 1u);
  EXPECT_EQ(images.at("gbuffer.emissive").first, glm::uvec2(30, 18));
  EXPECT_EQ(images.at("composite.lit").nan, 1u) << "and goes on from there";
  EXPECT_EQ(images.at("gbuffer.depth").nan + images.at("direct.diffuse").nan, 0u);
}

}  // namespace
}  // namespace nf::test
