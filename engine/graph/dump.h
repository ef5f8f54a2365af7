// A graph and its plan as text for people, as JSON (`nearfield.graph/1`) and as Graphviz; the difference of two plans.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "graph/plan.h"

namespace nf::graph {

// Told apart: the two sides of a history, and images that share a name ("denoise.state #2" is the second of them).
std::string resource_name(const Graph& graph, uint16_t resource);
// The same of passes, whose names group their times: each tile of a shadow map has its own.
std::string pass_label(const Graph& graph, uint32_t pass);

nlohmann::json to_json(const Graph& graph, const Plan& plan);
std::string to_text(const Graph& graph, const Plan& plan);
// Graphviz: boxes are passes, ellipses resources; culled passes are grey.
std::string to_dot(const Graph& graph, const Plan& plan);
// What changes from one plan to another: passes that come and go, barriers, bytes.
std::string diff_text(const Graph& a, const Plan& plan_a, const Graph& b, const Plan& plan_b);

}  // namespace nf::graph
