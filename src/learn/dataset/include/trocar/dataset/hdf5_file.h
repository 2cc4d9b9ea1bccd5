// SPDX-License-Identifier: Apache-2.0
/// \file hdf5_file.h  Rows of arrays in an HDF5 file, and attributes. The same calls give the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::dataset {

class Hdf5File {
 public:
  /// \return kFileUnwritable
  static base::Result<Hdf5File> Make(const std::filesystem::path& path);
  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&&) = delete;
  ~Hdf5File();

  /// Appends one row to a data set, which the first call makes, compressed where a row is large.
  /// \param shape  of a row; empty for a number
  /// \return kFileUnwritable
  template <typename T>
  base::Status Append(const std::string& name, const std::vector<std::size_t>& shape, std::span<const T> row);

  /// A data set of texts in UTF-8, padded with zeros to the longest. \return kFileUnwritable
  base::Status SetTexts(const std::string& name, const std::vector<std::string>& texts);
  base::Status SetText(const std::string& name, const std::string& text);
  base::Status SetNumber(const std::string& name, double value);
  /// Writes what is left, and closes. \return kFileUnwritable, for example for a full disk
  base::Status Close();

 private:
  Hdf5File(std::int64_t file, std::filesystem::path path) : file_(file), path_(std::move(path)) {}
  base::Error Failed(const std::string& what) const;
  base::Status AppendRow(const std::string& name, const std::vector<std::size_t>& shape, std::int64_t type,
                         const void* row);

  struct Rows {
    std::int64_t dataset;
    std::uint64_t count;
  };
  std::int64_t file_ = -1;
  std::filesystem::path path_;
  std::map<std::string, Rows> rows_;
};

}  // namespace trocar::dataset
