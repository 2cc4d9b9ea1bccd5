// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "trocar/device/emulator.h"
#include "trocar/device/igtl.h"

namespace trocar::device {
namespace {

constexpr double kPeriod = 1.0 / 60.0;  // [s]
constexpr double kLongestStep = 0.250;  // as in the trackers [s]

/// Sends the left hand as TRANSFORM, the right one as TDATA, so that both are tried.
class IgtlEmulator : public Emulator {
 public:
  explicit IgtlEmulator(SensorMotion motion) : motion_(std::move(motion)) {}

  void Receive(std::string_view) override {}
  std::string Advance(double time) override {
    std::string bytes;
    if (next_ < time - kLongestStep) next_ = time;
    for (; next_ <= time; next_ += kPeriod) {
      bytes += FormatIgtlTransform("LeftToTracker", motion_(kLeftHand, next_), next_);
      const IgtlTool right{"RightToTracker", motion_(kRightHand, next_)};
      bytes += FormatIgtlTrackingData("Tracker", {&right, 1}, next_);
    }
    return bytes;
  }

 private:
  SensorMotion motion_;
  double next_ = 0;  // [s]
};

}  // namespace

std::unique_ptr<Emulator> MakeIgtlEmulator(SensorMotion motion) {
  return std::make_unique<IgtlEmulator>(std::move(motion));
}

}  // namespace trocar::device
