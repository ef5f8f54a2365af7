// A graph and its plan as text for people and as JSON (`nearfield.graph/1`) for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "graph/plan.h"

namespace nf::graph {

nlohmann::json to_json(const Graph& graph, const Plan& plan);
std::string to_text(const Graph& graph, const Plan& plan);

}  // namespace nf::graph
