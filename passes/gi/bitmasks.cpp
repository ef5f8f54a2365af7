// Visibility bitmasks: vbao (occlusion, bent normal, environment by direction) and vbgi (the same and indirect light).
#include "gi/slices.h"

namespace nf::passes {
namespace {

// `params` is VbaoParams or VbgiParams; `names` the pass's and its images'.
struct Names {
  const char *trace, *visibility, *bent, *gi, *ambient;
};

template <class Params>
GiResult add_bitmask(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiParams& shared,
                     const Params& params, const char* file, const Names& names, const char* help) {
  gpu::Defines more = slice_defines(shared);
  if (in.environment.any() && params.ambient) more.emplace_back("ENVIRONMENT_MAP", "1");
  const gpu::Pipeline pipeline =
      pipelines.compute(file, {{"GI", GiParams::table(), &shared}, {"BITMASK", Params::table(), &params}}, more);
  const auto has = [&](const char* slot) { return pipeline.interface->find(slot) != nullptr; };
  const graph::Size size = in.gbuffer.size;
  const graph::ImageDesc color{size, VK_FORMAT_R16G16B16A16_SFLOAT};

  GiResult out;
  out.visibility = graph.image(names.visibility, {size, VK_FORMAT_R16_SFLOAT});
  auto builder = graph.compute(names.trace, pipeline, help);
  builder.in("depth", in.gbuffer.depth)
      .in("normal", in.gbuffer.normal)
      .out("visibility", out.visibility)
      .params(shared)
      .over(out.visibility);
  if (has("radiance")) {
    out.gi = graph.image(names.gi, color);
    builder.in("radiance", in.radiance.radiance).out("light", out.gi);
  }
  if (params.ambient) {
    out.bent = graph.image(names.bent, color);
    out.ambient = graph.image(names.ambient, color);
    builder.out("bent", out.bent).out("ambient", out.ambient).params(params);
    feed_environment(graph, builder, *pipeline.interface, in.environment);
  }
  in.noise.feed(graph, builder, *pipeline.interface);
  return out;
}

}  // namespace

GiResult add_vbao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const VbaoParams& params) {
  return add_bitmask(graph, pipelines, inputs, shared, params, "gi/vbao.comp",
                     {"vbao.trace", "vbao.visibility", "vbao.bent", "", "vbao.ambient"},
                     "Visibility bitmasks along screen-space slices: visibility, bent normal, environment");
}

GiResult add_vbgi(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const VbgiParams& params) {
  return add_bitmask(graph, pipelines, inputs, shared, params, "gi/vbgi.comp",
                     {"vbgi.trace", "vbgi.visibility", "vbgi.bent", "vbgi.gi", "vbgi.ambient"},
                     "Visibility bitmasks along screen-space slices: visibility and indirect diffuse light");
}

}  // namespace nf::passes
