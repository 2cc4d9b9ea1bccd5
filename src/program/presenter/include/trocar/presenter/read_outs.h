// SPDX-License-Identifier: Apache-2.0
/// \file read_outs.h  Numbers and events of a running session in words that a person reads.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::presenter {

enum class ForceLevel { kCalm, kWarning, kDanger };

/// Where the force of one instrument becomes a warning and where tissue may tear.
/// Source: domain facts, section 3.3; defaults without a measured source, to be tuned with a surgeon.
struct ForceThresholds {
  double warning = 3;  ///< [N]
  double danger = 6;   ///< [N]
};
/// Right end of the force bars [N].
inline constexpr double kForceBarEnd = 15.0;

/// A hollow organ: 8 and 12 N (traction, tear). Liver and everything else: 3 and 6 N (push, capsule tear).
ForceThresholds FindForceThresholds(roles::OrganRole organ) noexcept;
/// A force that is not finite is a danger.
ForceLevel JudgeForce(double force, const ForceThresholds& thresholds) noexcept;

/// "2.1 N"; "— N" for a number that is not finite
std::string FormatForce(double force);
/// "4.21 ms"
std::string FormatMilliseconds(double seconds);
/// "1:07.3"
std::string FormatTime(double seconds);
/// "18,234"
std::string FormatCount(std::uint64_t count);
/// "3.2e-05"
std::string FormatResidual(double residual);

/// "liver", "cystic duct": an organ's name with spaces; "tissue" where the index names none.
std::string OrganLabel(const patient::Patient& patient, std::int32_t organ);
/// "ring 1": the name of a scene's loose thing with spaces. \param object  index into Scene::objects
std::string ObjectLabel(const scene::Scene& scene, std::int32_t object);
/// "left grasper"; "left hand" where it has several tools
std::string HandLabel(const scene::Scene& scene, std::int32_t hand);

/// "clip applier"
std::string ToolName(const instrument::Tool& tool);
/// Name of the tool that a hand has in use, with spaces: "clip applier, 12 clips", "hook".
std::string ToolLabel(const scene::Scene& scene, const simulation::Snapshot& snapshot, instrument::Hand hand);
/// "4.2 mL"
std::string FormatMillilitres(double volume);
/// Volume of a fluid that has left the vessels and organs, and of it what still lies there: "12.0 mL, 3.5 mL in the abdomen".
std::string DescribeFluid(const surgery::FluidLedger& fluids, surgery::Fluid fluid);
/// Gallstones outside of their organ: "none spilled", "3 in the abdomen, 2 retrieved".
std::string DescribeStones(std::span<const surgery::StoneSnapshot> stones);
/// "waits", "retracts the fundus", ...
std::string DescribeAssistant(scene::AssistantCommand command, bool is_holding);

/// "holds the cystic duct", "touches the liver", "free"
std::string DescribeContact(const simulation::InstrumentSnapshot& instrument,
                            const patient::Patient& patient);

/// "Left grasper: grasped the liver, 2.1 N", "Tissue: last good state restored".
std::string DescribeEvent(const scene::Event& event, const scene::Scene& scene);
/// True for what should be seen at once: slips, missed grasps, restored states.
bool IsWarning(const scene::Event& event) noexcept;

/// How a task goes, for a person.
struct TaskReadOut {
  std::string time;      ///< "0:12.3 / 5:00.0"
  std::string progress;  ///< "3 of 12"
  std::string score;     ///< "87.4"; "—" before it is over
  std::string next;      ///< "Next: Ring 2 to the right"; after the end, the result
  std::string errors;    ///< "2 x The ring touched the wire", a line each
};
TaskReadOut DescribeTask(const scene::Task& task, const scene::TaskSnapshot& now);

/// "Find contacts"
std::string StageLabel(simulation::Stage stage);

/// Smoothed times of the stages, fed with every snapshot that is drawn.
class StageMeter {
 public:
  /// Takes the stage times of a tick; the same tick twice counts once.
  void Add(const simulation::Snapshot& snapshot) noexcept;
  /// Exponential mean over about 60 snapshots [s].
  const std::array<double, simulation::kStageCount>& Seconds() const noexcept { return seconds_; }

 private:
  std::array<double, simulation::kStageCount> seconds_{};
  std::uint64_t last_tick_ = 0;
  bool has_any_ = false;
};

/// Frames drawn in the last second.
class FrameMeter {
 public:
  /// \param time  of the frame [s], not falling
  void Add(double time) noexcept;
  /// Frames a second over the frames of the last second; 0 with fewer than two.
  double Rate(double now) const noexcept;
  std::uint64_t Count() const noexcept { return count_; }

 private:
  static constexpr int kCapacity = 512;
  std::array<double, kCapacity> times_{};
  std::uint64_t count_ = 0;
};

}  // namespace trocar::presenter
