// Images and blur of the gathering techniques.
#include "gi/gather.h"

namespace nf::passes {
namespace {

constexpr VkFormat scalar = VK_FORMAT_R16_SFLOAT, color = VK_FORMAT_R16G16B16A16_SFLOAT;

}  // namespace

GiResult add_gather(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface,
                    const GiInputs& in, const GatherNames& names) {
  const graph::Size size = in.gbuffer.size;
  GiResult out;
  const auto give = [&](const char* slot, graph::Tex& tex, const char* name, VkFormat format) {
    if (!interface.find(slot)) return;
    tex = graph.image(name, {size, format});
    pass.out(slot, tex);
  };
  give("visibility", out.visibility, names.visibility, scalar);
  give("light", out.gi, names.gi, color);
  give("bent", out.bent, names.bent, color);
  give("ambient", out.ambient, names.ambient, color);
  const auto feed = [&](const char* slot, graph::Tex tex) {
    if (interface.find(slot)) pass.in(slot, tex);
  };
  feed("depth", in.gbuffer.depth);
  feed("normal", in.gbuffer.normal);
  feed("radiance", in.radiance.radiance);
  feed("albedo", in.gbuffer.albedo);
  feed("material", in.gbuffer.material);
  feed_environment(graph, pass, interface, in.environment);
  in.noise.feed(graph, pass, interface);
  if (in.inspect && interface.find("inspection")) {
    const InspectBlock& block = in.inspect->block;
    in.inspect->records = graph.optional(graph.buffer("inspection", inspection_bytes(block)));
    pass.out("inspection", in.inspect->records).params(block);
  }
  pass.over(out.visibility);
  return out;
}

GiResult add_gather_blur(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiResult& raw,
                         const char* name, const GatherNames& names, bool edges) {
  const gpu::Pipeline pipeline = pipelines.compute(
      "gi/blur.comp", {}, {{"BLUR_EDGES", edges}, {"BLUR_LIGHT", bool(raw.gi)}, {"BLUR_AMBIENT", bool(raw.ambient)}});
  auto pass = graph.compute(name, pipeline, "Average of 4 x 4 pixels");
  pass.in("raw_visibility", raw.visibility);
  if (raw.gi) pass.in("raw_light", raw.gi);
  if (raw.ambient) pass.in("raw_ambient", raw.ambient);
  GiResult out = add_gather(graph, pass, *pipeline.interface, in, names);
  out.bent = raw.bent;
  return out;
}

}  // namespace nf::passes
