// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/device_bench.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "trocar/host/translate.h"

namespace trocar::presenter {
namespace {

using base::ErrorCode;
using math::Pose;

/// Poses that a fit is made of; more say nothing new.
constexpr std::size_t kMostPoses = 400;
constexpr double kDegree = 57.29577951308232;

std::string InstrumentName(device::Channel hand) {
  return hand == device::kLeftHand    ? host::Translate("the left instrument")
         : hand == device::kRightHand ? host::Translate("the right instrument")
                                      : host::Translate("the laparoscope");
}

std::vector<Pose> Thin(const std::vector<Pose>& poses) {
  const std::size_t count = std::min(kMostPoses, poses.size());
  std::vector<Pose> thinned;
  for (std::size_t i = 0; i < count; ++i) thinned.push_back(poses[i * poses.size() / count]);
  return thinned;
}

}  // namespace

std::string_view StepName(CalibrationStep step) noexcept {
  switch (step) {
    case CalibrationStep::kTip:
      return "tip";
    case CalibrationStep::kTrocar:
      return "trocar";
    case CalibrationStep::kJaw:
      return "jaw";
  }
  return "";
}

std::string StepHint(CalibrationStep step, device::Channel hand) {
  const std::string instrument = InstrumentName(hand);
  switch (step) {
    case CalibrationStep::kTip:
      return host::TranslateWith(
          "Put the tip of {1} into a small hole and keep it there; swing the handle round by more than 30 "
          "degrees.",
          {instrument});
    case CalibrationStep::kTrocar:
      return host::TranslateWith(
          "Leave {1} in its trocar; swing it in all directions by more than 30 degrees, in and out.",
          {instrument});
    case CalibrationStep::kJaw:
      return host::TranslateWith("First hold the jaws of {1} closed; from the middle on fully open.",
                                 {instrument});
  }
  return "";
}

DeviceBench::DeviceBench(std::filesystem::path store) : store_path_(std::move(store)) {}

base::Status DeviceBench::Open(const std::string& spec) {
  Close();
  auto driver = device::MakeDriver(spec, device::LoadDeviceStore(store_path_).store, device::SystemClock());
  if (!driver) return driver.error();
  spec_ = spec;
  thread_ = std::make_unique<session::DeviceThread>(std::move(*driver));
  report_ = thread_->Latest();
  return {};
}

void DeviceBench::Close() {
  thread_.reset();
  report_ = {};
  history_.clear();
  end_ = begin_ = 0;
}

void DeviceBench::Advance(double time) {
  now_ = time;
  if (thread_ == nullptr) return;
  const std::uint64_t reads = report_.reads;
  report_ = thread_->Latest();
  if (report_.reads != reads) {
    history_.push_back({time, report_.samples});
    if (IsMeasuring()) Collect(time);
  }
  while (!history_.empty() && history_.front().time < time - kHistory) history_.pop_front();
  if (IsMeasuring() && time >= end_) Finish();
}

base::Status DeviceBench::Begin(CalibrationStep step, device::Channel hand, double seconds) {
  if (thread_ == nullptr)
    return base::Error{ErrorCode::kDeviceState, "no device is open; choose one and press Test first"};
  if (step == CalibrationStep::kJaw && hand >= device::kJawTools)
    return base::Error{ErrorCode::kUsage, "a laparoscope has no jaws; choose the left or the right hand"};
  step_ = step;
  hand_ = hand;
  begin_ = now_;
  end_ = now_ + seconds;
  poses_.clear(), closed_.clear(), open_.clear();
  result_ = {};
  return {};
}

double DeviceBench::Progress() const {
  return IsMeasuring() ? std::clamp((now_ - begin_) / (end_ - begin_), 0.0, 1.0) : 0.0;
}

std::string DeviceBench::Hint() const {
  if (step_ == CalibrationStep::kJaw && IsMeasuring())
    return Progress() < 0.5 ? host::Translate("Hold the jaws closed.")
                            : host::Translate("Now hold the jaws fully open.");
  return StepHint(step_, hand_);
}

void DeviceBench::Collect(double time) {
  if (step_ == CalibrationStep::kJaw) {
    const auto raw = report_.raw_jaws[static_cast<std::size_t>(hand_)];
    // the hands need a moment between the two
    constexpr double kChange = 0.1;
    const double share = (time - begin_) / (end_ - begin_);
    if (raw && share < 0.5) closed_.push_back(*raw);
    if (raw && share >= 0.5 + kChange) open_.push_back(*raw);
    return;
  }
  const auto& pose = report_.sensors[static_cast<std::size_t>(hand_)];
  if (pose && (poses_.empty() || !(poses_.back() == *pose))) poses_.push_back(*pose);
}

base::Status DeviceBench::KeepTracker(bool is_tip) {
  const auto spec = device::ParseDeviceSpec(spec_.substr(0, spec_.find('+')));
  if (!spec) return spec.error();
  device::DeviceStore store = device::LoadDeviceStore(store_path_).store;
  device::TrackerEntry entry = store.Tracker(spec->kind);
  device::HandCalibration& calibration = entry.hands[static_cast<std::size_t>(hand_)];
  const std::vector<Pose> poses = Thin(poses_);
  device::FitQuality quality;
  if (is_tip) {
    const auto fit = device::FitPivot(poses);
    if (!fit) return fit.error();
    calibration.p_sensor_tip = fit->p_sensor_pivot;
    quality = fit->quality;
  } else {
    const auto fit = device::FitTrocar(poses, calibration.p_sensor_tip);
    if (!fit) return fit.error();
    calibration.p_source_trocar = fit->p_source_trocar;
    calibration.axis_sensor = fit->axis_sensor;
    calibration.is_measured = true;
    quality = fit->quality;
  }
  store.trackers[spec->kind] = entry;
  if (base::Status saved = device::SaveDeviceStore(store_path_, store); !saved) return saved;
  result_ = {
      true, quality.residual,
      host::TranslateWith("{1} kept, {2}.", {is_tip ? host::Translate("Tip") : host::Translate("Trocar"),
                                             FormatQuality(quality, poses.size())})};
  return {};
}

base::Status DeviceBench::KeepJaw() {
  auto fit = device::FitJaw(closed_, open_);
  if (!fit) return fit.error();
  device::DeviceStore store = device::LoadDeviceStore(store_path_).store;
  device::JawCalibration& kept = store.jaws[static_cast<std::size_t>(hand_)];
  fit->max_jaw = kept.max_jaw;
  kept = *fit;
  if (base::Status saved = device::SaveDeviceStore(store_path_, store); !saved) return saved;
  result_ = {true, 0.0,
             host::TranslateWith("Jaw kept: closed {1}, open {2} of 0 to 1023.",
                                 {std::to_string(kept.closed), std::to_string(kept.open)})};
  return {};
}

void DeviceBench::Finish() {
  end_ = begin_ = 0;
  const base::Status done =
      step_ == CalibrationStep::kJaw ? KeepJaw() : KeepTracker(step_ == CalibrationStep::kTip);
  if (!done) {
    result_ = {false, 0.0, host::ShownText(done.error())};
    return;
  }
  // what was measured holds from now on
  const Result kept = result_;
  if (const base::Status opened = Open(std::string(spec_)); !opened)
    result_.text += " " + host::ShownText(opened.error());
  result_ = kept;
}

base::Status DeviceBench::SwapHands() {
  const auto spec = device::ParseDeviceSpec(spec_.substr(0, spec_.find('+')));
  if (!spec) return spec.error();
  device::DeviceStore store = device::LoadDeviceStore(store_path_).store;
  if (auto tracker = device::MakeTracker(spec_.substr(0, spec_.find('+')), store, device::SystemClock());
      !tracker)
    return tracker.error();
  device::TrackerEntry entry = store.Tracker(spec->kind);
  std::swap(entry.stations[device::kLeftHand], entry.stations[device::kRightHand]);
  // where each sensor sits on its instrument goes with the sensor; where the trocar is, with the hand
  for (auto member : {&device::HandCalibration::p_sensor_tip, &device::HandCalibration::axis_sensor,
                      &device::HandCalibration::up_sensor})
    std::swap(entry.hands[device::kLeftHand].*member, entry.hands[device::kRightHand].*member);
  store.trackers[spec->kind] = entry;
  if (base::Status saved = device::SaveDeviceStore(store_path_, store); !saved) return saved;
  return Open(std::string(spec_));
}

}  // namespace trocar::presenter
