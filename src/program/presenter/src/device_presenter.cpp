// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/device_presenter.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/device/device_spec.h"
#include "trocar/host/json_text.h"
#include "trocar/host/log.h"
#include "trocar/host/translate.h"

namespace trocar::presenter {

DevicePresenter::DevicePresenter(const Options& options, std::filesystem::path store, SessionControl* control,
                                 DeviceScreen& screen)
    : options_(options),
      store_(std::move(store)),
      control_(control),
      screen_(&screen),
      bench_(store_),
      run_(options) {}

// finding and trying

void DevicePresenter::Start() {
  state_.spec = options_.device;
  Find();
  if (!options_.device.empty() && options_.is_device_page) Test();
}

void DevicePresenter::Find() {
  found_ = device::ListDevices();
  std::vector<std::string> lines;
  for (const device::FoundDevice& one : found_) lines.push_back(one.spec + "   " + one.description);
  if (state_.spec.empty() && !found_.empty()) state_.spec = found_.front().spec;
  screen_->ShowFound(lines);
  screen_->Show(state_);
}

void DevicePresenter::ChooseFound(std::size_t place) {
  if (place >= found_.size()) return;
  state_.spec = found_[place].spec;
  screen_->Show(state_);
}

void DevicePresenter::Test() {
  said_.clear();
  if (const base::Status opened = bench_.Open(state_.spec); !opened)
    Say(host::ShownText(opened.error()), true);
}

void DevicePresenter::Stop() {
  bench_.Close();
  Say(host::Translate("Closed."));
}

// calibration

void DevicePresenter::Begin(CalibrationStep step) {
  state_.result.clear();
  const double seconds = options_.run.IsAttended() ? kMeasureSeconds : kUnattendedSeconds;
  if (const base::Status begun = bench_.Begin(step, hand_, seconds); !begun)
    Say(host::ShownText(begun.error()), true);
}

void DevicePresenter::SwapHands() {
  Say(bench_.SwapHands(), host::Translate("Left and right are exchanged."));
}

void DevicePresenter::TakeMeasurement(bool was_measuring) {
  state_.progress = bench_.Progress();
  state_.can_measure = bench_.IsOpen() && !bench_.IsMeasuring();
  if (bench_.IsMeasuring()) state_.hint = bench_.Hint();
  if (!was_measuring || bench_.IsMeasuring()) return;
  state_.hint.clear();
  state_.result = bench_.LastResult().text;
}

// the operation

void DevicePresenter::Use() {
  TROCAR_ASSERT(control_ != nullptr);
  // a line has one reader
  bench_.Close();
  const device::DeviceStore store = device::LoadDeviceStore(store_).store;
  auto driver = device::MakeDriver(state_.spec, store, device::SystemClock());
  if (!driver) return Say(host::ShownText(driver.error()), true);
  control_->UseDevice(std::move(*driver), device::FindButtons(state_.spec, store));
  Say(host::Translate("The device holds the instruments."));
}

void DevicePresenter::UseHaptics(const std::string& name) {
  TROCAR_ASSERT(control_ != nullptr);
  if (control_->Haptics() != nullptr)
    return Say(
        host::Translate("A haptic device is in use already; to change it, start the window with --haptics."),
        true);
  const device::DeviceStore store = device::LoadDeviceStore(store_).store;
  Say(control_->UseHaptics(name, store.Buttons("haptics")),
      host::Translate("Now check the pose, hold the safety switch, and ask for force."));
}

void DevicePresenter::CheckPose() {
  TROCAR_ASSERT(control_ != nullptr);
  if (control_->Haptics() != nullptr) control_->Haptics()->BeginCheckPose();
}

void DevicePresenter::SetForce(bool is_on) {
  TROCAR_ASSERT(control_ != nullptr);
  session::HapticLoop* loop = control_->Haptics();
  if (loop != nullptr) is_on ? loop->RequestArm() : loop->Stop();
}

void DevicePresenter::TakeHaptics(double now) {
  session::HapticLoop* loop = control_ != nullptr ? control_->Haptics() : nullptr;
  state_.has_haptics = loop != nullptr;
  if (loop == nullptr) return;
  const session::HapticStatus& status = loop->Latest();
  state_.haptics = session::DescribeHaptics(status);
  if (hand_ < instrument::kHandCount) forces_.push_back({now, status.hands[hand_].force});
  while (!forces_.empty() && forces_.front().time < now - DeviceBench::kHistory) forces_.pop_front();
  // what is, not what was asked for
  state_.is_force_on = std::any_of(
      status.hands.begin(), status.hands.end(),
      [](const session::HapticHandStatus& one) { return one.state != haptics::ArmState::kUnarmed; });
}

// time

DevicePageRun::Step DevicePresenter::Advance(double now) {
  const bool was_measuring = bench_.IsMeasuring();
  bench_.Advance(now);
  if (bench_.IsOpen() && bench_.Report().message != said_) {
    said_ = bench_.Report().message;
    Say(said_, said_.starts_with("E-"));
  }
  TakeMeasurement(was_measuring);
  TakeHaptics(now);
  const DevicePageRun::Step step =
      run_.Advance(now, bench_.Report().reads > 0, !bench_.LastResult().text.empty());
  if (step == DevicePageRun::Step::kCalibrate) Begin(*run_.Calibration());
  if (step == DevicePageRun::Step::kGiveUp)
    Fail({base::ErrorCode::kDeviceStale, "the device said nothing: " + said_});
  screen_->Show(state_);
  screen_->ShowPlot(bench_.History(), forces_, hand_, now);
  return step;
}

std::string DevicePresenter::MakeReport() const {
  char text[400];
  std::snprintf(text, sizeof(text),
                ", \"reads\": %llu, \"shown\": %zu, \"calibrated\": %s, \"residual_mm\": %.3f}",
                static_cast<unsigned long long>(bench_.Report().reads), bench_.History().size(),
                bench_.LastResult().is_kept ? "true" : "false", 1e3 * bench_.LastResult().residual);
  // its name is of a file or a command line
  return "{\"device\": " + host::QuoteJson(bench_.Spec()) + text;
}

void DevicePresenter::Say(const std::string& text, bool is_warning) {
  state_.status = text;
  state_.is_status_warning = is_warning;
  screen_->Show(state_);
}

void DevicePresenter::Say(const base::Status& status, const std::string& success) {
  status.ok() ? Say(success) : Say(host::ShownText(status.error()), true);
}

}  // namespace trocar::presenter
