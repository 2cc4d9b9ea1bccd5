// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/igtl_tracker.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace trocar::device {
namespace {

constexpr int kMaxReads = 64;
constexpr std::size_t kReadSize = 4096;

bool BeginsWith(std::string_view name, std::string_view beginning) noexcept {
  const auto lower = [](char mark) { return std::tolower(static_cast<unsigned char>(mark)); };
  return !beginning.empty() && name.size() >= beginning.size() &&
         std::equal(beginning.begin(), beginning.end(), name.begin(),
                    [&](char a, char b) { return lower(a) == lower(b); });
}

}  // namespace

IgtlTracker::IgtlTracker(const IgtlSettings& settings, TransportOpener opener, Clock& clock)
    : PoseDriver("igtl", kChannelCount),
      settings_(settings),
      opener_(std::move(opener)),
      clock_(clock),
      hands_(settings.hands) {}

int IgtlTracker::FindChannel(std::string_view name) const noexcept {
  for (int channel = 0; channel < kChannelCount; ++channel) {
    if (BeginsWith(name, settings_.names[static_cast<std::size_t>(channel)])) return channel;
  }
  return -1;
}

/// \return false where the connection is lost or cannot be followed
bool IgtlTracker::Drain(const IgtlReader::Sink& sink) {
  std::array<char, kReadSize> bytes;
  for (int i = 0; i < kMaxReads; ++i) {
    const IoResult got = transport_->Read(bytes);
    if (got.is_lost || !reader_.Feed({bytes.data(), got.count}, sink)) return false;
    if (got.count == 0) break;
  }
  return true;
}

/// Says what came instead of a hand's pose.
base::Error IgtlTracker::NoPose() const {
  const std::vector<std::string> refused = reader_.DescribeRefused();
  if (!refused.empty()) {
    return {base::ErrorCode::kDeviceStale, "igtl: no pose of a hand came; " + refused[0] +
                                               (refused.size() > 1 ? "; also, " + refused[1] : "")};
  }
  const std::string received = reader_.DescribeReceived();
  if (!received.empty()) {
    return {base::ErrorCode::kDeviceStale,
            "igtl: no TRANSFORM or TDATA came whose name begins with " + settings_.names[0] + ", " +
                settings_.names[1] + " or " + settings_.names[2] +
                "; name the transforms so at the server. This came: " + received};
  }
  if (reader_.ByteCount() > 0) {
    return {base::ErrorCode::kDeviceStale,
            "igtl: " + std::to_string(reader_.ByteCount()) +
                " bytes came and no whole message; is this the tracker's port?"};
  }
  return {base::ErrorCode::kDeviceStale,
          "igtl: connected, but nothing came; let the server send TRANSFORM or TDATA without being asked"};
}

base::Status IgtlTracker::DoConfigure() {
  base::Result<std::unique_ptr<Transport>> opened = opener_();
  if (!opened) return opened.error();
  transport_ = std::move(*opened);
  reader_ = {};
  bool has_hand = false;
  const double end = clock_.Now() + settings_.answer_time;
  while (!has_hand && clock_.Now() < end) {
    if (!Drain([&](const IgtlPose& tool) { has_hand = has_hand || FindChannel(tool.name) >= 0; })) {
      transport_.reset();
      if (const std::string why = reader_.DescribeBadHeader(); !why.empty())
        return base::Error{base::ErrorCode::kDeviceLost, "igtl: cannot follow the server: " + why};
      return base::Error{
          base::ErrorCode::kDeviceLost,
          "igtl: the other side hung up; check the port and whether another program is connected to it"};
    }
    clock_.Sleep(0.002);
  }
  if (has_hand) return {};
  transport_.reset();
  return NoPose();
}

base::Status IgtlTracker::DoActivate() {
  hands_.Reset();
  last_pose_ = clock_.Now();
  return {};
}

ReadStatus IgtlTracker::DoRead(std::span<HandSample> samples) noexcept {
  const double now = clock_.Now();
  const bool is_there = Drain([&](const IgtlPose& tool) {
    last_pose_ = now;
    hands_.Accept(FindChannel(tool.name), tool.pose, now);
  });
  if (!is_there || now - last_pose_ > settings_.hands.lost_after) return ReadStatus::kLost;
  return hands_.Collect(now, samples) ? ReadStatus::kFresh : ReadStatus::kUnchanged;
}

}  // namespace trocar::device
