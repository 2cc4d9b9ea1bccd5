// SPDX-License-Identifier: Apache-2.0
#include "owner_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "trocar/host/user_folder.h"

namespace trocar::assessment {
namespace {

using base::Error;
using base::ErrorCode;

constexpr off_t kLargest = 1 << 20;  // of such a file [bytes]

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int Number() const { return number_; }

 private:
  int number_;
};

}  // namespace

base::Status WriteOwnerFile(const std::filesystem::path& path, std::string_view content) {
  const auto refuse = [&](int why) {
    return Error{ErrorCode::kFileUnwritable,
                 path.string() + ": " + std::strerror(why) +
                     (why == EEXIST ? "; choose another name, nothing is replaced" : "")};
  };
  std::error_code failure;
  if (path.has_parent_path()) failure = host::MakeFolders(path.parent_path());
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file.Number() < 0) return refuse(errno);
  while (!content.empty()) {
    const ssize_t written = ::write(file.Number(), content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int why = errno;
      ::unlink(path.c_str());
      return refuse(why);
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(file.Number()) != 0) {
    const int why = errno;
    ::unlink(path.c_str());
    return refuse(why);
  }
  return {};
}

base::Result<std::string> ReadOwnerFile(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.Number() < 0) {
    return Error{errno == ENOENT ? ErrorCode::kFileMissing : ErrorCode::kFileUnreadable,
                 path.string() + ": " + std::strerror(errno)};
  }
  struct stat status {};
  if (::fstat(file.Number(), &status) != 0 || !S_ISREG(status.st_mode))
    return Error{ErrorCode::kFileUnreadable, path.string() + " is no file"};
  // of the open file, not of the name: what is checked is what is read
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return Error{ErrorCode::kKeyUnsafe,
                 path.string() +
                     " may be read or written by others, who could sign in your name; run "
                     "chmod 600 on it, and make new keys if others had access"};
  }
  if (status.st_uid != ::geteuid() && ::geteuid() != 0)
    return Error{ErrorCode::kKeyUnsafe, path.string() + " belongs to another person; use a key of your own"};
  if (status.st_size > kLargest) return Error{ErrorCode::kFileTooLarge, path.string() + " is too large"};
  std::string content(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t count = ::read(file.Number(), content.data() + done, content.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Error{ErrorCode::kFileUnreadable, path.string() + " cannot be read"};
    done += static_cast<std::size_t>(count);
  }
  return content;
}

}  // namespace trocar::assessment
