// The report: one HTML file that needs nothing else, made of timing documents, sweeps and pictures.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace nf::editor {

struct ReportPicture {
  std::string id, label;
  std::vector<uint8_t> png;
};

struct ReportData {
  nlohmann::json timings = nlohmann::json::array();  // nearfield.timing/1 documents
  nlohmann::json sweeps = nlohmann::json::array();   // {command, context, spec, cells}
  std::vector<ReportPicture> pictures;
};

// Adds what a file holds: a timing document, or a sweep's folder or cells.jsonl. Throws nf::Error (Exit::Input).
void read_report_input(const std::filesystem::path& input, ReportData& data);

// Pictures are kept in the file up to 20 MiB, else in a folder beside it. Returns the paths that were written.
std::vector<std::string> write_report(const std::filesystem::path& path, const ReportData& data);

// The page's parts (page.cpp.in).
extern const char *const report_html, *const report_css, *const report_js;

}  // namespace nf::editor
