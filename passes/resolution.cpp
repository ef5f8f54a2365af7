// Splitting a picture into small ones, running between, and putting it together.
#include "resolution.h"

namespace nf::passes {

PixelGrid make_grid(int resolution, uint32_t frame, bool moving) {
  enum { Full, Half, Quarter, Checkerboard, Interleaved2, Interleaved4 };
  // Each pixel of a 2 x 2 block, diagonals first; of a 4 x 4 block, the same twice over.
  constexpr glm::ivec2 order[4] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
  const auto of_16 = [&](uint32_t i) { return order[i / 4 % 4] + 2 * order[i % 4]; };
  const uint32_t n = moving ? frame : 0;
  PixelGrid grid;
  switch (resolution) {
    case Half:
      return {2, {order[n % 4]}};
    case Quarter:
      return {4, {of_16(n % 16)}};
    case Checkerboard:
      return {2, {order[n % 2 * 2], order[n % 2 * 2 + 1]}};
    case Interleaved2:
      return {2, {order[0], order[1], order[2], order[3]}};
    case Interleaved4:
      grid.factor = 4;
      grid.offsets.clear();
      for (uint32_t i = 0; i < 16; ++i) grid.offsets.push_back(of_16(i));
      return grid;
    default:
      return grid;
  }
}

FrameBlock make_small_frame(const FrameBlock& frame, int factor, glm::ivec2 offset, uint32_t index, uint32_t count) {
  FrameBlock small = frame;
  const float f = float(factor);
  small.size = (frame.size + factor - 1) / factor;
  small.ray_scale = frame.ray_scale * f;
  // Pixel factor * q + offset + 0.5 = factor * (q + 0.5) + (offset + 0.5 - factor / 2).
  small.ray_offset = frame.ray_offset + (glm::vec2(offset) + 0.5f - 0.5f * f) * frame.ray_scale;
  small.pixels_per_tangent = frame.pixels_per_tangent / f;
  small.frame_index = frame.frame_index * count + index;
  return small;
}

SmallInputs add_split(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const Radiance& radiance,
                      int factor, glm::ivec2 offset) {
  const uint32_t f = uint32_t(factor);
  const graph::Size size{(g.size.width + f - 1) / f, (g.size.height + f - 1) / f};
  SmallInputs small{};
  small.gbuffer.size = size;
  small.gbuffer.depth = graph.optional(graph.image("resolution.depth", {size, graph.desc(g.depth).format}));
  small.gbuffer.normal = graph.optional(graph.image("resolution.normal", {size, graph.desc(g.normal).format}));
  small.radiance.radiance =
      graph.optional(graph.image("resolution.radiance", {size, graph.desc(radiance.radiance).format}));
  graph.fullscreen("resolution.split", pipelines.fullscreen("resolution_split.frag"), "One pixel of each block")
      .in("depth", g.depth)
      .in("normal", g.normal)
      .in("radiance", radiance.radiance)
      .out("small_depth", small.gbuffer.depth)
      .out("small_normal", small.gbuffer.normal)
      .out("small_radiance", small.radiance.radiance)
      .params(SplitBlock{.factor = factor, .offset = offset});
  return small;
}

void give_frame(graph::Graph& graph, size_t first_pass, const FrameBlock& frame) {
  graph.share(frame);
  const graph::ParamRow row = graph.shared.back();
  graph.shared.pop_back();
  for (size_t i = first_pass; i < graph.passes.size(); ++i) {
    graph::PassRow& pass = graph.passes[i];
    if (!pass.pipeline.interface || !pass.pipeline.interface->find(row.table->prefix)) continue;
    // A pass's rows stand together: they move to the end, with one more.
    const uint32_t first = uint32_t(graph.params.size());
    for (uint32_t p = 0; p < pass.param_count; ++p) {
      const graph::ParamRow moved = graph.params[pass.first_param + p];
      graph.params.push_back(moved);
    }
    graph.params.push_back(row);
    pass.first_param = first;
    ++pass.param_count;
  }
}

GiResult add_upsample(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const PixelGrid& grid,
                      const std::vector<GiResult>& small, const ResolutionParams& params) {
  const GiResult& has = small[0];
  gpu::Defines defines;
  int location = 0;
  const auto define = [&](graph::Tex tex, const char* name, const char* at) {
    if (!tex) return;
    defines.emplace_back(name, "1");
    defines.emplace_back(at, std::to_string(location++));
  };
  define(has.visibility, "HAS_VISIBILITY", "VISIBILITY_AT");
  define(has.gi, "HAS_GI", "GI_AT");
  define(has.ambient, "HAS_AMBIENT", "AMBIENT_AT");
  define(has.bent, "HAS_BENT", "BENT_AT");
  if (grid.all()) defines.emplace_back("ALL_PIXELS", "1");
  const gpu::Pipeline pipeline = pipelines.fullscreen("resolution_join.frag", defines);
  // The small results as layers of an image each, so that one pass reads all.
  const auto layers_of = [&](graph::Tex GiResult::*member, const char* name) {
    graph::ImageDesc desc = graph.desc(has.*member);
    desc.layers = uint8_t(small.size());
    const graph::Tex array = graph.image(name, desc);
    for (size_t i = 0; i < small.size(); ++i)
      graph.copy("resolution.gather", small[i].*member, graph::layer(array, uint8_t(i)));
    return array;
  };
  GiResult layers, out;
  const auto prepare = [&](graph::Tex GiResult::*member, const char* layers_name, const char* name) {
    if (!(has.*member)) return;
    layers.*member = layers_of(member, layers_name);
    out.*member = graph.optional(graph.image(name, {g.size, graph.desc(has.*member).format}));
  };
  prepare(&GiResult::visibility, "resolution.visibility_layers", "resolution.visibility");
  prepare(&GiResult::gi, "resolution.gi_layers", "resolution.gi");
  prepare(&GiResult::ambient, "resolution.ambient_layers", "resolution.ambient");
  prepare(&GiResult::bent, "resolution.bent_layers", "resolution.bent");

  auto builder = graph.fullscreen("resolution.join", pipeline, "The picture's GI from the small pictures'");
  const auto feed = [&](graph::Tex from, graph::Tex to, const char* in_slot, const char* out_slot) {
    if (from) builder.in(in_slot, from).out(out_slot, to);
  };
  feed(layers.visibility, out.visibility, "visibility_in", "visibility");
  feed(layers.gi, out.gi, "gi_in", "gi");
  feed(layers.ambient, out.ambient, "ambient_in", "ambient");
  feed(layers.bent, out.bent, "bent_in", "bent");
  UpsampleBlock block{
      .factor = grid.factor, .layers = int(small.size()), .offset0 = grid.offsets[0], .offset1 = grid.offsets.back()};
  if (!grid.all()) builder.in("depth", g.depth).in("normal", g.normal).params(params);
  builder.params(block);
  return out;
}

GiResult add_edge_fade(graph::Graph& graph, gpu::Pipelines& pipelines, const GBuffer& g, const GiResult& gi,
                       const EnvironmentMaps& environment, float band) {
  if (!gi.any()) return gi;
  struct Part {
    graph::Tex GiResult::*member;
    const char *define, *at, *in, *out, *name;
  };
  constexpr Part parts[] = {
      {&GiResult::visibility, "HAS_VISIBILITY", "VISIBILITY_AT", "visibility_in", "visibility", "edge_fade.visibility"},
      {&GiResult::gi, "HAS_GI", "GI_AT", "gi_in", "gi", "edge_fade.gi"},
      {&GiResult::ambient, "HAS_AMBIENT", "AMBIENT_AT", "ambient_in", "ambient", "edge_fade.ambient"},
      {&GiResult::bent, "HAS_BENT", "BENT_AT", "bent_in", "bent", "edge_fade.bent"}};
  gpu::Defines defines;
  int location = 0;
  for (const Part& part : parts)
    if (gi.*part.member) {
      defines.emplace_back(part.define, "1");
      defines.emplace_back(part.at, std::to_string(location++));
    }
  if (environment.any() && gi.ambient) defines.emplace_back("ENVIRONMENT_MAP", "1");
  const gpu::Pipeline pipeline = pipelines.fullscreen("edge_fade.frag", defines);
  auto builder = graph.fullscreen("edge_fade", pipeline, "At the border the GI goes over to none");
  if (pipeline.interface->find("normal")) builder.in("normal", g.normal);
  GiResult out;
  for (const Part& part : parts)
    if (const graph::Tex in = gi.*part.member) {
      out.*part.member = graph.optional(graph.image(part.name, {g.size, graph.desc(in).format}));
      builder.in(part.in, in).out(part.out, out.*part.member);
    }
  feed_environment(graph, builder, *pipeline.interface, environment);
  builder.params(EdgeFadeBlock{.band = band});
  return out;
}

glm::ivec2 overscan_border(glm::uvec2 size, float percent) {
  return glm::ivec2(glm::ceil(glm::vec2(size) * (percent * 0.01f)));
}

FrameView with_border(const FrameView& view, glm::ivec2 border) {
  FrameView wide = view;
  wide.size = view.size + glm::uvec2(2 * border);
  const float grow = float(wide.size.y) / float(view.size.y);
  for (scene::Camera* camera : {&wide.camera, &wide.previous_camera})
    camera->vfov = 2 * std::atan(std::tan(camera->vfov * 0.5f) * grow);
  return wide;
}

graph::Tex add_crop(graph::Graph& graph, gpu::Pipelines& pipelines, graph::Tex image, glm::ivec2 border) {
  graph::ImageDesc desc = graph.desc(image);
  desc.size = {desc.size.width - 2 * uint32_t(border.x), desc.size.height - 2 * uint32_t(border.y)};
  const graph::Tex cropped = graph.image("resolution.cropped", desc);
  graph.fullscreen("resolution.crop", pipelines.fullscreen("resolution_crop.frag"), "Cuts the border off")
      .in("source", image)
      .out("cropped", cropped)
      .params(CropBlock{.offset = border});
  return cropped;
}

}  // namespace nf::passes
