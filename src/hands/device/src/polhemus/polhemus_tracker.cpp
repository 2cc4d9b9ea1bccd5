// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/polhemus_tracker.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace trocar::device {
namespace {

using base::ErrorCode;

/// Most that one Read() takes from the line, so that a flood cannot hold it up (faults D14).
constexpr int kMaxReads = 16;
constexpr std::size_t kReadSize = 4096;
/// So many bad frames in a row mean that nothing useful comes any more (faults D3).
constexpr std::uint64_t kMaxBadFrames = 20;
constexpr double kCommandTime = 0.2;  // within which commands leave [s]
constexpr double kSettleTime = 0.05;  // after which old records have come in [s]
/// How often the stations are asked within the answer time: a command or an answer may be lost on the line.
constexpr int kQuestions = 4;

}  // namespace

PolhemusTracker::PolhemusTracker(const PolhemusSettings& settings, TransportOpener opener, Clock& clock)
    : PoseDriver(std::string(FormatName(settings.format)), kChannelCount),
      settings_(settings),
      opener_(std::move(opener)),
      clock_(clock),
      framer_(settings.format),
      hands_(settings.hands) {}

base::Status PolhemusTracker::CheckSettings() const {
  const auto fail = [this](const std::string& text) {
    return base::Error{ErrorCode::kDeviceSettings, GetName() + ": " + text};
  };
  int used = 0;
  for (int channel = 0; channel < kChannelCount; ++channel) {
    const int station = settings_.stations[static_cast<std::size_t>(channel)];
    if (station == 0) continue;
    ++used;
    if (station < 0 || station > StationCount(settings_.format)) {
      return fail("it has stations 1 to " + std::to_string(StationCount(settings_.format)) + ", not " +
                  std::to_string(station));
    }
    if (FindChannel(station) != channel)
      return fail("station " + std::to_string(station) + " is given to two hands");
  }
  if (used == 0) return fail("no hand has a station; give at least one");
  const TrackedHandsSettings& hands = settings_.hands;
  if (!(hands.max_speed > 0.0 && hands.max_turn_rate > 0.0 && hands.stale_after > 0.0 &&
        hands.lost_after > hands.stale_after && settings_.answer_time > 0.0))
    return fail("its speeds and times must be positive, and lost_after longer than stale_after");
  return {};
}

int PolhemusTracker::FindChannel(int station) const noexcept {
  for (int channel = 0; channel < kChannelCount; ++channel) {
    if (settings_.stations[static_cast<std::size_t>(channel)] == station) return channel;
  }
  return -1;
}

base::Status PolhemusTracker::DoConfigure() {
  if (base::Status good = CheckSettings(); !good) return good;
  base::Result<std::unique_ptr<Transport>> opened = opener_();
  if (!opened) return opened.error();
  transport_ = std::move(*opened);
  base::Status done = AwaitStations();
  if (!done) transport_.reset();
  return done;
}

/// Sets the tracker up and asks each station for one record.
///
/// \param is_first  what comes before is thrown away; a late answer to an earlier question is as good as one to this
base::Status PolhemusTracker::AskStations(const std::vector<int>& stations, bool is_first) {
  const std::string commands = SetUpCommands(settings_.format, stations, settings_.hands.hemisphere);
  if (base::Status sent = WriteAll(*transport_, clock_, commands, kCommandTime); !sent) return sent;
  if (is_first) {
    // records of an earlier life are still on their way
    clock_.Sleep(kSettleTime);
    std::array<char, kReadSize> bytes;
    for (int i = 0; i < kMaxReads && transport_->Read(bytes).count > 0; ++i) {
    }
    framer_.Restart();
  }
  return WriteAll(*transport_, clock_, PollCommand(), kCommandTime);
}

/// Sets the tracker up and waits until each station has answered once; asks again where an answer stays out.
base::Status PolhemusTracker::AwaitStations() {
  std::vector<int> waiting;
  for (const int station : settings_.stations) {
    if (station != 0) waiting.push_back(station);
  }
  const std::vector<int> stations = waiting;
  FramerCounts before = framer_.Counts();
  for (int question = 0; question < kQuestions && !waiting.empty(); ++question) {
    if (base::Status asked = AskStations(stations, question == 0); !asked) return asked;
    if (question == 0) before = framer_.Counts();
    std::array<char, kReadSize> bytes;
    const double end = clock_.Now() + settings_.answer_time / kQuestions;
    while (!waiting.empty() && clock_.Now() < end) {
      const IoResult got = transport_->Read(bytes);
      if (got.is_lost)
        return base::Error{ErrorCode::kDeviceLost, GetName() + " hung up; check plug and power"};
      framer_.Feed({bytes.data(), got.count},
                   [&](const TrackerRecord& record) { std::erase(waiting, record.station); });
      if (got.count == 0) clock_.Sleep(0.002);
    }
  }
  if (waiting.empty()) return {};
  if (framer_.Counts().records != before.records) {
    return base::Error{ErrorCode::kDeviceStale,
                       GetName() + ": station " + std::to_string(waiting.front()) +
                           " does not answer; is its sensor plugged in and switched on?"};
  }
  const std::uint64_t garbage = framer_.Counts().garbage - before.garbage;
  return base::Error{ErrorCode::kDeviceStale,
                     garbage > 0 ? GetName() + " answers " + std::to_string(garbage) +
                                       " bytes that are no records; check the speed, and which tracker it is"
                                 : GetName() + " does not answer; check power, cable and speed"};
}

base::Status PolhemusTracker::DoActivate() {
  hands_.Reset();
  last_record_ = clock_.Now();
  return WriteAll(*transport_, clock_, StartCommand(settings_.format), kCommandTime);
}

void PolhemusTracker::DoDeactivate() noexcept {
  // a tracker that is gone takes no command
  (void)transport_->Write(StopCommand(settings_.format));
}

void PolhemusTracker::DoCleanup() noexcept {
  transport_.reset();
  framer_.Restart();
}

ReadStatus PolhemusTracker::DoRead(std::span<HandSample> samples) noexcept {
  const double now = clock_.Now();
  std::array<char, kReadSize> bytes;
  bool is_lost = false;
  for (int i = 0; i < kMaxReads; ++i) {
    const IoResult got = transport_->Read(bytes);
    framer_.Feed({bytes.data(), got.count}, [&](const TrackerRecord& record) {
      last_record_ = now;
      const int channel = FindChannel(record.station);
      if (channel < 0 || record.error != ' ') {
        ++errors_;
        return;
      }
      hands_.Accept(channel, {record.rotation, record.position}, now);
    });
    is_lost = got.is_lost;
    if (is_lost || got.count == 0) break;
  }
  const bool is_babble = framer_.Counts().garbage_in_row > kMaxBadFrames * framer_.RecordLength();
  if (is_lost || now - last_record_ > settings_.hands.lost_after) return ReadStatus::kLost;
  const bool is_new = hands_.Collect(now, samples);
  if (is_babble) {
    for (HandSample& sample : samples) sample.is_valid = false;
  }
  return is_new ? ReadStatus::kFresh : ReadStatus::kUnchanged;
}

}  // namespace trocar::device
