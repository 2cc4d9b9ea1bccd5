// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/storage.h"
#include "trocar/host/user_folder.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

namespace trocar::record {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

base::Error Unwritable(const fs::path& path, const std::string& why) {
  return {base::ErrorCode::kFileUnwritable,
          path.string() + ": " + why + "; check the folder, its rights and the space left"};
}

class File final : public Storage {
 public:
  File(fs::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  ~File() override { ::close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  base::Status Append(std::span<const std::byte> bytes) override {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return Unwritable(path_, written < 0 ? std::strerror(errno) : "nothing was written");
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return {};
  }

  base::Status Sync() override {
    if (::fdatasync(descriptor_) != 0) return Unwritable(path_, std::strerror(errno));
    if (!is_name_synced_) {
      // the entry of a new file lies in its folder
      const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
      const int of_folder = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      if (of_folder < 0) return Unwritable(folder, std::strerror(errno));
      const bool is_synced = ::fsync(of_folder) == 0;
      const int why = errno;
      ::close(of_folder);
      if (!is_synced) return Unwritable(folder, std::strerror(why));
      is_name_synced_ = true;
    }
    return {};
  }

  Space GetSpace() const override {
    struct statvfs info {};
    // where the system does not tell, nobody is warned; a full disk is noticed by Append
    if (::fstatvfs(descriptor_, &info) != 0) return {kUnknown, kUnknown};
    return {static_cast<std::uint64_t>(info.f_bavail) * info.f_frsize,
            static_cast<std::uint64_t>(info.f_blocks) * info.f_frsize};
  }

 private:
  fs::path path_;
  int descriptor_;
  bool is_name_synced_ = false;
};

}  // namespace

base::Result<std::unique_ptr<Storage>> MakeFile(const fs::path& path) {
  std::error_code failure;
  if (path.has_parent_path()) failure = host::MakeFolders(path.parent_path());
  if (failure) return Unwritable(path.parent_path(), failure.message());
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_APPEND, 0644);
  if (descriptor < 0 && errno == EEXIST)
    return Unwritable(path,
                      "there is such a file already; a recording never replaces another, name a new one");
  if (descriptor < 0) return Unwritable(path, std::strerror(errno));
  return std::unique_ptr<Storage>(std::make_unique<File>(path, descriptor));
}

}  // namespace trocar::record
