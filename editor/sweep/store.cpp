// Finished cells on disk.
#include <algorithm>
#include <fcntl.h>
#include <fstream>
#include <map>
#include <unistd.h>

#include "image/file.h"
#include "sweep/sweep.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<json> read_lines(const fs::path& file, uint64_t& whole_bytes) {
  std::vector<json> cells;
  whole_bytes = 0;
  std::ifstream in(file, std::ios::binary);
  for (std::string line; std::getline(in, line) && !in.eof(); whole_bytes += line.size() + 1) {
    json cell = json::parse(line, nullptr, false);
    if (!cell.is_object() || cell.value("schema", "") != "nearfield.cell/1" || !cell.contains("id"))
      fail(Exit::Input, "cannot go on from '{}': its line {} is no nearfield.cell/1; choose another folder",
           file.string(), cells.size() + 1);
    cells.push_back(std::move(cell));
  }
  return cells;
}

}  // namespace

SweepStore::SweepStore(fs::path file) : file_(std::move(file)) {
  uint64_t whole = 0;
  cells_ = read_lines(file_, whole);
  std::error_code error;
  if (fs::exists(file_, error) && fs::file_size(file_, error) > whole) fs::resize_file(file_, whole, error);
  if (error) fail(Exit::Output, "cannot mend '{}': {}", file_.string(), error.message());
  for (const json& cell : cells_) ids_.insert(cell["id"].get<std::string>());
}

void SweepStore::add(const json& cell) {
  const std::string line = cell.dump() + "\n";
  const int out = open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
  bool good = out >= 0;
  for (size_t at = 0; good && at < line.size();) {
    const ssize_t count = write(out, line.data() + at, line.size() - at);
    good = count > 0;
    at += size_t(std::max<ssize_t>(count, 0));
  }
  good = good && fsync(out) == 0;
  if (out >= 0) close(out);
  if (!good) fail(Exit::Output, "cannot write '{}': is the folder there, and the disk not full?", file_.string());
  cells_.push_back(cell);
  ids_.insert(cell["id"].get<std::string>());
}

std::vector<std::string> merge_parts(const fs::path& folder, const SweepSpec& spec) {
  std::map<std::string, json> found;
  uint64_t bytes = 0;
  const auto take = [&](const fs::path& file) {
    for (json& cell : read_lines(file, bytes)) {
      const std::string id = cell["id"];
      found.emplace(id, std::move(cell));
    }
  };
  take(folder / "cells.jsonl");
  std::vector<fs::path> parts;
  if (fs::is_directory(folder / "parts"))
    for (const auto& entry : fs::directory_iterator(folder / "parts"))
      if (entry.path().extension() == ".jsonl") parts.push_back(entry.path());
  std::sort(parts.begin(), parts.end());
  for (const fs::path& part : parts) take(part);

  std::vector<std::string> missing;
  std::string text;
  for (const SweepCell& cell : plan_cells(spec)) {
    const auto row = found.find(cell.id(spec));
    if (row == found.end()) {
      missing.push_back(cell.id(spec));
      continue;
    }
    text += row->second.dump() + "\n";
    found.erase(row);
  }
  for (const auto& [id, cell] : found) text += cell.dump() + "\n";  // of narrowing
  image::write_file(folder / "cells.jsonl", text);
  return missing;
}

}  // namespace nf::editor
