// Names and texts out of files, made fit for a log line.
#pragma once

#include <string>
#include <string_view>

namespace nf::scene {

// `text` with control characters replaced by '?', cut to `limit` bytes: what comes from a file must not break a line.
std::string one_line(std::string_view text, size_t limit = 200);

}  // namespace nf::scene
