// Feedback of the last frame's light.
#include "feedback.h"

#include <algorithm>

#include "energy.h"

namespace nf::passes {
namespace {

constexpr VkFormat color = VK_FORMAT_R16G16B16A16_SFLOAT;

struct Sources {
  const GBuffer& g;
  const PreviousSurface& previous;
  const ReprojectBlock& reproject;
  const TemporalParams& same_surface;
  const graph::History& reflected;
};

graph::Tex add_gather(graph::Graph& graph, gpu::Pipelines& pipelines, const Sources& s) {
  const graph::Tex fed = graph.image("feedback.fed", {s.g.size, color});
  graph
      .fullscreen("feedback.gather", pipelines.fullscreen("feedback_gather.frag"),
                  "The last frame's light along the motion")
      .in("depth", s.g.depth)
      .in("normal", s.g.normal)
      .in("velocity", s.g.velocity)
      .in("previous_depth", s.previous.depth.prev)
      .in("previous_normal", s.previous.normal.prev)
      .in("previous_reflected", s.reflected.prev)
      .out("fed", fed)
      .params(s.reproject)
      .params(s.same_surface)
      .params(FeedbackBlock{});
  return fed;
}

graph::Tex add_scatter(graph::Graph& graph, gpu::Pipelines& pipelines, const Sources& s) {
  const graph::ImageDesc bits{s.g.size, VK_FORMAT_R32_UINT};
  const graph::Tex nearest = graph.image("feedback.nearest", bits), owner = graph.image("feedback.owner", bits);
  const graph::Tex fed = graph.image("feedback.fed", {s.g.size, color});
  graph.fullscreen("feedback.clear", pipelines.fullscreen("feedback_clear.frag"), "Nothing has landed yet")
      .out("nearest", nearest)
      .out("owner", owner);
  graph
      .compute("feedback.scatter_depth", pipelines.compute("feedback_scatter.comp"), "Nearest of what lands on a pixel")
      .in("previous_depth", s.previous.depth.prev)
      .inout("nearest", nearest)
      .params(s.reproject)
      .over(nearest);
  graph
      .compute("feedback.scatter", pipelines.compute("feedback_scatter.comp", {{"OWNER", "1"}}), "Which pixel that was")
      .in("previous_depth", s.previous.depth.prev)
      .inout("nearest", nearest)
      .inout("owner", owner)
      .params(s.reproject)
      .over(owner);
  graph.fullscreen("feedback.take", pipelines.fullscreen("feedback_take.frag"), "The light of what landed")
      .in("depth", s.g.depth)
      .in("normal", s.g.normal)
      .in("owner", owner)
      .in("previous_depth", s.previous.depth.prev)
      .in("previous_normal", s.previous.normal.prev)
      .in("previous_reflected", s.reflected.prev)
      .out("fed", fed)
      .params(s.reproject)
      .params(s.same_surface)
      .params(FeedbackBlock{});
  return fed;
}

// Up to six levels: holes of up to 64 pixels.
graph::Tex add_push_pull(graph::Graph& graph, gpu::Pipelines& pipelines, graph::Size size, graph::Tex fed) {
  const uint32_t largest = std::max(size.width, size.height);
  uint8_t levels = 1;
  while (levels < 6 && largest >> levels) ++levels;
  if (levels == 1) return fed;
  const graph::Size half{std::max(size.width / 2, 1u), std::max(size.height / 2, 1u)};
  const uint8_t mips = uint8_t(levels - 1);
  const graph::Tex pushed = graph.image("feedback.pushed", {half, color, mips});
  const gpu::Pipeline push = pipelines.fullscreen("feedback_fill.frag"),
                      pull = pipelines.fullscreen("feedback_fill.frag", {{"PULL", "1"}});
  for (uint8_t m = 0; m < mips; ++m)
    graph.fullscreen("feedback.push", push, "Means of what has light")
        .in("fine", m ? graph::mip(pushed, uint8_t(m - 1)) : graph::TexPart(fed))
        .out("level", graph::mip(pushed, m));
  const graph::Tex pulled = mips > 1 ? graph.image("feedback.pulled", {half, color, uint8_t(mips - 1)}) : graph::Tex{};
  const graph::Tex filled = graph.image("feedback.filled", {size, color});
  for (int m = int(mips) - 2; m >= -1; --m) {
    const graph::TexPart fine = m < 0 ? graph::TexPart(fed) : graph::mip(pushed, uint8_t(m));
    const bool coarsest = m == int(mips) - 2;
    const graph::TexPart coarse = coarsest ? graph::mip(pushed, uint8_t(m + 1)) : graph::mip(pulled, uint8_t(m + 1));
    graph.fullscreen("feedback.pull", pull, "Holes filled from coarser levels")
        .in("fine", fine)
        .in("coarse", coarse)
        .out("level", m < 0 ? graph::TexPart(filled) : graph::mip(pulled, uint8_t(m)));
  }
  return filled;
}

}  // namespace

Feedback add_feedback(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const PreviousSurface& previous,
                      const ReprojectBlock& reproject, const Radiance& direct, const FeedbackParams& params,
                      const TemporalParams& same_surface) {
  Feedback out;
  out.reflected = graph.history("feedback.reflected", {g.size, color});
  out.energy = graph.history("feedback.energy", {{1, 1}, VK_FORMAT_R32G32B32A32_SFLOAT});
  const Sources sources{g, previous, reproject, same_surface, out.reflected};
  out.fed = params.reprojection == 1 ? add_gather(graph, pipelines, sources) : add_scatter(graph, pipelines, sources);
  const graph::Tex filled = add_push_pull(graph, pipelines, g.size, out.fed);
  out.radiance = graph.image("feedback.radiance", {g.size, VK_FORMAT_R32_UINT});
  graph
      .fullscreen("feedback.merge", pipelines.fullscreen("feedback_merge.frag"),
                  "Direct light, emission, and the last frame's")
      .in("depth", g.depth)
      .in("direct_diffuse", direct.diffuse)
      .in("emissive", g.emissive)
      .in("fed", filled)
      .in("previous_energy", out.energy.prev)
      .out("radiance", out.radiance)
      .params(params)
      .params(FeedbackMergeBlock{});
  graph.optional(out.fed);
  return out;
}

graph::Tex add_feedback_keep(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const Feedback& feedback,
                             const GiResult& gi, const EnvironmentMaps& environment, const FeedbackParams& params) {
  gpu::Defines defines;
  if (params.include_ambient) {
    defines.emplace_back("INCLUDE_AMBIENT", "1");
    if (gi.ambient) defines.emplace_back("HAS_AMBIENT", "1");
    if (gi.visibility) defines.emplace_back("HAS_VISIBILITY", "1");
    if (environment.any() && !gi.ambient) defines.emplace_back("ENVIRONMENT_MAP", "1");
  }
  const gpu::Pipeline pipeline = pipelines.fullscreen("feedback_keep.frag", defines);
  auto builder = graph.fullscreen("feedback.keep", pipeline, "Light that goes on to the next frame");
  builder.in("depth", g.depth)
      .in("radiance", feedback.radiance)
      .in("albedo", g.albedo)
      .in("material", g.material)
      .in("gi", gi.gi)
      .out("reflected", feedback.reflected.next)
      .params(params);
  if (pipeline.interface->find("ambient")) builder.in("ambient", gi.ambient);
  if (pipeline.interface->find("normal")) builder.in("normal", g.normal);
  if (pipeline.interface->find("visibility")) builder.in("visibility", gi.visibility);
  feed_environment(graph, builder, *pipeline.interface, environment);

  return add_energy(graph, pipelines, "feedback.energy", feedback.reflected.next, feedback.energy.next);
}

}  // namespace nf::passes
