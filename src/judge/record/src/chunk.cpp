// SPDX-License-Identifier: Apache-2.0
#include "chunk.h"

#include <zlib.h>

#include <cstring>

namespace trocar::record {
namespace {

std::uint32_t AddTo(std::uint32_t checksum, const void* data, std::size_t size) {
  return static_cast<std::uint32_t>(::crc32_z(checksum, static_cast<const Bytef*>(data), size));
}

void Put(const void* data, std::size_t size, std::vector<std::byte>& bytes) {
  if (size == 0) return;
  const std::size_t begin = bytes.size();
  bytes.resize(begin + size);
  std::memcpy(bytes.data() + begin, data, size);
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
  Put(&header, sizeof header, bytes);
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
  Put(&header, sizeof header, bytes);
  Put(content.data(), content.size(), bytes);
}

}  // namespace trocar::record
