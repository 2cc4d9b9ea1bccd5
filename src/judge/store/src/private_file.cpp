// SPDX-License-Identifier: Apache-2.0
#include "private_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "trocar/host/user_folder.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPartial = ".partial-";

/// \param why  errno
base::Error Unwritable(const fs::path& path, int why) {
  if (IsFull(why))
    return {base::ErrorCode::kStoreFull,
            path.string() + ": " + std::strerror(why) + "; free space on that disk, and do it again"};
  return {base::ErrorCode::kFileUnwritable,
          path.string() + ": " + std::strerror(why) + "; check the folder and its rights"};
}

bool WriteAll(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

bool IsFull(int why) noexcept {
  return why == ENOSPC || why == EDQUOT || why == EFBIG;
}

base::Status MakePrivateFolder(const fs::path& folder) {
  if (const auto failure = host::MakePrivateFolders(folder)) return Unwritable(folder, failure.value());
  return {};
}

base::Status SyncFolder(const fs::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return Unwritable(folder, errno);
  const bool is_synced = ::fsync(file) == 0;
  const int why = errno;
  ::close(file);
  if (!is_synced) return Unwritable(folder, why);
  return {};
}

base::Status WritePrivateFile(const fs::path& path, std::string_view content) {
  auto writer = PrivateFileWriter::Start(path);
  if (!writer.ok()) return writer.error();
  if (auto written = writer->Append(content); !written.ok()) return written;
  return writer->Finish();
}

base::Status MakePrivateFileOnce(const fs::path& path, std::string_view content) {
  auto writer = PrivateFileWriter::Start(path);
  if (!writer.ok()) return writer.error();
  if (auto written = writer->Append(content); !written.ok()) return written;
  return writer->FinishOnce();
}

PrivateFileWriter::PrivateFileWriter(fs::path path, std::string partial, int file)
    : path_(std::move(path)), partial_(std::move(partial)), file_(file) {}

PrivateFileWriter::PrivateFileWriter(PrivateFileWriter&& other) noexcept
    : path_(std::move(other.path_)),
      partial_(std::move(other.partial_)),
      buffer_(std::move(other.buffer_)),
      file_(std::exchange(other.file_, -1)) {}

PrivateFileWriter::~PrivateFileWriter() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(partial_.c_str());
}

base::Result<PrivateFileWriter> PrivateFileWriter::Start(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (auto made = MakePrivateFolder(folder); !made.ok()) return made.error();
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    std::string partial = (folder / (kPartial + std::string("XXXXXX"))).string();
    const int file = ::mkostemp(partial.data(), O_CLOEXEC);  // of mode 0600
    if (file < 0) return Unwritable(path, errno);
    // held for as long as it is written: what nobody holds was left by a program that was killed
    struct stat info {};
    if (::flock(file, LOCK_EX | LOCK_NB) == 0 && ::fstat(file, &info) == 0 && info.st_nlink > 0)
      return PrivateFileWriter(path, std::move(partial), file);
    ::close(file);  // somebody took it for a remnant in between
  }
  return Unwritable(path, EBUSY);
}

namespace {

/// Of the program that writes "TARGET.partPID" (host::PartialPath), or 0. SQLite's own files beside it end in more.
long OwnerOfPart(std::string name) {
  for (const char* more : {"-journal", "-wal", "-shm"}) {
    if (name.ends_with(more)) name.resize(name.size() - std::strlen(more));
  }
  const std::size_t at = name.rfind(".part");
  if (at == std::string::npos) return 0;
  const std::string digits = name.substr(at + 5);
  if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos)
    return 0;
  return std::strtol(digits.c_str(), nullptr, 10);
}

/// Whether no program writes it any more.
bool IsRemnant(const fs::path& path) {
  const std::string name = path.filename().string();
  if (name.starts_with(kPartial)) {
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0) return false;
    const bool is_free = ::flock(file, LOCK_EX | LOCK_NB) == 0;
    ::close(file);
    return is_free;
  }
  const long owner = OwnerOfPart(name);
  if (owner > 0) return ::kill(static_cast<::pid_t>(owner), 0) != 0 && errno == ESRCH;
  // as earlier versions named copies of a store
  return name.ends_with(".sqlite.partial");
}

}  // namespace

base::Status EraseRemnants(const fs::path& folder) {
  std::error_code failure;
  std::vector<fs::path> remnants;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    if (IsRemnant(entry.path())) remnants.push_back(entry.path());
  }
  for (const fs::path& path : remnants) {
    if (auto gone = EraseFile(path); !gone.ok()) return gone;
  }
  return {};
}

base::Status PrivateFileWriter::Append(std::string_view text) {
  constexpr std::size_t kBuffer = 1u << 18;
  buffer_ += text;
  return buffer_.size() < kBuffer ? base::Status() : Write();
}

base::Status PrivateFileWriter::Write() {
  const bool is_written = WriteAll(file_, buffer_);
  buffer_.clear();
  if (!is_written) return Unwritable(path_, errno);
  return {};
}

base::Status PrivateFileWriter::Finish() {
  if (auto written = Write(); !written.ok()) return written;
  if (::fsync(file_) != 0) return Unwritable(path_, errno);
  if (::rename(partial_.c_str(), path_.c_str()) != 0) return Unwritable(path_, errno);
  ::close(std::exchange(file_, -1));
  return SyncFolder(path_.has_parent_path() ? path_.parent_path() : fs::path("."));
}

base::Status PrivateFileWriter::FinishOnce() {
  if (auto written = Write(); !written.ok()) return written;
  if (::fsync(file_) != 0) return Unwritable(path_, errno);
  if (::link(partial_.c_str(), path_.c_str()) != 0 && errno != EEXIST) return Unwritable(path_, errno);
  return SyncFolder(path_.has_parent_path() ? path_.parent_path() : fs::path("."));
}

base::Status EraseFile(const fs::path& path) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0 && errno == ENOENT) return {};
  if (file < 0) return Unwritable(path, errno);
  struct stat info {};
  bool is_done = ::fstat(file, &info) == 0 && S_ISREG(info.st_mode);
  static constexpr std::array<char, 65536> kZeros{};
  for (std::uint64_t left = is_done ? static_cast<std::uint64_t>(info.st_size) : 0; left > 0 && is_done;) {
    const auto part = std::min<std::uint64_t>(left, kZeros.size());
    is_done = WriteAll(file, {kZeros.data(), static_cast<std::size_t>(part)});
    left -= part;
  }
  is_done = is_done && ::fsync(file) == 0;
  const int why = errno;
  ::close(file);
  if (!is_done) return Unwritable(path, why);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return Unwritable(path, errno);
  return {};
}

}  // namespace trocar::store
