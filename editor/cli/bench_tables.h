// The papers' tables as ratios on this device: a preset set that is a data file, content/presets/NAME/tables.json.
// Each table is settings in rows and columns, measured interleaved on one renderer.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/measure.h"

namespace nf::editor {

inline constexpr const char* paper_tables_file = "tables.json";

class PaperTables {
 public:
  // Throws nf::Error (Exit::Input).
  explicit PaperTables(const std::filesystem::path& file);
  // Every table of it; false when interrupted. What comes out is then not complete.
  bool run(gpu::Device& device, scene::Scene& scene, passes::Renderer& renderer, const passes::FrameView& view,
           const MeasureOptions& method, const std::function<void(const std::string&)>& notice);
  // nearfield.paper_tables_result/1: costs in ms, ratios, published ones.
  nlohmann::json document() const;
  std::string markdown(const std::string& device, bool software, const std::string& scene,
                       const MeasureOptions& method) const;

 private:
  bool run_table(nlohmann::json& table, Meter& meter);
  bool run_stages(nlohmann::json& table, Meter& meter);
  nlohmann::json spec_, results_ = nlohmann::json::array();
  bool software_ = false;
};

}  // namespace nf::editor
