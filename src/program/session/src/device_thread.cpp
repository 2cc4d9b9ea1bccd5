// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/device_thread.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>

#include "trocar/device/hand_rig.h"
#include "trocar/device/pose_driver.h"
#include "trocar/host/newest_slot.h"
#include "trocar/host/translate.h"
#include "trocar/session/hand_joints.h"

namespace trocar::session {

using instrument::kLeft;
using instrument::kRight;
namespace {

constexpr double kReadPeriod = 0.002;  // [s]
constexpr double kRetryPeriod = 0.5;   // [s]
constexpr double kNap = 0.02;          // longest wait that a stop has to bear [s]
constexpr double kLookPeriod = 1.0;    // between two looks at what the driver held back [s]

/// What came and does not count, in the person's language; empty where all does.
std::string HeldBackText(const device::Driver& driver) {
  std::string text;
  for (const std::string& sentence : driver.DescribeHeldBack())
    text += (text.empty() ? "" : "; ") + host::TranslateComposed(sentence);
  return text;
}

}  // namespace

void PlaceAtHome(const scene::Scene& scene, device::Driver& driver) noexcept {
  const std::array<instrument::TrocarJoints, device::kChannelCount> homes = {
      scene.instruments[kLeft].home, scene.instruments[kRight].home, scene.laparoscope.home};
  for (std::size_t i = 0; i < homes.size(); ++i) {
    device::HandSample home = SampleOf(homes[i]);
    home.is_valid = true;
    driver.PlaceHand(static_cast<int>(i), home);
  }
}

struct DeviceThread::Content {
  std::unique_ptr<device::Driver> driver;
  const device::PoseDriver* tracker = nullptr;  // what of the driver can be calibrated
  const device::JawSensor* jaws = nullptr;
  device::HandButtons buttons;
  host::NewestSlot<DeviceReport> slot;
  DeviceReport report;
  double next_look = 0;       // at what is held back [s]
  std::size_t held_back = 0;  // reasons that were told
  std::atomic<bool> is_stopping{false};
  std::thread thread;

  void Publish() {
    slot.Back() = report;
    slot.Publish();
  }
  void Say(DeviceReport::Phase phase, std::string message) {
    report.phase = phase;
    report.message = std::move(message);
    Publish();
  }
  void Nap(double seconds) {
    for (double slept = 0; slept < seconds && !is_stopping.load(std::memory_order_relaxed); slept += kNap)
      device::SystemClock().Sleep(std::min(kNap, seconds - slept));
  }
  /// Looks for what can be calibrated in the driver and its parts.
  void FindParts(device::Driver& part) {
    if (auto* rig = dynamic_cast<device::HandRig*>(&part)) {
      FindParts(rig->Hands());
      FindParts(rig->Jaws());
    }
    if (auto* found = dynamic_cast<const device::PoseDriver*>(&part)) tracker = found;
    if (auto* found = dynamic_cast<const device::JawSensor*>(&part)) jaws = found;
  }
  void TakeParts() {
    for (int channel = 0; channel < device::kChannelCount && tracker != nullptr; ++channel) {
      const math::Pose* pose = tracker->GetSensorPose(channel);
      auto& sensor = report.sensors[static_cast<std::size_t>(channel)];
      sensor = pose != nullptr && report.samples[static_cast<std::size_t>(channel)].is_valid
                   ? std::optional<math::Pose>(*pose)
                   : std::nullopt;
    }
    for (int tool = 0; tool < device::kJawTools && jaws != nullptr; ++tool)
      report.raw_jaws[static_cast<std::size_t>(tool)] = jaws->GetRaw(tool);
  }
  bool Connect();
  void TellHeldBack();
  void Run();
};

/// Brings the driver to life. \return false, with the reason published, where that failed
bool DeviceThread::Content::Connect() {
  base::Status done = driver->Configure();
  if (done) {
    done = driver->Activate();
    if (!done) (void)driver->Cleanup();
  }
  const bool was_lost = report.losses > 0;
  held_back = 0;
  if (done) {
    Say(DeviceReport::Phase::kRunning,
        host::TranslateWith(was_lost ? host::Mark("{1} is connected again") : host::Mark("{1} is connected"),
                            {driver->GetName()}));
  } else {
    Say(was_lost ? DeviceReport::Phase::kLost : DeviceReport::Phase::kConnecting,
        host::ShownText(done.error()) + host::Translate("; trying again"));
  }
  return done.ok();
}

/// Once for each new reason; their counts change all the time.
void DeviceThread::Content::TellHeldBack() {
  const double now = device::SystemClock().Now();
  if (now < next_look) return;
  next_look = now + kLookPeriod;
  const std::size_t reasons = driver->DescribeHeldBack().size();
  if (reasons > held_back) {
    Say(report.phase, host::TranslateWith("{1} is connected, but not all that it sends counts: {2}",
                                          {driver->GetName(), HeldBackText(*driver)}));
  }
  held_back = reasons;
}

void DeviceThread::Content::Run() {
  while (!is_stopping.load(std::memory_order_relaxed)) {
    if (report.phase != DeviceReport::Phase::kRunning && !Connect()) {
      Nap(kRetryPeriod);
      continue;
    }
    const device::ReadStatus status = driver->Read(report.samples);
    const bool is_read = status == device::ReadStatus::kFresh || status == device::ReadStatus::kUnchanged;
    const bool is_fresh = status == device::ReadStatus::kFresh;
    // a button's time passes also where the device says nothing new
    const bool has_acted = is_read && buttons.See(report.samples, device::SystemClock().Now());
    switch (status) {
      case device::ReadStatus::kFresh:
      case device::ReadStatus::kUnchanged:
        TellHeldBack();
        if (!is_fresh && !has_acted) break;
        report.reads += is_fresh ? 1 : 0;
        report.acts = buttons.Acts();
        TakeParts();
        Publish();
        break;
      case device::ReadStatus::kNotActive:
      case device::ReadStatus::kLost:
        ++report.losses;
        buttons.ReleaseAll();
        report.acts = buttons.Acts();
        report.sensors = {};
        report.raw_jaws = {};
        {
          const std::string held = HeldBackText(*driver);
          Say(DeviceReport::Phase::kLost,
              host::ShownText(base::Error{base::ErrorCode::kDeviceLost,
                                          driver->GetName() + " was lost; check plug and power"}) +
                  (held.empty() ? "" : "; ") + held);
        }
        Nap(kRetryPeriod);
        break;
    }
    device::SystemClock().Sleep(kReadPeriod);
  }
  driver->Finalize();
}

DeviceThread::DeviceThread(std::unique_ptr<device::Driver> driver, const device::ButtonMap& buttons)
    : content_(std::make_unique<Content>()) {
  content_->buttons = device::HandButtons(buttons);
  content_->driver = std::move(driver);
  content_->FindParts(*content_->driver);
  content_->report.message = host::TranslateWith("{1} is being connected", {content_->driver->GetName()});
  content_->Publish();
  content_->slot.Update();
  content_->thread = std::thread([content = content_.get()] { content->Run(); });
}

DeviceThread::~DeviceThread() {
  content_->is_stopping.store(true);
  content_->thread.join();
}

const DeviceReport& DeviceThread::Latest() {
  content_->slot.Update();
  return content_->slot.Front();
}

}  // namespace trocar::session
