// SSAO with colour bleeding.
#include "gi/gather.h"
#include "gi/hemisphere.h"

namespace nf::passes {

GiResult add_ssao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                  const SsaoParams& params) {
  const bool ambient = params.bleed && params.ambient_share > 0;
  const gpu::Pipeline pipeline =
      pipelines.compute("gi/ssao.comp", {{"GI", GiParams::table(), &shared}, {"SSAO", SsaoParams::table(), &params}},
                        {{"AMBIENT_BLEED", ambient ? 1 : GiPipelines::absent},
                         {"ENVIRONMENT_MAP", ambient && in.environment.any() ? 1 : GiPipelines::absent}});
  auto pass =
      graph.compute("ssao.trace", pipeline, "Points in the hemisphere behind what is seen: visibility, bleeding");
  pass.params(shared).params(params);
  const GatherNames names{"ssao.visibility", "", "ssao.gi", ""}, raw{"ssao.raw_visibility", "", "ssao.raw_gi", ""};
  const GiResult traced = add_gather(graph, pass, *pipeline.interface, in, params.blur ? raw : names);
  return params.blur ? add_gather_blur(graph, pipelines, in, traced, "ssao.blur", names, false) : traced;
}

}  // namespace nf::passes
