// Where a parameter comes from: the place in its paper. Most have none.
#pragma once

#include <span>
#include <string_view>

namespace nf::passes {

// "Therrien et al. 2023, Algorithm 1, line 23"; empty: the parameter is not from a paper.
std::string_view param_source(std::string_view prefix, std::string_view name);

struct ParamSource {
  std::string_view id, place;
};
// All that have one; for the test that each is there.
std::span<const ParamSource> param_sources();

}  // namespace nf::passes
