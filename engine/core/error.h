// Errors of "the world" (files, shader text, missing features) and the check macro for broken invariants.
#pragma once

#include <fmt/format.h>
#include <stdexcept>
#include <string>

namespace nf {

// Process exit codes, documented in the README; every Error carries the one its failure maps to.
enum class Exit : int {
  Ok = 0,
  CheckFailed = 1,  // ran, but a check failed
  Usage = 2,        // unknown flag, bad value
  Input = 3,        // input missing or bad
  NoDevice = 4,     // no suitable device or display
  Shader = 5,       // shader or pipeline failed
  Gpu = 6,          // device lost, out of memory, time limit
  Output = 7,       // cannot write
  Internal = 70,    // a wrong graph, a broken invariant
  Interrupted = 130,
};

// One sentence that says what, why and what to try. Thrown by anything that meets a bad world; caught at a boundary
// (a command, a reload).
class Error : public std::runtime_error {
 public:
  Error(Exit exit, const std::string& message) : std::runtime_error(message), exit_(exit) {}
  Exit exit() const { return exit_; }

 private:
  Exit exit_;
};

template <class... Args>
[[noreturn]] void fail(Exit exit, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(exit, fmt::format(format, std::forward<Args>(args)...));
}

// Names what the program is doing (a pass, a file), printed by NF_CHECK. One per thread; nests by saving the old value.
class Doing {
 public:
  explicit Doing(std::string what);
  ~Doing();
  Doing(const Doing&) = delete;
  Doing& operator=(const Doing&) = delete;
  static const std::string& current();

 private:
  std::string previous_;
};

[[noreturn]] void check_failed(const char* expression, const std::string& values, const char* file, int line);

}  // namespace nf

// Broken invariants: prints expression, a formatted message, file:line and what was being done, then aborts.
#define NF_CHECK(condition, ...)                                                                      \
  do {                                                                                                \
    if (!(condition)) ::nf::check_failed(#condition, ::fmt::format(__VA_ARGS__), __FILE__, __LINE__); \
  } while (false)
