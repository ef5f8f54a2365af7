// The table of output layers.
#include "aov.h"

#include <string>

namespace nf::passes {
namespace {

constexpr VkFormat one = VK_FORMAT_R32_SFLOAT, two = VK_FORMAT_R32G32_SFLOAT, four = VK_FORMAT_R32G32B32A32_SFLOAT;

const Aov table[] = {
    {"", "RGB", "Final radiance before tone mapping", four, "AOV_COPY"},
    {"direct", "RGB", "Direct light of sun, point and spot lights", four, "AOV_DIRECT"},
    {"direct_diffuse", "RGB", "Its diffuse part", four, "AOV_COPY"},
    {"indirect", "RGB", "Diffuse reflectance times gi", four, "AOV_INDIRECT"},
    {"ambient", "RGB", "Light straight from the environment, outgoing", four, "AOV_AMBIENT"},
    {"gi", "RGB", "Irradiance / pi of bounced and emitted light, after reconstruction", four, "AOV_COPY"},
    {"gi_raw", "RGB", "The same before reconstruction", four, "AOV_COPY"},
    {"visibility", "V", "Cosine-weighted visibility, 1 = open", one, "AOV_COPY"},
    {"bent", "XYZ", "Mean unoccluded direction, world space", four, "AOV_BENT"},
    {"albedo", "RGB", "Base colour", four, "AOV_ALBEDO"},
    {"normal", "XYZ", "World-space normal", four, "AOV_NORMAL"},
    {"depth", "V", "Metres along the view axis, 0 = background", one, "AOV_DEPTH"},
    {"position", "XYZ", "World-space position", four, "AOV_POSITION"},
    {"velocity", "XY", "Motion since the last frame in pixels, x right, y down", two, "AOV_COPY"},
    {"emissive", "RGB", "Emitted radiance", four, "AOV_COPY"},
    {"radiance", "RGB", "What the GI gathers from", four, "AOV_RADIANCE"},
};

// What AOV_COPY, AOV_DIRECT and AOV_INDIRECT read.
graph::Tex source_of(const Aov& aov, const FrameOutputs& o) {
  const std::string_view name = aov.name;
  if (name.empty()) return o.lit;
  if (name == "direct" || name == "direct_diffuse") return o.direct.diffuse;
  if (name == "gi_raw") return o.gi_raw.gi;
  if (name == "gi" || name == "indirect") return o.gi.gi;
  if (name == "visibility") return o.gi.visibility;
  if (name == "bent") return o.gi.bent;
  if (name == "velocity") return o.gbuffer.velocity;
  if (name == "emissive") return o.gbuffer.emissive;
  return {};
}

}  // namespace

std::span<const Aov> aovs() {
  return table;
}

const Aov& find_aov(std::string_view name) {
  std::string names;
  for (const Aov& aov : table) {
    if (aov.name == name) return aov;
    if (*aov.name) names += (names.empty() ? "" : ", ") + std::string(aov.name);
  }
  fail(Exit::Input, "unknown layer '{}': there are {}", name, names);
}

AovPass create_aovs(gpu::Pipelines& pipelines, bool environment_map) {
  AovPass pass;
  for (const Aov& aov : table) {
    const bool ambient = std::string_view(aov.name) == "ambient";
    pass.pipelines.push_back(ambient ? gpu::Pipeline{} : pipelines.fullscreen("aov.frag", {{aov.define, "1"}}));
    for (int variant = 0; ambient && variant < ambient_variants; ++variant) {
      gpu::Defines defines = ambient_defines(variant, environment_map);
      defines.emplace_back(aov.define, "1");
      pass.ambient[variant] = pipelines.fullscreen("aov.frag", defines);
    }
  }
  return pass;
}

graph::Tex add_aov(graph::Graph& graph, const AovPass& pass, const Aov& aov, const FrameOutputs& o,
                   const SceneTables& scene, const EnvironmentMaps& environment) {
  const gpu::Pipeline row = pass.pipelines[size_t(&aov - table)];
  const gpu::Pipeline pipeline = row.interface ? row : pass.ambient[ambient_variant(o.gi)];
  const graph::Tex source = source_of(aov, o);
  const gpu::ShaderInterface& interface = *pipeline.interface;
  if (interface.find("source") && !source) return {};
  const char* resource = *aov.name ? aov.name : "final";
  const graph::Tex image = graph.image(resource, {*aov.name ? o.gbuffer.size : graph.desc(o.lit).size, aov.format});
  auto builder = graph.fullscreen(resource, pipeline, aov.help);
  // The shader's variant says what it reads.
  const std::pair<const char*, graph::Tex> inputs[] = {{"source", source},
                                                       {"source2", o.direct.specular},
                                                       {"depth", o.gbuffer.depth},
                                                       {"normal", o.gbuffer.normal},
                                                       {"radiance", o.direct.radiance},
                                                       {"visibility", o.gi.visibility},
                                                       {"bent", o.gi.bent},
                                                       {"ambient", o.gi.ambient},
                                                       {"albedo", o.gbuffer.albedo},
                                                       {"material", o.gbuffer.material}};
  for (const auto& [slot, tex] : inputs)
    if (interface.find(slot)) builder.in(slot, tex);
  if (interface.find("reflectance"))
    builder.in("reflectance", graph.import("lighting.reflectance", scene.reflectance()));
  feed_environment(graph, builder, interface, environment);
  builder.out("value", image);
  return image;
}

}  // namespace nf::passes
