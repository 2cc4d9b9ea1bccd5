// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "console.h"
#include "device_console.h"
#include "trocar/device/device_spec.h"

namespace trocar::cli {

using host::Mark;
using host::Say;
using host::Translate;
using host::TranslateWith;

namespace {

using device::HandCalibration;
using math::Pose;

struct CalibrateOptions {
  std::string spec, hand = "left";
  double seconds = 12;
  double wait = 3;  // before measuring begins [s]
};

int FindHand(const std::string& name) {
  return name == "left" ? device::kLeftHand : name == "right" ? device::kRightHand : device::kLaparoscope;
}

void Announce(const std::string& text, double wait) {
  host::PrintLine(text);
  for (int left = static_cast<int>(wait); left > 0; --left) {
    Say("  starting in {1} s\n", left);
    std::fflush(stdout);
    device::SystemClock().Sleep(1.0);
  }
}

/// Poses of one hand's sensor while the person moves it.
base::Result<std::vector<Pose>> CollectPoses(device::PoseDriver& driver, int hand, double seconds) {
  std::vector<Pose> poses;
  host::ProgressBar progress("measuring", seconds);
  const auto report = WatchDevice(driver, seconds, [&](const HandSamples& samples, double time) {
    progress.Show(time);
    const Pose* pose = driver.GetSensorPose(hand);
    if (pose == nullptr || !samples[static_cast<std::size_t>(hand)].is_valid) return;
    if (poses.empty() || !(poses.back() == *pose)) poses.push_back(*pose);
  });
  progress.Finish();
  if (!report) return report.error();
  PrintHeldBack(*report);
  if (report->is_lost)
    return base::Error{base::ErrorCode::kDeviceLost,
                       driver.GetName() + " was lost; check plug and power, and repeat"};
  // evenly thinned: more than this says nothing new
  constexpr std::size_t kMost = 400;
  std::vector<Pose> thinned;
  for (std::size_t i = 0; i < std::min(kMost, poses.size()); ++i)
    thinned.push_back(poses[i * poses.size() / std::min(kMost, poses.size())]);
  return thinned;
}

void PrintQuality(const char* what, const device::FitQuality& quality, std::size_t poses) {
  host::PrintLine("  " + Translate(what) + " " + device::FormatQuality(quality, poses));
}

base::Status KeepCalibration(const device::DeviceStore& store) {
  const auto path = device::FindDeviceStore();
  base::Status saved = device::SaveDeviceStore(path, store);
  if (saved) Say("Wrote {1}\n", path);
  return saved;
}

/// Where the tip and the shaft are: the two steps of a tracked instrument.
base::Status CalibrateTracker(const CalibrateOptions& options, bool is_tip) {
  device::DeviceStore store = LoadStoreOrWarn();
  const base::Result<device::DeviceSpec> spec = device::ParseDeviceSpec(options.spec);
  if (!spec) return spec.error();
  const auto driver = device::MakeTracker(options.spec, store, device::SystemClock());
  if (!driver) return driver.error();
  const int hand = FindHand(options.hand);
  Announce(
      TranslateWith(
          is_tip ? Mark("Put the {1} instrument's tip into a small hole and keep it there; swing the "
                        "handle round in all directions, by more than 30 degrees.")
                 : Mark("Leave the {1} instrument in its trocar; swing it in all directions by more than 30 "
                        "degrees, and move it in and out."),
          {Translate(options.hand)}),
      options.wait);
  const auto poses = CollectPoses(**driver, hand, options.seconds);
  if (!poses) return poses.error();

  device::TrackerEntry entry = store.Tracker(spec->kind);
  HandCalibration& calibration = entry.hands[static_cast<std::size_t>(hand)];
  if (is_tip) {
    const auto fit = device::FitPivot(*poses);
    if (!fit) return fit.error();
    calibration.p_sensor_tip = fit->p_sensor_pivot;
    PrintQuality(Mark("tip"), fit->quality, poses->size());
    Say("Next: trocar devices calibrate trocar {1} --hand {2}\n", options.spec, options.hand);
  } else {
    const auto fit = device::FitTrocar(*poses, calibration.p_sensor_tip);
    if (!fit) return fit.error();
    calibration.p_source_trocar = fit->p_source_trocar;
    calibration.axis_sensor = fit->axis_sensor;
    calibration.is_measured = true;
    PrintQuality(Mark("trocar"), fit->quality, poses->size());
  }
  store.trackers[spec->kind] = entry;
  return KeepCalibration(store);
}

base::Result<std::vector<int>> CollectRaw(const std::string& spec, int tool, double seconds) {
  auto sensor = device::MakeJawSensor(spec, device::SystemClock());
  if (!sensor) return sensor.error();
  std::vector<int> values;
  const auto report = WatchDevice(**sensor, seconds, [&](const HandSamples&, double) {
    if (const auto raw = (*sensor)->GetRaw(tool)) values.push_back(*raw);
  });
  if (!report) return report.error();
  return values;
}

base::Status CalibrateJaw(const CalibrateOptions& options) {
  const int tool = FindHand(options.hand);
  if (tool >= device::kJawTools)
    return base::Error{base::ErrorCode::kUsage, "a laparoscope has no jaws; --hand is left or right"};
  const double seconds = options.seconds / 2;
  Announce(TranslateWith("Close the {1} jaws and hold them closed.", {Translate(options.hand)}),
           options.wait);
  const auto closed = CollectRaw(options.spec, tool, seconds);
  if (!closed) return closed.error();
  Announce(TranslateWith("Open the {1} jaws fully and hold them open.", {Translate(options.hand)}),
           options.wait);
  const auto open = CollectRaw(options.spec, tool, seconds);
  if (!open) return open.error();
  auto fit = device::FitJaw(*closed, *open);
  if (!fit) return fit.error();
  device::DeviceStore store = LoadStoreOrWarn();
  device::JawCalibration& kept = store.jaws[static_cast<std::size_t>(tool)];
  fit->max_jaw = kept.max_jaw;
  kept = *fit;
  Say("  closed {1}, open {2} of 0 to 1023\n", kept.closed, kept.open);
  return KeepCalibration(store);
}

CLI::App* AddStep(CLI::App& calibrate, const char* name, const char* text, CalibrateOptions& options) {
  CLI::App* step = calibrate.add_subcommand(name, text);
  step->add_option("device", options.spec, "Device, such as liberty:/dev/ttyUSB0")
      ->required()
      ->type_name("DEVICE");
  step->add_option("--hand", options.hand, "Which instrument")
      ->check(CLI::IsMember({"left", "right", "laparoscope"}))
      ->capture_default_str();
  step->add_option("--seconds", options.seconds, "How long to measure")
      ->check(CLI::Range(0.5, 300.0))
      ->type_name("S")
      ->capture_default_str();
  step->add_option("--wait", options.wait, "Before measuring begins")
      ->check(CLI::Range(0.0, 60.0))
      ->type_name("S")
      ->capture_default_str();
  return step;
}

}  // namespace

void AddDevicesCalibrateCommand(CLI::App& devices, Outcome& outcome) {
  CLI::App* calibrate = devices.add_subcommand(
      "calibrate", "Find tip, shaft and trocar of a tracked instrument; range of jaws");
  calibrate->require_subcommand(1);
  auto options = std::make_shared<CalibrateOptions>();
  calibrate->footer(
      "First tip, then trocar, for each hand; jaw for each sensor. A fit that is poor is refused and changes "
      "nothing.\n"
      "Example: trocar devices calibrate tip liberty:/dev/ttyUSB0 --hand right");
  AddStep(*calibrate, "tip", "Where the tip is, seen from its sensor", *options)
      ->callback([options, &outcome] { outcome.status = CalibrateTracker(*options, true); });
  AddStep(*calibrate, "trocar", "Where the trocar is and which way the shaft points", *options)
      ->callback([options, &outcome] { outcome.status = CalibrateTracker(*options, false); });
  AddStep(*calibrate, "jaw", "What the jaw sensor reads closed and open", *options)
      ->callback([options, &outcome] { outcome.status = CalibrateJaw(*options); });
}

}  // namespace trocar::cli
