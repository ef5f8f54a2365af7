// Parameter tables: one declaration per parameter, in an X-macro list, yields the C++ struct, the table that user
// interface, command line, presets and help are made from, and the GLSL uniform block that the shader includer hands
// out. The struct *is* the block: every member is made of 4-byte scalars, so C++ layout and GLSL scalar layout are the
// same.
//
//   #define NF_BLUR_PARAMS(P)  P(Float, radius, 2.0f, 0.0f, 16.0f, "px", "Radius of the blur")
//                              P(Choice, shape, 0, 0, 1, "box|gauss", "Shape of the kernel")
//   NF_DECLARE_PARAMS(BlurParams, "blur", NF_BLUR_PARAMS)
//
// (one logical line) gives struct BlurParams {float radius; int32_t shape;}, BlurParams::table(), the ids blur.radius
// and blur.shape, and in a shader, after #include "params/blur", the uniform block instance `blur`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nf {

enum class ParamType : uint8_t { Float, Int, Bool, Choice, Vec2, Vec3, Vec4, UVec2, IVec2, Uint, Mat4 };

struct Param {
  const char* name;
  ParamType type;
  uint32_t offset, size;  // bytes
  double default_value, min, max;
  const char* unit;  // for Choice: the names, separated by '|'
  const char* help;
};

// `editable` is false for blocks that no user sets (the frame's cameras); their rows have only name, type and offset.
struct ParamTable {
  const char* prefix;
  std::span<const Param> params;
  uint32_t size;
  bool editable;
};

// A live instance of a table's struct. Editor and command line see only this; they know no pass.
struct ParamBlock {
  const ParamTable* table = nullptr;
  void* data = nullptr;
};

namespace params {

double get(const ParamTable& table, const void* data, const Param& param);
void set(const ParamTable& table, void* data, const Param& param, double value);
void reset(const ParamBlock& block);
std::string choice_name(const Param& param, int index);
// "2", "true", "gauss": how a value is written on the command line and shown in help.
std::string format(const Param& param, double value);

// Applies "prefix.name=value". Throws nf::Error: Exit::Input for an unknown id (with the nearest one there is),
// Exit::Usage for a value that does not parse or is out of range.
void assign(std::span<const ParamBlock> blocks, std::string_view assignment);

// {"prefix.name": value} of the parameters that differ from their defaults (or of all). Reading throws as assign does.
nlohmann::json to_json(std::span<const ParamBlock> blocks, bool all = false);
void from_json(std::span<const ParamBlock> blocks, const nlohmann::json& values);

// The GLSL text of `#include "params/<prefix>"`.
std::string glsl_block(const ParamTable& table);
const char* glsl_type(ParamType type);

}  // namespace params

namespace detail {
template <ParamType>
struct ParamValue;
template <>
struct ParamValue<ParamType::Float> {
  using Type = float;
};
template <>
struct ParamValue<ParamType::Int> {
  using Type = int32_t;
};
template <>
struct ParamValue<ParamType::Bool> {
  using Type = uint32_t;
};  // 0 or 1, as GLSL's uint
template <>
struct ParamValue<ParamType::Choice> {
  using Type = int32_t;
};
template <>
struct ParamValue<ParamType::Vec2> {
  using Type = glm::vec2;
};
template <>
struct ParamValue<ParamType::Vec3> {
  using Type = glm::vec3;
};
template <>
struct ParamValue<ParamType::Vec4> {
  using Type = glm::vec4;
};
template <>
struct ParamValue<ParamType::UVec2> {
  using Type = glm::uvec2;
};
template <>
struct ParamValue<ParamType::IVec2> {
  using Type = glm::ivec2;
};
template <>
struct ParamValue<ParamType::Uint> {
  using Type = uint32_t;
};
template <>
struct ParamValue<ParamType::Mat4> {
  using Type = glm::mat4;
};
}  // namespace detail

}  // namespace nf

#define NF_PARAM_MEMBER_(type, name, value, low, high, unit, help) \
  ::nf::detail::ParamValue<::nf::ParamType::type>::Type name = value;
#define NF_PARAM_ROW_(type, name, value, low, high, unit, help) \
  ::nf::Param{#name,                                            \
              ::nf::ParamType::type,                            \
              static_cast<uint32_t>(offsetof(Self, name)),      \
              sizeof(Self::name),                               \
              static_cast<double>(value),                       \
              low,                                              \
              high,                                             \
              unit,                                             \
              help},
#define NF_DECLARE_PARAMS(Struct, prefix, LIST)                                                       \
  struct Struct {                                                                                     \
    LIST(NF_PARAM_MEMBER_)                                                                            \
    static const ::nf::ParamTable& table() {                                                          \
      using Self = Struct;                                                                            \
      static const ::nf::Param rows[] = {LIST(NF_PARAM_ROW_)};                                        \
      static const ::nf::ParamTable value{prefix, rows, static_cast<uint32_t>(sizeof(Struct)), true}; \
      return value;                                                                                   \
    }                                                                                                 \
  };

// The same for a block that no user edits: LIST(F) lines are F(type, name).
#define NF_FIELD_MEMBER_(type, name) ::nf::detail::ParamValue<::nf::ParamType::type>::Type name{};
#define NF_FIELD_ROW_(type, name) \
  ::nf::Param{                    \
      #name, ::nf::ParamType::type, static_cast<uint32_t>(offsetof(Self, name)), sizeof(Self::name), 0, 0, 0, "", ""},
#define NF_DECLARE_BLOCK(Struct, prefix, LIST)                                                         \
  struct Struct {                                                                                      \
    LIST(NF_FIELD_MEMBER_)                                                                             \
    static const ::nf::ParamTable& table() {                                                           \
      using Self = Struct;                                                                             \
      static const ::nf::Param rows[] = {LIST(NF_FIELD_ROW_)};                                         \
      static const ::nf::ParamTable value{prefix, rows, static_cast<uint32_t>(sizeof(Struct)), false}; \
      return value;                                                                                    \
    }                                                                                                  \
  };
