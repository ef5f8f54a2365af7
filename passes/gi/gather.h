// What the passes of ssao, ssdo, raymarch and hbil share: their images by name, and the blur.
#pragma once

#include "gi/gi_inputs.h"
#include "gi/gi_result.h"

namespace nf::passes {

struct GatherNames {
  const char *visibility, *bent, *gi, *ambient;
};

// Declares an image for each output slot that the shader has (visibility, bent, light, ambient), feeds the inputs that
// it has (depth, normal, radiance, albedo, material, environment, noise), one thread a pixel.
GiResult add_gather(graph::Graph& graph, graph::PassBuilder& pass, const gpu::ShaderInterface& interface,
                    const GiInputs& inputs, const GatherNames& names);

// Averages 4 x 4 pixels of visibility, gi and ambient; `edges`: of one surface only. The bent normal stays.
GiResult add_gather_blur(graph::Graph& graph, GiPipelines& pipelines, const GiInputs& inputs, const GiResult& raw,
                         const char* name, const GatherNames& names, bool edges);

}  // namespace nf::passes
