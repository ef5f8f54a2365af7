// The table of GI techniques. Editor, command line and frame know a technique only by its row.
#pragma once

#include <span>
#include <string_view>

#include "gi/gi_inputs.h"
#include "gi/gi_result.h"
#include "gi/hemisphere.h"
#include "gi/slices.h"

namespace nf::passes {

// Parameter values of every technique; those of the others are kept when one is chosen.
struct GiSettings {
  GiParams shared;
  HbaoParams hbao;
  GtaoParams gtao;
  VbaoParams vbao;
  VbgiParams vbgi;
  HbilParams hbil;
  SsaoParams ssao;
  SsdoParams ssdo;
  RaymarchParams raymarch;
};

struct Technique {
  const char* id;
  const char* name;
  const char* paper;    // where it comes from
  const char* outputs;  // which members of GiResult it gives
  // What makes it the form that the paper prints, errata included, as "id=value": the defaults are the radiometric
  // form. Empty when there is no other form.
  std::span<const char* const> paper_mode;
  GiResult (*add)(graph::Graph&, GiPipelines&, const GiInputs&, const GiSettings&);
  ParamBlock (*params)(GiSettings&);  // private parameters; an empty block when there are none
  // What it takes the screen for whatever gi.thickness_mode and gi.radius_mode say: solid without end behind what is
  // seen, as a horizon hides all below it; within a ball of gi.radius.
  bool infinitely_thick = false, in_ball = false;
  // Whether, as set, it takes the scene's own radius for gi.radius (scene/peaks.h).
  bool (*finds_radius)(const GiSettings&) = nullptr;
  // Whether, as set, it gathers direct specular light, too.
  bool (*gathers_specular)(const GiSettings&) = nullptr;
};

std::span<const Technique> techniques();
// Throws nf::Error (Exit::Input) naming the techniques there are.
const Technique& find_technique(std::string_view id);

}  // namespace nf::passes
