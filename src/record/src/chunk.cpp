// SPDX-License-Identifier: Apache-2.0
#include "chunk.h"

#include <zlib.h>

#include <cstring>

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
  const bool has_base = base.size() == state.size();
  // numbers of eight bytes that lie close have the same high bytes: those of all side by side deflate well
  const std::size_t words = state.size() / 8, rest = state.size() % 8;
  std::vector<std::byte> planes(state.size());
  for (std::size_t word = 0; word < words; ++word) {
    for (std::size_t plane = 0; plane < 8; ++plane) {
      std::byte value = state[8 * word + plane];
      if (has_base) value ^= base[8 * word + plane];
      planes[plane * words + word] = value;
    }
  }
  for (std::size_t i = state.size() - rest; i < state.size(); ++i)
    planes[i] = has_base ? state[i] ^ base[i] : state[i];
  StateHeader header{state.size(), has_base ? 1u : 0u};
  std::vector<std::byte> bytes;
  Put(header, bytes);
  uLongf size = ::compressBound(static_cast<uLong>(planes.size()));
  bytes.resize(sizeof header + size);
  ::compress2(reinterpret_cast<Bytef*>(bytes.data() + sizeof header), &size,
              reinterpret_cast<const Bytef*>(planes.data()), static_cast<uLong>(planes.size()), Z_BEST_SPEED);
  bytes.resize(sizeof header + size);
  return bytes;
}

std::vector<std::byte> ExpandState(std::span<const std::byte> bytes, std::span<const std::byte> base) {
  StateHeader header;
  if (bytes.size() < sizeof header) return {};
  std::memcpy(&header, bytes.data(), sizeof header);
  // deflate gains a factor of 1032 at most
  if (header.size > 1100 * static_cast<std::uint64_t>(bytes.size()) + 64) return {};
  if (header.has_base > 1 || (header.has_base == 1 && base.size() != header.size)) return {};
  std::vector<std::byte> planes(header.size);
  uLongf size = static_cast<uLongf>(header.size);
  if (::uncompress(reinterpret_cast<Bytef*>(planes.data()), &size,
                   reinterpret_cast<const Bytef*>(bytes.data() + sizeof header),
                   static_cast<uLong>(bytes.size() - sizeof header)) != Z_OK ||
      size != header.size)
    return {};
  std::vector<std::byte> state(header.size);
  const std::size_t words = state.size() / 8;
  for (std::size_t word = 0; word < words; ++word) {
    for (std::size_t plane = 0; plane < 8; ++plane) state[8 * word + plane] = planes[plane * words + word];
  }
  for (std::size_t i = 8 * words; i < state.size(); ++i) state[i] = planes[i];
  if (header.has_base == 1) {
    for (std::size_t i = 0; i < state.size(); ++i) state[i] ^= base[i];
  }
  return state;
}

}  // namespace trocar::record
