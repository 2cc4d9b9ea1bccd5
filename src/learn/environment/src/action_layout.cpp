// SPDX-License-Identifier: Apache-2.0
#include "action_layout.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <string>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::environment {

using instrument::kHandCount;

namespace {

constexpr std::array<const char*, kHandCount> kHandNames = {"left.", "right."};
constexpr std::array<const char*, 5> kJointNames = {"pan", "tilt", "spin", "depth", "jaw"};
constexpr std::array<const char*, 5> kTipNames = {"x", "y", "z", "spin", "jaw"};
constexpr std::array<const char*, 5> kPedalNames = {"cut", "coagulate", "rinse", "aspirate", "tool"};
constexpr std::array<double, 5> kJointRates = {kMaxTurn, kMaxTurn, kMaxSpin, kMaxTipSpeed, kMaxJaw};
constexpr std::array<double, 5> kTipRates = {kMaxTipSpeed, kMaxTipSpeed, kMaxTipSpeed, kMaxSpin, kMaxJaw};
constexpr std::size_t kMoves = 10;  // to and fro along each of five, in a discrete action
constexpr std::size_t kCameraMoves = 8;
constexpr std::size_t kCommands = 4;  // of the assistant

/// What a policy's single precision adds to a bound at most; so far beyond it an action is cut and not refused [-].
constexpr double kRounding = 1e-6;

/// With as many digits as tell it from any other.
std::string InFull(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

/// Place in a row of `count` equal parts of -1 to 1.
std::size_t PartOf(double value, std::size_t count) {
  const double part = 0.5 * (value + 1) * static_cast<double>(count);
  return std::min(count - 1, base::TruncateTo<std::size_t>(std::max(part, 0.0)));
}

/// Of the parts of PartOf.
double MiddleOf(std::size_t part, std::size_t count) {
  return -1 + (2 * static_cast<double>(part) + 1) / static_cast<double>(count);
}

}  // namespace

ActionLayout::ActionLayout(const scene::Scene& scene, const EnvironmentSettings& settings)
    : kind_(settings.actions),
      clips_(settings.clips_actions),
      moves_camera_(settings.moves_camera),
      has_assistant_(scene.operation && scene.operation->assistant) {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const scene::InstrumentSetup& setup = scene.instruments[hand];
    const bool has_tissue = scene.operation || scene.model;
    const auto obeys = [&](bool instrument::Pedals::*pedal) {
      return std::any_of(setup.tray.begin(), setup.tray.end(), [&](const instrument::Tool& tool) {
        return instrument::AbilitiesOf(tool.kind).pedals.*pedal;
      });
    };
    if (obeys(&instrument::Pedals::cut) && has_tissue) pedals_[hand].push_back(Pedal::kCut);
    if (obeys(&instrument::Pedals::coagulate) && has_tissue) pedals_[hand].push_back(Pedal::kCoagulate);
    if (obeys(&instrument::Pedals::rinse)) pedals_[hand].push_back(Pedal::kRinse);
    if (obeys(&instrument::Pedals::aspirate)) pedals_[hand].push_back(Pedal::kAspirate);
    tools_[hand] = setup.tray.size();
    if (tools_[hand] > 1) pedals_[hand].push_back(Pedal::kNextTool);

    const std::string name = kHandNames[hand];
    if (kind_ == ActionKind::kDiscrete) {
      Add(name + "choice", "-", 1 + kMoves + pedals_[hand].size());
      continue;
    }
    const bool is_tip = kind_ == ActionKind::kTip;
    const auto& rates = is_tip ? kTipRates : kJointRates;
    for (std::size_t i = 0; i < rates.size(); ++i) {
      const bool is_length = is_tip ? i < 3 : i == 3;
      char unit[32];
      std::snprintf(unit, sizeof unit, "%g %s", rates[i], is_length ? "m/s" : "rad/s");
      Add(name + (is_tip ? kTipNames : kJointNames)[i], unit);
    }
    for (const Pedal pedal : pedals_[hand]) Add(name + kPedalNames[static_cast<std::size_t>(pedal)], "-");
  }
  if (kind_ == ActionKind::kDiscrete) {
    if (moves_camera_) Add("camera.choice", "-", 1 + kCameraMoves);
    if (has_assistant_) Add("assistant.choice", "-", kCommands);
    return;
  }
  if (moves_camera_) {
    for (const char* joint : {"pan", "tilt", "spin"}) Add(std::string("camera.") + joint, "1 rad/s");
    Add("camera.depth", "0.12 m/s");
  }
  if (has_assistant_) Add("assistant.command", "-");
}

void ActionLayout::Add(std::string name, std::string unit, std::size_t choices) {
  fields_.push_back({std::move(name), size_++, 1, std::move(unit), choices});
}

base::Status ActionLayout::Check(std::span<const double> action) const {
  const auto wrong = [](const std::string& what) {
    return base::Error{base::ErrorCode::kActionInvalid, what};
  };
  if (action.size() != size_) {
    return wrong("an action of this environment has " + std::to_string(size_) + " numbers, not " +
                 std::to_string(action.size()) + "; its action space says which");
  }
  for (const Field& field : fields_) {
    const double value = action[field.first];
    if (!std::isfinite(value))
      return wrong("\"" + field.name + "\" of the action is NaN or infinite; look at what the policy gives");
    if (clips_) continue;
    if (field.choices == 0
            ? std::abs(value) > 1 + kRounding
            : value < 0 || value >= static_cast<double>(field.choices) || value != std::floor(value)) {
      return wrong("\"" + field.name + "\" of the action is " + InFull(value) + "; it goes from " +
                   (field.choices == 0 ? "-1 to 1: clip it"
                                       : "0 to " + std::to_string(field.choices - 1) + ", in whole numbers"));
    }
  }
  return {};
}

Motion ActionLayout::Read(std::span<const double> action, scene::Input& input) const {
  for (scene::HandControls& controls : input.controls) controls = {.tool = controls.tool};
  if (kind_ == ActionKind::kDiscrete) return ReadDiscrete(action, input);
  Motion motion;
  std::size_t next = 0;
  const auto take = [&] { return std::clamp(action[next++], -1.0, 1.0); };  // rounding, or all of it
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto& rates = kind_ == ActionKind::kTip ? kTipRates : kJointRates;
    for (std::size_t i = 0; i < rates.size(); ++i) motion.rates[hand][i] = rates[i] * take();
    scene::HandControls& controls = input.controls[hand];
    for (const Pedal pedal : pedals_[hand]) {
      const double value = take();
      switch (pedal) {
        case Pedal::kCut:
          controls.cut = value > 0;
          break;
        case Pedal::kCoagulate:
          controls.coagulate = value > 0;
          break;
        case Pedal::kRinse:
          controls.rinse = value > 0;
          break;
        case Pedal::kAspirate:
          controls.aspirate = value > 0;
          break;
        case Pedal::kNextTool:
          controls.tool = static_cast<std::uint8_t>(PartOf(value, tools_[hand]));
          break;
      }
    }
  }
  if (moves_camera_) {
    for (std::size_t i = 0; i < 4; ++i) motion.camera[i] = (i == 3 ? kMaxTipSpeed : kMaxTurn) * take();
  }
  if (has_assistant_) input.assistant = static_cast<scene::AssistantCommand>(PartOf(take(), kCommands));
  return motion;
}

Motion ActionLayout::ReadDiscrete(std::span<const double> action, scene::Input& input) const {
  Motion motion;
  std::size_t next = 0;
  const auto take = [&] {
    const double most = static_cast<double>(fields_[next].choices) - 1;
    return base::TruncateTo<std::size_t>(std::clamp(std::floor(action[next++]), 0.0, most));
  };
  for (int hand = 0; hand < kHandCount; ++hand) {
    auto choice = take();
    if (choice == 0) continue;
    --choice;
    if (choice < kMoves) {
      motion.rates[hand][choice / 2] = (choice % 2 == 0 ? 1 : -1) * kTipRates[choice / 2];
      continue;
    }
    scene::HandControls& controls = input.controls[hand];
    switch (pedals_[hand][choice - kMoves]) {
      case Pedal::kCut:
        controls.cut = true;
        break;
      case Pedal::kCoagulate:
        controls.coagulate = true;
        break;
      case Pedal::kRinse:
        controls.rinse = true;
        break;
      case Pedal::kAspirate:
        controls.aspirate = true;
        break;
      case Pedal::kNextTool:
        controls.tool = static_cast<std::uint8_t>((controls.tool + std::size_t{1}) % tools_[hand]);
        break;
    }
  }
  if (moves_camera_) {
    if (const auto choice = take(); choice > 0) {
      const std::size_t joint = (choice - 1) / 2;
      motion.camera[joint] = (choice % 2 == 1 ? 1 : -1) * (joint == 3 ? kMaxTipSpeed : kMaxTurn);
    }
  }
  if (has_assistant_) input.assistant = static_cast<scene::AssistantCommand>(take());
  return motion;
}

void ActionLayout::Write(std::span<const math::Vec3, kHandCount> ports, const scene::Input& before,
                         const scene::Input& after, double seconds, std::span<double> action) const {
  TROCAR_ASSERT(kind_ != ActionKind::kDiscrete && seconds > 0 && action.size() == size_);
  const auto share = [&](double way, double rate) { return std::clamp(way / (seconds * rate), -1.0, 1.0); };
  std::size_t next = 0;
  for (std::size_t hand = 0; hand < kHandCount; ++hand) {
    const instrument::TrocarJoints &from = before.hands[hand], &to = after.hands[hand];
    if (kind_ == ActionKind::kTip) {
      const math::Vec3 way = instrument::CalcToolPose(ports[hand], to).translation -
                             instrument::CalcToolPose(ports[hand], from).translation;
      for (const double along : {way.x, way.y, way.z}) action[next++] = share(along, kMaxTipSpeed);
      action[next++] = share(to.spin - from.spin, kMaxSpin);
    } else {
      action[next++] = share(to.pan - from.pan, kMaxTurn);
      action[next++] = share(to.tilt - from.tilt, kMaxTurn);
      action[next++] = share(to.spin - from.spin, kMaxSpin);
      action[next++] = share(to.depth - from.depth, kMaxTipSpeed);
    }
    action[next++] = share(to.jaw - from.jaw, kMaxJaw);
    const scene::HandControls& controls = after.controls[hand];
    for (const Pedal pedal : pedals_[hand]) {
      switch (pedal) {
        case Pedal::kCut:
          action[next++] = controls.cut ? 1 : -1;
          break;
        case Pedal::kCoagulate:
          action[next++] = controls.coagulate ? 1 : -1;
          break;
        case Pedal::kRinse:
          action[next++] = controls.rinse ? 1 : -1;
          break;
        case Pedal::kAspirate:
          action[next++] = controls.aspirate ? 1 : -1;
          break;
        case Pedal::kNextTool:
          action[next++] = MiddleOf(controls.tool, tools_[hand]);
          break;
      }
    }
  }
  if (moves_camera_) {
    const instrument::TrocarJoints &from = before.laparoscope, &to = after.laparoscope;
    action[next++] = share(to.pan - from.pan, kMaxTurn);
    action[next++] = share(to.tilt - from.tilt, kMaxTurn);
    action[next++] = share(to.spin - from.spin, kMaxTurn);
    action[next++] = share(to.depth - from.depth, kMaxTipSpeed);
  }
  if (has_assistant_) action[next++] = MiddleOf(static_cast<std::size_t>(after.assistant), kCommands);
  TROCAR_ASSERT(next == size_);
}

void ActionLayout::Move(const scene::Scene& scene, const Motion& motion, double dt,
                        scene::Input& input) const {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto& rates = motion.rates[hand];
    instrument::TrocarJoints& joints = input.hands[hand];
    if (kind_ == ActionKind::kJoints) {
      joints.pan += dt * rates[0];
      joints.tilt += dt * rates[1];
      joints.spin += dt * rates[2];
      joints.depth += dt * rates[3];
    } else {
      // a hand that rests keeps its bits
      const math::Vec3 step = {dt * rates[0], dt * rates[1], dt * rates[2]};
      if (step != math::Vec3{}) {
        const math::Vec3& port = scene.instruments[hand].p_world_port;
        const math::Vec3 tip = instrument::CalcToolPose(port, joints).translation + step;
        joints = instrument::FindJoints(port, tip, joints.spin, joints.jaw);
      }
      joints.spin += dt * rates[3];
    }
    joints.jaw += dt * rates[4];
    instrument::JointLimits limits;
    limits.max_jaw = scene.instruments[hand].tray.at(input.controls[hand].tool).max_jaw;
    joints = instrument::ClampJoints(joints, limits);
  }
  if (!moves_camera_) return;
  input.laparoscope.pan += dt * motion.camera[0];
  input.laparoscope.tilt += dt * motion.camera[1];
  input.laparoscope.spin += dt * motion.camera[2];
  input.laparoscope.depth += dt * motion.camera[3];
  instrument::JointLimits limits;
  input.laparoscope = instrument::ClampJoints(input.laparoscope, limits);
}

}  // namespace trocar::environment
