// SPDX-License-Identifier: Apache-2.0
#include "state_coder.h"

#include <zstd.h>

#include <cstdint>
#include <cstring>

#include "trocar/base/assert.h"

namespace trocar::record {
namespace {

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

StatePlanes::StatePlanes(std::span<const std::byte> state) : planes_(SplitPlanes(state)) {}

bool HasBase(std::span<const std::byte> bytes) {
  StateHeader header;
  if (bytes.size() < sizeof header) return false;
  std::memcpy(&header, bytes.data(), sizeof header);
  return header.has_base == 1;
}

std::vector<std::byte> CompressState(std::span<const std::byte> state, const StatePlanes* base) {
  const StateHeader header{state.size(), base == nullptr ? 0u : 1u};
  const std::vector<std::byte> planes = SplitPlanes(state);
  const std::span<const std::byte> of_base = base == nullptr ? std::span<const std::byte>() : base->Bytes();
  std::vector<std::byte> bytes(sizeof header + ::ZSTD_compressBound(planes.size()));
  std::memcpy(bytes.data(), &header, sizeof header);
  const std::unique_ptr<ZSTD_CCtx, decltype(&::ZSTD_freeCCtx)> context(::ZSTD_createCCtx(), &::ZSTD_freeCCtx);
  ::ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kCompressionLevel);
  ::ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, kWindowBits);
  ::ZSTD_CCtx_setParameter(context.get(), ZSTD_c_enableLongDistanceMatching, 1);
  ::ZSTD_CCtx_refPrefix(context.get(), of_base.data(), of_base.size());
  const std::size_t size = ::ZSTD_compress2(context.get(), bytes.data() + sizeof header,
                                            bytes.size() - sizeof header, planes.data(), planes.size());
  TROCAR_ASSERT(!::ZSTD_isError(size));  // there is room for what cannot be compressed
  bytes.resize(sizeof header + size);
  bytes.shrink_to_fit();
  return bytes;
}

std::vector<std::byte> ExpandState(std::span<const std::byte> bytes, const StatePlanes* base) {
  StateHeader header;
  if (bytes.size() < sizeof header) return {};
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.size > kMostState || header.has_base > 1 || (header.has_base == 1) != (base != nullptr))
    return {};
  const std::span<const std::byte> of_base = base == nullptr ? std::span<const std::byte>() : base->Bytes();
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
