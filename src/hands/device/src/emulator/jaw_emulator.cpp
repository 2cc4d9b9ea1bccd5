// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <utility>

#include "trocar/device/emulator.h"

namespace trocar::device {
namespace {

constexpr double kPeriod = 0.010;       // between two values of one tool [s]
constexpr double kLongestStep = 0.250;  // as in the trackers [s]

class JawEmulator : public Emulator {
 public:
  explicit JawEmulator(JawEmulation emulation) : emulation_(std::move(emulation)) {}

  void Receive(std::string_view) override {}
  std::string Advance(double time) override {
    std::string bytes;
    if (next_ < time - kLongestStep) next_ = time;
    for (; next_ <= time; next_ += kPeriod) {
      const HandSamples hands = emulation_.motion(next_);
      std::array<int, kJawTools> raw{};
      for (std::size_t tool = 0; tool < raw.size(); ++tool) {
        const JawCalibration& sensor = emulation_.calibrations[tool];
        const double opening = hands[tool].jaw / sensor.max_jaw;
        raw[tool] = static_cast<int>(std::lround(sensor.closed + opening * (sensor.open - sensor.closed)));
      }
      if (emulation_.format == JawFormat::kHid) {
        bytes += FormatHidReport(raw, static_cast<std::uint16_t>(static_cast<std::uint32_t>(1e3 * next_)));
        continue;
      }
      for (int tool = 0; tool < kJawTools; ++tool)
        bytes += FormatReading(
            {tool, static_cast<std::uint32_t>(1e3 * next_), raw[static_cast<std::size_t>(tool)]});
    }
    return bytes;
  }

 private:
  JawEmulation emulation_;
  double next_ = 0;  // [s]
};

}  // namespace

std::unique_ptr<Emulator> MakeJawEmulator(JawEmulation emulation) {
  return std::make_unique<JawEmulator>(std::move(emulation));
}

}  // namespace trocar::device
