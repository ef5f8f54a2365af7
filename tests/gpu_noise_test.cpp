// The kinds of sampling noise on the device: bit for bit what the same text gives as C++.
#include "glsl_twin.h"
#include "gpu_fixture.h"
#include "noise.h"

NF_GLSL_BEGIN
#include "common/noise.glsl"
NF_GLSL_END

namespace nf::test {
namespace {

using glm::ivec2;
using glm::vec3;

class NoiseOnDevice : public GpuGraphTest {
 protected:
  std::unique_ptr<passes::Noise> noise_;
  void TearDown() override {
    noise_.reset();
    GpuGraphTest::TearDown();
  }
};

TEST_F(NoiseOnDevice, IsTheSameAsOnTheHost) {
  start({{"noise.comp", R"(#version 460
#include "common/noise_table.glsl"
#include "common/noise.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
uniform writeonly image2D target;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  imageStore(target, p, vec4(sampling_noise(p, FRAME, 9u), 0.0));
}
)"}});
  noise_ = std::make_unique<passes::Noise>(device());
  const std::vector<uint32_t> table = passes::make_noise_table();
  auto texel = [&](ivec2 at) { return table[size_t(at.y) * 64 + size_t(at.x)]; };
  const std::function<vec3(ivec2, uint32_t)> host[] = {
      [](ivec2 p, uint32_t frame) { return twin::noise_hilbert_r2(p, frame, 9); },
      [](ivec2 p, uint32_t frame) { return twin::noise_ign(p, frame, 9); },
      [](ivec2 p, uint32_t frame) { return twin::noise_4x4(p, frame, 9); },
      [&](ivec2 p, uint32_t frame) { return twin::noise_blue(texel(twin::blue_texel(p)), frame, 9); },
      [&](ivec2 p, uint32_t frame) { return twin::noise_stbn(texel(twin::blue_texel(p)), frame, 9); },
      [](ivec2 p, uint32_t frame) { return twin::noise_white(p, frame, 9); }};
  for (size_t kind = 0; kind < std::size(host); ++kind) {
    for (const uint32_t frame : {37u, 0xFFFFFFF0u}) {
      const gpu::Pipeline pipeline = pipelines_->compute(
          "noise.comp", {{"NOISE_KIND", std::to_string(kind)}, {"FRAME", std::to_string(frame) + "u"}});
      graph::Graph graph(executor_->histories());
      const graph::Tex target = graph.image("target", {{96, 80}, VK_FORMAT_R32G32B32A32_SFLOAT});
      graph::PassBuilder pass = graph.compute("noise", pipeline);
      pass.out("target", target).over(target);
      noise_->feed(graph, pass, *pipeline.interface);
      graph.readback("target", target);
      const std::vector<float> values = run(graph);
      size_t wrong = 0;
      for (int i = 0; i < 96 * 80; ++i) {
        const vec3 expected = host[kind](ivec2(i % 96, i / 96), frame);
        for (int d = 0; d < 3; ++d) wrong += values[size_t(4 * i + d)] != expected[d];
      }
      EXPECT_EQ(wrong, 0u) << "kind " << kind << ", frame " << frame;
      EXPECT_NE(values[0], values[4]) << "control: it is no constant";
    }
  }
}

}  // namespace
}  // namespace nf::test
