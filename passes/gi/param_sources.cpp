#include "gi/param_sources.h"

namespace nf::passes {
namespace {

#define VB "Therrien et al. 2023 (visibility bitmask), "
#define HBIL "Mayaux 2018 (HBIL), "
#define SSAO "Colliander, Tornquist 2015 (SSAO and colour bleeding), "
#define SSDO "Ritschel et al. 2009 (SSDO), "

constexpr ParamSource rows[] = {
    {"gi.radius", VB "Algorithm 1, line 5; section 4.1"},
    {"gi.slices", VB "Algorithm 1, line 9"},
    {"gi.projection", VB "Algorithm 1, line 16"},
    {"gi.steps", VB "Algorithm 1, line 13"},
    {"gi.step_exponent", VB "section 4.3, after Figure 14"},
    {"gi.step_jitter", VB "section 4.3, Figure 14"},
    {"gi.thickness_mode", VB "section 3.1, after Figure 6"},
    {"gi.thickness", VB "Algorithm 1, lines 1 and 15"},
    {"gi.back_along", VB "Algorithm 1, line 15"},
    {"vbao.sectors", VB "Algorithm 1, line 2; section 4.1"},
    {"vbao.sector_rule", VB "Algorithm 1, line 18; section 3.1"},
    {"vbao.sector_measure", VB "equation 4; Algorithm 1, line 26"},
    {"vbao.fast_acos", VB "section 3.1: from cosines to angles"},
    {"vbao.ambient", VB "section 3.2"},
    {"vbao.regions", VB "section 3.2, Figure 8"},
    {"vbgi.emitter", VB "Algorithm 1, line 23"},
    {"vbgi.sectors", VB "Algorithm 1, line 2; section 4.1"},
    {"vbgi.sector_rule", VB "Algorithm 1, line 18; section 3.1"},
    {"vbgi.sector_measure", VB "equation 4; Algorithm 1, lines 23 and 26"},
    {"vbgi.fast_acos", VB "section 3.1: from cosines to angles"},
    {"vbgi.ambient", VB "section 3.2"},
    {"vbgi.regions", VB "section 3.2, Figure 8"},
    {"raymarch.rays", VB "section 4.3, Figure 16"},
    {"resolution.gi", VB "section 4.3; " HBIL "section 3.3"},
    {"resolution.upsample", VB "section 4.3"},
    {"feedback.reprojection", VB "section 4.3; " HBIL "section 3.2, equations 16 and 17"},
    {"hbil.space", HBIL "section 1.1"},
    {"hbil.normal_start", HBIL "section 2.1"},
    {"hbil.printed_sign", HBIL "equations 5 and 11"},
    {"hbil.reject", HBIL "section 3.4"},
    {"hbil.reject_from", HBIL "section 3.4: a"},
    {"hbil.reject_to", HBIL "section 3.4: b"},
    {"hbil.cone", HBIL "section 2.2.2, equation 12"},
    {"hbil.far", HBIL "sections 2.2.3 and 2.2.4"},
    {"ssao.samples", SSAO "The Kernel Texture; Performance"},
    {"ssao.kernel", SSAO "The Kernel Texture"},
    {"ssao.range", SSAO "SSAO Pass; Discussion, footnote 2"},
    {"ssao.range_limit", SSAO "SSAO Pass: the range check"},
    {"ssao.range_depth", SSAO "SSAO Pass: the range check"},
    {"ssao.bleed", SSAO "Calculating Colour Bleed, equation 1"},
    {"ssao.specular", SSAO "Algorithms: allLightFbo"},
    {"ssao.sender", SSAO "equation 1: A_f"},
    {"ssao.sender_area", SSAO "equation 1: A_f"},
    {"ssao.damping", SSAO "Blur Pass"},
    {"ssao.ambient_share", SSAO "Discussion"},
    {"ssao.blur", SSAO "Blur Pass"},
    {"ssao.show", SSAO "Figure 5"},
    {"ssdo.samples", SSDO "section 3: N"},
    {"ssdo.auto_radius", SSDO "section 7.2"},
    {"ssdo.directions", SSDO "section 3, the equation of L_dir"},
    {"ssdo.blocker", SSDO "section 3, Figure 2"},
    {"ssdo.fade", SSDO "section 7.2"},
    {"ssdo.bounce", SSDO "section 3, the equation of L_ind"},
    {"ssdo.sender", SSDO "section 3, the equation of L_ind: A_s"},
    {"ssdo.strength", SSDO "section 3: A_s"},
    {"ssdo.ambient", SSDO "section 3: L_in"},
    {"ssdo.blur", SSDO "section 3, Implementation Details"},
    {"shadow.screen_samples", SSDO "section 4, Figure 6"},
    {"shadow.screen_length", SSDO "section 4, Figure 6: r_max"},
};

}  // namespace

std::string_view param_source(std::string_view prefix, std::string_view name) {
  for (const ParamSource& row : rows)
    if (row.id.size() == prefix.size() + 1 + name.size() && row.id.starts_with(prefix) &&
        row.id[prefix.size()] == '.' && row.id.ends_with(name))
      return row.place;
  return {};
}

std::span<const ParamSource> param_sources() {
  return rows;
}

}  // namespace nf::passes
