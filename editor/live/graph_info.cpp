#include "live/graph_info.h"

#include <map>
#include <nlohmann/json.hpp>

namespace nf::editor::live {
namespace {

std::string part_text(const nlohmann::json& row) {
  return fmt::format("mip {}+{} layer {}+{}", row.at("mip").get<int>(), row.at("mips").get<int>(),
                     row.at("layer").get<int>(), row.at("layers").get<int>());
}

GraphInfo::Resource read_resource(const nlohmann::json& row) {
  GraphInfo::Resource r;
  r.name = row.at("name");
  r.buffer = row.at("kind") == "buffer";
  r.bytes = row.at("bytes");
  r.mips = row.at("mips");
  r.layers = row.at("layers");
  r.imported = row.at("imported");
  r.history = !r.imported && !row.at("transient").get<bool>();
  r.live = !row.at("first").is_null();
  if (r.live) r.first = row.at("first"), r.last = row.at("last");
  if (!row.at("heap").is_null()) r.heap = row.at("heap"), r.offset = row.at("offset");
  if (!r.buffer) {
    r.format = row.at("format");
    r.size = fmt::format("{}x{}", row.at("size")[0].get<uint32_t>(), row.at("size")[1].get<uint32_t>());
  } else {
    r.size = fmt::format("{} B", row.at("size").get<uint64_t>());
  }
  return r;
}

}  // namespace

GraphInfo make_graph_info(const nlohmann::json& document) {
  GraphInfo info;
  std::map<std::string, uint32_t> rows;
  for (const nlohmann::json& row : document.at("resources")) {
    rows.emplace(row.at("name"), uint32_t(info.resources.size()));
    info.resources.push_back(read_resource(row));
  }
  for (size_t r = 0; r < info.resources.size(); ++r)
    for (const nlohmann::json& other : document.at("resources")[r].at("alias_of"))
      info.resources[r].alias_of.push_back(uint16_t(rows.at(other)));
  // Positions count live passes only; rows of `passes` count all of them.
  std::vector<uint32_t> row_of;
  for (const nlohmann::json& row : document.at("passes")) {
    GraphInfo::Pass pass{
        .name = row.at("name"), .label = row.at("label"), .description = row.at("description"), .kind = row.at("kind")};
    pass.culled = row.at("culled");
    if (!pass.culled) row_of.push_back(uint32_t(info.passes.size()));
    for (const nlohmann::json& barrier : row.at("barriers")) {
      pass.barriers +=
          fmt::format("{} ({}): {} -> {}, {} -> {}\n", barrier.at("resource").get<std::string>(), part_text(barrier),
                      barrier.at("src").get<std::string>(), barrier.at("dst").get<std::string>(),
                      barrier.at("from").get<std::string>(), barrier.at("to").get<std::string>());
      ++pass.barrier_count;
    }
    for (const nlohmann::json& use : row.at("uses"))
      info.uses.push_back({.pass = uint32_t(info.passes.size()),
                           .resource = rows.at(use.at("resource")),
                           .read = use.at("reads"),
                           .write = use.at("writes"),
                           .mip = use.at("mip"),
                           .layer = use.at("layer"),
                           .slot = use.at("slot").is_null() ? std::string() : use.at("slot").get<std::string>()});
    info.passes.push_back(std::move(pass));
  }
  for (GraphInfo::Resource& r : info.resources)
    if (r.live) r.first = row_of.at(r.first), r.last = row_of.at(r.last);
  const nlohmann::json& memory = document.at("memory");
  info.placed = memory.at("placed_bytes");
  info.max_live = memory.at("max_live_bytes");
  info.unaliased = memory.at("unaliased_bytes");
  for (const nlohmann::json& heap : memory.at("heaps")) info.heaps.push_back(heap);
  return info;
}

}  // namespace nf::editor::live
