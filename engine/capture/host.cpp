// What Linux tells about itself. A value that cannot be found out is empty or 0.
#include "capture/host.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

namespace nf::capture {
namespace {

// The value behind `key` in a file of "key<separator> value" lines.
std::string find_value(const char* file, const std::string& key, char separator) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const size_t at = line.find(separator);
    if (at == std::string::npos || !line.starts_with(key)) continue;
    std::string value = line.substr(at + 1);
    std::erase(value, '"');
    value.erase(0, value.find_first_not_of(" \t"));
    return value;
  }
  return {};
}

double load_average() {
  double average = 0;
  std::ifstream("/proc/loadavg") >> average;
  return average;
}

double monotonic() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// CPU seconds that the whole machine has used.
double machine_busy() {
  std::ifstream in("/proc/stat");
  std::string cpu;
  double user = 0, nice = 0, system = 0, idle = 0, wait = 0, irq = 0, soft = 0;
  if (!(in >> cpu >> user >> nice >> system >> idle >> wait >> irq >> soft)) return 0;
  return (user + nice + system + irq + soft) / double(std::max(sysconf(_SC_CLK_TCK), 1L));
}

int core_count() {
  return int(std::max(std::thread::hardware_concurrency(), 1u));
}

}  // namespace

double own_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + double(t.tv_usec) * 1e-6; };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Host describe_host() {
  Host host{.os = find_value("/etc/os-release", "PRETTY_NAME", '='),
            .cpu = find_value("/proc/cpuinfo", "model name", ':'),
            .cores = core_count()};
  host.ram_mib = std::atol(find_value("/proc/meminfo", "MemTotal", ':').c_str()) / 1024;
  return host;
}

LoadWatch::LoadWatch()
    : average_(load_average()), busy_(machine_busy()), own_(own_cpu_seconds()), start_(monotonic()) {}

HostLoad LoadWatch::load() const {
  HostLoad load{.cores = core_count(), .average_start = average_, .average_end = load_average()};
  const double seconds = monotonic() - start_;
  if (seconds > 0) load.others = std::max((machine_busy() - busy_ - own_cpu_seconds() + own_) / seconds, 0.0);
  return load;
}

std::string utc_date() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace nf::capture
