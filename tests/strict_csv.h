// A reader of CSV that takes nothing but RFC 4180: CR LF at the end of every line, quotes only round whole fields, the
// same number of fields in every line.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace nf::test {

using CsvRows = std::vector<std::vector<std::string>>;

// Throws std::runtime_error saying what is wrong where.
inline CsvRows read_csv(std::string_view text) {
  CsvRows rows;
  size_t at = 0;
  const auto bad = [&](const char* what) {
    throw std::runtime_error(std::string(what) + " at byte " + std::to_string(at));
  };
  while (at < text.size()) {
    std::vector<std::string>& row = rows.emplace_back();
    for (bool more = true; more;) {
      std::string& field = row.emplace_back();
      if (at < text.size() && text[at] == '"') {
        for (++at;; ++at) {
          if (at >= text.size()) bad("open quotes");
          if (text[at] != '"')
            field += text[at];
          else if (at + 1 < text.size() && text[at + 1] == '"')
            field += text[at++];
          else
            break;
        }
        ++at;
      } else {
        for (; at < text.size() && text[at] != ',' && text[at] != '\r'; ++at) {
          if (text[at] == '"' || text[at] == '\n') bad("a quote or line feed in a plain field");
          field += text[at];
        }
      }
      more = at < text.size() && text[at] == ',';
      if (more) ++at;
    }
    if (text.substr(at, 2) != "\r\n") bad("no CR LF");
    at += 2;
    if (row.size() != rows.front().size()) bad("another number of fields");
  }
  return rows;
}

}  // namespace nf::test
