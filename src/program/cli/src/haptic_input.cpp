// SPDX-License-Identifier: Apache-2.0
#include "haptic_input.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <utility>

#include "command.h"
#include "trocar/device/device_store.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/device/ports.h"
#include "trocar/host/log.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"

namespace trocar::cli {

using session::HapticHandStatus;

namespace {

/// What the person has to do before force can come.
std::string NextStep(const session::HapticStatus& status) {
  switch (status.check_pose) {
    case haptics::CheckPoseState::kConfirmed:
      return host::Translate("hold the safety switches (the first buttons)");
    case haptics::CheckPoseState::kWrongDevice:
      return host::Translate(
          "another device answered the check pose: exchange left and right, and start again");
    case haptics::CheckPoseState::kUnconfirmed:
    case haptics::CheckPoseState::kAsking:
      break;
  }
  return status.asked == instrument::kLeft
             ? host::Translate("bring the left device to the middle of its reach and hold its first button")
             : host::Translate("bring the right device to the middle of its reach and hold its first button");
}

}  // namespace

void AddHapticOptions(CLI::App& command, HapticOptions& options) {
  CLI::Option* haptics =
      command
          .add_option("--haptics", options.name,
                      "Hands of a haptic device in place of the script's: " + device::ListForceDrivers())
          ->type_name("DEVICE");
  command
      .add_flag("--force", options.has_force,
                "Asks for force: it comes when the check pose is answered and the safety switch held")
      ->needs(haptics);
  command
      .add_option("--haptic-record", options.record,
                  "Write rates, forces and every change of the force feedback to this file (JSON)")
      ->needs(haptics)
      ->type_name("FILE");
}

base::Result<std::unique_ptr<HapticInput>> HapticInput::Open(const HapticOptions& options,
                                                             const simulation::Simulation& simulation) {
  auto driver = device::MakeForceDriver(options.name);
  if (!driver) return driver.error();
  const auto settings = session::MakeHapticSettings(**driver, simulation.GetScene(),
                                                    simulation.GetSnapshot().X_world_laparoscope,
                                                    LoadStoreOrWarn().Buttons("haptics"));
  if (!settings) return settings.error();
  std::unique_ptr<HapticInput> input(new HapticInput);
  auto loop = session::HapticLoop::Start(std::move(*driver), *settings, input->link_);
  if (!loop) return loop.error();
  input->loop_ = std::move(*loop);
  input->wants_force_ = options.has_force;
  input->record_file_ = options.record;
  if (options.has_force) input->loop_->BeginCheckPose();
  input->since_start_ = {};
  return input;
}

void HapticInput::Await(double time) {
  device::SystemClock().Sleep(time - since_start_.Seconds());
}

void HapticInput::AfterStep(simulation::Simulation& simulation) {
  for (const instrument::Hand hand : {instrument::kLeft, instrument::kRight}) {
    simulation.CutPatch(hand, link_.patches[hand].Back());
    link_.patches[hand].Publish();
  }
  const session::HapticStatus& status = loop_->Latest();
  record_.Add(since_start_.Seconds(), status);
  AskForForce(status);
}

base::Status HapticInput::SaveRecord() const {
  return record_file_.empty() ? base::Status{} : host::WriteFile(record_file_, record_.FormatJson());
}

/// Asks while every safety switch is held, until any hand has felt force. From then on nothing asks.
void HapticInput::AskForForce(const session::HapticStatus& status) {
  if (!wants_force_) return;
  const std::string step = NextStep(status);
  if (step != said_) host::Log(host::LogLevel::kInfo, "force feedback: " + step);
  said_ = step;
  wants_force_ = std::none_of(status.hands.begin(), status.hands.end(), [](const HapticHandStatus& hand) {
    return hand.state != haptics::ArmState::kUnarmed;
  });
  const bool are_held =
      std::all_of(status.hands.begin(), status.hands.end(),
                  [](const HapticHandStatus& hand) { return !hand.is_present || hand.is_switch_held; });
  if (wants_force_ && are_held && status.check_pose == haptics::CheckPoseState::kConfirmed)
    loop_->RequestArm();
}

}  // namespace trocar::cli
