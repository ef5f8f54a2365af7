#include "gi/gi_inputs.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace nf::passes {
namespace {

bool is_choice(const Param& param) {
  return param.type == ParamType::Choice || param.type == ParamType::Bool;
}

}  // namespace

gpu::Defines GiPipelines::defines(std::initializer_list<Choices> choices, std::initializer_list<Extra> extras) {
  gpu::Defines all;
  for (const Extra& extra : extras)
    if (extra.value != absent) all.emplace_back(extra.name, std::to_string(extra.value));
  for (const Choices& c : choices) {
    for (const Param& param : c.table.params) {
      if (!is_choice(param)) continue;
      std::string name = std::string(c.prefix) + "_" + param.name;
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char x) { return char(std::toupper(x)); });
      all.emplace_back(name, std::to_string(int(params::get(c.table, c.data, param))));
    }
  }
  return all;
}

gpu::Pipeline GiPipelines::compute(const char* file, std::initializer_list<Choices> choices,
                                   std::initializer_list<Extra> extras) {
  values_.clear();
  for (const Choices& c : choices)
    for (const Param& param : c.table.params)
      if (is_choice(param)) values_.push_back(int32_t(params::get(c.table, c.data, param)));
  for (const Extra& extra : extras) values_.push_back(extra.value);
  values_.push_back(inspect_);
  for (const Row& row : rows_)
    if (row.file == file && row.values == values_) return row.pipeline;
  gpu::Defines all = defines(choices, extras);
  if (inspect_) all.emplace_back("INSPECT", "1");
  rows_.push_back({file, values_, pipelines_.compute(file, all)});
  return rows_.back().pipeline;
}

}  // namespace nf::passes
