// The technique table.
#include "gi/techniques.h"

#include <string>

namespace nf::passes {
namespace {

const Technique table[] = {
    {"none", "No screen-space GI", "", "", false,
     [](graph::Graph&, const GiPipelines&, const GBuffer&, const Radiance&, const GiSettings&) { return GiResult{}; },
     [](GiSettings&) { return ParamBlock{}; }},
    {"vbgi", "Visibility bitmask GI",
     "Therrien, Levesque, Gilet: Screen Space Indirect Lighting with Visibility Bitmask (2023)", "visibility, gi",
     false,
     [](graph::Graph& graph, const GiPipelines& p, const GBuffer& g, const Radiance& r, const GiSettings& s) {
       return add_vbgi(graph, p.vbgi, g, r, s.shared, s.vbgi);
     },
     [](GiSettings& s) {
       return ParamBlock{&VbgiParams::table(), &s.vbgi};
     }},
};

}  // namespace

GiPipelines create_gi(gpu::Pipelines& pipelines) {
  return {create_vbgi(pipelines)};
}

std::span<const Technique> techniques() {
  return table;
}

const Technique& find_technique(std::string_view id) {
  std::string names;
  for (const Technique& technique : table) {
    if (technique.id == id) return technique;
    names += (names.empty() ? "" : ", ") + std::string(technique.id);
  }
  fail(Exit::Input, "unknown technique '{}': this version has {}", id, names);
}

}  // namespace nf::passes
