// SPDX-License-Identifier: Apache-2.0
/// \file jaw_sensor.h  How far the jaws are open, by a potentiometer in the handle: docs/hardware/jaw-sensor.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/device/driver.h"
#include "trocar/device/framer.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/device/ports.h"

namespace trocar::device {

inline constexpr int kJawTools = 2;      ///< left, right
inline constexpr int kMaxJawRaw = 1023;  ///< of a 10-bit converter

/// One value of one tool.
struct JawReading {
  int tool = 0;                    ///< 0 left, 1 right
  std::uint32_t milliseconds = 0;  ///< of the sensor's own clock, which runs over [ms]
  int raw = 0;                     ///< 0 to kMaxJawRaw
};

enum class JawFormat {
  kText,  ///< lines "J,<tool>,<ms>,<raw>" over USB serial
  kHid    ///< HID reports: left, right and milliseconds, 16 bits each, low byte first
};

/// Takes lines apart. A line is right to the last character or it is garbage.
class JawFramer {
 public:
  template <typename Sink>
  void Feed(std::string_view bytes, Sink&& sink) {
    framer_.Feed(bytes, Parse, sink);
  }
  void Restart() noexcept { framer_.Restart(); }
  const FramerCounts& Counts() const noexcept { return framer_.Counts(); }

 private:
  static Parsed Parse(std::string_view bytes, JawReading& reading) noexcept;
  Framer<JawReading, 32> framer_;
};

struct HidReport {
  std::array<std::optional<int>, kJawTools> raw;  ///< 0 to kMaxJawRaw; none where the value is beyond that
  /// Of the sensor's own clock, which runs over. None from boards without one: whether those still measure cannot be known [ms].
  std::optional<std::uint16_t> milliseconds;
};
inline constexpr std::size_t kHidReportSize = 2 * (kJawTools + 1),
                             kHidReportSizeWithoutClock = 2 * kJawTools;  ///< [bytes]
/// Nothing where the report has another size.
HidReport ParseHidReport(std::string_view bytes) noexcept;
/// Report that ParseHidReport() reads.
std::string FormatHidReport(const std::array<int, kJawTools>& raw, std::uint16_t milliseconds);

/// "J,1,1234,512\r\n"
std::string FormatReading(const JawReading& reading);

struct JawCalibration {
  int closed = 0;                       ///< raw value with closed jaws
  int open = kMaxJawRaw;                ///< and with fully open ones; may be less than `closed`
  double max_jaw = 1.0471975511965976;  ///< what fully open means, 60 degrees [rad]

  friend bool operator==(const JawCalibration&, const JawCalibration&) = default;
};
/// Raw steps that closed and open must differ by.
inline constexpr int kMinJawRange = 50;

/// \param closed, open  raw values read while the jaws were held so; the medians count
/// \return kCalibrationPoor where there are too few or they hardly differ
base::Result<JawCalibration> FitJaw(std::span<const int> closed, std::span<const int> open);

/// Median of three, then a first-order low pass.
class JawFilter {
 public:
  static constexpr double kCutOff = 15.0;  ///< [Hz]
  /// \return the filtered raw value; the first one passes unchanged, and so does the first after a gap
  double Filter(const JawReading& reading) noexcept;
  void Reset() noexcept { *this = {}; }

 private:
  std::array<int, 3> last_{};
  int count_ = 0;
  std::uint32_t time_ = 0;  // [ms]
  double value_ = 0;
};

struct JawSettings {
  JawFormat format = JawFormat::kText;
  std::array<JawCalibration, kJawTools> calibrations;
  double answer_time = 1.5;    ///< within which the first value comes, the board's start included [s], > 0
  double stale_after = 0.100;  ///< without a value of a new time a tool is not seen [s], > 0
  double lost_after = 0.500;   ///< without any such value the sensor is lost [s], > stale_after
};

/// Fills the jaw of the left and the right hand, nothing else. See HandRig for the rest of the hand.
class JawSensor : public Driver {
 public:
  /// \param clock  outlives the driver
  JawSensor(const JawSettings& settings, TransportOpener opener, Clock& clock);

  /// The newest unfiltered value of a tool, for calibration.
  std::optional<int> GetRaw(int tool) const noexcept;
  const FramerCounts& GetFramerCounts() const noexcept { return framer_.Counts(); }

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override { transport_.reset(); }
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  IoResult Drain(double now) noexcept;
  void Take(const JawReading& reading, double now) noexcept;

  struct Tool {
    JawFilter filter;
    std::optional<int> raw;
    std::uint32_t milliseconds = 0;  // of the last value, by the sensor's clock [ms]
    double time = 0;                 // of the last value [s]
    HandSample sample;
  };
  JawSettings settings_;
  TransportOpener opener_;
  Clock& clock_;
  std::unique_ptr<Transport> transport_;
  JawFramer framer_;
  std::array<Tool, kJawTools> tools_;
  std::uint32_t hid_clock_ = 0;  // of the sensor, unwrapped [ms]
  double last_reading_ = 0;      // [s]
  bool is_new_ = false;
};

/// A HID device on this machine that may be a jaw sensor.
struct HidInfo {
  std::string path;         ///< "/dev/hidraw3"
  std::string description;  ///< maker and product
};
/// Boards with the USB numbers of docs/hardware/jaw-sensor.md; empty in a build without hidapi.
std::vector<HidInfo> ListHidSensors();
/// \param path  empty: the first that is found; the path of a socket: an emulated sensor's, a report a packet
/// \return kDeviceLost, or kDeviceUnsupported in a build without hidapi
base::Result<std::unique_ptr<Transport>> OpenHidSensor(const std::string& path);

}  // namespace trocar::device
