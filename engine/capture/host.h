// The machine: what it is, and how busy others keep it.
#pragma once

#include <string>

namespace nf::capture {

struct Host {
  std::string os, cpu;
  int cores = 1;
  long ram_mib = 0;
};
Host describe_host();

struct HostLoad {
  int cores = 1;
  double average_start = 0, average_end = 0;  // one-minute load averages
  double others = 0;                          // cores kept busy by other processes, on average
};

// CPU seconds that this process has used, all threads: what a frame costs on a software device, whoever else is at
// work.
double own_cpu_seconds();

// Watches from its construction on.
class LoadWatch {
 public:
  LoadWatch();
  HostLoad load() const;

 private:
  double average_ = 0, busy_ = 0, own_ = 0, start_ = 0;  // seconds but for the average
};

// "2026-11-22T05:40:36Z", now.
std::string utc_date();

}  // namespace nf::capture
