// The slice techniques: hbao, gtao, vbao, vbgi. One dispatch each.
#pragma once

#include "gi/bitmask_params.h"
#include "gi/gi_inputs.h"
#include "gi/gi_params.h"
#include "gi/gi_result.h"
#include "gi/horizon_params.h"

namespace nf::passes {

GiResult add_hbao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const HbaoParams& params);
GiResult add_gtao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const GtaoParams& params);
GiResult add_vbao(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const VbaoParams& params);
GiResult add_vbgi(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiParams& shared,
                  const VbgiParams& params);

// What else their shaders are compiled for, STEP_EXPONENT: a whole gi.step_exponent, else 0.
GiPipelines::Extra whole_step_exponent(const GiParams& shared);

}  // namespace nf::passes
