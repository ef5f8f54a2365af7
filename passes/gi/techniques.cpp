// The technique table.
#include "gi/techniques.h"

#include <string>

namespace nf::passes {
namespace {

// The forms as printed. Algorithm 1 of the visibility-bitmask paper with the post's readings where it is silent: equal
// angles, widths rounded, slices uniform on the screen, thickness along the receiver's view ray, the emitter's cosine.
constexpr const char* vbao_paper[] = {"gi.slice_measure=screen",  "gi.projection=view_cosine",
                                      "gi.back_along=receiver_v", "vbao.span=point",
                                      "vbao.sector_rule=round",   "vbao.sector_measure=uniform_angle"};
constexpr const char* vbgi_paper[] = {
    "gi.slice_measure=screen", "gi.projection=view_cosine", "gi.back_along=receiver_v",         "vbgi.span=point",
    "vbgi.sector_rule=round",  "vbgi.emitter=cosine",       "vbgi.sector_measure=uniform_angle"};
constexpr const char* gtao_paper[] = {"gi.slice_measure=screen", "gi.projection=view_cosine",
                                      "gi.radius_mode=ball_falloff"};
constexpr const char* hbao_paper[] = {"gi.slice_measure=screen", "gi.projection=view_cosine", "gi.radius_mode=ball",
                                      "hbao.falloff=quadratic", "hbao.bias=30"};

// Horizon angles in the local camera space, the sign of equation 5, light blended along the slice, acos(1 - AO).
constexpr const char* hbil_paper[] = {"hbil.space=local",  "hbil.printed_sign=true", "hbil.reject=running",
                                      "hbil.cone=printed", "hbil.far=factor",        "gi.step_exponent=1"};
constexpr const char* ssao_paper[] = {"gi.noise=4x4",   "ssao.kernel=chapman", "ssao.range=quadratic",
                                      "ssao.self=bias", "ssao.sender=point",   "ssao.damping=0.05",
                                      "ssao.blur=true", "ssao.specular=true"};
constexpr const char* ssdo_paper[] = {"gi.noise=4x4", "ssdo.directions=uniform", "ssdo.sender=clamped",
                                      "ssdo.fade=0.25", "ssdo.blur=true"};

const Technique table[] = {
    {"none",
     "No screen-space GI",
     "",
     "",
     {},
     [](graph::Graph&, GiPipelines&, const GiInputs&, const GiSettings&) { return GiResult{}; },
     [](GiSettings&) { return ParamBlock{}; }},
    {"hbao", "Horizon-based ambient occlusion",
     "Bavoil, Sainz, Dimitrov: Image-Space Horizon-Based Ambient Occlusion (2008)", "visibility, bent", hbao_paper,
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_hbao(graph, pipelines, in, s.shared, s.hbao);
     },
     [](GiSettings& s) {
       return ParamBlock{&HbaoParams::table(), &s.hbao};
     },
     true},
    {"gtao", "Ground-truth ambient occlusion",
     "Jimenez, Wu, Pesce, Jarabo: Practical Realtime Strategies for Accurate Indirect Occlusion (2016)",
     "visibility, bent", gtao_paper,
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_gtao(graph, pipelines, in, s.shared, s.gtao);
     },
     [](GiSettings& s) {
       return ParamBlock{&GtaoParams::table(), &s.gtao};
     },
     true},
    {"vbao", "Visibility bitmask AO",
     "Therrien, Levesque, Gilet: Screen Space Indirect Lighting with Visibility Bitmask (2023)",
     "visibility, bent, ambient", vbao_paper,
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_vbao(graph, pipelines, in, s.shared, s.vbao);
     },
     [](GiSettings& s) {
       return ParamBlock{&VbaoParams::table(), &s.vbao};
     }},
    {"vbgi", "Visibility bitmask GI",
     "Therrien, Levesque, Gilet: Screen Space Indirect Lighting with Visibility Bitmask (2023)",
     "visibility, bent, gi, ambient", vbgi_paper,
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_vbgi(graph, pipelines, in, s.shared, s.vbgi);
     },
     [](GiSettings& s) {
       return ParamBlock{&VbgiParams::table(), &s.vbgi};
     }},
    {"hbil", "Horizon-based indirect lighting", "Mayaux: Horizon-Based Indirect Lighting (2018)",
     "visibility, bent, gi, ambient", hbil_paper,
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_hbil(graph, pipelines, in, s.shared, s.hbil);
     },
     [](GiSettings& s) {
       return ParamBlock{&HbilParams::table(), &s.hbil};
     },
     true},
    {"ssao", "SSAO with colour bleeding",
     "Colliander, Tornquist: Screen Space Ambient Occlusion & Colour Bleeding (2015), after Chapman (2011)",
     "visibility, gi", ssao_paper,
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_ssao(graph, pipelines, in, s.shared, s.ssao);
     },
     [](GiSettings& s) {
       return ParamBlock{&SsaoParams::table(), &s.ssao};
     },
     true, true, nullptr, [](const GiSettings& s) { return s.ssao.bleed && s.ssao.specular; }},
    {"ssdo", "Screen-space directional occlusion",
     "Ritschel, Grosch, Seidel: Approximating Dynamic Global Illumination in Image Space (2009)",
     "visibility, bent, gi, ambient", ssdo_paper,
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_ssdo(graph, pipelines, in, s.shared, s.ssdo);
     },
     [](GiSettings& s) {
       return ParamBlock{&SsdoParams::table(), &s.ssdo};
     },
     true, true, [](const GiSettings& s) { return s.ssdo.auto_radius != 0; }},
    {"raymarch",
     "Rays through the depth buffer",
     "The baseline of Therrien, Levesque, Gilet (2023), Figure 16",
     "visibility, bent, gi, ambient",
     {},
     [](graph::Graph& graph, GiPipelines& pipelines, const GiInputs& in, const GiSettings& s) {
       return add_raymarch(graph, pipelines, in, s.shared, s.raymarch);
     },
     [](GiSettings& s) {
       return ParamBlock{&RaymarchParams::table(), &s.raymarch};
     },
     true,
     true},
};

}  // namespace

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
