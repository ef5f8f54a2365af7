// Horizon techniques: hbao (by solid angle) and gtao (by projected solid angle).
#include "gi/gather.h"
#include "gi/slices.h"

namespace nf::passes {
namespace {

template <class Params>
GiResult add_horizons(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                      const Params& params, const char* file, const char* trace, const GatherNames& names) {
  const gpu::Pipeline pipeline = pipelines.compute(
      file, {{"GI", GiParams::table(), &shared}, {"HORIZON", Params::table(), &params}}, {whole_step_exponent(shared)});
  auto pass = graph.compute(trace, pipeline, "The highest sample on each side of screen-space slices");
  pass.params(shared).params(params);
  return add_gather(graph, pass, *pipeline.interface, in, names);
}

}  // namespace

GiPipelines::Extra whole_step_exponent(const GiParams& shared) {
  const int whole = int(shared.step_exponent);
  return {"STEP_EXPONENT", float(whole) == shared.step_exponent ? whole : 0};
}

GiResult add_hbao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const HbaoParams& params) {
  return add_horizons(graph, pipelines, inputs, shared, params, "gi/hbao.comp", "hbao.trace",
                      {"hbao.visibility", "hbao.bent", "", ""});
}

GiResult add_gtao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const GtaoParams& params) {
  return add_horizons(graph, pipelines, inputs, shared, params, "gi/gtao.comp", "gtao.trace",
                      {"gtao.visibility", "gtao.bent", "", ""});
}

}  // namespace nf::passes
