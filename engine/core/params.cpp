// Everything that is derived from parameter tables: values by id, JSON, GLSL text.
#include "core/params.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.h"

namespace nf::params {
namespace {

std::vector<std::string> choices(const Param& param) {
  std::vector<std::string> names(1);
  for (const char* c = param.unit; *c; ++c) {
    if (*c == '|')
      names.emplace_back();
    else
      names.back() += *c;
  }
  return names;
}

size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (a[i] == b[j] ? 0u : 1u)});
      diagonal = above;
    }
  }
  return row.back();
}

struct Found {
  const ParamBlock* block;
  const Param* param;
};

Found find(std::span<const ParamBlock> blocks, std::string_view id) {
  std::string nearest;
  size_t best = 1000;
  for (const ParamBlock& block : blocks) {
    for (const Param& param : block.table->params) {
      const std::string candidate = fmt::format("{}.{}", block.table->prefix, param.name);
      if (candidate == id) return {&block, &param};
      if (const size_t distance = edit_distance(candidate, id); distance < best) best = distance, nearest = candidate;
    }
  }
  fail(Exit::Input, "unknown parameter '{}': did you mean '{}'? `nearfield info --params` lists them all", id, nearest);
}

double parse(const Param& param, std::string_view id, std::string_view text) {
  if (param.type == ParamType::Bool) {
    if (text == "true" || text == "1" || text == "on") return 1;
    if (text == "false" || text == "0" || text == "off") return 0;
    fail(Exit::Usage, "bad value '{}' for {}: it is a switch; use true or false", text, id);
  }
  if (param.type == ParamType::Choice) {
    const auto names = choices(param);
    const auto it = std::find(names.begin(), names.end(), text);
    if (it != names.end()) return double(it - names.begin());
    fail(Exit::Usage, "bad value '{}' for {}: use one of {}", text, id, fmt::join(names, ", "));
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    fail(Exit::Usage, "bad value '{}' for {}: it is not a number", text, id);
  return value;
}

void assign_value(const Found& found, std::string_view id, double value) {
  const Param& param = *found.param;
  if (param.type == ParamType::Int && value != std::floor(value))
    fail(Exit::Usage, "bad value {} for {}: it is a whole number", value, id);
  if (!(value >= param.min && value <= param.max))
    fail(Exit::Usage, "bad value {} for {}: the range is {} to {} {}", value, id, param.min, param.max, param.unit);
  set(*found.block->table, found.block->data, param, value);
}

}  // namespace

double get(const ParamTable& table, const void* data, const Param& param) {
  NF_CHECK(table.editable, "{} has no scalar values", table.prefix);
  const char* at = static_cast<const char*>(data) + param.offset;
  if (param.type == ParamType::Float) {
    float value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  int32_t value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

void set(const ParamTable& table, void* data, const Param& param, double value) {
  NF_CHECK(table.editable, "{} has no scalar values", table.prefix);
  char* at = static_cast<char*>(data) + param.offset;
  if (param.type == ParamType::Float) {
    const float stored = float(value);
    std::memcpy(at, &stored, sizeof stored);
  } else {
    const int32_t stored = int32_t(std::lround(value));
    std::memcpy(at, &stored, sizeof stored);
  }
}

void reset(const ParamBlock& block) {
  for (const Param& param : block.table->params) set(*block.table, block.data, param, param.default_value);
}

std::string choice_name(const Param& param, int index) {
  return choices(param).at(size_t(index));
}

std::string format(const Param& param, double value) {
  switch (param.type) {
    case ParamType::Bool:
      return value != 0 ? "true" : "false";
    case ParamType::Choice:
      return choice_name(param, int(value));
    case ParamType::Float:
      return fmt::format("{}", float(value));
    default:
      return fmt::format("{}", int64_t(value));
  }
}

void assign(std::span<const ParamBlock> blocks, std::string_view assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0)
    fail(Exit::Usage, "bad assignment '{}': write it as id=value, e.g. gi.radius=2", assignment);
  const std::string_view id = assignment.substr(0, equals);
  const Found found = find(blocks, id);
  assign_value(found, id, parse(*found.param, id, assignment.substr(equals + 1)));
}

nlohmann::json to_json(std::span<const ParamBlock> blocks, bool all) {
  nlohmann::json result = nlohmann::json::object();
  for (const ParamBlock& block : blocks) {
    for (const Param& param : block.table->params) {
      const double value = get(*block.table, block.data, param);
      // Defaults are compared as stored (float), not as written (double).
      const double standard = param.type == ParamType::Float ? double(float(param.default_value)) : param.default_value;
      if (!all && value == standard) continue;
      nlohmann::json& entry = result[fmt::format("{}.{}", block.table->prefix, param.name)];
      switch (param.type) {
        case ParamType::Bool:
          entry = value != 0;
          break;
        case ParamType::Choice:
          entry = choice_name(param, int(value));
          break;
        case ParamType::Float:
          entry = std::stod(fmt::format("{}", float(value)));
          break;
        default:
          entry = int64_t(value);
      }
    }
  }
  return result;
}

void from_json(std::span<const ParamBlock> blocks, const nlohmann::json& values) {
  if (!values.is_object()) fail(Exit::Input, "bad preset: 'params' must be an object of id: value");
  for (const auto& [id, value] : values.items()) {
    const Found found = find(blocks, id);
    if (value.is_string())
      assign_value(found, id, parse(*found.param, id, value.get<std::string>()));
    else if (value.is_boolean() && found.param->type == ParamType::Bool)
      assign_value(found, id, value.get<bool>() ? 1 : 0);
    else if (value.is_number() && found.param->type != ParamType::Bool && found.param->type != ParamType::Choice)
      assign_value(found, id, value.get<double>());
    else
      fail(Exit::Usage, "bad value {} for {}: wrong type", value.dump(), id);
  }
}

const char* glsl_type(ParamType type) {
  switch (type) {
    case ParamType::Float:
      return "float";
    case ParamType::Int:
    case ParamType::Choice:
      return "int";
    case ParamType::Bool:
    case ParamType::Uint:
      return "uint";
    case ParamType::Vec2:
      return "vec2";
    case ParamType::Vec3:
      return "vec3";
    case ParamType::Vec4:
      return "vec4";
    case ParamType::UVec2:
      return "uvec2";
    case ParamType::IVec2:
      return "ivec2";
    case ParamType::Mat4:
      return "mat4";
  }
  return "";
}

std::string glsl_block(const ParamTable& table) {
  std::string text = fmt::format("layout(scalar) uniform {0}_block {{\n", table.prefix);
  for (const Param& param : table.params) text += fmt::format("  {} {};\n", glsl_type(param.type), param.name);
  return text + fmt::format("}} {};\n", table.prefix);
}

}  // namespace nf::params
