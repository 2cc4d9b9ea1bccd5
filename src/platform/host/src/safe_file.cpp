// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/safe_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "trocar/host/partial_path.h"
#include "trocar/host/user_folder.h"

namespace trocar::host {
namespace {

namespace fs = std::filesystem;

/// Closes a descriptor at scope end.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int Get() const { return fd_; }

 private:
  int fd_;
};

base::Error Unreadable(const fs::path& path) {
  return {base::ErrorCode::kFileUnreadable,
          path.string() + ": " + std::strerror(errno) + "; check the file and its rights"};
}

base::Error Unwritable(const fs::path& path, const std::string& why) {
  return {base::ErrorCode::kFileUnwritable,
          path.string() + ": " + why + "; check the folder, its rights and the space left"};
}

bool WriteAll(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(fd) == 0;
}

}  // namespace

base::Result<std::string> ReadFile(const fs::path& path, std::size_t limit_bytes) {
  // O_NONBLOCK: opening a FIFO must not wait for a writer; the check below then refuses it
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.Get() < 0) {
    if (errno == ENOENT || errno == ENOTDIR) {
      return base::Error{base::ErrorCode::kFileMissing, path.string() + " does not exist; check the path"};
    }
    return Unreadable(path);
  }
  struct stat info {};
  if (::fstat(file.Get(), &info) != 0) return Unreadable(path);
  if (!S_ISREG(info.st_mode)) {
    return base::Error{base::ErrorCode::kFileUnreadable,
                       path.string() + " is not a regular file; name a file"};
  }
  if (static_cast<std::size_t>(info.st_size) > limit_bytes) {
    return base::Error{base::ErrorCode::kFileTooLarge,
                       path.string() + " has " + std::to_string(info.st_size) + " bytes, more than the " +
                           std::to_string(limit_bytes) + " that are accepted"};
  }
  std::string content(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t have = 0;
  while (have < content.size()) {
    const ssize_t got = ::read(file.Get(), content.data() + have, content.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return Unreadable(path);
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  content.resize(have);
  return content;
}

base::Status WriteFile(const fs::path& path, std::string_view content) {
  std::error_code failure;
  if (path.has_parent_path()) failure = MakeFolders(path.parent_path());
  if (failure) return Unwritable(path.parent_path(), failure.message());
  const PartialPath part(path);
  const fs::path& partial = part.Path();
  bool written = false;
  int why = 0;
  {
    const Descriptor file(::open(partial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
    if (file.Get() < 0) return Unwritable(path, std::strerror(errno));
    written = WriteAll(file.Get(), content);
    why = errno;
  }
  if (written) {
    fs::rename(partial, path, failure);
    if (!failure) return {};
  }
  return Unwritable(path, failure ? failure.message() : std::strerror(why));
}

}  // namespace trocar::host
