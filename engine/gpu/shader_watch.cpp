// Polling a shader folder. Editors write in place, or write aside and rename over; both change the stamp.
#include <set>
#include <sys/stat.h>

#include "gpu/reload.h"

namespace nf::gpu {

namespace fs = std::filesystem;

ShaderWatch::ShaderWatch(fs::path folder, std::chrono::milliseconds quiet) : folder_(std::move(folder)), quiet_(quiet) {
  for (const auto& [name, stamp] : scan()) files_[name] = {stamp, stamp, {}};
}

std::map<std::string, ShaderWatch::Stamp> ShaderWatch::scan() const {
  static const std::set<std::string> extensions = {".comp", ".vert", ".frag", ".glsl"};
  std::map<std::string, Stamp> found;
  std::error_code error;
  // A folder that vanishes in between is looked at again with the next call.
  for (fs::recursive_directory_iterator it(folder_, fs::directory_options::follow_directory_symlink, error), end;
       !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    if (!extensions.count(path.extension().string()) || path.filename().string().starts_with('.')) continue;
    struct stat info {};
    if (stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) continue;
    found[path.lexically_relative(folder_).generic_string()] = {
        int64_t(info.st_mtim.tv_sec) * 1'000'000'000 + info.st_mtim.tv_nsec, uint64_t(info.st_size), info.st_ino};
  }
  return found;
}

std::vector<std::string> ShaderWatch::changed() {
  const std::map<std::string, Stamp> now_there = scan();
  const Clock::time_point now = Clock::now();
  const int64_t wall_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  for (const auto& [name, stamp] : now_there) files_.try_emplace(name);
  std::vector<std::string> result;
  for (auto it = files_.begin(); it != files_.end();) {
    File& file = it->second;
    const auto there = now_there.find(it->first);
    const Stamp stamp = there == now_there.end() ? Stamp{} : there->second;
    if (stamp != file.seen) file.seen = stamp, file.since = now;
    // Written long enough ago by the file's own time, or, where that lies ahead, by ours. A file that is gone has only
    // the latter: it may be about to be replaced.
    const bool quiet = now - file.since >= quiet_ ||
                       (stamp != Stamp{} && wall_ns - stamp.modified_ns >= std::chrono::nanoseconds(quiet_).count());
    if (file.seen != file.told && quiet) {
      file.told = file.seen;
      result.push_back(it->first);
    }
    it = file.seen == Stamp{} && file.told == Stamp{} ? files_.erase(it) : std::next(it);
  }
  return result;
}

}  // namespace nf::gpu
