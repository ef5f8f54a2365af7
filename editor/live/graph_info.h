// The graph as the panels show it, read from the document that `nearfield graph --format json` prints.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "live/published.h"

namespace nf::editor::live {

GraphInfo make_graph_info(const nlohmann::json& document);

}  // namespace nf::editor::live
