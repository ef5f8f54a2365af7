// HBIL.
#include "gi/gather.h"
#include "gi/hemisphere.h"
#include "gi/slices.h"

namespace nf::passes {

GiResult add_hbil(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                  const HbilParams& params) {
  const gpu::Pipeline pipeline = pipelines.compute(
      "gi/hbil.comp", {{"GI", GiParams::table(), &shared}, {"HBIL", HbilParams::table(), &params}},
      {whole_step_exponent(shared), {"ENVIRONMENT_MAP", in.environment.any() ? 1 : GiPipelines::absent}});
  auto pass = graph.compute("hbil.trace", pipeline, "Rising horizons: light, bent cone, environment through it");
  pass.params(shared).params(params);
  return add_gather(graph, pass, *pipeline.interface, in, {"hbil.visibility", "hbil.bent", "hbil.gi", "hbil.ambient"});
}

}  // namespace nf::passes
