// URIs of a glTF file: data URIs, and paths that must stay inside the scene's folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace nf::scene::gltf {

bool is_data_uri(std::string_view uri);
// The bytes of a base64 data URI; `where` names it in errors.
std::vector<uint8_t> decode_data_uri(std::string_view uri, const std::string& where);

// The existing regular file a relative URI names, symlinks resolved. Refuses everything that is not plainly inside
// `folder`: schemes, absolute paths, "..", encoded separators, links that leave.
std::filesystem::path resolve_uri(const std::filesystem::path& folder, const std::string& uri,
                                  const std::string& where);

}  // namespace nf::scene::gltf
