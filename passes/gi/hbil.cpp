// HBIL.
#include <algorithm>

#include "gi/gather.h"
#include "gi/hemisphere.h"
#include "gi/slices.h"

namespace nf::passes {

namespace {

// Levels from half the size on, as many as the shader looks at.
graph::Tex add_radiance_mips(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in) {
  constexpr uint8_t most = 6;  // RADIANCE_LEVELS of hbil.glsl
  const graph::Size half{std::max(in.gbuffer.size.width / 2, 1u), std::max(in.gbuffer.size.height / 2, 1u)};
  uint8_t levels = 1;
  while (levels < most && std::max(half.width, half.height) >> levels) ++levels;
  const graph::Tex mips = graph.image("hbil.radiance_mips", {half, VK_FORMAT_R16G16B16A16_SFLOAT, levels});
  for (uint8_t m = 0; m < levels; ++m) {
    const gpu::Pipeline pipeline =
        pipelines.compute("gi/radiance_mip.comp", {}, {{"FULL", m ? GiPipelines::absent : 1}});
    auto pass = graph.compute("hbil.radiance_mip", pipeline, "Means of the surfaces' light, for wide steps");
    if (m)
      pass.in("finer", graph::mip(mips, uint8_t(m - 1)));
    else
      pass.in("depth", in.gbuffer.depth).in("radiance", in.radiance.radiance);
    pass.out("mip", graph::mip(mips, m)).over(graph::mip(mips, m));
  }
  return mips;
}

}  // namespace

GiResult add_hbil(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                  const HbilParams& params) {
  const gpu::Pipeline pipeline = pipelines.compute(
      "gi/hbil.comp", {{"GI", GiParams::table(), &shared}, {"HBIL", HbilParams::table(), &params}},
      {whole_step_exponent(shared), {"ENVIRONMENT_MAP", in.environment.any() ? 1 : GiPipelines::absent}});
  const graph::Tex mips = params.mips ? add_radiance_mips(graph, pipelines, in) : graph::Tex{};
  auto pass = graph.compute("hbil.trace", pipeline, "Rising horizons: light, bent cone, environment through it");
  pass.params(shared).params(params);
  if (mips) pass.in("radiance_mips", mips);
  return add_gather(graph, pass, *pipeline.interface, in, {"hbil.visibility", "hbil.bent", "hbil.gi", "hbil.ambient"});
}

}  // namespace nf::passes
