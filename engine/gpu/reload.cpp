// Programs compiled anew in place, and compilers' words turned into places in files.
#include "gpu/reload.h"

#include <algorithm>
#include <sstream>

#include "gpu/pipeline.h"

namespace nf::gpu {
namespace {

// "file:line: message"; a line without such a head is a fault of the whole file, or of nobody's.
ReloadError parse(const std::string& text) {
  const size_t colon = text.find(": ");
  const std::string head = text.substr(0, colon == text.npos ? 0 : colon);
  const size_t number = head.rfind(':');
  ReloadError error;
  error.message = colon == text.npos ? text : text.substr(colon + 2);
  if (number != head.npos && number + 1 < head.size() &&
      std::all_of(head.begin() + ptrdiff_t(number) + 1, head.end(), [](char c) { return c >= '0' && c <= '9'; })) {
    error.file = head.substr(0, number);
    error.line = uint32_t(std::strtoul(head.c_str() + number + 1, nullptr, 10));
  } else if (head.find(' ') == head.npos) {
    error.file = head;
  } else {
    error.message = text;
  }
  return error;
}

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

// glslang tells no column, but begins with the word it means: 'colour' : undeclared identifier.
uint32_t column_of(const std::string& line, const std::string& message) {
  const size_t end = message.size() > 1 && message[0] == '\'' ? message.find('\'', 1) : message.npos;
  if (end == message.npos || end == 1) return 0;
  const std::string word = message.substr(1, end - 1);
  for (size_t at = line.find(word); at != line.npos; at = line.find(word, at + 1)) {
    const bool whole = !is_word(word[0]) || ((at == 0 || !is_word(line[at - 1])) &&
                                             (at + word.size() == line.size() || !is_word(line[at + word.size()])));
    if (whole) return uint32_t(at + 1);
  }
  return 0;
}

// The frame's passes name their attachments in C++, which stays as it is.
std::string other_outputs(const ShaderInterface& old, const ShaderInterface& now) {
  std::vector<std::string> before = old.color_outputs, after = now.color_outputs;
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  if (before == after) return {};
  return fmt::format("its outputs were {}, and are {}: the pass has attachments for the first", fmt::join(before, ", "),
                     after.empty() ? "none" : fmt::format("{}", fmt::join(after, ", ")));
}

}  // namespace

std::vector<ReloadError> shader_errors(const ShaderCompiler& compiler, const std::string& text) {
  std::vector<ReloadError> errors;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part);) {
    if (part.empty()) continue;
    ReloadError error = parse(part);
    std::istringstream source(error.line ? compiler.text_of(error.file) : std::string());
    std::string line;
    for (uint32_t number = 0; number < error.line && std::getline(source, line);) ++number;
    if (source) {
      error.column = column_of(line, error.message);
      error.source_line = line;
    }
    if (std::find(errors.begin(), errors.end(), error) == errors.end()) errors.push_back(std::move(error));
  }
  return errors;
}

// All or nothing. Where words and interface are what they were, nothing is made anew.
void Pipelines::replace(Row& row) {
  Row made = build(row.files, row.defines, row.state, &row.program.interface);
  ShaderInterface &old = row.program.interface, &interface = made.program.interface;
  if (const std::string fault = other_outputs(old, interface); !fault.empty()) {
    destroy(made);
    fail(Exit::Shader, "{}: {}", row.files.back(), fault);
  }
  interface.generation = old.generation;
  interface.revision = old.revision;
  const bool same_interface = interface == old;
  if (!same_interface) ++interface.generation;
  const bool same_words =
      std::equal(made.program.stages.begin(), made.program.stages.end(), row.program.stages.begin(),
                 row.program.stages.end(), [](const auto& a, const auto& b) { return a.spirv == b.spirv; });
  if (same_words && same_interface) {
    destroy(made);
    row.program.dependencies = std::move(made.program.dependencies);
    return;
  }
  ++interface.revision;
  // What the frame uses is made now: a driver that refuses it does so here, and the time is the reload's. With other
  // outputs the attachments will be others too.
  if (interface.color_outputs == old.color_outputs) try {
      for (const Variant& variant : row.variants)
        made.variants.push_back({variant.colors, variant.depth, create(made, variant.colors, variant.depth)});
    } catch (...) {
      destroy(made);
      throw;
    }
  device_.wait_idle();
  destroy(row);
  row.program = std::move(made.program);
  row.set0 = made.set0;
  row.layout = made.layout;
  row.variants = std::move(made.variants);
}

Reload Pipelines::reload(std::span<const std::string> changed) {
  const auto start = std::chrono::steady_clock::now();
  Reload result;
  for (Row& row : rows_) {
    const auto& read = row.program.dependencies;
    const bool concerned =
        changed.empty() || row.broken || std::any_of(read.begin(), read.end(), [&](const auto& file) {
          return std::find(changed.begin(), changed.end(), file) != changed.end();
        });
    if (!concerned) continue;
    try {
      replace(row);
      row.broken = false;
      ++result.recompiled;
    } catch (const Error& error) {
      if (error.exit() != Exit::Shader) throw;
      row.broken = true;
      for (ReloadError& fault : shader_errors(compiler_, error.what()))
        if (std::find(result.errors.begin(), result.errors.end(), fault) == result.errors.end())
          result.errors.push_back(std::move(fault));
    }
  }
  result.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace nf::gpu
