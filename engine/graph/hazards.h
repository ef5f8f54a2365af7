// An independent check of a plan: it replays the frames over bytes and objects to everything that Vulkan's rules for
// execution and memory dependencies, image layouts and aliased memory forbid, and to every read that does not get what
// the declared order of passes promises. It shares no table and no idea with compile().
#pragma once

#include <string>
#include <vector>

#include "graph/plan.h"

namespace nf::graph {

// The objections, each naming frame, pass and resource; at most `limit`. Empty: the plan is sound.
//
// Per cell (a mip of a layer, or a buffer) it keeps the last write, the reads since, the stages that are known to come
// after each, what has been made available, to which access of which stage it is visible, the layout, and which pass's
// content is there; per byte of a heap the owner. A barrier counts for the bytes of the resource it names and for
// nobody else's, and where in its bytes an image keeps a cell is unknown; so the check is stricter than Vulkan.
std::vector<std::string> find_hazards(const Graph& graph, const Plan& plan, size_t limit = 20);

}  // namespace nf::graph
