// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "trocar/host/printable.h"
#include "trocar/host/user_folder.h"

namespace trocar::host {
namespace {

constexpr int kMostTries = 8;

/// Process number that a lock file names, or 0.
long ReadOwner(int descriptor) {
  char text[32] = {};
  if (pread(descriptor, text, sizeof(text) - 1, 0) <= 0) return 0;
  long owner = 0;
  return std::sscanf(text, "%ld", &owner) == 1 && owner > 0 ? owner : 0;
}

/// The file that was locked is still the one that the path names: its last owner may have removed it.
bool IsStillThere(int descriptor, const std::filesystem::path& path) {
  struct stat held {
  }, named{};
  return fstat(descriptor, &held) == 0 && stat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

}  // namespace

base::Result<FileLock> FileLock::Take(const std::filesystem::path& path) {
  std::error_code ignored;
  if (path.has_parent_path()) ignored = MakeFolders(path.parent_path());
  for (int tries = 0; tries < kMostTries; ++tries) {
    const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (descriptor < 0) {
      return base::Error{
          base::ErrorCode::kFileUnwritable,
          "cannot make the lock file " + Printable(path.string()) + ": " + std::strerror(errno)};
    }
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const long owner = ReadOwner(descriptor);
      close(descriptor);
      return base::Error{base::ErrorCode::kFileInUse, Printable(path.string()) + " is held by " +
                                                          (owner > 0 ? "process " + std::to_string(owner)
                                                                     : std::string("another program"))};
    }
    if (!IsStillThere(descriptor, path)) {
      close(descriptor);
      continue;
    }
    const std::string owner = std::to_string(getpid()) + "\n";
    // who holds it is told for messages only; the lock itself does not depend on it
    if (ftruncate(descriptor, 0) == 0) (void)!pwrite(descriptor, owner.data(), owner.size(), 0);
    return FileLock(path, descriptor);
  }
  return base::Error{base::ErrorCode::kFileInUse,
                     Printable(path.string()) + " is taken and given back all the time"};
}

void FileLock::LeaveToParent() noexcept {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  unlink(path_.c_str());
  close(descriptor_);
}

}  // namespace trocar::host
