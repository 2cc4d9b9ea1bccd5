// SPDX-License-Identifier: Apache-2.0
#include "byte_source.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <vector>

namespace trocar::images::import {
namespace {

using core::ErrorCode;

static_assert(std::endian::native == std::endian::little);

class PlainSource : public ByteSource {
 public:
  PlainSource(const InputFile& file, std::uint64_t begin) : file_(file), at_(begin) {}
  std::size_t Read(void* to, std::size_t bytes) override {
    // never past the size that was seen when the file was opened
    bytes =
        static_cast<std::size_t>(std::min<std::uint64_t>(bytes, file_.bytes - std::min(at_, file_.bytes)));
    std::size_t have = 0;
    while (have < bytes) {
      const ssize_t got =
          ::pread(file_.fd, static_cast<char*>(to) + have, bytes - have, static_cast<off_t>(at_ + have));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      have += static_cast<std::size_t>(got);
    }
    at_ += have;
    return have;
  }

 private:
  InputFile file_;
  std::uint64_t at_;
};

class DeflatedSource : public ByteSource {
 public:
  DeflatedSource(const InputFile& file, std::uint64_t begin) : packed_(file, begin), buffer_(1 << 16) {
    constexpr int kGzipOrZlib = 15 + 32;
    if (::inflateInit2(&stream_, kGzipOrZlib) != Z_OK) throw std::bad_alloc();
  }
  ~DeflatedSource() override { ::inflateEnd(&stream_); }
  DeflatedSource(const DeflatedSource&) = delete;
  DeflatedSource& operator=(const DeflatedSource&) = delete;

  std::size_t Read(void* to, std::size_t bytes) override {
    constexpr std::size_t kMostAtOnce = 1u << 30;
    std::size_t have = 0;
    while (have < bytes && !is_over_) {
      if (stream_.avail_in == 0) {
        stream_.next_in = buffer_.data();
        stream_.avail_in = static_cast<uInt>(packed_.Read(buffer_.data(), buffer_.size()));
        if (stream_.avail_in == 0) break;
      }
      const std::size_t capacity = std::min(bytes - have, kMostAtOnce);
      stream_.next_out = static_cast<Bytef*>(to) + have;
      stream_.avail_out = static_cast<uInt>(capacity);
      const int state = ::inflate(&stream_, Z_NO_FLUSH);
      have += capacity - stream_.avail_out;
      if (state == Z_STREAM_END) {
        StartNextMember();
      } else if (state != Z_OK && state != Z_BUF_ERROR) {
        throw Failure{ErrorCode::kImageUndecodable, "its packed samples are damaged"};
      }
    }
    return have;
  }

 private:
  /// gzip files may hold several streams, one after the other; what follows them otherwise is left alone.
  void StartNextMember() {
    if (stream_.avail_in == 0) {
      stream_.next_in = buffer_.data();
      stream_.avail_in = static_cast<uInt>(packed_.Read(buffer_.data(), buffer_.size()));
    }
    is_over_ = stream_.avail_in < 2 || stream_.next_in[0] != 0x1f || stream_.next_in[1] != 0x8b ||
               ::inflateReset(&stream_) != Z_OK;
  }

  PlainSource packed_;
  std::vector<Bytef> buffer_;
  z_stream stream_{};
  bool is_over_ = false;
};

template <typename Stored>
Stored Swapped(Stored value) {
  unsigned char bytes[sizeof(Stored)];
  std::memcpy(bytes, &value, sizeof(value));
  std::reverse(bytes, bytes + sizeof(value));
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

template <typename Stored, typename Given>
void Convert(ByteSource& source, std::uint64_t count, bool is_swapped, std::byte* to) {
  constexpr std::size_t kChunk = 1 << 16;
  std::vector<Stored> stored(kChunk);
  std::vector<Given> given(kChunk);
  while (count > 0) {
    const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(count, kChunk));
    if (source.Read(stored.data(), now * sizeof(Stored)) != now * sizeof(Stored)) {
      throw Failure{ErrorCode::kImageTruncated, "it ends before its last sample"};
    }
    for (std::size_t i = 0; i < now; ++i)
      given[i] = static_cast<Given>(is_swapped ? Swapped(stored[i]) : stored[i]);
    std::memcpy(to, given.data(), now * sizeof(Given));
    to += now * sizeof(Given);
    count -= now;
  }
}

}  // namespace

std::unique_ptr<ByteSource> OpenPlain(const InputFile& file, std::uint64_t begin) {
  return std::make_unique<PlainSource>(file, begin);
}

std::unique_ptr<ByteSource> OpenDeflated(const InputFile& file, std::uint64_t begin) {
  return std::make_unique<DeflatedSource>(file, begin);
}

std::string ReadBegin(const InputFile& file, std::size_t most) {
  std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(most, file.bytes)), '\0');
  text.resize(PlainSource(file, 0).Read(text.data(), text.size()));
  return text;
}

bool IsGzip(const InputFile& file) {
  return ReadBegin(file, 2) == "\x1f\x8b";
}

FileKind FindKind(const InputFile& file) {
  constexpr std::size_t kEnough = 544;
  const FileKind plain = SniffKind(ReadBegin(file, kEnough));
  if (plain == FileKind::kDicom || !IsGzip(file)) return plain;
  std::string begin(kEnough, '\0');
  begin.resize(DeflatedSource(file, 0).Read(begin.data(), begin.size()));
  const FileKind kind = SniffKind(begin);
  return kind == FileKind::kNifti ? kind : FileKind::kUnknown;
}

std::size_t StoredBytes(StoredType type) {
  switch (type) {
    case StoredType::kInt8:
    case StoredType::kUint8:
      return 1;
    case StoredType::kInt16:
    case StoredType::kUint16:
      return 2;
    case StoredType::kInt32:
    case StoredType::kUint32:
    case StoredType::kFloat32:
      return 4;
    default:
      return 8;
  }
}

SampleKind HandedOverAs(StoredType type) {
  switch (type) {
    case StoredType::kUint8:
      return SampleKind::kUint8;
    case StoredType::kInt8:
    case StoredType::kInt16:
      return SampleKind::kInt16;
    case StoredType::kUint16:
      return SampleKind::kUint16;
    case StoredType::kInt32:
      return SampleKind::kInt32;
    case StoredType::kUint32:
      return SampleKind::kUint32;
    default:
      return SampleKind::kFloat32;
  }
}

void CheckBytesPresent(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                       const ImportRequest& request) {
  if (request.is_size_believed != 0) return;
  const std::uint64_t needed = CheckedProduct({header.SampleCount(), StoredBytes(stored.type)});
  const std::uint64_t begin = stored.is_whole_file_deflated ? 0 : stored.begin;
  const std::uint64_t present = file.bytes - std::min(begin, file.bytes);
  const bool is_packed = stored.is_deflated || stored.is_whole_file_deflated;
  if (needed / (is_packed ? kMostDeflated : 1) <= present) return;
  throw Failure{ErrorCode::kImageTruncated, "its header announces " + std::to_string(needed) +
                                                " bytes of samples, which the " + std::to_string(present) +
                                                " bytes there cannot hold"};
}

void ReadSamples(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                 std::byte* to) {
  std::unique_ptr<ByteSource> source;
  if (stored.is_whole_file_deflated) {
    source = OpenDeflated(file, 0);
    std::vector<char> skipped(4096);
    for (std::uint64_t left = stored.begin; left > 0;) {
      const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(left, skipped.size()));
      if (source->Read(skipped.data(), now) != now) break;
      left -= now;
    }
  } else {
    source = stored.is_deflated ? OpenDeflated(file, stored.begin) : OpenPlain(file, stored.begin);
  }
  const std::uint64_t count = header.SampleCount();
  const bool is_swapped = stored.is_big_endian;
  switch (stored.type) {
    case StoredType::kInt8:
      return Convert<std::int8_t, std::int16_t>(*source, count, is_swapped, to);
    case StoredType::kUint8:
      return Convert<std::uint8_t, std::uint8_t>(*source, count, is_swapped, to);
    case StoredType::kInt16:
      return Convert<std::int16_t, std::int16_t>(*source, count, is_swapped, to);
    case StoredType::kUint16:
      return Convert<std::uint16_t, std::uint16_t>(*source, count, is_swapped, to);
    case StoredType::kInt32:
      return Convert<std::int32_t, std::int32_t>(*source, count, is_swapped, to);
    case StoredType::kUint32:
      return Convert<std::uint32_t, std::uint32_t>(*source, count, is_swapped, to);
    case StoredType::kInt64:
      return Convert<std::int64_t, float>(*source, count, is_swapped, to);
    case StoredType::kUint64:
      return Convert<std::uint64_t, float>(*source, count, is_swapped, to);
    case StoredType::kFloat32:
      return Convert<float, float>(*source, count, is_swapped, to);
    case StoredType::kFloat64:
      return Convert<double, float>(*source, count, is_swapped, to);
  }
}

}  // namespace trocar::images::import
