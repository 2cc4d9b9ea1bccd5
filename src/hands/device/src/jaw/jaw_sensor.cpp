// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/jaw_sensor.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace trocar::device {
namespace {

using base::ErrorCode;

constexpr int kMaxReads = 64;
constexpr std::size_t kReadSize = 1024;
/// A longer silence and the filter starts anew [ms].
constexpr std::uint32_t kLongestGap = 200;
constexpr std::size_t kMinFitValues = 10;

int Median(std::span<const int> values) {
  std::vector<int> sorted(values.begin(), values.end());
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  return sorted[sorted.size() / 2];
}

base::Status CheckCalibration(const JawCalibration& calibration) {
  const auto is_raw = [](int value) { return value >= 0 && value <= kMaxJawRaw; };
  if (is_raw(calibration.closed) && is_raw(calibration.open) &&
      std::abs(calibration.open - calibration.closed) >= kMinJawRange && calibration.max_jaw > 0.0)
    return {};
  return base::Error{
      ErrorCode::kDeviceSettings,
      "jaw: closed and open must be raw values of 0 to 1023 that differ by at least 50; run trocar "
      "devices calibrate jaw"};
}

double Opening(const JawCalibration& calibration, double raw) noexcept {
  return std::clamp((raw - calibration.closed) / (calibration.open - calibration.closed), 0.0, 1.0);
}

}  // namespace

base::Result<JawCalibration> FitJaw(std::span<const int> closed, std::span<const int> open) {
  if (closed.size() < kMinFitValues || open.size() < kMinFitValues) {
    return base::Error{ErrorCode::kCalibrationPoor,
                       "jaw: too few values came in; check the wiring and repeat"};
  }
  JawCalibration calibration;
  calibration.closed = Median(closed);
  calibration.open = Median(open);
  if (std::abs(calibration.open - calibration.closed) < kMinJawRange) {
    return base::Error{ErrorCode::kCalibrationPoor,
                       "jaw: open and closed read " + std::to_string(calibration.open) + " and " +
                           std::to_string(calibration.closed) +
                           ", too alike; is the potentiometer's axle fixed to the handle?"};
  }
  return calibration;
}

double JawFilter::Filter(const JawReading& reading) noexcept {
  const std::uint32_t gap = reading.milliseconds - time_;  // right also where the clock runs over
  if (count_ == 0 || gap > kLongestGap) {
    last_ = {reading.raw, reading.raw, reading.raw};
    value_ = reading.raw;
    count_ = 1;
  } else {
    last_ = {last_[1], last_[2], reading.raw};
    const int median =
        std::max(std::min(last_[0], last_[1]), std::min(std::max(last_[0], last_[1]), last_[2]));
    constexpr double kTwoPi = 6.283185307179586;
    value_ += (median - value_) * (1.0 - std::exp(-kTwoPi * kCutOff * 1e-3 * gap));
  }
  time_ = reading.milliseconds;
  return value_;
}

JawSensor::JawSensor(const JawSettings& settings, TransportOpener opener, Clock& clock)
    : Driver("jaw", kChannelCount), settings_(settings), opener_(std::move(opener)), clock_(clock) {}

base::Status JawSensor::DoConfigure() {
  for (const JawCalibration& calibration : settings_.calibrations) {
    if (base::Status good = CheckCalibration(calibration); !good) return good;
  }
  base::Result<std::unique_ptr<Transport>> opened = opener_();
  if (!opened) return opened.error();
  transport_ = std::move(*opened);
  framer_.Restart();
  for (Tool& tool : tools_) tool = {};
  hid_clock_ = 0;
  const double end = clock_.Now() + settings_.answer_time;
  while (clock_.Now() < end && !tools_[0].raw && !tools_[1].raw) {
    if (Drain(clock_.Now()).is_lost) {
      transport_.reset();
      return base::Error{ErrorCode::kDeviceLost, "jaw: the sensor hung up; check its plug"};
    }
    clock_.Sleep(0.002);
  }
  if (tools_[0].raw || tools_[1].raw) return {};
  transport_.reset();
  return base::Error{
      ErrorCode::kDeviceStale,
      framer_.Counts().garbage > 0
          ? "jaw: what comes in are no lines J,<tool>,<ms>,<raw>; is this the jaw sensor's line?"
          : "jaw: the sensor sends nothing; check its firmware and wiring"};
}

base::Status JawSensor::DoActivate() {
  last_reading_ = clock_.Now();
  return {};
}

void JawSensor::Take(const JawReading& reading, double now) noexcept {
  Tool& tool = tools_[static_cast<std::size_t>(reading.tool)];
  // a board whose clock stands still repeats an old value: it is there, the jaw is not seen
  if (tool.raw && reading.milliseconds == tool.milliseconds) return;
  tool.milliseconds = reading.milliseconds;
  const JawCalibration& calibration = settings_.calibrations[static_cast<std::size_t>(reading.tool)];
  tool.raw = reading.raw;
  tool.time = now;
  tool.sample.jaw = calibration.max_jaw * Opening(calibration, tool.filter.Filter(reading));
  tool.sample.time = now;
  tool.sample.is_valid = true;
  last_reading_ = now;
  is_new_ = true;
}

/// Takes in what is there.
IoResult JawSensor::Drain(double now) noexcept {
  std::array<char, kReadSize> bytes;
  std::array<std::optional<int>, kJawTools> newest;  // of reports without a clock
  IoResult got;
  for (int i = 0; i < kMaxReads; ++i) {
    got = transport_->Read(bytes);
    if (got.is_lost || got.count == 0) break;
    if (settings_.format == JawFormat::kText) {
      framer_.Feed({bytes.data(), got.count}, [&](const JawReading& reading) { Take(reading, now); });
      continue;
    }
    const HidReport report = ParseHidReport({bytes.data(), got.count});
    if (report.milliseconds) hid_clock_ += static_cast<std::uint16_t>(*report.milliseconds - hid_clock_);
    for (std::size_t tool = 0; tool < report.raw.size(); ++tool) {
      const std::optional<int>& raw = report.raw[tool];
      if (raw && report.milliseconds) Take({static_cast<int>(tool), hid_clock_, *raw}, now);
      if (raw && !report.milliseconds) newest[tool] = raw;
    }
  }
  const auto milliseconds = static_cast<std::uint32_t>(static_cast<std::uint64_t>(1e3 * now));
  for (std::size_t tool = 0; tool < newest.size(); ++tool) {
    if (newest[tool]) Take({static_cast<int>(tool), milliseconds, *newest[tool]}, now);
  }
  return got;
}

ReadStatus JawSensor::DoRead(std::span<HandSample> samples) noexcept {
  const double now = clock_.Now();
  if (Drain(now).is_lost || now - last_reading_ > settings_.lost_after) return ReadStatus::kLost;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    Tool& tool = tools_[i];
    if (tool.sample.is_valid && now - tool.time > settings_.stale_after) {
      tool.sample.is_valid = false;
      is_new_ = true;
    }
    samples[i] = tool.sample;
  }
  samples[kLaparoscope].is_valid = false;
  return std::exchange(is_new_, false) ? ReadStatus::kFresh : ReadStatus::kUnchanged;
}

std::optional<int> JawSensor::GetRaw(int tool) const noexcept {
  return tool >= 0 && tool < kJawTools ? tools_[static_cast<std::size_t>(tool)].raw : std::nullopt;
}

}  // namespace trocar::device
