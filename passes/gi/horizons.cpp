// Horizon techniques: hbao (by solid angle) and gtao (by projected solid angle).
#include <string>

#include "gi/slices.h"

namespace nf::passes {
namespace {

struct Names {
  const char *trace, *visibility, *bent;
};

template <class Params>
GiResult add_horizons(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                      const Params& params, const char* file, const Names& names, const char* help) {
  const gpu::Pipeline pipeline = pipelines.compute(
      file, {{"GI", GiParams::table(), &shared}, {"HORIZON", Params::table(), &params}}, slice_defines(shared));
  const graph::Size size = in.gbuffer.size;
  GiResult out;
  out.visibility = graph.image(names.visibility, {size, VK_FORMAT_R16_SFLOAT});
  auto builder = graph.compute(names.trace, pipeline, help);
  builder.in("depth", in.gbuffer.depth)
      .in("normal", in.gbuffer.normal)
      .out("visibility", out.visibility)
      .params(shared)
      .params(params)
      .over(out.visibility);
  if (pipeline.interface->find("albedo")) builder.in("albedo", in.gbuffer.albedo);
  if (params.bent) {
    out.bent = graph.image(names.bent, {size, VK_FORMAT_R16G16B16A16_SFLOAT});
    builder.out("bent", out.bent);
  }
  in.noise.feed(graph, builder, *pipeline.interface);
  return out;
}

}  // namespace

gpu::Defines slice_defines(const GiParams& shared) {
  const int whole = int(shared.step_exponent);
  return {{"STEP_EXPONENT", float(whole) == shared.step_exponent ? std::to_string(whole) : "0"}};
}

GiResult add_hbao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const HbaoParams& params) {
  return add_horizons(graph, pipelines, inputs, shared, params, "gi/hbao.comp",
                      {"hbao.trace", "hbao.visibility", "hbao.bent"},
                      "Horizons along screen-space slices: solid angle");
}

GiResult add_gtao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const GtaoParams& params) {
  return add_horizons(graph, pipelines, inputs, shared, params, "gi/gtao.comp",
                      {"gtao.trace", "gtao.visibility", "gtao.bent"},
                      "Horizons along screen-space slices: projected solid angle");
}

}  // namespace nf::passes
