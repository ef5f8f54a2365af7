// The table of GI techniques. Editor, command line and frame know a technique only by its row.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "gbuffer.h"
#include "gi/gi_result.h"
#include "gi/vbgi.h"
#include "lighting.h"

namespace nf::passes {

// Parameter values of every technique; those of the others are kept when one is chosen.
struct GiSettings {
  GiParams shared;
  VbgiParams vbgi;
};

struct GiPipelines {
  VbgiPass vbgi;
};
GiPipelines create_gi(gpu::Pipelines& pipelines);

struct Technique {
  const char* id;
  const char* name;
  const char* paper;    // where it comes from
  const char* outputs;  // which members of GiResult it gives
  bool paper_mode;      // whether the form as printed exists beside the radiometric one
  GiResult (*add)(graph::Graph&, const GiPipelines&, const GBuffer&, const Radiance&, const GiSettings&);
  ParamBlock (*params)(GiSettings&);  // private parameters; an empty block when there are none
};

std::span<const Technique> techniques();
// Throws nf::Error (Exit::Input) naming the techniques there are.
const Technique& find_technique(std::string_view id);

}  // namespace nf::passes
