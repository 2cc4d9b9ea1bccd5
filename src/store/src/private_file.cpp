// SPDX-License-Identifier: Apache-2.0
#include "private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

namespace trocar::store {
namespace {

namespace fs = std::filesystem;

core::Error Unwritable(const fs::path& path, const std::string& why) {
  return {core::ErrorCode::kFileUnwritable,
          path.string() + ": " + why + "; check the folder, its rights and the space left"};
}

bool WriteAll(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

core::Status MakePrivateFolder(const fs::path& folder) {
  std::error_code failure;
  if (fs::is_directory(folder, failure)) return {};
  fs::create_directories(folder, failure);
  if (failure) return Unwritable(folder, failure.message());
  fs::permissions(folder, fs::perms::owner_all, failure);
  if (failure) return Unwritable(folder, failure.message());
  return {};
}

core::Status SyncFolder(const fs::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return Unwritable(folder, std::strerror(errno));
  const bool is_synced = ::fsync(file) == 0;
  const int why = errno;
  ::close(file);
  if (!is_synced) return Unwritable(folder, std::strerror(why));
  return {};
}

core::Status WritePrivateFile(const fs::path& path, std::string_view content) {
  auto writer = PrivateFileWriter::Start(path);
  if (!writer.ok()) return writer.error();
  if (auto written = writer->Append(content); !written.ok()) return written;
  return writer->Finish();
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

core::Result<PrivateFileWriter> PrivateFileWriter::Start(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (auto made = MakePrivateFolder(folder); !made.ok()) return made.error();
  std::string partial = (folder / ".partial-XXXXXX").string();
  const int file = ::mkostemp(partial.data(), O_CLOEXEC);  // of mode 0600
  if (file < 0) return Unwritable(path, std::strerror(errno));
  return PrivateFileWriter(path, std::move(partial), file);
}

core::Status PrivateFileWriter::Append(std::string_view text) {
  constexpr std::size_t kBuffer = 1u << 18;
  buffer_ += text;
  return buffer_.size() < kBuffer ? core::Status() : Write();
}

core::Status PrivateFileWriter::Write() {
  const bool is_written = WriteAll(file_, buffer_);
  buffer_.clear();
  if (!is_written) return Unwritable(path_, std::strerror(errno));
  return {};
}

core::Status PrivateFileWriter::Finish() {
  if (auto written = Write(); !written.ok()) return written;
  if (::fsync(file_) != 0) return Unwritable(path_, std::strerror(errno));
  if (::rename(partial_.c_str(), path_.c_str()) != 0) return Unwritable(path_, std::strerror(errno));
  ::close(std::exchange(file_, -1));
  return SyncFolder(path_.has_parent_path() ? path_.parent_path() : fs::path("."));
}

core::Status EraseFile(const fs::path& path) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0 && errno == ENOENT) return {};
  if (file < 0) return Unwritable(path, std::strerror(errno));
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
  if (!is_done) return Unwritable(path, std::strerror(why));
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return Unwritable(path, std::strerror(errno));
  return {};
}

}  // namespace trocar::store
