// SPDX-License-Identifier: Apache-2.0
/// \file skill.h  How able a scripted surgeon is: levels, weaknesses, and people who differ a little from each other.
///
/// All figures are tunables that say what is meant by a level here. They make people of known skill, so that it can be
/// asked which metrics find out; they do not say how residents move.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "trocar/agent/hand_motion.h"
#include "trocar/agent/surgeon.h"

namespace trocar::agent {

/// How a surgeon works. The defaults are the steady reference, "expert" of `trocar play`.
struct SurgeonSkill {
  HandSkill hand;
  double pause = 0.05;         ///< before each act, at most [s]
  double miss_share = 0;       ///< of grasps that first close beside the thing [-]
  double camera_speed = 0.09;  ///< of the lens [m/s]
  /// How often the free hand goes ahead to its next work while the other one moves [-], 0 to 1.
  double anticipation = 0;
  /// How often a step begins at another goal's thing, and has to begin again [-], 0 to 0.5.
  double wrong_plan = 0;
  double press = 0;         ///< how far tools go past what they take, into what lies behind [m], >= 0
  double early_pedal = 0;   ///< for which the pedal is pressed before the electrode touches [s], >= 0
  double delay = 0;         ///< from seeing to acting [s], 0 to 0.5
  double camera_drift = 0;  ///< how far the picture wanders off, to either side [rad], 0 to 0.6
};

/// Three levels. Everything between and around them: SampleSkill.
enum class SkillLevel : std::uint8_t { kNovice, kIntermediate, kExpert };
inline constexpr int kSkillLevelCount = 3;
/// "novice", "intermediate", "expert"
std::string_view NameOf(SkillLevel level) noexcept;
SurgeonSkill LevelSkill(SkillLevel level) noexcept;

/// One thing that is wrong throughout.
enum class Weakness : std::uint8_t {
  kTremor,       ///< the tip trembles
  kIdleHand,     ///< the hand that is not at work waits, and never goes ahead
  kForce,        ///< presses and pulls harder than needed
  kEnergyInAir,  ///< presses the pedal before the electrode touches
  kPoorCamera,   ///< lets the picture wander off the tools
  kWandering,    ///< takes detours
  kOvershoot,    ///< goes past the aim and comes back
  kHesitation,   ///< pauses before each act
  kWrongPlan,    ///< begins at the wrong place
  kDelay         ///< reacts late
};
inline constexpr int kWeaknessCount = 10;
/// The name of the surgeon who has it: "trembles", "one_handed", "presses", "burns_early", "looks_away", "wanders",
/// "overshoots", "hesitates", "confuses", "reacts_late".
std::string_view NameOf(Weakness weakness) noexcept;
/// One line, for a person.
std::string_view AboutOf(Weakness weakness) noexcept;
/// \param strength  1: plain to see; > 0
SurgeonSkill PlantWeakness(SurgeonSkill skill, Weakness weakness, double strength = 1) noexcept;

/// Somebody of about that skill: every figure times a factor of their own, log-uniform from 1 / (1 + spread) to
/// 1 + spread.
/// \param spread  [-], >= 0
/// \note The same skill, spread and seed give the same person.
SurgeonSkill SampleSkill(const SurgeonSkill& around, double spread, std::uint64_t seed) noexcept;

/// A surgeon of that skill for a task or an operation. On patients, anticipation, wrong plans, pressing and early pedals
/// are not used: the operation has plans of its own.
/// \return kUnknownName where the scene is nothing that a scripted surgeon can do
base::Result<std::unique_ptr<Surgeon>> MakeSkilledSurgeon(std::shared_ptr<const scene::Scene> scene,
                                                          const SurgeonSkill& skill, std::uint64_t seed);

/// Whether the weakness can show in a scene: no pedal without an electrode, no idle hand where the rules name both.
bool CanShow(Weakness weakness, const scene::Scene& scene) noexcept;

}  // namespace trocar::agent
