// The spatial filter: packing, then one full-screen pass a level.
#include "denoise.h"

namespace nf::passes {
namespace {

// 32-bit texels between the passes.
struct Packed {
  graph::Tex state, light, ambient, bent;
};

Packed packed_images(graph::Graph& graph, graph::Size size, const GiResult& gi) {
  const graph::ImageDesc desc{size, VK_FORMAT_R32_UINT};
  Packed p{.state = graph.image("denoise.state", desc), .light = {}, .ambient = {}, .bent = {}};
  if (gi.gi) p.light = graph.image("denoise.light", desc);
  if (gi.ambient) p.ambient = graph.image("denoise.ambient", desc);
  if (gi.bent) p.bent = graph.image("denoise.bent", desc);
  return p;
}

Packed add_prepare(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const GiResult& gi,
                   graph::Tex moments, const TemporalParams& temporal) {
  gpu::Defines defines = result_defines(gi);
  if (moments) defines.emplace_back("WITH_MEAN", "1");
  const Packed p = packed_images(graph, g.size, gi);
  auto builder = graph.fullscreen("denoise.prepare", pipelines.fullscreen("denoise_prepare.frag", defines),
                                  "Packs the GI for the filter");
  feed_result(builder, gi);
  if (moments)
    builder.in("moments", moments);
  else
    builder.in("depth", g.depth).params(temporal);
  builder.out("state", p.state);
  if (p.light) builder.out("packed_light", p.light);
  if (p.ambient) builder.out("packed_ambient", p.ambient);
  if (p.bent) builder.out("packed_bent", p.bent);
  return p;
}

constexpr const char* level_names[] = {"denoise.level1", "denoise.level2", "denoise.level3", "denoise.level4",
                                       "denoise.level5"};

}  // namespace

GiResult add_denoise(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const GiResult& gi,
                     graph::Tex moments, const DenoiseParams& params, const TemporalParams& temporal) {
  if (params.method == 0 || !gi.any()) return gi;
  const bool wide = params.method == 1;
  Packed p = add_prepare(graph, pipelines, g, gi, moments, temporal);
  GiResult out;
  const int levels = wide ? 1 : params.passes;
  for (int level = 0; level < levels; ++level) {
    const bool last = level + 1 == levels;
    gpu::Defines defines = result_defines(gi);
    if (wide) defines.emplace_back("WIDE", "1");
    if (last) defines.emplace_back("LAST", "1");
    auto builder = graph.fullscreen(level_names[level], pipelines.fullscreen("denoise.frag", defines),
                                    "Edge-aware blur of the GI");
    builder.in("depth", g.depth).in("normal", g.normal).in("state_in", p.state);
    if (p.light) builder.in("light_in", p.light);
    if (p.ambient) builder.in("ambient_in", p.ambient);
    if (p.bent) builder.in("bent_in", p.bent);
    builder.params(params).params(DenoiseBlock{.spacing = 1 << level});
    if (last) {
      const graph::ImageDesc light{g.size, VK_FORMAT_R16G16B16A16_SFLOAT};
      // Not every frame reads all that its technique gives.
      const auto final_image = [&](const char* slot, const char* name, const graph::ImageDesc& desc) {
        const graph::Tex tex = graph.optional(graph.image(name, desc));
        builder.out(slot, tex);
        return tex;
      };
      out.visibility = final_image("visibility", "denoise.visibility", {g.size, VK_FORMAT_R16_SFLOAT});
      if (gi.gi) out.gi = final_image("light", "denoise.gi", light);
      if (gi.ambient) out.ambient = final_image("ambient", "denoise.ambient", light);
      if (gi.bent) out.bent = final_image("bent", "denoise.bent", light);
      break;
    }
    const Packed next = packed_images(graph, g.size, gi);
    builder.out("state", next.state);
    if (next.light) builder.out("light", next.light);
    if (next.ambient) builder.out("ambient", next.ambient);
    if (next.bent) builder.out("bent", next.bent);
    p = next;
  }
  if (!gi.visibility) out.visibility = {};  // absent stays absent
  return out;
}

}  // namespace nf::passes
