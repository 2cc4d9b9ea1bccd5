// SPDX-License-Identifier: Apache-2.0
#include "byte_source.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "trocar/base/to_integer.h"

namespace trocar::images::import {
namespace {

using base::ErrorCode;

static_assert(std::endian::native == std::endian::little);

bool IsBlank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

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
        throw Failure{ErrorCode::kImageUndecodable, "its samples do not unpack as gzip or zlib"};
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

/// Bytes written as pairs of hexadecimal digits, with any blanks between them.
class HexSource : public ByteSource {
 public:
  HexSource(const InputFile& file, std::uint64_t begin) : text_(file, begin), buffer_(1 << 16) {}
  std::size_t Read(void* to, std::size_t bytes) override {
    auto* out = static_cast<unsigned char*>(to);
    for (std::size_t have = 0; have < bytes; ++have) {
      const int high = NextDigit(), low = high < 0 ? -1 : NextDigit();
      if (low < 0) return have;
      out[have] = static_cast<unsigned char>(16 * high + low);
    }
    return bytes;
  }

 private:
  /// \return -1 at the end
  int NextDigit() {
    for (;;) {
      if (at_ == filled_) {
        filled_ = text_.Read(buffer_.data(), buffer_.size());
        at_ = 0;
        if (filled_ == 0) return -1;
      }
      const char c = buffer_[at_++];
      if (c >= '0' && c <= '9') return c - '0';
      if (c >= 'a' && c <= 'f') return c - 'a' + 10;
      if (c >= 'A' && c <= 'F') return c - 'A' + 10;
      if (!IsBlank(c)) throw Failure{ErrorCode::kImageUndecodable, "its samples are no hexadecimal digits"};
    }
  }

  PlainSource text_;
  std::vector<char> buffer_;
  std::size_t at_ = 0, filled_ = 0;
};

template <typename Stored>
Stored Swapped(Stored value) {
  unsigned char bytes[sizeof(Stored)];
  std::memcpy(bytes, &value, sizeof(value));
  std::reverse(bytes, bytes + sizeof(value));
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

[[noreturn]] void FailAtEnd() {
  throw Failure{ErrorCode::kImageTruncated, "it ends before its last sample"};
}

/// Samples as bytes, a chunk after the other.
template <typename Stored>
class BinarySamples {
 public:
  BinarySamples(ByteSource& source, bool is_swapped) : source_(source), is_swapped_(is_swapped) {}
  void Read(std::vector<Stored>& to, std::size_t count) {
    if (source_.Read(to.data(), count * sizeof(Stored)) != count * sizeof(Stored)) FailAtEnd();
    if (!is_swapped_) return;
    for (std::size_t i = 0; i < count; ++i) to[i] = Swapped(to[i]);
  }

 private:
  ByteSource& source_;
  bool is_swapped_;
};

/// Samples as numbers in text, between blanks or commas.
template <typename Stored>
class TextSamples {
 public:
  explicit TextSamples(ByteSource& source) : source_(source), buffer_(1 << 16) {}
  void Read(std::vector<Stored>& to, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) to[i] = Next();
  }

 private:
  Stored Next() {
    constexpr std::size_t kLongest = 64;
    std::string word;
    for (;;) {
      if (at_ == filled_) {
        filled_ = source_.Read(buffer_.data(), buffer_.size());
        at_ = 0;
        if (filled_ == 0) break;
      }
      const char c = buffer_[at_++];
      const bool is_between = IsBlank(c) || c == ',';
      if (is_between && !word.empty()) break;
      if (!is_between) word += c;
      if (word.size() > kLongest) FailAtNoNumber();
    }
    if (word.empty()) FailAtEnd();
    double number = 0;
    const char* const begin = word.data() + (word[0] == '+' ? 1 : 0);
    const auto parsed = std::from_chars(begin, word.data() + word.size(), number);
    if (parsed.ec != std::errc() || parsed.ptr != word.data() + word.size()) FailAtNoNumber();
    if constexpr (std::is_integral_v<Stored>) {
      // the largest 64-bit number becomes 2^63 or 2^64 as double, which does not fit any more
      if (!(number >= static_cast<double>(std::numeric_limits<Stored>::min()) &&
            number < static_cast<double>(std::numeric_limits<Stored>::max()) + 1.0) ||
          number != std::floor(number))
        throw Failure{ErrorCode::kImageUndecodable, "one of the samples in its text is beyond its type"};
      return base::TruncateTo<Stored>(number);
    } else {
      return static_cast<Stored>(number);
    }
  }
  [[noreturn]] static void FailAtNoNumber() {
    throw Failure{ErrorCode::kImageUndecodable, "one of the samples in its text is no number"};
  }

  ByteSource& source_;
  std::vector<char> buffer_;
  std::size_t at_ = 0, filled_ = 0;
};

/// Writes all samples to `to`, the channels of a voxel side by side.
template <typename Stored, typename Given, typename Samples>
void Write(Samples&& samples, const ImageHeader& header, std::uint64_t run, std::byte* to) {
  constexpr std::size_t kChunk = 1 << 16;
  const std::uint64_t count = header.SampleCount(), channels = header.channels;
  std::vector<Stored> stored(kChunk);
  std::vector<Given> given(kChunk);
  for (std::uint64_t begin = 0; begin < count; begin += kChunk) {
    const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(count - begin, kChunk));
    samples.Read(stored, now);
    for (std::size_t i = 0; i < now; ++i) given[i] = static_cast<Given>(stored[i]);
    if (run == 1 || channels == 1) {
      std::memcpy(to + begin * sizeof(Given), given.data(), now * sizeof(Given));
      continue;
    }
    for (std::size_t i = 0; i < now; ++i) {
      const std::uint64_t at = begin + i, channel = at / run % channels, before = at / (run * channels) * run;
      std::memcpy(to + ((before + at % run) * channels + channel) * sizeof(Given), &given[i], sizeof(Given));
    }
  }
}

template <typename Stored, typename Given>
void Convert(ByteSource& source, const ImageHeader& header, const StoredSamples& stored, std::byte* to) {
  if (stored.packing == Packing::kText)
    Write<Stored, Given>(TextSamples<Stored>(source), header, stored.run, to);
  else
    Write<Stored, Given>(BinarySamples<Stored>(source, stored.is_big_endian), header, stored.run, to);
}

std::unique_ptr<ByteSource> Open(const InputFile& file, const StoredSamples& stored) {
  switch (stored.packing) {
    case Packing::kDeflated:
      return OpenDeflated(file, stored.begin);
    case Packing::kHex:
      return std::make_unique<HexSource>(file, stored.begin);
    default:
      return OpenPlain(file, stored.begin);
  }
}

/// Passes over `bytes`; fewer at the end. \return how many
std::uint64_t PassOver(ByteSource& source, std::uint64_t bytes) {
  std::vector<char> passed(1 << 16);
  for (std::uint64_t left = bytes; left > 0;) {
    const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(left, passed.size()));
    const std::size_t got = source.Read(passed.data(), now);
    left -= got;
    if (got != now) return bytes - left;
  }
  return bytes;
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

std::string ReadUnpacked(const InputFile& file, std::size_t most) {
  if (!IsGzip(file)) return ReadBegin(file, most);
  std::string bytes(most, '\0');
  bytes.resize(DeflatedSource(file, 0).Read(bytes.data(), bytes.size()));
  return bytes;
}

std::uint64_t CountUnpacked(const InputFile& file, std::uint64_t most) {
  if (!IsGzip(file)) return std::min(file.bytes, most);
  DeflatedSource source(file, 0);
  return PassOver(source, most);
}

bool IsGzip(const InputFile& file) {
  return ReadBegin(file, 2) == "\x1f\x8b";
}

FileKind FindKind(const InputFile& file) {
  constexpr std::size_t kEnough = 8000;  // comments may stand before what makes a MetaImage
  const FileKind plain = SniffKind(ReadBegin(file, kEnough));
  if (plain == FileKind::kDicom || !IsGzip(file)) return plain;
  const FileKind kind = SniffKind(ReadUnpacked(file, kEnough));
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

std::uint64_t BytesOfSamples(const ImageHeader& header, const StoredSamples& stored) {
  return CheckedProduct({header.SampleCount(), StoredBytes(stored.type)});
}

std::uint64_t SkipLines(const InputFile& file, std::uint64_t begin, std::uint64_t lines) {
  PlainSource source(file, begin);
  std::vector<char> buffer(1 << 16);
  for (std::uint64_t at = begin; lines > 0;) {
    const std::size_t got = source.Read(buffer.data(), buffer.size());
    if (got == 0)
      throw Failure{ErrorCode::kImageTruncated, "it has fewer lines than its \"line skip\" leaves out"};
    for (std::size_t i = 0; i < got && lines > 0; ++i) {
      if (buffer[i] == '\n' && --lines == 0) return at + i + 1;
    }
    at += got;
  }
  return begin;
}

void CheckBytesPresent(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                       const ImportRequest& request) {
  if (request.is_size_believed != 0) return;
  const std::uint64_t bytes = BytesOfSamples(header, stored);
  const std::uint64_t present = file.bytes - std::min(stored.begin, file.bytes);
  // fewest that they can be written in
  const std::uint64_t needed = stored.packing == Packing::kDeflated ? bytes / kMostDeflated
                               : stored.packing == Packing::kHex    ? CheckedProduct({bytes, 2})
                               : stored.packing == Packing::kText
                                   ? CheckedProduct({header.SampleCount(), 2}) - 1
                                   : bytes;
  if (needed <= present) return;
  throw Failure{ErrorCode::kImageTruncated, "its header announces " + std::to_string(bytes) +
                                                " bytes of samples, which the " + std::to_string(present) +
                                                " bytes there cannot hold"};
}

void ReadSamples(const ImageHeader& header, const StoredSamples& stored, const InputFile& file,
                 std::byte* to) {
  std::uint64_t skipped = stored.skipped;
  if (stored.bytes_after) {
    // counted by unpacking it once for nothing: keeping the end of a stream would take as much memory again
    const std::uint64_t all = PassOver(*Open(file, stored), std::numeric_limits<std::uint64_t>::max());
    std::uint64_t needed = BytesOfSamples(header, stored);
    if (__builtin_add_overflow(needed, *stored.bytes_after, &needed) || needed > all) FailAtEnd();
    skipped = all - needed;
  }
  const std::unique_ptr<ByteSource> source = Open(file, stored);
  if (PassOver(*source, skipped) != skipped) FailAtEnd();
  switch (stored.type) {
    case StoredType::kInt8:
      return Convert<std::int8_t, std::int16_t>(*source, header, stored, to);
    case StoredType::kUint8:
      return Convert<std::uint8_t, std::uint8_t>(*source, header, stored, to);
    case StoredType::kInt16:
      return Convert<std::int16_t, std::int16_t>(*source, header, stored, to);
    case StoredType::kUint16:
      return Convert<std::uint16_t, std::uint16_t>(*source, header, stored, to);
    case StoredType::kInt32:
      return Convert<std::int32_t, std::int32_t>(*source, header, stored, to);
    case StoredType::kUint32:
      return Convert<std::uint32_t, std::uint32_t>(*source, header, stored, to);
    case StoredType::kInt64:
      return Convert<std::int64_t, float>(*source, header, stored, to);
    case StoredType::kUint64:
      return Convert<std::uint64_t, float>(*source, header, stored, to);
    case StoredType::kFloat32:
      return Convert<float, float>(*source, header, stored, to);
    case StoredType::kFloat64:
      return Convert<double, float>(*source, header, stored, to);
  }
}

}  // namespace trocar::images::import
