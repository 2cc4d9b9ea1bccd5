// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "polhemus_layout.h"
#include "trocar/device/polhemus.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::device {
namespace {

using math::Quaternion;
using math::Vec3;
using Verdict = Parsed::Verdict;

constexpr Parsed kIncomplete{Verdict::kIncomplete, 0};
constexpr Parsed kGarbage{Verdict::kGarbage, 0};

/// No field reaches further [m].
constexpr double kReach = 10.0;
/// A unit quaternion in single precision is this near to one [-].
constexpr double kUnitTolerance = 0.01;

float ReadFloat(std::string_view bytes, std::size_t at) noexcept {
  std::uint32_t word = 0;
  for (int i = 3; i >= 0; --i)
    word = word << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  return std::bit_cast<float>(word);
}

Vec3 ReadFloats3(std::string_view bytes, std::size_t at) noexcept {
  return {ReadFloat(bytes, at), ReadFloat(bytes, at + 4), ReadFloat(bytes, at + 8)};
}

/// True for a letter, a space or a mark: what trackers put where an error would stand.
bool IsErrorMark(char mark) noexcept {
  return mark >= ' ' && mark <= '~';
}

bool SetPosition(const Vec3& inches, TrackerRecord& record) noexcept {
  record.position = inches * kMetresPerInch;
  // false for NaN too
  return std::fabs(record.position.x) <= kReach && std::fabs(record.position.y) <= kReach &&
         std::fabs(record.position.z) <= kReach;
}

bool SetRotation(const Quaternion& q, TrackerRecord& record) noexcept {
  const double norm = std::sqrt(math::SquaredNorm(q));
  if (!(std::fabs(norm - 1.0) <= kUnitTolerance)) return false;
  record.rotation = math::Normalized(q);
  return true;
}

bool SetEuler(const Vec3& degrees, TrackerRecord& record) noexcept {
  constexpr double kMostDegrees = 360.0;
  for (int i = 0; i < 3; ++i) {
    if (!(std::fabs(degrees[i]) <= kMostDegrees)) return false;
  }
  record.rotation = RotationFromEuler(degrees * (kPi / 180.0));
  return true;
}

bool ReadQuaternion(std::string_view bytes, std::size_t at, TrackerRecord& record) noexcept {
  return SetRotation(
      {ReadFloat(bytes, at), ReadFloat(bytes, at + 4), ReadFloat(bytes, at + 8), ReadFloat(bytes, at + 12)},
      record);
}

// --- FASTRAK, ASCII: columns, because values may touch

/// Could `mark` stand at this column of a number written as Sxxx.xx? Blanks come before digits.
bool FitsColumn(std::string_view field, std::size_t column) noexcept {
  const char mark = field[column];
  const bool is_digit = mark >= '0' && mark <= '9';
  if (column == 4) return mark == '.';
  if (column > 4) return is_digit;
  const char before = column == 0 ? ' ' : field[column - 1];
  if (mark == ' ') return before == ' ';
  if (mark == '-' || mark == '+') return before == ' ';
  return is_digit;
}

double ReadColumns(std::string_view field) noexcept {
  double value = 0;
  bool is_negative = false;
  for (const char mark : field) {
    if (mark == '-') is_negative = true;
    if (mark >= '0' && mark <= '9') value = 10.0 * value + (mark - '0');
  }
  value /= 100.0;
  return is_negative ? -value : value;
}

Parsed ParseFastrakAscii(std::string_view bytes, TrackerRecord& record) noexcept {
  const std::size_t have = std::min(bytes.size(), kFastrakAsciiLength);
  for (std::size_t i = kFastrakHeader; i < have; ++i) {
    if (i < kFastrakAsciiLength - 2) {
      const std::size_t column = (i - kFastrakHeader) % kColumns;
      if (!FitsColumn(bytes.substr(i - column, column + 1), column)) return kGarbage;
    } else if (bytes[i] != (i == kFastrakAsciiLength - 2 ? '\r' : '\n')) {
      return kGarbage;
    }
  }
  if (bytes.size() < kFastrakAsciiLength) return kIncomplete;
  Vec3 inches, degrees;
  for (int i = 0; i < 3; ++i) {
    inches[i] = ReadColumns(bytes.substr(kFastrakHeader + kColumns * static_cast<std::size_t>(i), kColumns));
    degrees[i] =
        ReadColumns(bytes.substr(kFastrakHeader + kColumns * static_cast<std::size_t>(i + 3), kColumns));
  }
  if (!SetPosition(inches, record) || !SetEuler(degrees, record)) return kGarbage;
  return {Verdict::kRecord, kFastrakAsciiLength};
}

Parsed ParseFastrakBinary(std::string_view bytes, TrackerRecord& record) noexcept {
  if (bytes.size() < kFastrakBinaryLength) return kIncomplete;
  const std::size_t at = kFastrakHeader;
  if (bytes[kFastrakBinaryLength - 1] != ' ' || !SetPosition(ReadFloats3(bytes, at), record) ||
      !ReadQuaternion(bytes, at + 12, record))
    return kGarbage;
  return {Verdict::kRecord, kFastrakBinaryLength};
}

Parsed ParseFastrak(PolhemusFormat format, std::string_view bytes, TrackerRecord& record) noexcept {
  if (bytes[0] != '0') return kGarbage;
  if (bytes.size() < 2) return kIncomplete;
  record.station = bytes[1] - '0';
  if (record.station < 1 || record.station > StationCount(format)) return kGarbage;
  if (bytes.size() < 3) return kIncomplete;
  record.error = bytes[2];
  if (!IsErrorMark(record.error)) return kGarbage;
  return format == PolhemusFormat::kFastrakAscii ? ParseFastrakAscii(bytes, record)
                                                 : ParseFastrakBinary(bytes, record);
}

// --- LIBERTY and PATRIOT

Parsed ParseFrame(PolhemusFormat format, std::string_view bytes, TrackerRecord& record) noexcept {
  const std::string_view preamble = Preamble(format);
  for (std::size_t i = 0; i < std::min(bytes.size(), preamble.size()); ++i) {
    if (bytes[i] != preamble[i]) return kGarbage;
  }
  if (bytes.size() < 3) return kIncomplete;
  record.station = static_cast<unsigned char>(bytes[2]);
  if (record.station < 1 || record.station > StationCount(format)) return kGarbage;
  if (bytes.size() < 4) return kIncomplete;
  if (bytes[3] != 'C' && bytes[3] != 'P') return kGarbage;
  if (bytes.size() < 5) return kIncomplete;
  record.error = bytes[4];
  if (bytes.size() < kFrameHeader) return kIncomplete;
  // a size that is none of the two lists is a lie, or not ours: never waited for
  const std::size_t size = static_cast<unsigned char>(bytes[6]) |
                           static_cast<std::size_t>(static_cast<unsigned char>(bytes[7])) << 8;
  if (size != kQuaternionPayload && size != kEulerPayload) return kGarbage;
  if (bytes.size() < kFrameHeader + size) return kIncomplete;
  if (!SetPosition(ReadFloats3(bytes, kFrameHeader), record)) return kGarbage;
  if (size == kQuaternionPayload) {
    if (bytes[kFrameHeader + size - 1] != ' ' || !ReadQuaternion(bytes, kFrameHeader + 12, record))
      return kGarbage;
  } else if (bytes.substr(kFrameHeader + size - 2, 2) != "\r\n" ||
             !SetEuler(ReadFloats3(bytes, kFrameHeader + 12), record)) {
    return kGarbage;
  }
  return {Verdict::kRecord, kFrameHeader + size};
}

}  // namespace

Parsed PolhemusFramer::Parse(std::string_view bytes, TrackerRecord& record) const noexcept {
  return IsFastrak(format_) ? ParseFastrak(format_, bytes, record) : ParseFrame(format_, bytes, record);
}

std::size_t PolhemusFramer::RecordLength() const noexcept {
  if (format_ == PolhemusFormat::kFastrakAscii) return kFastrakAsciiLength;
  return format_ == PolhemusFormat::kFastrakBinary ? kFastrakBinaryLength : kFrameHeader + kQuaternionPayload;
}

}  // namespace trocar::device
