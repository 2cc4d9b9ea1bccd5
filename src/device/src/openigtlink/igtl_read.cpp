// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>

#include "trocar/core/printable.h"
#include "trocar/device/igtl.h"

namespace trocar::device {
namespace {

using math::Vec3;

constexpr std::size_t kTypeAt = 2, kTypeSize = 12, kNameAt = 14, kNameSize = 20, kBodySizeAt = 42,
                      kCrcAt = 50;
constexpr std::size_t kTransformSize = 48;
constexpr std::size_t kToolSize = 70, kToolPoseAt = 22;
constexpr std::size_t kExtendedHeaderSize = 12;
/// Bodies of other kinds, pictures for example, are passed over up to this; more than that is a lie [bytes].
constexpr std::uint64_t kMostSkipped = 1u << 28;
/// Larger than any room [m].
constexpr double kReach = 100.0;
constexpr double kUnitTolerance = 0.02;

std::uint64_t ReadWord(std::string_view bytes, std::size_t at, std::size_t size) noexcept {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < size; ++i) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

/// A name that ends at the first zero byte or at its room.
std::string_view ReadName(std::string_view bytes, std::size_t at, std::size_t size) noexcept {
  const std::string_view room = bytes.substr(at, size);
  return room.substr(0, std::min(room.find('\0'), room.size()));
}

/// \return false where the numbers are no rigid pose
bool ReadPose(std::string_view bytes, math::Pose& pose) noexcept {
  Vec3 columns[4];
  for (std::size_t i = 0; i < 12; ++i) {
    columns[i / 3][static_cast<int>(i % 3)] =
        std::bit_cast<float>(static_cast<std::uint32_t>(ReadWord(bytes, 4 * i, 4)));
  }
  const auto is_unit = [](const Vec3& v) { return std::fabs(math::Norm(v) - 1.0) <= kUnitTolerance; };
  if (!is_unit(columns[0]) || !is_unit(columns[1]) || !is_unit(columns[2])) return false;
  if (!(math::Dot(math::Cross(columns[0], columns[1]), columns[2]) >= 1.0 - 3.0 * kUnitTolerance))
    return false;
  pose.translation = columns[3] / 1000.0;
  if (!(math::Norm(pose.translation) <= kReach)) return false;
  const Vec3 x = math::Normalized(columns[0]);
  const Vec3 y = math::Normalized(columns[1] - x * math::Dot(x, columns[1]));
  pose.rotation = math::RotationFromAxes(x, y, math::Cross(x, y));
  return true;
}

bool IsPrintable(std::string_view text) noexcept {
  return std::all_of(text.begin(), text.end(), [](char mark) { return mark > ' ' && mark <= '~'; });
}

}  // namespace

void IgtlReader::Restart() noexcept {
  size_ = 0;
  wanted_ = kIgtlHeaderSize;
  to_skip_ = 0;
}

bool IgtlReader::Feed(std::string_view bytes, const Sink& sink) {
  while (!bytes.empty()) {
    if (to_skip_ > 0) {
      const std::size_t passed = static_cast<std::size_t>(std::min<std::uint64_t>(to_skip_, bytes.size()));
      bytes.remove_prefix(passed);
      to_skip_ -= passed;
      continue;
    }
    const std::size_t taken = std::min(bytes.size(), wanted_ - size_);
    std::copy_n(bytes.data(), taken, buffer_.data() + size_);
    size_ += taken;
    bytes.remove_prefix(taken);
    if (size_ < wanted_) continue;
    if (size_ == kIgtlHeaderSize && wanted_ == kIgtlHeaderSize) {
      if (!ReadHeader()) return false;
      if (size_ < wanted_) continue;
    }
    if (size_ > 0) ReadBody(sink);
    size_ = 0;
    wanted_ = kIgtlHeaderSize;
  }
  return true;
}

/// Decides by a whole header what becomes of the body; every size is checked before it is believed (faults D7).
bool IgtlReader::ReadHeader() noexcept {
  const std::string_view header(buffer_.data(), kIgtlHeaderSize);
  const std::uint64_t version = ReadWord(header, 0, 2);
  const std::string_view type = ReadName(header, kTypeAt, kTypeSize);
  const std::uint64_t body = ReadWord(header, kBodySizeAt, 8);
  if (version < 1 || version > 3 || type.empty() || !IsPrintable(type) || body > kMostSkipped) {
    ++counts_.bad;
    return false;
  }
  const bool is_read = type == "TRANSFORM" || type == "TDATA";
  if (is_read && body <= kCapacity - kIgtlHeaderSize) {
    wanted_ = kIgtlHeaderSize + static_cast<std::size_t>(body);
    return true;
  }
  ++(is_read ? counts_.bad : counts_.skipped);
  if (is_read) {
    ++counts_.large;
    std::copy_n(buffer_.data() + kTypeAt, large_name_.size(), large_name_.begin());
    large_size_ = body;
  }
  to_skip_ = body;
  size_ = 0;
  wanted_ = kIgtlHeaderSize;
  return true;
}

std::string IgtlReader::DescribeLarge() const {
  if (counts_.large == 0) return {};
  const std::string_view name(large_name_.data(), large_name_.size());
  return std::to_string(counts_.large) + " messages had more than " + std::to_string(kMostIgtlTools) +
         " tools and were passed over, the last " + std::string(ReadName(name, 0, kTypeSize)) + " \"" +
         core::Printable(ReadName(name, kTypeSize, kNameSize)) + "\" of " + std::to_string(large_size_) +
         " bytes; let the server send fewer tools in one message";
}

void IgtlReader::ReadBody(const Sink& sink) {
  const std::string_view header(buffer_.data(), kIgtlHeaderSize);
  std::string_view body(buffer_.data() + kIgtlHeaderSize, size_ - kIgtlHeaderSize);
  if (ReadWord(header, kCrcAt, 8) != CalcIgtlCrc(body)) {
    ++counts_.bad;
    return;
  }
  if (ReadWord(header, 0, 2) >= 2) {
    // extended header and metadata stand around the content
    const std::size_t before = body.size() < kExtendedHeaderSize ? body.size() + 1 : ReadWord(body, 0, 2);
    if (before < kExtendedHeaderSize || before > body.size()) {
      ++counts_.bad;
      return;
    }
    const std::uint64_t behind = ReadWord(body, 2, 2) + ReadWord(body, 4, 4);
    if (behind > body.size() - before) {
      ++counts_.bad;
      return;
    }
    body = body.substr(before, body.size() - before - static_cast<std::size_t>(behind));
  }
  const bool is_transform = ReadName(header, kTypeAt, kTypeSize) == "TRANSFORM";
  if (is_transform ? body.size() != kTransformSize : body.empty() || body.size() % kToolSize != 0) {
    ++counts_.bad;
    return;
  }
  bool is_good = true;
  const std::size_t step = is_transform ? kTransformSize : kToolSize;
  for (; !body.empty(); body.remove_prefix(step)) {
    IgtlPose tool;
    tool.name = is_transform ? ReadName(header, kNameAt, kNameSize) : ReadName(body, 0, kNameSize);
    if (ReadPose(body.substr(is_transform ? 0 : kToolPoseAt), tool.pose)) {
      sink(tool);
    } else {
      is_good = false;
    }
  }
  ++(is_good ? counts_.messages : counts_.bad);
}

}  // namespace trocar::device
