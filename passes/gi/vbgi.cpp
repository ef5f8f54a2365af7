// The visibility-bitmask pass: one dispatch per frame.
#include "gi/vbgi.h"

namespace nf::passes {

VbgiPass create_vbgi(gpu::Pipelines& pipelines) {
  return {pipelines.compute("gi/vbgi.comp")};
}

GiResult add_vbgi(graph::Graph& graph, const VbgiPass& pass, const GBuffer& g, const Radiance& direct,
                  const GiParams& shared, const VbgiParams& params) {
  GiResult out{.visibility = graph.image("vbgi.visibility", {g.size, VK_FORMAT_R16_SFLOAT}),
               .bent = {},
               .gi = graph.image("vbgi.gi", {g.size, VK_FORMAT_R16G16B16A16_SFLOAT}),
               .ambient = {}};
  graph
      .compute("vbgi.trace", pass.trace,
               "Visibility bitmasks along screen-space slices: visibility and indirect diffuse light")
      .in("depth", g.depth)
      .in("normal", g.normal)
      .in("radiance", direct.radiance)
      .out("light", out.gi)
      .out("visibility", out.visibility)
      .params(shared)
      .params(params)
      .over(out.gi);
  return out;
}

}  // namespace nf::passes
