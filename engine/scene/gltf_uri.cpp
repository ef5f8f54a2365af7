// URIs of a glTF file. We decode exactly once and look at the result, so nothing can hide behind an encoding.
#include "scene/gltf_uri.h"

#include <algorithm>
#include <array>

#include "scene/gltf_import.h"
#include "scene/text.h"

namespace nf::scene::gltf {

namespace {

constexpr const char* advice_inside = "keep the scene's files in its own folder, under plain relative names";

constexpr std::array<int8_t, 256> base64_values() {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int8_t, 256> values{};
  for (int8_t& value : values) value = -1;
  for (size_t i = 0; i < alphabet.size(); ++i) values[static_cast<unsigned char>(alphabet[i])] = int8_t(i);
  return values;
}

std::vector<uint8_t> decode_base64(std::string_view text, const std::string& where) {
  static constexpr std::array<int8_t, 256> values = base64_values();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0, count = 0;
  for (const char c : text) {
    const int8_t value = values[static_cast<unsigned char>(c)];
    if (value < 0) refuse("{} is not valid base64", where);
    bits = bits << 6 | uint32_t(value);
    if (++count % 4 == 0) {
      bytes.insert(bytes.end(), {uint8_t(bits >> 16), uint8_t(bits >> 8), uint8_t(bits)});
    }
  }
  if (count % 4 == 1) refuse("{} is truncated base64", where);
  if (count % 4 == 2) bytes.push_back(uint8_t(bits >> 4));
  if (count % 4 == 3) bytes.insert(bytes.end(), {uint8_t(bits >> 10), uint8_t(bits >> 2)});
  return bytes;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string decode_percent(const std::string& uri, const std::string& where) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      text += uri[i];
      continue;
    }
    const int high = i + 2 < uri.size() ? hex_value(uri[i + 1]) : -1, low = high >= 0 ? hex_value(uri[i + 2]) : -1;
    if (low < 0) refuse("{} has a broken percent code in its URI '{}'", where, one_line(uri));
    const char c = static_cast<char>(high * 16 + low);
    if (c == '/' || c == '\\' || c == 0) {
      refuse_advising(advice_inside, "{} hides a path separator in its URI '{}'", where, one_line(uri));
    }
    text += c;
    i += 2;
  }
  return text;
}

void check_relative(const std::string& name, const std::string& where) {
  const auto outside = [&] {
    refuse_advising(advice_inside, "{} has the URI '{}', which leaves the scene's folder", where, one_line(name));
  };
  if (name.empty()) refuse("{} has an empty URI", where);
  if (std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; })) outside();
  // A colon before the first slash is a scheme (or a drive).
  if (name.find(':') < name.find('/') || name[0] == '/' || name.find('\\') != std::string::npos) outside();
  for (const std::filesystem::path& part : std::filesystem::path(name)) {
    if (part == "..") outside();
  }
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}

std::vector<uint8_t> decode_data_uri(std::string_view uri, const std::string& where) {
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
    refuse("{} has a data URI that is not base64", where);
  }
  return decode_base64(uri.substr(comma + 1), where);
}

std::filesystem::path resolve_uri(const std::filesystem::path& folder, const std::string& uri,
                                  const std::string& where) {
  namespace fs = std::filesystem;
  const std::string name = decode_percent(uri, where);
  check_relative(name, where);
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  const fs::path file = error ? fs::path() : fs::canonical(root / name, error);
  if (error) {
    refuse_advising("put the file beside the scene, or fix its name", "{} needs the file '{}', which is missing", where,
                    one_line(name));
  }
  if (std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first != root.end()) {
    refuse_advising(advice_inside, "{} has the URI '{}', a link that leaves the scene's folder", where, one_line(name));
  }
  if (!fs::is_regular_file(file, error)) refuse("{} has the URI '{}', which is not a file", where, one_line(name));
  return file;
}

}  // namespace nf::scene::gltf
