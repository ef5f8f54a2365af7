// SSDO.
#include "gi/gather.h"
#include "gi/hemisphere.h"

namespace nf::passes {

GiResult add_ssdo(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                  const SsdoParams& params) {
  const gpu::Pipeline pipeline =
      pipelines.compute("gi/ssdo.comp", {{"GI", GiParams::table(), &shared}, {"SSDO", SsdoParams::table(), &params}},
                        {{"ENVIRONMENT_MAP", params.ambient && in.environment.any() ? 1 : GiPipelines::absent}});
  auto pass = graph.compute("ssdo.trace", pipeline,
                            "Directions of the hemisphere, blocked or open: visibility, environment, one bounce");
  pass.params(shared).params(params);
  const GatherNames names{"ssdo.visibility", "ssdo.bent", "ssdo.gi", "ssdo.ambient"};
  const GatherNames raw{"ssdo.raw_visibility", "ssdo.bent", "ssdo.raw_gi", "ssdo.raw_ambient"};
  const GiResult traced = add_gather(graph, pass, *pipeline.interface, in, params.blur ? raw : names);
  return params.blur ? add_gather_blur(graph, pipelines, in, traced, "ssdo.blur", names, true) : traced;
}

}  // namespace nf::passes
