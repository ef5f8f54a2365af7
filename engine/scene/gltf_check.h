// Checked access to a JSON object of a glTF document: every problem names the member by its path. Shared by the parts
// of check_document.
#pragma once

#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>

#include "scene/gltf_import.h"
#include "scene/text.h"

namespace nf::scene::gltf {

inline constexpr int64_t no_limit = int64_t(1) << 53;  // beyond it JSON numbers lose whole values

// A JSON object with its path in the document.
struct At {
  const nlohmann::json& value;
  std::string path;

  std::string key(const char* name) const { return path.empty() ? name : path + "." + name; }
  bool has(const char* name) const { return value.contains(name); }

  void require(const char* name) const {
    if (!has(name)) refuse("{} is missing", key(name));
  }

  void integer(const char* name, int64_t least, int64_t most) const {
    if (has(name)) check_integer(value[name], key(name), least, most);
  }
  static void check_integer(const nlohmann::json& number, const std::string& where, int64_t least, int64_t most) {
    if (!number.is_number_integer()) refuse("{} is not a whole number", where);
    const bool huge = number.is_number_unsigned() && number.get<uint64_t>() > uint64_t(no_limit);
    if (huge || number.get<int64_t>() < least || number.get<int64_t>() > most) {
      refuse("{} is {}, which is out of range", where, number.dump());
    }
  }

  // A row of a section of the document.
  void index(const char* name, const char* section, size_t rows) const {
    if (has(name)) check_index(value[name], key(name), section, rows);
  }
  static void check_index(const nlohmann::json& number, const std::string& where, const char* section, size_t rows) {
    if (!number.is_number_integer()) refuse("{} is not a whole number", where);
    const bool inside = number.is_number_unsigned() && number.get<uint64_t>() < rows;
    if (!inside) refuse("{} is {}, but the file has {} {}", where, number.dump(), rows, section);
  }

  void number(const char* name) const {
    if (has(name)) check_number(value[name], key(name));
  }
  static void check_number(const nlohmann::json& number, const std::string& where) {
    if (!number.is_number()) refuse("{} is not a number", where);
    if (!(std::abs(number.get<double>()) <= double(std::numeric_limits<float>::max()))) {
      refuse("{} is not a finite number", where);
    }
  }

  // A list of rows of a section of the document.
  void indices(const char* name, const char* section, size_t rows) const {
    if (!has(name)) return;
    if (!value[name].is_array()) refuse("{} is not a list", key(name));
    for (const nlohmann::json& row : value[name]) check_index(row, key(name), section, rows);
  }

  void numbers(const char* name, size_t count) const {
    if (!has(name)) return;
    const nlohmann::json& list = value[name];
    if (!list.is_array() || list.size() != count) refuse("{} is not a list of {} numbers", key(name), count);
    for (const nlohmann::json& element : list) check_number(element, key(name));
  }

  void number_list(const char* name) const {
    if (!has(name)) return;
    if (!value[name].is_array()) refuse("{} is not a list", key(name));
    for (const nlohmann::json& element : value[name]) check_number(element, key(name));
  }

  void text(const char* name) const {
    if (has(name) && !value[name].is_string()) refuse("{} is not a text", key(name));
  }
  // A text that is one of a list.
  void word(const char* name, std::initializer_list<const char*> words) const {
    text(name);
    if (!has(name)) return;
    const std::string& given = value[name].get_ref<const std::string&>();
    for (const char* known : words) {
      if (given == known) return;
    }
    refuse("{} is '{}'", key(name), one_line(given, 40));
  }
  void flag(const char* name) const {
    if (has(name) && !value[name].is_boolean()) refuse("{} is neither true nor false", key(name));
  }

  // Calls `check` with the member, which must be an object, when it is there.
  template <class Check>
  void object(const char* name, const Check& check) const {
    if (!has(name)) return;
    if (!value[name].is_object()) refuse("{} is not an object", key(name));
    check(At{value[name], key(name)});
  }
  template <class Check>
  void objects(const char* name, const Check& check) const {
    if (!has(name)) return;
    if (!value[name].is_array()) refuse("{} is not a list", key(name));
    for (size_t i = 0; i < value[name].size(); ++i) {
      const nlohmann::json& element = value[name][i];
      std::string where = fmt::format("{}[{}]", key(name), i);
      if (!element.is_object()) refuse("{} is not an object", where);
      check(At{element, std::move(where)});
    }
  }

  // The same for the member `name` of `extensions`.
  template <class Check>
  void extension(const char* name, const Check& check) const {
    object("extensions", [&](const At& extensions) { extensions.object(name, check); });
  }

  size_t rows(const char* name) const { return has(name) && value[name].is_array() ? value[name].size() : 0; }
};

void check_materials(const At& root);
void check_cameras_and_lights(const At& root);
void check_skins_and_animations(const At& root);

}  // namespace nf::scene::gltf
