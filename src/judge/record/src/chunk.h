// SPDX-License-Identifier: Apache-2.0
// The bytes of a recording: a header, then chunks that each carry a checksum and their place in the row.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::record {

static_assert(std::endian::native == std::endian::little, "a recording is little-endian");

inline constexpr std::array<char, 8> kMagic{'T', 'R', 'O', 'C', 'R', 'E', 'C', '\n'};
/// Counts up whenever the meaning of a byte changes. Older formats stay readable.
/// 2: joints off the grid are packed in bits (input_codec.cpp).
inline constexpr std::uint32_t kFormat = 2;

struct FileHeader {
  std::array<char, 8> magic = kMagic;
  std::uint32_t format = kFormat;
  std::uint32_t checksum = 0;  // of the header, this being 0
  std::uint64_t file_id = 0;   // random: a chunk of another file is none of this one
};
static_assert(sizeof(FileHeader) == 24);

enum class ChunkKind : std::uint32_t {
  kDescription = 1,  // JSON
  kInputs = 2,       // count of ticks, then InputEncoder's bytes
  kHash = 3,         // of the state after `tick`
  kKeyframe = 4,     // a compressed saved state after `tick`; the inputs after it begin a new row
  kEvents = 5,       // JSON, an array
  kMark = 6,         // text
  kEnding = 7        // JSON; nothing follows
};

struct ChunkHeader {
  std::uint32_t magic = 0x4b435254;  // "TRCK"
  ChunkKind kind = ChunkKind::kDescription;
  std::uint64_t number = 0;    // of the chunk in its file, from 0
  std::uint64_t tick = 0;      // ticks done before the first input, or when the rest was noted
  std::uint32_t size = 0;      // of the content [bytes]
  std::uint32_t checksum = 0;  // CRC-32 of file id, header (this being 0) and content
};
static_assert(sizeof(ChunkHeader) == 32);
/// Far beyond any content.
inline constexpr std::uint32_t kMostContent = 64u << 20;

std::uint32_t CalcHeaderChecksum(FileHeader header);
std::uint32_t CalcChunkChecksum(std::uint64_t file_id, ChunkHeader header,
                                std::span<const std::byte> content);

std::vector<std::byte> MakeFileHeader(std::uint64_t file_id);
/// Appends a chunk.
void PutChunk(std::uint64_t file_id, std::uint64_t number, ChunkKind kind, std::uint64_t tick,
              std::span<const std::byte> content, std::vector<std::byte>& bytes);

inline std::span<const std::byte> BytesOf(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}
inline std::string_view TextOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace trocar::record
