// Temporal accumulation: one full-screen pass.
#include "temporal.h"

namespace nf::passes {

gpu::Defines result_defines(const GiResult& gi) {
  gpu::Defines defines;
  if (gi.visibility) defines.emplace_back("HAS_VISIBILITY", "1");
  int location = 1;  // visibility goes out at 0, always
  const auto has = [&](graph::Tex tex, const char* name, const char* at) {
    if (!tex) return;
    defines.emplace_back(name, "1");
    defines.emplace_back(at, std::to_string(location++));
  };
  has(gi.gi, "HAS_GI", "GI_AT");
  has(gi.ambient, "HAS_AMBIENT", "AMBIENT_AT");
  has(gi.bent, "HAS_BENT", "BENT_AT");
  return defines;
}

void feed_result(graph::PassBuilder& builder, const GiResult& gi) {
  if (gi.gi) builder.in("gi", gi.gi);
  if (gi.visibility) builder.in("visibility", gi.visibility);
  if (gi.ambient) builder.in("ambient", gi.ambient);
  if (gi.bent) builder.in("bent", gi.bent);
}

namespace {

// Texels of 4x4 pixels: how much of what a point sees there has changed since the last frame.
graph::Tex add_changes(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g,
                       const PreviousSurface& previous, const ReprojectBlock& reproject) {
  const graph::Size size{(g.size.width + 3) / 4, (g.size.height + 3) / 4};
  const graph::Tex changes = graph.image("temporal.changes", {size, VK_FORMAT_R16G16_SFLOAT});
  const graph::Tex nearby = graph.image("temporal.nearby", {size, VK_FORMAT_R16_SFLOAT});
  graph
      .fullscreen("temporal.changes", pipelines.fullscreen("temporal_changes.frag"), "What has moved, appeared or gone")
      .in("depth", g.depth)
      .in("normal", g.normal)
      .in("velocity", g.velocity)
      .in("previous_depth", previous.depth.prev)
      .in("previous_normal", previous.normal.prev)
      .out("changes", changes)
      .params(reproject);
  graph.fullscreen("temporal.nearby", pipelines.fullscreen("temporal_nearby.frag"), "How much of that a point sees")
      .in("depth", g.depth)
      .in("changes", changes)
      .out("nearby", nearby);
  return nearby;
}

}  // namespace

Temporal add_temporal(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const PreviousSurface& previous,
                      const ReprojectBlock& reproject, const GiResult& gi, const TemporalParams& params) {
  const graph::ImageDesc desc{g.size, VK_FORMAT_R16G16B16A16_SFLOAT};
  const graph::History moments = graph.history("temporal.moments", desc);
  Temporal out{.gi = {}, .moments = moments.next};
  gpu::Defines defines = result_defines(gi);
  graph::Tex nearby;
  if (params.motion > 0) {
    nearby = add_changes(graph, pipelines, g, previous, reproject);
    defines.emplace_back("FOLLOW_CHANGES", "1");
  }
  auto builder = graph.fullscreen("temporal", pipelines.fullscreen("temporal.frag", defines),
                                  "Mean of the GI over frames, and its variance");
  builder.in("depth", g.depth)
      .in("normal", g.normal)
      .in("velocity", g.velocity)
      .in("previous_depth", previous.depth.prev)
      .in("previous_normal", previous.normal.prev)
      .in("previous_moments", moments.prev)
      .out("moments", moments.next)
      .params(reproject)
      .params(params)
      .params(TemporalBlock{});
  if (nearby) builder.in("nearby", nearby);
  feed_result(builder, gi);
  const auto keep = [&](graph::Tex has, const char* name, const char* prev_slot, const char* slot) -> graph::Tex {
    if (!has) return {};
    const graph::History history = graph.history(name, desc);
    builder.in(prev_slot, history.prev).out(slot, history.next);
    return history.next;
  };
  out.gi.gi = keep(gi.gi, "temporal.light", "previous_light", "light");
  out.gi.ambient = keep(gi.ambient, "temporal.ambient", "previous_ambient", "mean_ambient");
  out.gi.bent = keep(gi.bent, "temporal.bent", "previous_bent", "mean_bent");
  if (gi.visibility) out.gi.visibility = moments.next;
  return out;
}

}  // namespace nf::passes
