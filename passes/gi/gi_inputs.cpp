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

gpu::Defines GiPipelines::defines(std::initializer_list<Choices> choices, gpu::Defines more) {
  for (const Choices& c : choices) {
    for (const Param& param : c.table.params) {
      if (!is_choice(param)) continue;
      std::string name = std::string(c.prefix) + "_" + param.name;
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char x) { return char(std::toupper(x)); });
      more.emplace_back(name, std::to_string(int(params::get(c.table, c.data, param))));
    }
  }
  return more;
}

gpu::Pipeline GiPipelines::compute(const char* file, std::initializer_list<Choices> choices, const gpu::Defines& more) {
  values_.clear();
  for (const Choices& c : choices)
    for (const Param& param : c.table.params)
      if (is_choice(param)) values_.push_back(int32_t(params::get(c.table, c.data, param)));
  for (const Row& row : rows_)
    if (row.file == file && row.values == values_ && row.more == more) return row.pipeline;
  rows_.push_back({file, more, values_, pipelines_.compute(file, defines(choices, more))});
  return rows_.back().pipeline;
}

}  // namespace nf::passes
