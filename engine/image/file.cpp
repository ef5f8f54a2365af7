// POSIX file access, chosen over streams because errno says why something failed.
#include "image/file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace nf::image {
namespace {

namespace fs = std::filesystem;

struct Descriptor {
  int fd = -1;
  Descriptor(const fs::path& path, int flags) : fd(open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd >= 0) close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool write_all(std::span<const uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t count = write(fd, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return false;
      bytes = bytes.subspan(size_t(count));
    }
    // Some file systems report a full disk only here.
    return close(std::exchange(fd, -1)) == 0;
  }
};

[[noreturn]] void fail_to_write(const fs::path& path, int why) {
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  std::error_code ignored;
  std::string advice = "choose another path";
  if (why == ENOENT && !fs::exists(folder, ignored)) advice = fmt::format("create the folder '{}' first", folder);
  if (why == EISDIR) advice = "give the name of a file";
  if (why == ENOSPC || why == EDQUOT) advice = "free some space";
  fail(Exit::Output, "cannot write '{}': {}; {}", path.string(), std::strerror(why), advice);
}

}  // namespace

std::vector<uint8_t> read_file(const fs::path& path) {
  auto fail_to_read = [&](const char* why) {
    fail(Exit::Input, "cannot read '{}': {}; check the path", path.string(), why);
  };
  // Without O_NONBLOCK opening a pipe nobody writes to would wait for ever.
  Descriptor file(path, O_RDONLY | O_NONBLOCK);
  struct stat info {};
  if (file.fd < 0 || fstat(file.fd, &info) != 0) fail_to_read(std::strerror(errno));
  if (S_ISDIR(info.st_mode)) fail_to_read("it is a folder");
  if (!S_ISREG(info.st_mode)) fail_to_read("it is not a regular file");

  std::vector<uint8_t> bytes(size_t(info.st_size));
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = read(file.fd, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_to_read(std::strerror(errno));
    if (count == 0) break;
    done += size_t(count);
  }
  bytes.resize(done);
  return bytes;
}

void write_file(const fs::path& path, std::span<const uint8_t> bytes) {
  std::error_code error;
  fs::path target = path;
  if (fs::is_symlink(path, error) && fs::exists(path, error)) target = fs::canonical(path, error);
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status)) fail_to_write(path, EISDIR);
  if (!path.has_filename()) fail_to_write(path, fs::exists(path.parent_path(), error) ? EISDIR : ENOENT);
  // Renaming would replace a file its owner made read-only.
  if (fs::exists(status) && access(target.c_str(), W_OK) != 0) fail_to_write(path, errno);

  if (fs::exists(status) && !fs::is_regular_file(status)) {
    Descriptor device(target, O_WRONLY);
    if (device.fd < 0 || !device.write_all(bytes)) fail_to_write(path, errno);
    return;
  }

  // A short name of its own: one made from the target's could be too long.
  static std::atomic<uint32_t> counter = 0;
  const fs::path temporary = target.parent_path() / fmt::format(".nearfield-{}-{}.tmp", getpid(), counter++);
  Descriptor file(temporary, O_WRONLY | O_CREAT | O_EXCL);
  if (file.fd < 0) fail_to_write(path, errno);
  if (!file.write_all(bytes) || rename(temporary.c_str(), target.c_str()) != 0) {
    const int why = errno;
    unlink(temporary.c_str());
    fail_to_write(path, why);
  }
}

void write_file(const fs::path& path, std::string_view text) {
  write_file(path, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

}  // namespace nf::image
