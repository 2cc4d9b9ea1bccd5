// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/tutorial.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "trocar/host/translate.h"

namespace trocar::presenter {
namespace {

// how much of a motion shows that it was understood
constexpr double kMovedAcross = 0.015, kMovedDeep = 0.008;  // m
constexpr double kOpen = 0.5, kClosed = 0.1, kSpun = 0.35;  // rad
constexpr double kLooked = 0.06;                            // rad

enum Lesson { kTake, kMove, kDepth, kOpenJaws, kCloseJaws, kSpin, kOtherHand, kLook, kRing, kPause };

// in the order of Lesson; names of keys and buttons are put in by KeyBindings::Fill
constexpr std::string_view kTexts[kTutorialSteps] = {
    "Click into the picture: the mouse takes the right instrument.",
    "Move the mouse: the tip follows it across the picture.",
    "Turn the wheel away from you: the tip goes into the picture; towards you: back out.",
    "Hold the {button:open} mouse button (or {open-jaws}): the jaws open.",
    "Hold the {button:close} mouse button (or {close-jaws}): the jaws close.",
    "Hold {spin-left} or {spin-right}: the instrument spins about its shaft.",
    "Press {other-hand}: the mouse takes the other hand; this one keeps its place and its grip.",
    "Hold {hold-laparoscope} and move the mouse: the laparoscope looks round. Let {hold-laparoscope} go "
    "again.",
    "Take a ring: jaws open; move until the tip lies over the ring's rim in the picture; turn the wheel away "
    "from "
    "you: the tip goes in behind that spot and stops at the rim; close. Then open them: it falls.",
    "Press {run}: everything stands still. Press it again to go on."};

double CalcTurn(const instrument::TrocarJoints& a, const instrument::TrocarJoints& b) {
  return std::hypot(a.pan - b.pan, a.tilt - b.tilt);
}

bool IsAnyHeld(const simulation::Snapshot& snapshot) {
  return std::any_of(snapshot.instruments.begin(), snapshot.instruments.end(),
                     [](const simulation::InstrumentSnapshot& one) { return one.object >= 0; });
}

}  // namespace

std::span<const std::string_view> TutorialTexts() noexcept {
  return kTexts;
}

std::string TutorialTaskName() {
  return host::Translate("peg transfer");
}

void Tutorial::Begin(int step) {
  is_on_ = true;
  step_ = std::clamp(step, 0, kTutorialSteps);
  has_start_ = false;
}

void Tutorial::Remember(const TutorialSight& sight) {
  start_ = *sight.input;
  start_hand_ = sight.hand;
  was_open_ = was_held_ = was_paused_ = false;
  has_start_ = true;
}

bool Tutorial::Observe(const TutorialSight& sight) {
  if (!is_on_ || IsDone() || sight.snapshot == nullptr || sight.input == nullptr) return false;
  if (!has_start_) Remember(sight);
  if (!IsStepDone(sight)) return false;
  ++step_;
  Remember(sight);
  return true;
}

bool Tutorial::IsStepDone(const TutorialSight& sight) {
  const auto hand = static_cast<std::size_t>(sight.hand);
  const instrument::TrocarJoints &now = sight.input->hands[hand], &start = start_.hands[hand];
  switch (step_) {
    case kTake:
      return sight.is_pointer_taken;
    case kMove:
      return now.depth * CalcTurn(now, start) > kMovedAcross;
    case kDepth:
      return std::fabs(now.depth - start.depth) > kMovedDeep;
    case kOpenJaws:
      return now.jaw > kOpen;
    case kCloseJaws:
      was_open_ = was_open_ || now.jaw > kOpen;
      return was_open_ && now.jaw < kClosed;
    case kSpin:
      return std::fabs(now.spin - start.spin) > kSpun;
    case kOtherHand:
      return sight.hand != start_hand_;
    case kLook:
      was_held_ = was_held_ || (sight.is_laparoscope_held &&
                                CalcTurn(sight.input->laparoscope, start_.laparoscope) > kLooked);
      return was_held_ && !sight.is_laparoscope_held;
    case kRing:
      was_held_ = was_held_ || IsAnyHeld(*sight.snapshot);
      return was_held_ && !IsAnyHeld(*sight.snapshot);
    case kPause:
      was_paused_ = was_paused_ || sight.is_paused;
      return was_paused_ && !sight.is_paused;
    default:
      return false;
  }
}

std::string Tutorial::Text(const KeyBindings& bindings) const {
  if (!is_on_) return "";
  const std::string leave = bindings.Fill(host::Translate("   ({tutorial} leaves the tutorial)"));
  if (IsDone())
    return host::TranslateWith(
        "Done: these are all the controls. {1} or the button below begins the task, as an attempt that is "
        "kept: "
        "the bright ring shows what comes next.{2}",
        {bindings.Fill("{reset}"), leave});
  return host::TranslateWith("{1} of {2}:  {3}{4}",
                             {std::to_string(step_ + 1), std::to_string(kTutorialSteps),
                              bindings.Fill(host::Translate(kTexts[step_])), leave});
}

}  // namespace trocar::presenter
