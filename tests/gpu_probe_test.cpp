// Resources looked at between the passes of a frame: the values there, and every image of the real frame.
#include <cmath>
#include <cstring>

#include "glsl_twin.h"
#include "gpu_fixture.h"
#include "graph/probe.h"
#include "packed.h"

NF_GLSL_BEGIN
#include "common/denoise.glsl"
#include "common/pack.glsl"
NF_GLSL_END

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
  for (const uint64_t order : {0u, 1u, 2u, 3u}) {
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

// One texel of every image of the frame at once is the texel of the whole image, and the picture is what it is without.
// Every 32-bit word says what it means.
TEST_F(ProbeFrame, OneTexelOfEveryImage) {
  const scene::Scene scene = load(small_room());
  passes::FrameSettings settings;
  settings.reconstruct = true;
  settings.shadow.resolution = 64;
  settings.shadow.tile_resolution = 32;
  const passes::FrameView view = view_of_small_room({32, 18});
  passes::Renderer renderer(device(), scene);
  const auto frame = [&](std::optional<glm::vec2> place, std::vector<graph::Probe>& probes) {
    renderer.executor().invalidate_histories();
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs out = renderer.build(graph, view, settings);
    graph.readback("picture", renderer.add_picture(graph, out, settings));
    probes = graph::last_states(graph, graph.resources.size());
    const graph::Graph plain = graph;
    for (const graph::ResourceRow& row : plain.resources) {
      const bool word = !row.is_buffer && row.lifetime != graph::Lifetime::Imported;
      if (word && row.desc.format == VK_FORMAT_R32_UINT) {
        EXPECT_TRUE(passes::unpack_texel(row.name, row.desc.size, 0)) << row.name;
      }
    }
    for (size_t i = probes.size(); i-- > 0;) {
      const graph::Size size = graph::size_of(plain.resources[probes[i].resource].desc, probes[i].mip);
      if (place)
        probes[i].texel = graph::Texel{uint32_t(place->x * float(size.width)), uint32_t(place->y * float(size.height))};
      EXPECT_EQ(graph::add_probe(graph, probes[i]), "");
    }
    renderer.executor().run(graph);
    return renderer.executor().take_readbacks();
  };
  std::vector<graph::Probe> probes;
  const std::vector<graph::Readback> whole = frame(std::nullopt, probes);
  const uint64_t plans = renderer.executor().replans();
  for (const glm::vec2 place : {glm::vec2(0.3f, 0.8f), glm::vec2(0.99f, 0.01f)}) {
    const std::vector<graph::Readback> texels = frame(place, probes);
    ASSERT_EQ(texels.size(), whole.size());
    EXPECT_EQ(renderer.executor().replans(), plans + 1) << "another place is no other plan";
    size_t images = 0, different = 0;
    for (size_t i = 0; i < whole.size(); ++i) {
      if (whole[i].name != std::string_view("probe")) {
        EXPECT_EQ(texels[i].texels, whole[i].texels) << whole[i].name;
        continue;
      }
      const graph::Texel at = *probes[images++].texel;
      const size_t bytes = texels[i].texels.size(), offset = (size_t(at.y) * whole[i].desc.size.width + at.x) * bytes;
      EXPECT_EQ(bytes, gpu::texel_bytes(whole[i].desc.format));
      EXPECT_EQ(0, std::memcmp(texels[i].texels.data(), whole[i].texels.data() + offset, bytes)) << i;
      different += std::memcmp(texels[i].texels.data(), whole[i].texels.data(), bytes) != 0;
    }
    EXPECT_EQ(images, probes.size());
    EXPECT_GT(images, 40u);
    EXPECT_GT(different, images / 4) << "the control: another texel is another number";
  }
}

TEST(Packed, TheHostReadsWhatTheShadersWrote) {
  const auto unpacked = [](const char* image, uint32_t bits) {
    return passes::unpack_texel(image, {64, 32}, bits).value().values;
  };
  for (int i = 0; i < 200; ++i) {
    const float t = float(i) * 0.37f;
    const glm::vec3 n = glm::normalize(glm::vec3(std::sin(t), std::cos(t * 1.3f), std::sin(t * 0.7f + 1)));
    const uint32_t bits = twin::pack_normal(n);
    const glm::vec3 shader = twin::unpack_normal(bits);
    const std::vector<float> host = unpacked("gbuffer.normal", bits);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(host[size_t(c)], shader[c], 1e-6f);
      EXPECT_NEAR(host[size_t(c)], n[c], 1e-4f);
    }
    const glm::vec3 light = glm::abs(n) * std::exp2(t - 20);
    const uint32_t packed = twin::pack_rgb9e5(light);
    const std::vector<float> read = unpacked("direct.radiance", packed);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(read[size_t(c)], twin::unpack_rgb9e5(packed)[c]);
    const uint32_t state = twin::pack_state(n.x, light.x);
    EXPECT_EQ(unpacked("denoise.state", state),
              (std::vector<float>{twin::unpack_visibility(state), twin::unpack_variance(state)}));
  }
  EXPECT_EQ(unpacked("denoise.bent", twin::NO_BENT), std::vector<float>{});
  EXPECT_EQ(unpacked("feedback.nearest", ~0u), std::vector<float>{});
  EXPECT_EQ(unpacked("feedback.nearest", 0x40200000u), std::vector<float>{2.5f});
  EXPECT_EQ(unpacked("feedback.owner", 5 * 64 + 7), (std::vector<float>{7, 5}));
  EXPECT_FALSE(passes::unpack_texel("nobody", {64, 32}, 0));
}

}  // namespace
}  // namespace nf::test
