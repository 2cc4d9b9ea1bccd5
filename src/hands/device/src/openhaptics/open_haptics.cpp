// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/open_haptics.h"

#include <algorithm>
#include <atomic>

#include "hd_devices.h"
#include "hd_host.h"
#include "trocar/host/clock.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

constexpr std::size_t kMaxDevices = ForceMailbox::kMaxDevices;
/// Without a report for so long the device, its library or the host is gone (faults D2) [ns].
constexpr std::int64_t kLostAfter = 500'000'000;

/// The library has one scheduler and one current device.
std::atomic<bool> is_library_taken{false};

}  // namespace

struct OpenHaptics::Content {
  explicit Content(const OpenHapticsSettings& wanted) : settings(wanted) {
    if (settings.host.empty()) {
      end = std::make_unique<HdDevices>(own_mailbox);
    } else {
      end = std::make_unique<HdHost>();
    }
  }

  OpenHapticsSettings settings;
  ForceMailbox own_mailbox;  // of a library in this process
  std::unique_ptr<HdEnd> end;
  std::vector<ForceLimits> limits;
  std::int64_t last_report = 0;  // [ns]

  /// A device that has fallen silent is lost.
  ReadStatus Judge(ReadStatus read) noexcept {
    if (end->HasFailed()) return ReadStatus::kLost;
    const std::int64_t now = host::NowNanoseconds();
    if (read == ReadStatus::kFresh) last_report = now;
    return read == ReadStatus::kUnchanged && now - last_report > kLostAfter ? ReadStatus::kLost : read;
  }
};

OpenHaptics::OpenHaptics(const OpenHapticsSettings& settings)
    : ForceDriver("openhaptics",
                  static_cast<int>(std::clamp<std::size_t>(settings.names.size(), 1, kMaxDevices))),
      content_(std::make_unique<Content>(settings)) {}

OpenHaptics::~OpenHaptics() {
  Finalize();
}

ForceLimits OpenHaptics::GetLimits(int channel) const noexcept {
  const auto index = static_cast<std::size_t>(channel);
  return index < content_->limits.size() ? content_->limits[index] : ForceLimits{};
}

SupervisedLibrary OpenHaptics::GetSupervisedLibrary() const {
  return content_->end->Supervised();
}

base::Status OpenHaptics::DoConfigure() {
  Content& c = *content_;
  if (c.settings.names.empty() || c.settings.names.size() > kMaxDevices)
    return base::Error{ErrorCode::kDeviceSettings, "openhaptics: name one device, or two"};
  if (is_library_taken.exchange(true)) {
    return base::Error{ErrorCode::kDeviceBusy,
                       "openhaptics is in use already; name both devices in one: openhaptics:Left,Right"};
  }
  base::Status opened = c.end->Open(c.settings, c.limits);
  if (!opened) DoCleanup();
  return opened;
}

base::Status OpenHaptics::DoActivate() {
  content_->end->Mailbox().Clear();
  content_->last_report = host::NowNanoseconds();
  return content_->end->Start();
}

void OpenHaptics::DoDeactivate() noexcept {
  content_->end->Stop();
}

void OpenHaptics::DoCleanup() noexcept {
  content_->end->Close();
  content_->limits.clear();
  is_library_taken.store(false);
}

ReadStatus OpenHaptics::DoReadForceSamples(std::span<ForceSample> samples) noexcept {
  return content_->Judge(content_->end->Mailbox().Read(samples));
}

ReadStatus OpenHaptics::DoRead(std::span<HandSample> samples) noexcept {
  return content_->Judge(content_->end->Mailbox().Read(samples, content_->settings.p_device_trocar));
}

void OpenHaptics::DoSendForce(int channel, const GatedForce& force) noexcept {
  content_->end->Mailbox().Send(channel, force);
}

}  // namespace trocar::device
