// SPDX-License-Identifier: Apache-2.0
/// \file byte_source.h  Bytes of a file one after the other, unpacked where they are deflated; and the
/// samples of a volume made from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
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
/// As OpenPlain, unpacking gzip or zlib.
/// \note Read throws Failure kImageUndecodable for a damaged stream
std::unique_ptr<ByteSource> OpenDeflated(const InputFile& file, std::uint64_t begin);

/// Whether the file begins like gzip.
bool IsGzip(const InputFile& file);

/// Format of the file, by its first bytes; looks into gzip.
FileKind FindKind(const InputFile& file);

/// The file's first bytes, at most `most`.
std::string ReadBegin(const InputFile& file, std::size_t most);
/// The first bytes of the file's content, at most `most`; a gzip file is unpacked.
std::string ReadUnpacked(const InputFile& file, std::size_t most);

/// Bytes of the file, of one that gzip has packed those of what it holds; counts no further than `most`.
std::uint64_t CountUnpacked(const InputFile& file, std::uint64_t most);

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

/// How the bytes of samples are written down.
enum class Packing { kPlain, kDeflated, kText, kHex };

/// Where and how a volume's samples stand in a file.
struct StoredSamples {
  StoredType type = StoredType::kUint8;
  bool is_big_endian = false;
  Packing packing = Packing::kPlain;
  std::uint64_t begin = 0;    ///< in the file, of what is packed
  std::uint64_t skipped = 0;  ///< bytes of the unpacked stream before the first sample
  /// Where set, the samples end so many bytes before the unpacked stream does, wherever that makes them begin.
  std::optional<std::uint64_t> bytes_after{};
  /// Samples of a channel that lie side by side before the next channel's: 1 where the channels of a voxel are neighbours.
  std::uint64_t run = 1;
};

/// Bytes that the samples take unpacked. \throw Failure kImageTooLarge
std::uint64_t BytesOfSamples(const ImageHeader& header, const StoredSamples& stored);

/// Where byte `begin` of a file gets to, when so many lines from there on are left out.
/// \throw Failure kImageTruncated
std::uint64_t SkipLines(const InputFile& file, std::uint64_t begin, std::uint64_t lines);

/// Compares what the samples need with the bytes present. \throw Failure kImageTruncated
void CheckBytesPresent(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                       const ImportRequest& request);

/// Reads, converts and writes header.SampleCount() samples to `to`, the channels of a voxel side by side.
/// \throw Failure kImageTruncated, or kImageUndecodable for what is no sample
void ReadSamples(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                 std::byte* to);

}  // namespace trocar::images::import
