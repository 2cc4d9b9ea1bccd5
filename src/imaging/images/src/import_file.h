// SPDX-License-Identifier: Apache-2.0
/// \file import_file.h  Opening files that strangers made: regular files only, and as large as when opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "import_socket.h"
#include "trocar/base/result.h"

namespace trocar::images {

/// Whether a symbolic link at the end of a path is followed.
enum class Links {
  kFollow,  ///< the person typed this path
  kRefuse   ///< the name was found in a folder or a header
};

/// An open file and what it was like then.
class ImportFile {
 public:
  /// Never waits (FIFO, device).
  /// \return kFileMissing, kFileUnreadable, or kImagePathUnsafe for what is no regular file
  static base::Result<ImportFile> Open(const std::filesystem::path& path, Links links);
  /// As Open, for a path that a header names, relative to `folder`: no part of it may be a link.
  /// \pre IsPathBelow(path)
  static base::Result<ImportFile> OpenBelow(const std::filesystem::path& folder, std::string_view path);

  int Get() const { return descriptor_.Get(); }
  std::uint64_t Bytes() const { return bytes_; }
  const std::filesystem::path& Path() const { return path_; }
  /// First bytes of the file, at most `most`.
  std::string ReadBegin(std::size_t most) const;
  /// \return kImageChanged when size or time of change differ from when it was opened
  base::Status CheckUnchanged() const;

 private:
  static base::Result<ImportFile> OpenAt(int folder, const char* name, const std::filesystem::path& path,
                                         Links links);

  Descriptor descriptor_;
  std::filesystem::path path_;
  std::uint64_t bytes_ = 0;
  std::int64_t changed_s_ = 0, changed_ns_ = 0;
};

/// Names in a folder, in byte order, without those that begin with a dot.
/// \return kImageFolderMissing, or kImageTooLarge for more than 100,000 names
base::Result<std::vector<std::string>> ListFolder(const std::filesystem::path& folder);

}  // namespace trocar::images
