// Reading what was measured, and putting the page together.
#include "report/report.h"

#include <fstream>

#include "core/error.h"
#include "image/file.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr size_t most_inline_bytes = 20u << 20;

std::string base64(const std::vector<uint8_t>& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t have = std::min<size_t>(bytes.size() - i, 3);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (k < have ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k) out += k <= have ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void replace(std::string& text, const std::string& mark, const std::string& with) {
  const size_t at = text.find(mark);
  NF_CHECK(at != std::string::npos, "the page has no {}", mark);
  text.replace(at, mark.size(), with);
}

// A picture that is not there is left out: figures are worth showing without it.
void add_picture(const fs::path& folder, const std::string& name, const std::string& label, ReportData& data) {
  const fs::path path = folder / name;
  std::error_code error;
  if (name.empty() || !fs::is_regular_file(path, error)) return;
  for (const ReportPicture& known : data.pictures)
    if (known.id == name) return;
  data.pictures.push_back({name, label, image::read_file(path)});
}

json parse(const fs::path& path, const std::string& text) {
  json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) fail(Exit::Input, "cannot read '{}': it is not JSON", path.string());
  return value;
}

std::string text_of(const fs::path& path) {
  const std::vector<uint8_t> bytes = image::read_file(path);
  return {bytes.begin(), bytes.end()};
}

void read_sweep(const fs::path& folder, ReportData& data) {
  json sweep = {{"cells", json::array()}};
  std::ifstream in(folder / "cells.jsonl");
  if (!in) fail(Exit::Input, "cannot read '{}': no cells.jsonl in it; is it a sweep's folder?", folder.string());
  for (std::string line; std::getline(in, line);) {
    if (in.eof()) break;  // a line without its end was cut off by a crash
    json cell = parse(folder / "cells.jsonl", line);
    if (cell.value("schema", "") != "nearfield.cell/1")
      fail(Exit::Input, "cannot read '{}': a line is no nearfield.cell/1", (folder / "cells.jsonl").string());
    if (sweep["context"].is_null()) sweep["context"] = cell["context"];
    cell.erase("context");
    if (!cell.value("reference_picture", "").empty())
      add_picture(folder, cell["reference_picture"], "reference of " + cell.value("place", ""), data);
    sweep["cells"].push_back(std::move(cell));
  }
  for (const json& cell : sweep["cells"]) add_picture(folder, cell.value("picture", ""), cell["id"], data);
  if (fs::exists(folder / "sweep.json")) {
    const json plan = parse(folder / "sweep.json", text_of(folder / "sweep.json"));
    sweep["spec"] = plan.value("spec", json());
    sweep["command"] = plan.value("command", "");
  }
  data.sweeps.push_back(std::move(sweep));
}

}  // namespace

void read_report_input(const fs::path& input, ReportData& data) {
  if (fs::is_directory(input)) return read_sweep(input, data);
  if (input.filename() == "cells.jsonl") return read_sweep(input.parent_path(), data);
  json document = parse(input, text_of(input));
  if (!document.is_object() || document.value("schema", "") != "nearfield.timing/1")
    fail(Exit::Input, "cannot report on '{}': it is neither a nearfield.timing/1 document nor a sweep's folder",
         input.string());
  for (const json& run : document["runs"])
    add_picture(input.parent_path(), run.value("picture", ""), run["name"], data);
  data.timings.push_back(std::move(document));
}

std::vector<std::string> write_report(const fs::path& path, const ReportData& data) {
  size_t bytes = 0;
  for (const ReportPicture& picture : data.pictures) bytes += picture.png.size() * 4 / 3;
  const bool inside = bytes <= most_inline_bytes;
  std::vector<std::string> written = {path.string()};
  json pictures = json::array();
  const std::string folder = path.stem().string() + "_files";
  for (size_t i = 0; i < data.pictures.size(); ++i) {
    const ReportPicture& picture = data.pictures[i];
    std::string source = "data:image/png;base64,";
    if (inside) {
      source += base64(picture.png);
    } else {
      source = fmt::format("{}/{}.png", folder, i);
      std::error_code error;
      fs::create_directories(path.parent_path() / folder, error);
      image::write_file(path.parent_path() / source, picture.png);
      written.push_back((path.parent_path() / source).string());
    }
    pictures.push_back({{"id", picture.id}, {"label", picture.label}, {"source", source}});
  }
  std::string text = json({{"timings", data.timings}, {"sweeps", data.sweeps}, {"pictures", pictures}})
                         .dump(-1, ' ', false, json::error_handler_t::replace);
  // Nothing in the data may end the element that holds it.
  for (size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
  std::string page = report_html;
  replace(page, "/*CSS*/", report_css);
  replace(page, "/*DATA*/", text);
  const size_t script = page.rfind("/*JS*/");
  page.replace(script, 6, report_js);
  image::write_file(path, page);
  return written;
}

}  // namespace nf::editor
