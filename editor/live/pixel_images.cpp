#include "live/pixel_images.h"

#include <cstring>

#include "graph/dump.h"
#include "packed.h"

namespace nf::editor::live {

glm::uvec2 covering_texel(glm::uvec2 pixel, glm::uvec2 picture, glm::ivec2 border, glm::uvec2 image) {
  const glm::uvec2 whole = picture + glm::uvec2(2 * border);
  const bool cropped = border != glm::ivec2(0) && image == picture;
  const glm::uvec2 full = cropped ? picture : whole, at = cropped ? pixel : pixel + glm::uvec2(border);
  glm::uvec2 texel;
  for (int i = 0; i < 2; ++i) {
    const uint32_t factor = std::max((full[i] + image[i] / 2) / std::max(image[i], 1u), 1u);
    const bool even = full[i] / factor == image[i] || (full[i] + factor - 1) / factor == image[i];
    texel[i] = even ? at[i] / factor : uint32_t(uint64_t(at[i]) * image[i] / full[i]);
  }
  return glm::min(texel, image - 1u);
}

std::vector<ImageValue> read_pixel(graph::Graph& graph, size_t resources, glm::uvec2 pixel, glm::uvec2 picture,
                                   glm::ivec2 border) {
  std::vector<graph::Probe> probes = graph::last_states(graph, resources);
  std::vector<ImageValue> out;
  for (graph::Probe& probe : probes) {
    const graph::ResourceRow& row = graph.resources[probe.resource];
    const graph::Size size = graph::size_of(row.desc, probe.mip);
    ImageValue& value = out.emplace_back();
    value.name = graph::resource_name(graph, probe.resource);
    value.format = gpu::format_name(row.desc.format);
    value.pass = graph.passes[probe.pass].name;
    value.size = {size.width, size.height};
    value.mip = probe.mip, value.mips = row.desc.mips;
    value.layer = probe.layer, value.layers = row.desc.layers;
    value.of_view = passes::shows_view(row.name);
    value.texel = covering_texel(pixel, picture, border, value.size);
    probe.name = pixel_readback;
    probe.texel = graph::Texel{value.texel.x, value.texel.y};
  }
  for (size_t i = probes.size(); i-- > 0;)
    if (out[i].of_view)
      if (const std::string fault = graph::add_probe(graph, probes[i]); !fault.empty())
        fail(Exit::Internal, "{}", fault);
  return out;
}

void take_texel(const graph::Readback& readback, ImageValue& value) {
  if (readback.desc.format != VK_FORMAT_R32_UINT) {
    uint32_t channels = 0;
    value.values = graph::to_floats(readback, channels);
    return;
  }
  uint32_t bits = 0;
  std::memcpy(&bits, readback.texels.data(), sizeof bits);
  value.numbers = {bits};
  const std::string name = value.name.substr(0, value.name.find(" #"));
  const std::string stem = name.ends_with(".prev") ? name.substr(0, name.size() - 5) : name;
  if (const auto unpacked = passes::unpack_texel(stem, {value.size.x, value.size.y}, bits)) {
    value.meaning = unpacked->meaning;
    value.unpacked = unpacked->values;
  }
}

}  // namespace nf::editor::live
