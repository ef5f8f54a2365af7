// Whole files of bytes: read at once, written through a temporary file so that a reader never meets half of one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace nf::image {

// Regular files only. Throws nf::Error (Exit::Input).
std::vector<uint8_t> read_file(const std::filesystem::path& path);

// Writes beside the target and renames; on failure nothing is left behind and the old target is untouched. A link is
// followed, a device or pipe is written to directly. Throws nf::Error (Exit::Output).
void write_file(const std::filesystem::path& path, std::span<const uint8_t> bytes);
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace nf::image
