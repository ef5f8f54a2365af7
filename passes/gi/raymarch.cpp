// Rays through the depth buffer.
#include "gi/gather.h"
#include "gi/hemisphere.h"

namespace nf::passes {

GiResult add_raymarch(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                      const RaymarchParams& params) {
  const gpu::Pipeline pipeline = pipelines.compute(
      "gi/raymarch.comp", {{"GI", GiParams::table(), &shared}, {"RAYMARCH", RaymarchParams::table(), &params}},
      {{"ENVIRONMENT_MAP", params.ambient && in.environment.any() ? 1 : GiPipelines::absent}});
  auto pass = graph.compute("raymarch.trace", pipeline, "Rays of the hemisphere through the depth buffer");
  pass.params(shared).params(params);
  return add_gather(graph, pass, *pipeline.interface, in,
                    {"raymarch.visibility", "raymarch.bent", "raymarch.gi", "raymarch.ambient"});
}

}  // namespace nf::passes
