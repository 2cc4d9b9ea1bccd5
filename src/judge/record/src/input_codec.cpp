// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/input_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "input_fields.h"
#include "trocar/base/state_archive.h"
#include "trocar/base/to_integer.h"

namespace trocar::record {

using scene::Input;

namespace {

constexpr int kGridBits = 30;
/// Largest multiple of the grid that is encoded as one; a double holds it exactly.
constexpr double kMostMultiple = 9007199254740992.0;  // 2^53

/// How a joint is written, two bits each.
enum class JointCode : std::uint32_t {
  kSame,   // bit for bit the last one
  kGrid,   // both on the grid: how far from where a steady motion would lead
  kOther,  // of format 1: its bits, exclusive-or those of where a steady motion would lead
  kBits  // its place among all doubles, less that of where a steady acceleration would lead, in as many bits as it needs
};
constexpr std::uint32_t kControlsChange = 1u << 30;
constexpr std::uint32_t kSettingsChange = 1u << 31;
static_assert(2 * kJointCount <= 30);

bool HaveSameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// As a multiple of the grid; false where it is none.
bool FindMultiple(double value, std::int64_t& multiple) {
  const double scaled = std::ldexp(value, kGridBits);
  if (!(std::abs(scaled) < kMostMultiple)) return false;
  multiple = base::TruncateTo<std::int64_t>(scaled);
  return HaveSameBits(std::ldexp(static_cast<double>(multiple), -kGridBits), value);
}

void PutVarint(std::uint64_t value, std::vector<std::byte>& bytes) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<std::byte>(value | 0x80));
  bytes.push_back(static_cast<std::byte>(value));
}

bool TakeByte(std::span<const std::byte>& bytes, std::uint8_t& value) {
  if (bytes.empty()) return false;
  value = static_cast<std::uint8_t>(bytes.front());
  bytes = bytes.subspan(1);
  return true;
}

bool TakeVarint(std::span<const std::byte>& bytes, std::uint64_t& value) {
  value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    std::uint8_t byte = 0;
    if (!TakeByte(bytes, byte)) return false;
    value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
    if (byte < 0x80) return true;
  }
  return false;
}

std::uint64_t ZigZag(std::int64_t value) {
  return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}
std::int64_t UnZigZag(std::uint64_t value) {
  return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
}

/// Where a steady motion leads. What is not a number has bits that depend on the processor: none of those.
double Predict(double last, double before_last) {
  const double next = 2 * last - before_last;
  return std::isfinite(next) ? next : 0.0;
}

/// Where a steady acceleration leads: hands of programs move smoothly.
double PredictBent(double last, double before_last, double third_last) {
  const double next = 3 * last - 3 * before_last + third_last;
  return std::isfinite(next) ? next : 0.0;
}

/// The place of a double among all of them: neighbours differ by one, of either sign, and every place has one.
std::uint64_t PlaceOf(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return bits >> 63 != 0 ? bits ^ 0x7fffffffffffffffULL : bits;
}
double AtPlace(std::uint64_t place) {
  return std::bit_cast<double>(place >> 63 != 0 ? place ^ 0x7fffffffffffffffULL : place);
}

/// Bits one after the other, the lowest first.
class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  void Put(std::uint64_t word, int count) {
    for (int i = 0; i < count; ++i, ++filled_) {
      if (filled_ % 8 == 0) bytes_.push_back(std::byte{0});
      bytes_.back() |= static_cast<std::byte>((word >> i & 1) << (filled_ % 8));
    }
  }

 private:
  std::vector<std::byte>& bytes_;
  int filled_ = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::byte>& bytes) : bytes_(bytes) {}
  bool Take(int count, std::uint64_t& word) {
    word = 0;
    for (int i = 0; i < count; ++i) {
      if (left_ == 0) {
        if (!TakeByte(bytes_, now_)) return false;
        left_ = 8;
      }
      word |= static_cast<std::uint64_t>(now_ >> (8 - left_) & 1) << i;
      --left_;
    }
    return true;
  }

 private:
  std::span<const std::byte>& bytes_;
  std::uint8_t now_ = 0;
  int left_ = 0;
};

/// A word by its width, six bits, and the bits below its highest one; from this width on all 64.
constexpr int kWholeWord = 63;

void PutWord(std::uint64_t word, BitWriter& bits) {
  const int width = std::min(static_cast<int>(std::bit_width(word)), kWholeWord);
  bits.Put(static_cast<std::uint64_t>(width), 6);
  bits.Put(word, width == kWholeWord ? 64 : std::max(0, width - 1));
}

bool TakeWord(BitReader& bits, std::uint64_t& word) {
  std::uint64_t width = 0;
  if (!bits.Take(6, width)) return false;
  if (width == kWholeWord) return bits.Take(64, word);
  word = 0;
  if (width == 0) return true;
  if (!bits.Take(static_cast<int>(width) - 1, word)) return false;
  word |= std::uint64_t{1} << (width - 1);
  return true;
}

bool TakeLowBytes(std::span<const std::byte>& bytes, std::uint64_t& word) {
  std::uint8_t count = 0;
  if (!TakeByte(bytes, count) || count > 8 || bytes.size() < count) return false;
  word = 0;
  for (int i = 0; i < count; ++i)
    word |= static_cast<std::uint64_t>(bytes[static_cast<std::size_t>(i)]) << (8 * i);
  bytes = bytes.subspan(count);
  return true;
}

void SetJoints(const std::array<double, kJointCount>& joints, Input& input) {
  std::size_t i = 0;
  for (instrument::TrocarJoints* part : {&input.hands[0], &input.hands[1], &input.laparoscope}) {
    for (double* joint : {&part->pan, &part->tilt, &part->spin, &part->depth, &part->jaw})
      *joint = joints[i++];
  }
}

template <typename T>
void PutFields(T& value, std::vector<std::byte>& bytes) {
  base::StateArchive archive = base::StateArchive::ForSave(bytes);
  archive.Field("value", value);
}

/// A value of fixed size.
template <typename T>
bool TakeFields(std::span<const std::byte>& bytes, T& value) {
  std::vector<std::byte> sample;
  PutFields(value, sample);
  if (bytes.size() < sample.size()) return false;
  base::StateArchive archive = base::StateArchive::ForRestore(bytes.first(sample.size()));
  archive.Field("value", value);
  bytes = bytes.subspan(sample.size());
  return archive.ok();
}

/// What changes seldom: feet, tools, the assistant.
struct Controls {
  std::array<scene::HandControls, instrument::kHandCount> hands;
  scene::AssistantCommand assistant = scene::AssistantCommand::kWait;

  void VisitState(base::StateArchive& archive) {
    archive.Field("hands", hands);
    archive.Field("assistant", assistant);
  }
  friend bool operator==(const Controls&, const Controls&) = default;
};
Controls ControlsOf(const Input& input) {
  return {input.controls, input.assistant};
}

}  // namespace

std::array<double, kJointCount> ListJoints(const Input& input) noexcept {
  std::array<double, kJointCount> joints{};
  std::size_t i = 0;
  for (const instrument::TrocarJoints* part : {&input.hands[0], &input.hands[1], &input.laparoscope}) {
    for (const double joint : {part->pan, part->tilt, part->spin, part->depth, part->jaw})
      joints[i++] = joint;
  }
  return joints;
}

void RoundJoints(Input& input) noexcept {
  auto joints = ListJoints(input);
  for (double& joint : joints) {
    const double scaled = std::ldexp(joint, kGridBits);
    // adding zero makes -0.0 the zero that is on the grid
    if (std::abs(scaled) < kMostMultiple) joint = std::ldexp(std::nearbyint(scaled), -kGridBits) + 0.0;
  }
  SetJoints(joints, input);
}

void InputEncoder::Encode(const Input& input, std::vector<std::byte>& bytes) {
  const auto joints = ListJoints(input), last = ListJoints(last_);
  std::array<std::byte, 4> head{};
  const std::size_t start = bytes.size();
  bytes.insert(bytes.end(), head.begin(), head.end());
  std::uint32_t codes = 0;
  std::vector<std::byte> packed;  // of all joints off the grid: after the others
  BitWriter bits(packed);
  for (std::size_t i = 0; i < kJointCount; ++i) {
    JointCode code = JointCode::kSame;
    std::int64_t now = 0, one = 0, two = 0;
    if (HaveSameBits(joints[i], last[i])) {
      code = JointCode::kSame;
    } else if (FindMultiple(joints[i], now) && FindMultiple(last[i], one) &&
               FindMultiple(before_last_[i], two)) {
      code = JointCode::kGrid;
      PutVarint(ZigZag(now - (2 * one - two)), bytes);
    } else {
      code = JointCode::kBits;
      const double expected = PredictBent(last[i], before_last_[i], third_last_[i]);
      PutWord(ZigZag(static_cast<std::int64_t>(PlaceOf(joints[i]) - PlaceOf(expected))), bits);
    }
    codes |= static_cast<std::uint32_t>(code) << (2 * i);
  }
  bytes.insert(bytes.end(), packed.begin(), packed.end());
  if (Controls now = ControlsOf(input); now != ControlsOf(last_)) {
    codes |= kControlsChange;
    PutFields(now, bytes);
  }
  if (scene::LiveSettings now = input.settings; !HaveSameFields(now, last_.settings)) {
    codes |= kSettingsChange;
    PutFields(now, bytes);
  }
  for (std::size_t i = 0; i < head.size(); ++i) bytes[start + i] = static_cast<std::byte>(codes >> (8 * i));
  third_last_ = before_last_;
  before_last_ = last;
  last_ = input;
}

bool InputDecoder::Decode(std::span<const std::byte>& bytes, Input& input) {
  std::uint32_t codes = 0;
  for (int i = 0; i < 4; ++i) {
    std::uint8_t byte = 0;
    if (!TakeByte(bytes, byte)) return false;
    codes |= static_cast<std::uint32_t>(byte) << (8 * i);
  }
  const auto last = ListJoints(last_);
  auto joints = last;
  for (std::size_t i = 0; i < kJointCount; ++i) {
    std::int64_t one = 0, two = 0;
    std::uint64_t word = 0;
    switch (static_cast<JointCode>(codes >> (2 * i) & 3)) {
      case JointCode::kSame:
        break;
      case JointCode::kGrid:
        if (!FindMultiple(last[i], one) || !FindMultiple(before_last_[i], two) || !TakeVarint(bytes, word))
          return false;
        joints[i] = std::ldexp(static_cast<double>(2 * one - two + UnZigZag(word)), -kGridBits);
        break;
      case JointCode::kOther:
        if (!TakeLowBytes(bytes, word)) return false;
        joints[i] =
            std::bit_cast<double>(word ^ std::bit_cast<std::uint64_t>(Predict(last[i], before_last_[i])));
        break;
      case JointCode::kBits:
        break;
    }
  }
  BitReader bits(bytes);
  for (std::size_t i = 0; i < kJointCount; ++i) {
    if (static_cast<JointCode>(codes >> (2 * i) & 3) != JointCode::kBits) continue;
    std::uint64_t word = 0;
    if (!TakeWord(bits, word)) return false;
    const double expected = PredictBent(last[i], before_last_[i], third_last_[i]);
    joints[i] = AtPlace(PlaceOf(expected) + static_cast<std::uint64_t>(UnZigZag(word)));
  }
  Input now = last_;
  SetJoints(joints, now);
  if ((codes & kControlsChange) != 0) {
    Controls controls;
    if (!TakeFields(bytes, controls)) return false;
    now.controls = controls.hands;
    now.assistant = controls.assistant;
  }
  if ((codes & kSettingsChange) != 0 && !TakeFields(bytes, now.settings)) return false;
  third_last_ = before_last_;
  before_last_ = last;
  last_ = now;
  input = now;
  return true;
}

}  // namespace trocar::record
