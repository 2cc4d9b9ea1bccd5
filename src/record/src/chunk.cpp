// SPDX-License-Identifier: Apache-2.0
#include "chunk.h"

#include <zlib.h>
#include <zstd.h>

#include <cstring>
#include <memory>

#include "trocar/core/assert.h"

namespace trocar::record {
namespace {

std::uint32_t AddTo(std::uint32_t checksum, const void* data, std::size_t size) {
  return static_cast<std::uint32_t>(::crc32_z(checksum, static_cast<const Bytef*>(data), size));
}

template <typename T>
void Put(const T& value, std::vector<std::byte>& bytes) {
  const auto view = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), view.begin(), view.end());
}

/// Before a compressed state.
struct StateHeader {
  std::uint64_t size = 0;  // of the state [bytes]
  std::uint64_t has_base = 0;
};

constexpr int kCompressionLevel = 1;  // higher ones gain two per cent
/// A state repeats whole arrays megabytes later, and those of its base lie before it.
constexpr int kWindowBits = 24;
constexpr std::uint64_t kMostState = std::uint64_t{256} << 20;  // far beyond the state of any patient

/// First all first bytes of the words of eight, then all second ones: numbers that lie close have the same high bytes.
std::vector<std::byte> SplitPlanes(std::span<const std::byte> bytes) {
  const std::size_t words = bytes.size() / 8;
  std::vector<std::byte> planes(bytes.begin(), bytes.end());
  for (std::size_t word = 0; word < words; ++word) {
    for (std::size_t plane = 0; plane < 8; ++plane) planes[plane * words + word] = bytes[8 * word + plane];
  }
  return planes;
}

std::vector<std::byte> JoinPlanes(std::span<const std::byte> planes) {
  const std::size_t words = planes.size() / 8;
  std::vector<std::byte> bytes(planes.begin(), planes.end());
  for (std::size_t word = 0; word < words; ++word) {
    for (std::size_t plane = 0; plane < 8; ++plane) bytes[8 * word + plane] = planes[plane * words + word];
  }
  return bytes;
}

}  // namespace

std::uint32_t CalcHeaderChecksum(FileHeader header) {
  header.checksum = 0;
  return AddTo(0, &header, sizeof header);
}

std::uint32_t CalcChunkChecksum(std::uint64_t file_id, ChunkHeader header,
                                std::span<const std::byte> content) {
  header.checksum = 0;
  const std::uint32_t of_header = AddTo(AddTo(0, &file_id, sizeof file_id), &header, sizeof header);
  return AddTo(of_header, content.data(), content.size());
}

std::vector<std::byte> MakeFileHeader(std::uint64_t file_id) {
  FileHeader header;
  header.file_id = file_id;
  header.checksum = CalcHeaderChecksum(header);
  std::vector<std::byte> bytes;
  Put(header, bytes);
  return bytes;
}

void PutChunk(std::uint64_t file_id, std::uint64_t number, ChunkKind kind, std::uint64_t tick,
              std::span<const std::byte> content, std::vector<std::byte>& bytes) {
  ChunkHeader header;
  header.kind = kind;
  header.number = number;
  header.tick = tick;
  header.size = static_cast<std::uint32_t>(content.size());
  header.checksum = CalcChunkChecksum(file_id, header, content);
  Put(header, bytes);
  bytes.insert(bytes.end(), content.begin(), content.end());
}

std::vector<std::byte> CompressState(std::span<const std::byte> state, std::span<const std::byte> base) {
  const StateHeader header{state.size(), base.empty() ? 0u : 1u};
  const std::vector<std::byte> planes = SplitPlanes(state), of_base = SplitPlanes(base);
  std::vector<std::byte> bytes;
  Put(header, bytes);
  bytes.resize(sizeof header + ::ZSTD_compressBound(planes.size()));
  const std::unique_ptr<ZSTD_CCtx, decltype(&::ZSTD_freeCCtx)> context(::ZSTD_createCCtx(), &::ZSTD_freeCCtx);
  ::ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kCompressionLevel);
  ::ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, kWindowBits);
  ::ZSTD_CCtx_setParameter(context.get(), ZSTD_c_enableLongDistanceMatching, 1);
  ::ZSTD_CCtx_refPrefix(context.get(), of_base.data(), of_base.size());
  const std::size_t size = ::ZSTD_compress2(context.get(), bytes.data() + sizeof header,
                                            bytes.size() - sizeof header, planes.data(), planes.size());
  TROCAR_ASSERT(!::ZSTD_isError(size));  // there is room for what cannot be compressed
  bytes.resize(sizeof header + size);
  return bytes;
}

std::vector<std::byte> ExpandState(std::span<const std::byte> bytes, std::span<const std::byte> base) {
  StateHeader header;
  if (bytes.size() < sizeof header) return {};
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.size > kMostState || header.has_base > 1 || (header.has_base == 1) == base.empty()) return {};
  const std::vector<std::byte> of_base = SplitPlanes(base);
  std::vector<std::byte> planes(header.size);
  const std::unique_ptr<ZSTD_DCtx, decltype(&::ZSTD_freeDCtx)> context(::ZSTD_createDCtx(), &::ZSTD_freeDCtx);
  ::ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kWindowBits);
  ::ZSTD_DCtx_refPrefix(context.get(), of_base.data(), of_base.size());
  const std::size_t size = ::ZSTD_decompressDCtx(context.get(), planes.data(), planes.size(),
                                                 bytes.data() + sizeof header, bytes.size() - sizeof header);
  if (::ZSTD_isError(size) || size != header.size) return {};
  return JoinPlanes(planes);
}

}  // namespace trocar::record
