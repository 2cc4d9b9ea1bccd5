// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>

#include "trocar/device/igtl.h"

namespace trocar::device {
namespace {

using math::Vec3;

constexpr std::size_t kTypeAt = 2, kTypeSize = 12, kNameAt = 14, kNameSize = 20, kBodySizeAt = 42,
                      kCrcAt = 50;
constexpr std::size_t kToolSize = 70, kToolPoseAt = 22;
constexpr std::size_t kExtendedHeaderSize = 12;
/// Bodies of other kinds, pictures for example, are passed over up to this; more than that is a lie [bytes].
constexpr std::uint64_t kMostSkipped = 1u << 28;
/// Larger than any room [m].
constexpr double kReach = 100.0;
/// An axis may be longer or shorter than 1, or lean towards another, by this much, and is put right: matrices that came through
/// texts of three digits stay below 0.002. A scale that somebody meant, of a registration for example, is more.
constexpr double kUnitTolerance = 0.005;
constexpr double kDegrees = 57.29577951308232;

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

struct PoseResult {
  bool is_good = false;
  IgtlFault fault{};
  std::array<double, 3> numbers{};
};

/// Columns of a matrix and the place behind them [mm]; orthonormalised within the tolerance.
PoseResult MakePose(const std::array<Vec3, 4>& columns, math::Pose& pose) noexcept {
  const auto refuse = [](IgtlFault fault, std::array<double, 3> numbers = {}) {
    return PoseResult{false, fault, numbers};
  };
  const auto& [x, y, z, place] = columns;
  if (x == Vec3{} && y == Vec3{} && z == Vec3{}) return refuse(IgtlFault::kZero);
  const std::array<double, 3> lengths = {math::Norm(x), math::Norm(y), math::Norm(z)};
  const double volume = math::Dot(math::Cross(x, y), z);
  if (!std::isfinite(volume) || !(math::Norm(place) / 1000.0 <= kReach)) return refuse(IgtlFault::kNumbers);
  if (lengths[0] * lengths[1] * lengths[2] == 0) return refuse(IgtlFault::kScale, lengths);
  // the largest cosine between two axes
  const double skew = std::max({std::fabs(math::Dot(x, y)) / (lengths[0] * lengths[1]),
                                std::fabs(math::Dot(x, z)) / (lengths[0] * lengths[2]),
                                std::fabs(math::Dot(y, z)) / (lengths[1] * lengths[2])});
  if (!(skew <= kUnitTolerance)) return refuse(IgtlFault::kSkew, {kDegrees * std::asin(std::min(skew, 1.0))});
  if (volume < 0) return refuse(IgtlFault::kMirror, lengths);
  for (const double length : lengths) {
    if (!(std::fabs(length - 1.0) <= kUnitTolerance)) return refuse(IgtlFault::kScale, lengths);
  }
  const Vec3 right = math::Normalized(x);
  const Vec3 up = math::Normalized(y - right * math::Dot(right, y));
  pose = {math::RotationFromAxes(right, up, math::Cross(right, up)), place / 1000.0};
  return {true};
}

float SwapBytes(float value) noexcept {
  const auto word = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>(word >> 24 | (word >> 8 & 0xff00) | (word << 8 & 0xff0000) | word << 24);
}

template <std::size_t kCount>
std::array<float, kCount> ReadFloats(std::string_view bytes) noexcept {
  std::array<float, kCount> numbers;
  for (std::size_t i = 0; i < kCount; ++i)
    numbers[i] = std::bit_cast<float>(static_cast<std::uint32_t>(ReadWord(bytes, 4 * i, 4)));
  return numbers;
}

PoseResult MakePose(const std::array<float, 12>& numbers, math::Pose& pose) noexcept {
  std::array<Vec3, 4> columns;
  for (std::size_t i = 0; i < numbers.size(); ++i) columns[i / 3][static_cast<int>(i % 3)] = numbers[i];
  return MakePose(columns, pose);
}

/// A place [mm] and a quaternion x, y, z, w.
PoseResult MakePose(const std::array<float, 7>& numbers, math::Pose& pose) noexcept {
  const math::Quaternion q{numbers[6], numbers[3], numbers[4], numbers[5]};
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  const Vec3 place{numbers[0] / 1000.0, numbers[1] / 1000.0, numbers[2] / 1000.0};
  if (length == 0) return {false, IgtlFault::kZero, {}};
  if (!std::isfinite(length) || !(math::Norm(place) <= kReach)) return {false, IgtlFault::kNumbers, {}};
  if (std::fabs(length - 1.0) > kUnitTolerance) return {false, IgtlFault::kScale, {length, length, length}};
  pose = {math::Normalized(q), place};
  return {true};
}

/// A place [mm] and a quaternion's x, y and z: w is what makes its length 1, and never negative, as the reference library has it
/// (igtlPositionMessage.cxx, UnpackContent). Longer than 1, it belongs to no rotation; the library takes none then.
PoseResult MakePose(const std::array<float, 6>& numbers, math::Pose& pose) noexcept {
  // numbers of the wrong byte order are often next to nothing, and would pass for no rotation
  constexpr float kLeast = 1e-30f;
  const bool is_tiny = std::any_of(numbers.begin(), numbers.end(),
                                   [](float number) { return number != 0 && std::fabs(number) < kLeast; });
  if (is_tiny) return {false, IgtlFault::kNumbers, {}};
  std::array<float, 7> all;
  std::copy(numbers.begin(), numbers.end(), all.begin());
  double square = 0;
  for (std::size_t i = 3; i < numbers.size(); ++i) square += double{numbers[i]} * numbers[i];
  all[6] = static_cast<float>(std::sqrt(std::max(0.0, 1.0 - square)));
  return MakePose(all, pose);
}

template <std::size_t kCount>
PoseResult ReadPose(std::string_view bytes, math::Pose& pose) noexcept {
  std::array<float, kCount> numbers = ReadFloats<kCount>(bytes);
  PoseResult result = MakePose(numbers, pose);
  if (result.is_good) return result;
  for (float& number : numbers) number = SwapBytes(number);
  if (math::Pose swapped; MakePose(numbers, swapped).is_good) result.fault = IgtlFault::kByteOrder;
  return result;
}

/// How the kinds that are read are laid out [bytes].
struct Layout {
  std::string_view type;
  std::size_t step;     // of one pose
  std::size_t pose_at;  // in it
  bool has_tools;       // several, each with its name before it
  bool has_quaternion;
};
constexpr std::array<Layout, 4> kLayouts = {{{"TRANSFORM", 48, 0, false, false},
                                             {"TDATA", kToolSize, kToolPoseAt, true, false},
                                             {"POSITION", 28, 0, false, true},
                                             {"QTDATA", 50, kToolPoseAt, true, true}}};
constexpr std::size_t kPlaceSize = 12;          // of a POSITION without its quaternion
constexpr std::size_t kShortPositionSize = 24;  // of one with the quaternion's first three numbers

const Layout* FindLayout(std::string_view type) noexcept {
  const auto found = std::find_if(kLayouts.begin(), kLayouts.end(),
                                  [&](const Layout& layout) { return layout.type == type; });
  return found == kLayouts.end() ? nullptr : &*found;
}

bool IsPrintable(std::string_view text) noexcept {
  return std::all_of(text.begin(), text.end(), [](char mark) { return mark > ' ' && mark <= '~'; });
}

}  // namespace

void IgtlReader::Restart() noexcept {
  size_ = 0;
  wanted_ = kIgtlHeaderSize;
  to_skip_ = 0;
  is_header_bad_ = false;
}

bool IgtlReader::Feed(std::string_view bytes, const Sink& sink) {
  if (is_header_bad_) return false;
  byte_count_ += bytes.size();
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
    is_header_bad_ = true;
    return false;
  }
  const Layout* layout = FindLayout(type);
  const bool is_read = layout != nullptr;
  if (is_read && body <= kCapacity - kIgtlHeaderSize) {
    wanted_ = kIgtlHeaderSize + static_cast<std::size_t>(body);
    return true;
  }
  ++(is_read ? counts_.bad : counts_.skipped);
  IgtlSeen* seen = See(type, ReadName(header, kNameAt, kNameSize));
  if (is_read) {
    Refuse(seen, layout->has_tools ? IgtlFault::kManyTools : IgtlFault::kSize, {body});
  }
  to_skip_ = body;
  size_ = 0;
  wanted_ = kIgtlHeaderSize;
  return true;
}

/// \return null where the table is full of others
IgtlSeen* IgtlReader::See(std::string_view type, std::string_view name) noexcept {
  const auto is_it = [](const auto& room, std::string_view text) {
    return ReadName({room.data(), room.size()}, 0, room.size()) == text;
  };
  for (std::size_t i = 0; i < seen_count_; ++i) {
    IgtlSeen& seen = seen_[i];
    if (!is_it(seen.type, type) || !is_it(seen.name, name)) continue;
    ++seen.came;
    return &seen;
  }
  if (seen_count_ == seen_.size()) {
    ++unseen_;
    return nullptr;
  }
  IgtlSeen& seen = seen_[seen_count_++];
  seen = {};
  type.copy(seen.type.data(), seen.type.size());
  name.copy(seen.name.data(), seen.name.size());
  seen.came = 1;
  return &seen;
}

void IgtlReader::Refuse(IgtlSeen* seen, IgtlFault fault, std::array<std::uint64_t, 2> words,
                        std::array<double, 3> numbers) noexcept {
  if (seen == nullptr) return;
  ++seen->refused;
  seen->fault = fault;
  seen->words = words;
  seen->numbers = numbers;
}

void IgtlReader::ReadBody(const Sink& sink) {
  const std::string_view header(buffer_.data(), kIgtlHeaderSize);
  std::string_view body(buffer_.data() + kIgtlHeaderSize, size_ - kIgtlHeaderSize);
  const std::string_view type = ReadName(header, kTypeAt, kTypeSize),
                         device = ReadName(header, kNameAt, kNameSize);
  const auto refuse = [&](IgtlFault fault, std::array<std::uint64_t, 2> words) {
    ++counts_.bad;
    Refuse(See(type, device), fault, words);
  };
  const std::uint64_t told = ReadWord(header, kCrcAt, 8), belongs = CalcIgtlCrc(body);
  if (told != belongs) {
    refuse(told == 0 ? IgtlFault::kNoChecksum : IgtlFault::kChecksum, {told, belongs});
    return;
  }
  if (ReadWord(header, 0, 2) >= 2) {
    // extended header and metadata stand around the content
    const std::size_t before = body.size() < kExtendedHeaderSize ? body.size() + 1 : ReadWord(body, 0, 2);
    const std::uint64_t behind =
        before > body.size() ? 0 : std::uint64_t{ReadWord(body, 2, 2)} + ReadWord(body, 4, 4);
    if (before < kExtendedHeaderSize || before > body.size() || behind > body.size() - before) {
      refuse(IgtlFault::kExtendedHeader, {body.size()});
      return;
    }
    body = body.substr(before, body.size() - before - static_cast<std::size_t>(behind));
  }
  const Layout& layout = *FindLayout(type);
  if (layout.has_tools && body.empty()) {  // none is seen just now
    (void)See(type, device);
    ++counts_.messages;
    return;
  }
  const bool is_short = !layout.has_tools && layout.has_quaternion && body.size() == kShortPositionSize;
  const std::size_t step = is_short ? kShortPositionSize : layout.step;
  if (layout.has_tools ? body.size() % step != 0 : body.size() != step) {
    refuse(layout.has_quaternion && body.size() == kPlaceSize ? IgtlFault::kNoRotation : IgtlFault::kSize,
           {body.size()});
    return;
  }
  bool is_good = true;
  for (; !body.empty(); body.remove_prefix(step)) {
    IgtlPose tool;
    tool.name = layout.has_tools ? ReadName(body, 0, kNameSize) : device;
    IgtlSeen* seen = See(type, tool.name);
    const std::string_view bytes = body.substr(layout.pose_at);
    const PoseResult result = is_short                ? ReadPose<6>(bytes, tool.pose)
                              : layout.has_quaternion ? ReadPose<7>(bytes, tool.pose)
                                                      : ReadPose<12>(bytes, tool.pose);
    if (!result.is_good) {
      is_good = false;
      Refuse(seen, result.fault, {}, result.numbers);
      continue;
    }
    if (seen != nullptr) ++seen->poses;
    sink(tool);
  }
  ++(is_good ? counts_.messages : counts_.bad);
}

}  // namespace trocar::device
