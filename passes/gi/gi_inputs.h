// What a GI technique is given: the surfaces in view, the light that leaves them, the environment; and its pipelines.
#pragma once

#include <cstdint>
#include <vector>

#include "environment.h"
#include "gbuffer.h"
#include "gi/inspect.h"
#include "lighting.h"
#include "noise.h"

namespace nf::passes {

struct GiInputs {
  const GBuffer& gbuffer;
  const Radiance& radiance;  // .radiance is what the technique gathers
  const EnvironmentMaps& environment;
  Noise& noise;
  InspectRequest* inspect = nullptr;  // where a pixel's records are wanted; filled in
};

// Pipelines of the techniques' shaders, one for each combination of choices that was used: every Choice and Bool of the
// given blocks is the constant PREFIX_NAME to the shader, so that its inner loops have no switches. Compiled when
// first used; throws nf::Error (Exit::Shader).
class GiPipelines {
 public:
  explicit GiPipelines(gpu::Pipelines& pipelines) : pipelines_(pipelines) {}

  struct Choices {
    const char* prefix;  // in capitals
    const ParamTable& table;
    const void* data;
  };
  // From here on shaders are those that write the records of a pixel (INSPECT), or those that do not.
  void inspect(bool on) { inspect_ = on; }
  // Another constant; one that is absent is not defined.
  struct Extra {
    const char* name;
    int32_t value;
  };
  static constexpr int32_t absent = INT32_MIN;
  static gpu::Defines defines(std::initializer_list<Choices> choices, std::initializer_list<Extra> extras = {});
  // `file` is compared by address: pass a literal, and with it always the same extras.
  gpu::Pipeline compute(const char* file, std::initializer_list<Choices> choices,
                        std::initializer_list<Extra> extras = {});

 private:
  struct Row {
    const char* file;
    std::vector<int32_t> values;
    gpu::Pipeline pipeline;
  };
  gpu::Pipelines& pipelines_;
  std::vector<Row> rows_;
  std::vector<int32_t> values_;  // scratch
  bool inspect_ = false;
};

}  // namespace nf::passes
