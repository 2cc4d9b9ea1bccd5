// SPDX-License-Identifier: Apache-2.0
/// \file byte_source.h  Bytes of a file one after the other, unpacked where they are deflated; and the
/// samples of a volume made from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "reader.h"

namespace trocar::images::import {

/// No deflate stream holds more bytes for one of its own.
inline constexpr std::uint64_t kMostDeflated = 1040;

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `to`; fewer bytes only at the end.
  virtual std::size_t Read(void* to, std::size_t bytes) = 0;
};

/// From byte `begin` of the file on.
std::unique_ptr<ByteSource> OpenPlain(const InputFile& file, std::uint64_t begin);
/// Likewise, unpacking gzip or zlib.
/// \note Read throws Failure kImageUndecodable for a damaged stream
std::unique_ptr<ByteSource> OpenDeflated(const InputFile& file, std::uint64_t begin);

/// Whether the file begins like gzip.
bool IsGzip(const InputFile& file);

/// What kind of file it is; looks into gzip.
FileKind FindKind(const InputFile& file);

/// The file's header as text, at most `most` bytes.
std::string ReadBegin(const InputFile& file, std::size_t most);

/// Type of a sample in a file.
enum class StoredType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64
};
std::size_t StoredBytes(StoredType type);
SampleKind HandedOverAs(StoredType type);

/// Where and how a volume's samples stand in a file.
struct StoredSamples {
  StoredType type = StoredType::kUint8;
  bool is_big_endian = false;
  bool is_deflated = false;
  std::uint64_t begin = 0;  ///< in the file, or where `is_whole_file_deflated`, in the unpacked bytes
  bool is_whole_file_deflated = false;
};

/// Compares what the samples need with the bytes present. \throw Failure kImageTruncated
void CheckBytesPresent(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                       const ImportRequest& request);

/// Reads, converts and writes header.SampleCount() samples to `to`.
void ReadSamples(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                 std::byte* to);

}  // namespace trocar::images::import
