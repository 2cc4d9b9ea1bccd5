// SPDX-License-Identifier: Apache-2.0
#include "trocar/dataset/hdf5_file.h"

#include <hdf5.h>

#include <algorithm>
#include <mutex>
#include <utility>

namespace trocar::dataset {
namespace {

constexpr unsigned kCompression = 1;             // of zlib: higher costs much and gains little
constexpr std::size_t kLeastToCompress = 1024;   // values in a row
constexpr std::size_t kSmallRowsTogether = 256;  // of those that are not compressed

/// Debian's HDF5 is not built for several threads.
std::mutex& Library() {
  static std::mutex mutex;
  return mutex;
}

template <typename T>
std::int64_t TypeOf();
template <>
std::int64_t TypeOf<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
std::int64_t TypeOf<std::int8_t>() {
  return H5T_NATIVE_INT8;
}
template <>
std::int64_t TypeOf<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
std::int64_t TypeOf<double>() {
  return H5T_NATIVE_DOUBLE;
}

}  // namespace

base::Result<Hdf5File> Hdf5File::Make(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::create_directories(path.parent_path(), failure);
  const std::scoped_lock lock(Library());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // our errors say it
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  Hdf5File made(file, path);
  if (file < 0) return made.Failed("it cannot be made");
  return base::Result<Hdf5File>(std::move(made));
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : file_(std::exchange(other.file_, -1)), path_(std::move(other.path_)), rows_(std::move(other.rows_)) {}

Hdf5File::~Hdf5File() {
  (void)Close();
}

base::Error Hdf5File::Failed(const std::string& what) const {
  return {base::ErrorCode::kFileUnwritable,
          path_.string() + ": " + what + "; check the folder, its rights and the space left"};
}

base::Status Hdf5File::AppendRow(const std::string& name, const std::vector<std::size_t>& shape,
                                 std::int64_t type, const void* row) {
  const std::scoped_lock lock(Library());
  const int rank = static_cast<int>(shape.size()) + 1;
  std::vector<hsize_t> sizes(1, 0), most(1, H5S_UNLIMITED), chunk(1, 1);
  std::size_t values = 1;
  for (const std::size_t side : shape) {
    sizes.push_back(side), most.push_back(side), chunk.push_back(side);
    values *= side;
  }
  auto found = rows_.find(name);
  if (found == rows_.end()) {
    const bool is_large = values >= kLeastToCompress;
    if (!is_large) chunk[0] = kSmallRowsTogether;
    const hid_t space = H5Screate_simple(rank, sizes.data(), most.data());
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(how, rank, chunk.data());
    if (is_large) H5Pset_deflate(how, kCompression);
    H5Pset_obj_track_times(how, false);  // the same bytes on another day
    const hid_t dataset = H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, how, H5P_DEFAULT);
    H5Pclose(how);
    H5Sclose(space);
    if (dataset < 0) return Failed(name + " cannot be made");
    found = rows_.emplace(name, Rows{dataset, 0}).first;
  }
  Rows& rows = found->second;
  sizes[0] = rows.count + 1;
  std::vector<hsize_t> start(static_cast<std::size_t>(rank), 0), count = sizes;
  start[0] = rows.count;
  count[0] = 1;
  bool is_good = H5Dset_extent(rows.dataset, sizes.data()) >= 0;
  const hid_t place = H5Dget_space(rows.dataset);
  H5Sselect_hyperslab(place, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  const hid_t memory = H5Screate_simple(rank, count.data(), nullptr);
  is_good = H5Dwrite(rows.dataset, type, memory, place, H5P_DEFAULT, row) >= 0 && is_good;
  H5Sclose(memory);
  H5Sclose(place);
  if (!is_good) return Failed(name + " cannot be written");
  ++rows.count;
  return {};
}

template <typename T>
base::Status Hdf5File::Append(const std::string& name, const std::vector<std::size_t>& shape,
                              std::span<const T> row) {
  return AppendRow(name, shape, TypeOf<T>(), row.data());
}
template base::Status Hdf5File::Append(const std::string&, const std::vector<std::size_t>&,
                                       std::span<const std::uint8_t>);
template base::Status Hdf5File::Append(const std::string&, const std::vector<std::size_t>&,
                                       std::span<const std::int8_t>);
template base::Status Hdf5File::Append(const std::string&, const std::vector<std::size_t>&,
                                       std::span<const float>);
template base::Status Hdf5File::Append(const std::string&, const std::vector<std::size_t>&,
                                       std::span<const double>);

base::Status Hdf5File::SetTexts(const std::string& name, const std::vector<std::string>& texts) {
  const std::scoped_lock lock(Library());
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  std::string padded;
  for (const std::string& text : texts) padded += text + std::string(longest - text.size(), '\0');
  const hsize_t count = texts.size();
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, longest);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(how, false);
  const hid_t dataset = H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, how, H5P_DEFAULT);
  const bool is_good = dataset >= 0 && (texts.empty() || H5Dwrite(dataset, type, H5S_ALL, H5S_ALL,
                                                                  H5P_DEFAULT, padded.data()) >= 0);
  if (dataset >= 0) H5Dclose(dataset);
  H5Pclose(how);
  H5Sclose(space);
  H5Tclose(type);
  if (!is_good) return Failed(name + " cannot be written");
  return {};
}

base::Status Hdf5File::SetText(const std::string& name, const std::string& text) {
  const std::scoped_lock lock(Library());
  // as a data set of bytes: an attribute holds at most 64 kB
  const hsize_t size = text.size();
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(how, false);
  const hid_t dataset =
      H5Dcreate2(file_, name.c_str(), H5T_NATIVE_UINT8, space, H5P_DEFAULT, how, H5P_DEFAULT);
  const bool is_good =
      dataset >= 0 && H5Dwrite(dataset, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0;
  if (dataset >= 0) H5Dclose(dataset);
  H5Pclose(how);
  H5Sclose(space);
  if (!is_good) return Failed(name + " cannot be written");
  return {};
}

base::Status Hdf5File::SetNumber(const std::string& name, double value) {
  const std::scoped_lock lock(Library());
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(file_, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
  const bool is_good = attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value) >= 0;
  if (attribute >= 0) H5Aclose(attribute);
  H5Sclose(space);
  if (!is_good) return Failed(name + " cannot be written");
  return {};
}

base::Status Hdf5File::Close() {
  if (file_ < 0) return {};
  const std::scoped_lock lock(Library());
  bool is_good = true;
  for (const auto& [name, rows] : rows_) is_good = H5Dclose(rows.dataset) >= 0 && is_good;
  rows_.clear();
  is_good = H5Fclose(std::exchange(file_, -1)) >= 0 && is_good;
  if (!is_good) return Failed("its end cannot be written");
  return {};
}

}  // namespace trocar::dataset
