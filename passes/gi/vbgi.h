// Visibility bitmasks with indirect diffuse light (Therrien, Levesque, Gilet 2023), in radiometric form.
#pragma once

#include "gbuffer.h"
#include "gi/gi_params.h"
#include "gi/gi_result.h"
#include "gi/vbgi_params.h"
#include "lighting.h"

namespace nf::passes {

NF_DECLARE_PARAMS(VbgiParams, "vbgi", NF_VBGI_PARAMS)

struct VbgiPass {
  gpu::Pipeline trace;
};
VbgiPass create_vbgi(gpu::Pipelines& pipelines);
GiResult add_vbgi(graph::Graph& graph, const VbgiPass& pass, const GBuffer& gbuffer, const Radiance& direct,
                  const GiParams& shared, const VbgiParams& params);

}  // namespace nf::passes
