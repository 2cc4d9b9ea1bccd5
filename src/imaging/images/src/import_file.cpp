// SPDX-License-Identifier: Apache-2.0
#include "import_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "import_protocol.h"
#include "trocar/base/assert.h"
#include "trocar/host/printable.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr std::size_t kMostNames = 100000;

}  // namespace

base::Result<ImportFile> ImportFile::Open(const fs::path& path, Links links) {
  return OpenAt(AT_FDCWD, path.c_str(), path, links);
}

base::Result<ImportFile> ImportFile::OpenBelow(const fs::path& folder, std::string_view path) {
  TROCAR_ASSERT(IsPathBelow(path));
  Descriptor inner;  // the folder that the next part of the path is looked for in
  fs::path walked = folder;
  for (auto slash = path.find('/'); slash != std::string_view::npos; slash = path.find('/')) {
    const std::string name(path.substr(0, slash));
    path.remove_prefix(slash + 1);
    const fs::path start = folder.empty() ? fs::path(".") : folder;
    if (inner.Get() < 0) inner = Descriptor(::open(start.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    walked /= name;
    const std::string printed = host::Printable(walked.string());
    struct stat info {};
    if (inner.Get() < 0 || ::fstatat(inner.Get(), name.c_str(), &info, AT_SYMLINK_NOFOLLOW) != 0)
      return Error{ErrorCode::kFileMissing, printed + " does not exist; check the path"};
    if (S_ISLNK(info.st_mode))
      return Error{ErrorCode::kImagePathUnsafe,
                   printed + " is a symbolic link; put the file itself into the folder"};
    Descriptor next(::openat(inner.Get(), name.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (next.Get() < 0) return Error{ErrorCode::kFileMissing, printed + " is no folder; check the path"};
    inner = std::move(next);
  }
  walked /= std::string(path);
  return inner.Get() < 0 ? Open(walked, Links::kRefuse)
                         : OpenAt(inner.Get(), std::string(path).c_str(), walked, Links::kRefuse);
}

base::Result<ImportFile> ImportFile::OpenAt(int folder, const char* name, const fs::path& path, Links links) {
  const std::string printed = host::Printable(path.string());
  const int follow = links == Links::kRefuse ? O_NOFOLLOW : 0;
  ImportFile file;
  // O_NONBLOCK: opening a FIFO must not wait for a writer; the check below then refuses it
  file.descriptor_ =
      Descriptor(::openat(folder, name, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | follow));
  if (file.Get() < 0) {
    if (errno == ENOENT || errno == ENOTDIR)
      return Error{ErrorCode::kFileMissing, printed + " does not exist; check the path"};
    if (errno == ELOOP)
      return Error{ErrorCode::kImagePathUnsafe,
                   printed + " is a symbolic link; put the file itself into the folder"};
    if (errno == ENXIO || errno == ENODEV)  // a socket, a device without its hardware
      return Error{ErrorCode::kImagePathUnsafe, printed + " is not a regular file; name an image file"};
    return Error{ErrorCode::kFileUnreadable,
                 printed + ": " + std::strerror(errno) + "; check the file and its rights"};
  }
  struct stat info {};
  if (::fstat(file.Get(), &info) != 0)
    return Error{ErrorCode::kFileUnreadable, printed + ": " + std::strerror(errno) + "; check the file"};
  if (!S_ISREG(info.st_mode))
    return Error{ErrorCode::kImagePathUnsafe, printed + " is not a regular file; name an image file"};
  file.path_ = path;
  file.bytes_ = static_cast<std::uint64_t>(info.st_size);
  file.changed_s_ = info.st_mtim.tv_sec;
  file.changed_ns_ = info.st_mtim.tv_nsec;
  return file;
}

std::string ImportFile::ReadBegin(std::size_t most) const {
  std::string begin(static_cast<std::size_t>(std::min<std::uint64_t>(most, bytes_)), '\0');
  std::size_t have = 0;
  while (have < begin.size()) {
    const ssize_t got = ::pread(Get(), begin.data() + have, begin.size() - have, static_cast<off_t>(have));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    have += static_cast<std::size_t>(got);
  }
  begin.resize(have);
  return begin;
}

base::Status ImportFile::CheckUnchanged() const {
  struct stat info {};
  if (::fstat(Get(), &info) == 0 && static_cast<std::uint64_t>(info.st_size) == bytes_ &&
      info.st_mtim.tv_sec == changed_s_ && info.st_mtim.tv_nsec == changed_ns_) {
    return {};
  }
  return Error{ErrorCode::kImageChanged, host::Printable(path_.string()) +
                                             " changed while it was read; wait until it is complete, then "
                                             "open it again"};
}

base::Result<std::vector<std::string>> ListFolder(const fs::path& folder) {
  std::error_code failure;
  std::vector<std::string> names;
  fs::directory_iterator entry(folder, failure);
  for (const fs::directory_iterator end; !failure && entry != end; entry.increment(failure)) {
    std::string name = entry->path().filename().string();
    if (name.starts_with('.')) continue;
    names.push_back(std::move(name));
    if (names.size() > kMostNames) {
      return Error{ErrorCode::kImageTooLarge, host::Printable(folder.string()) + " holds more than " +
                                                  std::to_string(kMostNames) +
                                                  " files; put the series into a folder of its own"};
    }
  }
  if (failure) {
    return Error{ErrorCode::kImageFolderMissing, host::Printable(folder.string()) + " cannot be listed (" +
                                                     failure.message() + "); name the folder of the slices"};
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace trocar::images
