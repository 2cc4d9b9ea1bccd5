// SPDX-License-Identifier: Apache-2.0
#include "trocar/agent/skill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"
#include "skilled_surgeon.h"
#include "task_surgeon.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"

namespace trocar::agent {

using scene::Scene;

namespace {

struct WeaknessText {
  std::string_view name, about;
};
constexpr std::array<WeaknessText, kWeaknessCount> kWeaknesses = {{
    {"trembles", "able, but the tips tremble"},
    {"one_handed", "able, but the hand that is not at work never goes ahead"},
    {"presses", "able, but presses into what lies behind"},
    {"burns_early", "able, but presses the pedal before the electrode touches"},
    {"looks_away", "able, but lets the picture wander off the tools"},
    {"wanders", "able, but takes detours"},
    {"overshoots", "able, but goes past each aim and comes back"},
    {"hesitates", "able, but pauses before each act"},
    {"confuses", "able, but often begins at the wrong place"},
    {"reacts_late", "able, but acts late on what is seen"},
}};

SurgeonSkill Novice() noexcept {
  SurgeonSkill skill;
  skill.hand = {0.05, 0.5, 0.0003, 0.0010, 1.0, 1.2, 0.04, 0.10};
  skill.pause = 0.8;
  skill.miss_share = 0.35;
  skill.camera_speed = 0.03;
  skill.anticipation = 0.1;
  skill.wrong_plan = 0.15;
  skill.press = 0.0008;
  skill.early_pedal = 0.4;
  skill.delay = 0.15;
  skill.camera_drift = 0.03;
  return skill;
}

SurgeonSkill Intermediate() noexcept {
  SurgeonSkill skill;
  skill.hand = {0.08, 0.35, 0.0002, 0.0005, 1.6, 2.0, 0.02, 0.05};
  skill.pause = 0.3;
  skill.miss_share = 0.12;
  skill.camera_speed = 0.055;
  skill.anticipation = 0.5;
  skill.wrong_plan = 0.05;
  skill.press = 0.0004;
  skill.early_pedal = 0.15;
  skill.delay = 0.08;
  skill.camera_drift = 0.015;
  return skill;
}

SurgeonSkill Expert() noexcept {
  SurgeonSkill skill;
  skill.anticipation = 1.0;
  return skill;
}

/// Both hands are named by the rules, so that there is work for the second one.
bool NeedsBothHands(const Scene& scene) noexcept {
  if (!scene.task) return false;
  using scene::ConditionKind;
  bool needs[instrument::kHandCount] = {};
  for (const scene::Goal& goal : scene.task->goals) {
    for (const scene::Condition& step : goal.steps) {
      if (step.kind == ConditionKind::kHandedOver) return true;
      if (step.hand >= 0 && step.hand < instrument::kHandCount) needs[step.hand] = true;
    }
  }
  return needs[instrument::kLeft] && needs[instrument::kRight];
}

bool HasElectrode(const Scene& scene) noexcept {
  return std::any_of(scene.instruments.begin(), scene.instruments.end(), [](const auto& instrument) {
    return std::any_of(instrument.tray.begin(), instrument.tray.end(),
                       [](const instrument::Tool& tool) { return tool.kind == instrument::ToolKind::kHook; });
  });
}

/// Things that can be taken, or ducts and sheets that can be pressed.
bool HasSomethingToPress(const Scene& scene) noexcept {
  const bool has_things = std::any_of(scene.objects.begin(), scene.objects.end(),
                                      [](const auto& object) { return object.Moves(); });
  return has_things || !scene.patient.tubes.empty() || (scene.model && !scene.model->sheets.empty());
}

/// Goals in other places, one of which may be mistaken for another.
bool HasOtherPlaces(const Scene& scene) noexcept {
  if (!scene.task) return false;
  return std::count_if(scene.task->goals.begin(), scene.task->goals.end(), [](const scene::Goal& goal) {
           if (goal.steps.empty()) return false;
           const scene::Condition& first = goal.steps.front();
           return first.object >= 0 ||
                  (!first.regions.empty() && first.kind != scene::ConditionKind::kCameraSees);
         }) >= 2;
}

}  // namespace

std::string_view NameOf(SkillLevel level) noexcept {
  constexpr std::string_view kNames[] = {"novice", "intermediate", "expert"};
  return kNames[static_cast<std::size_t>(level)];
}

SurgeonSkill LevelSkill(SkillLevel level) noexcept {
  switch (level) {
    case SkillLevel::kNovice:
      return Novice();
    case SkillLevel::kIntermediate:
      return Intermediate();
    case SkillLevel::kExpert:
      break;
  }
  return Expert();
}

std::string_view NameOf(Weakness weakness) noexcept {
  return kWeaknesses[static_cast<std::size_t>(weakness)].name;
}

std::string_view AboutOf(Weakness weakness) noexcept {
  return kWeaknesses[static_cast<std::size_t>(weakness)].about;
}

SurgeonSkill PlantWeakness(SurgeonSkill skill, Weakness weakness, double strength) noexcept {
  switch (weakness) {
    case Weakness::kTremor:
      skill.hand.tremor += 0.0012 * strength;
      break;
    case Weakness::kIdleHand:
      skill.anticipation = 0;
      break;
    case Weakness::kForce:
      skill.press += 0.004 * strength;
      break;
    case Weakness::kEnergyInAir:
      skill.early_pedal += 1.2 * strength;
      break;
    case Weakness::kPoorCamera:
      skill.camera_drift += 0.35 * strength;
      break;
    case Weakness::kWandering:
      skill.hand.wander += 0.35 * strength;
      break;
    case Weakness::kOvershoot:
      skill.hand.overshoot += 0.12 * strength;
      break;
    case Weakness::kHesitation:
      skill.pause += 1.5 * strength;
      break;
    case Weakness::kWrongPlan:
      skill.wrong_plan = std::min(0.5, skill.wrong_plan + 0.4 * strength);
      break;
    case Weakness::kDelay:
      skill.delay = std::min(0.5, skill.delay + 0.35 * strength);
      break;
  }
  return skill;
}

SurgeonSkill SampleSkill(const SurgeonSkill& around, double spread, std::uint64_t seed) noexcept {
  math::Random random(seed ^ 0x736b696c6cULL);
  const double most = math::Log1p(spread);
  const auto vary = [&](double value) { return value * math::Exp(random.Uniform(-most, most)); };
  SurgeonSkill skill = around;
  skill.hand.speed = vary(skill.hand.speed);
  skill.hand.shortest = vary(skill.hand.shortest);
  skill.hand.tremor = vary(skill.hand.tremor);
  skill.hand.aim_error = vary(skill.hand.aim_error);
  skill.hand.jaw_rate = vary(skill.hand.jaw_rate);
  skill.hand.spin_rate = vary(skill.hand.spin_rate);
  skill.hand.overshoot = vary(skill.hand.overshoot);
  skill.hand.wander = vary(skill.hand.wander);
  skill.pause = vary(skill.pause);
  skill.miss_share = std::min(0.6, vary(skill.miss_share));
  skill.camera_speed = vary(skill.camera_speed);
  skill.anticipation = std::min(1.0, vary(skill.anticipation));
  skill.wrong_plan = std::min(0.5, vary(skill.wrong_plan));
  skill.press = vary(skill.press);
  skill.early_pedal = vary(skill.early_pedal);
  skill.delay = std::min(0.5, vary(skill.delay));
  skill.camera_drift = std::min(0.6, vary(skill.camera_drift));
  return skill;
}

base::Result<std::unique_ptr<Surgeon>> MakeSkilledSurgeon(std::shared_ptr<const Scene> scene,
                                                          const SurgeonSkill& skill, std::uint64_t seed) {
  std::unique_ptr<Surgeon> hands;
  if (IsDoneByGoals(*scene)) {
    hands = std::make_unique<TaskSurgeon>(scene, skill, ErrorScenario::kNone, seed);
  } else if (IsCholecystectomy(*scene)) {
    hands = std::make_unique<CholecystectomySurgeon>(scene, skill, OperationErrorScenario::kNone, seed);
  } else {
    return base::Error{
        base::ErrorCode::kUnknownName,
        "\"" + scene->name + "\" is neither a training task nor a cholecystectomy; see trocar play --list"};
  }
  if (!(skill.delay > 0) && !(skill.camera_drift > 0)) return hands;
  return std::unique_ptr<Surgeon>(
      std::make_unique<SkilledSurgeon>(std::move(hands), skill, scene->tick_seconds, seed));
}

bool CanShow(Weakness weakness, const Scene& scene) noexcept {
  switch (weakness) {
    case Weakness::kIdleHand:
      return NeedsBothHands(scene);
    case Weakness::kEnergyInAir:
      return HasElectrode(scene);
    case Weakness::kPoorCamera:
      return !scene.settings.holds_camera;
    case Weakness::kForce:
      return HasSomethingToPress(scene);
    case Weakness::kWrongPlan:
      return HasOtherPlaces(scene);
    default:
      return true;
  }
}

}  // namespace trocar::agent
