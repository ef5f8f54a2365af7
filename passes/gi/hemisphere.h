// Techniques that look at points or along rays in the hemisphere (ssao, ssdo, raymarch), and hbil. One dispatch each,
// and where asked for a blur of 4 x 4 pixels.
#pragma once

#include "gi/gi_inputs.h"
#include "gi/gi_params.h"
#include "gi/gi_result.h"
#include "gi/hbil_params.h"
#include "gi/raymarch_params.h"
#include "gi/ssao_params.h"
#include "gi/ssdo_params.h"

namespace nf::passes {

GiResult add_ssao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const SsaoParams& params);
GiResult add_ssdo(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const SsdoParams& params);
GiResult add_raymarch(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                      const RaymarchParams& params);
GiResult add_hbil(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const HbilParams& params);

}  // namespace nf::passes
