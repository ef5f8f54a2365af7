// Reporting of broken invariants.
#include "core/error.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace nf {
namespace {
thread_local std::string doing_now;
}

Doing::Doing(std::string what) : previous_(std::exchange(doing_now, std::move(what))) {}
Doing::~Doing() {
  doing_now = std::move(previous_);
}
const std::string& Doing::current() {
  return doing_now;
}

void check_failed(const char* expression, const std::string& values, const char* file, int line) {
  std::fprintf(stderr, "internal error: %s (%s) at %s:%d%s%s\n", expression, values.c_str(), file, line,
               doing_now.empty() ? "" : " while ", doing_now.c_str());
  std::fflush(nullptr);
  std::abort();
}

}  // namespace nf
