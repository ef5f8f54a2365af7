// Visibility bitmasks: vbao (occlusion, bent normal, environment by direction) and vbgi (the same and indirect light).
#include "gi/gather.h"
#include "gi/slices.h"

namespace nf::passes {
namespace {

template <class Params>
GiResult add_bitmask(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                     const Params& params, const char* file, const char* trace, const GatherNames& names) {
  const gpu::Pipeline pipeline =
      pipelines.compute(file, {{"GI", GiParams::table(), &shared}, {"BITMASK", Params::table(), &params}},
                        {whole_step_exponent(shared),
                         {"ENVIRONMENT_MAP", in.environment.any() && params.ambient ? 1 : GiPipelines::absent}});
  auto pass = graph.compute(trace, pipeline, "Sectors of screen-space slices that samples cover");
  pass.params(shared);
  if (params.ambient) pass.params(params);
  return add_gather(graph, pass, *pipeline.interface, in, names);
}

}  // namespace

GiResult add_vbao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const VbaoParams& params) {
  return add_bitmask(graph, pipelines, inputs, shared, params, "gi/vbao.comp", "vbao.trace",
                     {"vbao.visibility", "vbao.bent", "", "vbao.ambient"});
}

GiResult add_vbgi(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const VbgiParams& params) {
  return add_bitmask(graph, pipelines, inputs, shared, params, "gi/vbgi.comp", "vbgi.trace",
                     {"vbgi.visibility", "vbgi.bent", "vbgi.gi", "vbgi.ambient"});
}

}  // namespace nf::passes
