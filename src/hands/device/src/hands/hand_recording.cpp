// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/hand_recording.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include "trocar/host/safe_file.h"

namespace trocar::device {
namespace {

constexpr std::string_view kHands[kChannelCount] = {"left", "right", "laparoscope"};
constexpr std::string_view kHandColumns[] = {"seen",    "pan_rad", "tilt_rad", "spin_rad",
                                             "depth_m", "jaw_rad", "buttons"};
constexpr std::size_t kMostColumns = std::size(kHandColumns);
constexpr std::size_t kColumnsBefore = kMostColumns - 1;  // recordings of earlier versions have no buttons

std::string Heading(std::size_t columns) {
  std::string line = "time_s";
  for (const std::string_view hand : kHands) {
    for (std::size_t i = 0; i < columns; ++i)
      line.append(",").append(hand).append("_").append(kHandColumns[i]);
  }
  return line;
}

void Append(std::string& text, double value) {
  char digits[32];
  const auto [end, failure] = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, failure == std::errc() ? end : digits);
}

/// Exactly `values.size()` finite numbers with commas between.
bool ReadRow(std::string_view line, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) {
      if (!line.starts_with(',')) return false;
      line.remove_prefix(1);
    }
    const auto [end, failure] = std::from_chars(line.data(), line.data() + line.size(), values[i]);
    if (failure != std::errc() || !std::isfinite(values[i])) return false;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  }
  return line.empty();
}

// what a hand can be at
constexpr double kMostTime = 36'000;                // [s]
constexpr double kMostTilt = 3.141592653589793;     // pan and tilt [rad]
constexpr double kMostSpin = 1000;                  // many turns [rad]
constexpr double kMostDepth = 1, kLeastDepth = -1;  // [m]
constexpr double kMostJaw = 3.141592653589793;      // [rad]

bool IsOfAHand(const HandSample& hand) noexcept {
  return std::fabs(hand.pan) <= kMostTilt && std::fabs(hand.tilt) <= kMostTilt &&
         std::fabs(hand.spin) <= kMostSpin && hand.depth >= kLeastDepth && hand.depth <= kMostDepth &&
         hand.jaw >= 0 && hand.jaw <= kMostJaw;
}

/// `from`, moved towards `to` as far as a hand gets in `dt` [s]; all joints arrive together.
HandSample Approach(const HandSample& from, const HandSample& to, double dt) noexcept {
  const double reach = std::max({0.05, std::fabs(from.depth), std::fabs(to.depth)});
  const double way =
      std::max(std::fabs(to.depth - from.depth), reach * std::hypot(to.pan - from.pan, to.tilt - from.tilt));
  const double turn = std::max(std::fabs(to.spin - from.spin), std::fabs(to.jaw - from.jaw));
  const double needed = std::max(way / kMaxPlaySpeed, turn / kMaxPlayTurnRate);  // [s]
  HandSample hand = to;
  if (needed <= dt) return hand;
  const double share = dt / needed;
  const auto between = [share](double a, double b) { return a + share * (b - a); };
  hand.pan = between(from.pan, to.pan);
  hand.tilt = between(from.tilt, to.tilt);
  hand.spin = between(from.spin, to.spin);
  hand.depth = between(from.depth, to.depth);
  hand.jaw = between(from.jaw, to.jaw);
  return hand;
}

/// \return false where a hand's buttons are no whole number of 32 bits
bool MakeFrame(std::span<const double> row, std::size_t columns, HandFrame& frame) {
  frame.time = row[0];
  for (std::size_t i = 0; i < frame.hands.size(); ++i) {
    const auto hand = row.subspan(1 + i * columns, columns);
    frame.hands[i] = {hand[1], hand[2], hand[3], hand[4], hand[5], frame.time, hand[0] != 0.0};
    if (columns == kColumnsBefore) continue;
    const double buttons = hand[kColumnsBefore];
    constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
    if (!(buttons >= 0.0 && buttons <= kMost) || buttons != std::floor(buttons)) return false;
    frame.hands[i].buttons = static_cast<std::uint32_t>(buttons);
  }
  return true;
}

}  // namespace

std::string FormatHandFrames(const std::vector<HandFrame>& frames) {
  std::string text = Heading(kMostColumns) + "\n";
  for (const HandFrame& frame : frames) {
    Append(text, frame.time);
    for (const HandSample& hand : frame.hands) {
      text += hand.is_valid ? ",1" : ",0";
      for (const double joint : {hand.pan, hand.tilt, hand.spin, hand.depth, hand.jaw}) {
        text += ',';
        Append(text, joint);
      }
      text += ',' + std::to_string(hand.buttons);
    }
    text += '\n';
  }
  return text;
}

base::Result<std::vector<HandFrame>> ParseHandFrames(std::string_view text, const std::string& name) {
  const auto fail = [&](std::size_t line, const std::string& why) {
    return base::Error{base::ErrorCode::kDeviceSettings,
                       name + ": line " + std::to_string(line) + ": " + why};
  };
  std::vector<HandFrame> frames;
  std::array<double, 1 + kChannelCount * kMostColumns> room;
  std::size_t columns = kMostColumns;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return fail(line, "cut short; take this line away to play the rest");
    std::string_view words = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (words.ends_with('\r')) words.remove_suffix(1);
    if (line == 1) {
      if (words == Heading(kColumnsBefore)) columns = kColumnsBefore;
      if (words != Heading(columns)) return fail(1, "no recording of hands; trocar devices record makes one");
      continue;
    }
    const std::span<double> row = std::span(room).first(1 + kChannelCount * columns);
    if (!ReadRow(words, row)) return fail(line, "not " + std::to_string(row.size()) + " finite numbers");
    if (!frames.empty() && row[0] < frames.back().time) return fail(line, "the time falls");
    if (!MakeFrame(row, columns, frames.emplace_back()))
      return fail(line, "buttons are a whole number of 32 bits");
    const HandFrame& frame = frames.back();
    if (!(frame.time >= 0 && frame.time <= kMostTime) ||
        !std::all_of(frame.hands.begin(), frame.hands.end(), IsOfAHand))
      return fail(line,
                  "no hand gets there: times are 0 to 36000 s, pan, tilt and jaws within half a turn, depths "
                  "within 1 m");
  }
  if (frames.empty()) return fail(1, "no frame in it; record again");
  return frames;
}

HandPlayer::HandPlayer(std::filesystem::path path, Clock& clock)
    : Driver("recording", kChannelCount), path_(std::move(path)), clock_(clock) {}

base::Status HandPlayer::DoConfigure() {
  const base::Result<std::string> text = host::ReadFile(path_);
  if (!text) return text.error();
  base::Result<std::vector<HandFrame>> frames = ParseHandFrames(*text, path_.string());
  if (!frames) return frames.error();
  frames_ = std::move(*frames);
  return {};
}

base::Status HandPlayer::DoActivate() {
  start_ = clock_.Now();
  last_ = 0;
  next_ = 0;
  hands_ = homes_;
  is_known_ = is_placed_;
  return {};
}

void HandPlayer::PlaceHand(int channel, const HandSample& home) noexcept {
  if (channel < 0 || channel >= kChannelCount || !IsFinite(home)) return;
  homes_[static_cast<std::size_t>(channel)] = home;
  is_placed_[static_cast<std::size_t>(channel)] = true;
}

ReadStatus HandPlayer::DoRead(std::span<HandSample> samples) noexcept {
  const double time = clock_.Now() - start_;
  const std::size_t before = next_;
  while (next_ < frames_.size() && frames_[next_].time <= time) ++next_;
  const double dt = std::max(0.0, time - last_);
  last_ = time;
  bool is_under_way = false;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = next_ > 0 ? frames_[next_ - 1].hands[i] : HandSample{};
    if (!samples[i].is_valid) continue;  // stays where it is
    const HandSample wanted = samples[i];
    if (is_known_[i]) samples[i] = Approach(hands_[i], wanted, dt);
    is_under_way = is_under_way || samples[i] != wanted;
    hands_[i] = samples[i];
    is_known_[i] = true;
  }
  return next_ != before || is_under_way ? ReadStatus::kFresh : ReadStatus::kUnchanged;
}

}  // namespace trocar::device
