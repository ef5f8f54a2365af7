// Resources looked at between the passes of a frame: the values there, and every image of the real frame.
#include "gpu_fixture.h"
#include "graph/probe.h"

namespace nf::test {
namespace {

class ProbeOnDevice : public GpuGraphTest {
 protected:
  void SetUp() override {
    start({{"fill.comp", R"(#version 460
layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f) uniform writeonly image2D target;
void main() { imageStore(target, ivec2(gl_GlobalInvocationID.xy), vec4(gl_GlobalInvocationID.x)); }
)"},
           {"double.comp", R"(#version 460
layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f) uniform image2D target;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  imageStore(target, p, imageLoad(target, p) * 2.0 + 1.0);
}
)"},
           {"count.comp", R"(#version 460
layout(local_size_x = 8) in;
layout(std430) buffer Numbers { uint at[]; } numbers;
void main() { if (gl_GlobalInvocationID.x < 4) numbers.at[gl_GlobalInvocationID.x] += 10 + gl_GlobalInvocationID.x; }
)"},
           {"begin.comp", R"(#version 460
layout(local_size_x = 8) in;
layout(std430) writeonly buffer Numbers { uint at[]; } numbers;
void main() { if (gl_GlobalInvocationID.x < 4) numbers.at[gl_GlobalInvocationID.x] = 1; }
)"}});
  }
};

TEST_F(ProbeOnDevice, BeforeAndAfterAPassThatChangesIt) {
  graph::Graph graph;
  const graph::Tex a = graph.image("a", {{16, 8}, VK_FORMAT_R32_SFLOAT});
  const graph::Buf numbers = graph.buffer("numbers", 16);
  graph.compute("fill", pipelines_->compute("fill.comp")).out("target", a).over(a);
  graph.compute("begin", pipelines_->compute("begin.comp")).out("numbers", numbers).over(4u);
  graph.compute("double", pipelines_->compute("double.comp")).inout("target", a).over(a);
  graph.compute("count", pipelines_->compute("count.comp")).inout("numbers", numbers).over(4u);
  graph.compute("double again", pipelines_->compute("double.comp")).inout("target", a).over(a);
  graph.readback("end", a);
  graph.readback("numbers", numbers);
  // From the last pass to the first.
  for (const graph::Probe& probe : {graph::Probe{.pass = 3, .resource = numbers.id, .name = "counted"},
                                    graph::Probe{.pass = 3, .before = true, .resource = numbers.id, .name = "begun"},
                                    graph::Probe{.pass = 2, .resource = a.id, .name = "after"},
                                    graph::Probe{.pass = 2, .before = true, .resource = a.id, .name = "before"}})
    ASSERT_EQ(graph::add_probe(graph, probe), "");
  for (const uint64_t order : {0, 1, 2, 3}) {
    executor_->options.order_seed = order;
    executor_->run(graph);
    const std::vector<graph::Readback> all = executor_->take_readbacks();
    const auto value = [&](const char* name, size_t texel) {
      const graph::Readback* found = graph::find_readback(all, name);
      uint32_t channels = 0;
      return found ? graph::to_floats(*found, channels).at(texel) : -1.0f;
    };
    EXPECT_EQ(value("before", 5), 5);
    EXPECT_EQ(value("after", 5), 11);
    EXPECT_EQ(value("end", 5), 23);
    const auto number = [&](const char* name) {
      uint32_t bits = 0;
      if (const graph::Readback* found = graph::find_readback(all, name)) std::memcpy(&bits, &found->texels[8], 4);
      return bits;
    };
    EXPECT_EQ(number("begun"), 1u);
    EXPECT_EQ(number("counted"), 13u);
    EXPECT_EQ(number("numbers"), 13u);
    EXPECT_EQ(graph::find_readback(all, "nobody"), nullptr);
  }
}

// Every image and buffer of the real frame, after each pass that uses it: readable under validation, and the picture is
// what it is without.
class ProbeFrame : public GpuTest {};

TEST_F(ProbeFrame, EverythingCanBeLookedAt) {
  const scene::Scene scene = load(small_room());
  passes::FrameSettings settings;
  settings.reconstruct = true;
  settings.shadow.resolution = 64;
  settings.shadow.tile_resolution = 32;
  passes::FrameView view = view_of_small_room({32, 18});
  passes::Renderer renderer(device(), scene);
  const auto build = [&](graph::Graph& graph) {
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("picture", renderer.add_picture(graph, out, settings));
  };
  const auto frame = [&](const std::vector<graph::Probe>& probes) {
    renderer.executor().invalidate_histories();
    graph::Graph graph(renderer.executor().histories());
    build(graph);
    for (size_t i = probes.size(); i-- > 0;) EXPECT_EQ(graph::add_probe(graph, probes[i]), "");
    renderer.executor().run(graph);
    return renderer.executor().take_readbacks();
  };
  const std::vector<std::byte> picture = graph::find_readback(frame({}), "picture")->texels;
  graph::Graph plain;
  build(plain);
  std::vector<std::vector<graph::Probe>> rounds;
  uint32_t refused = 0, images = 0, not_black = 0;
  for (uint32_t p = 0; p < plain.passes.size(); ++p) {
    uint32_t round = p % 4 * 4;  // several probes a frame, never two of one pass
    for (const graph::UseRow& use : plain.uses_of(plain.passes[p])) {
      const graph::Probe probe{.pass = p, .resource = use.resource, .mip = use.part.mip, .layer = use.part.layer};
      if (!graph::probe_fault(plain, probe).empty()) {
        ++refused;
        continue;
      }
      if (rounds.size() <= round) rounds.resize(round + 1);
      rounds[round++].push_back(probe);
    }
  }
  for (const std::vector<graph::Probe>& probes : rounds) {
    const std::vector<graph::Readback> all = frame(probes);
    EXPECT_EQ(graph::find_readback(all, "picture")->texels, picture);
    for (const graph::Readback& readback : all) {
      if (readback.name != std::string_view("probe") || readback.desc.format == VK_FORMAT_UNDEFINED) continue;
      uint32_t channels = 0;
      const std::vector<float> values = graph::to_floats(readback, channels);
      ++images;
      not_black += std::any_of(values.begin(), values.end(), [](float v) { return v != 0; });
    }
  }
  std::printf("%zu passes: %u images looked at in %zu frames, %u of them not all zero; %u uses refused\n",
              plain.passes.size(), images, rounds.size(), not_black, refused);
  EXPECT_GT(images, 60u);
  EXPECT_GT(not_black, images / 2);
}

}  // namespace
}  // namespace nf::test
