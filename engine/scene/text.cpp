// Names and texts out of files, made fit for a log line.
#include "scene/text.h"

namespace nf::scene {

std::string one_line(std::string_view text, size_t limit) {
  std::string line(text.substr(0, limit));
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  if (text.size() > limit) line += "...";
  return line;
}

}  // namespace nf::scene
