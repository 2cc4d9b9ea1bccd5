// SPDX-License-Identifier: Apache-2.0
/// \file golden_play.h  Plays what tests/golden/goldens.json names, with the engine's libraries alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "trocar/agent/surgeon.h"
#include "trocar/base/result.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"

namespace trocar::bits {

/// One entry of goldens.json: a scene with its script, or a task or an operation that a scripted surgeon does.
struct Golden {
  std::string name, lane;
  std::string scene;          ///< file, from the repository on; empty where it is a task or an operation
  std::string task, surgeon;  ///< empty where it is a scene
  std::uint64_t ticks = 0;    ///< of a scene; 0: until the surgeon has finished
  bool has_generated_patient = false;
  std::uint64_t patient_seed = 0;
  std::string hash;  ///< after the last tick
};

/// What tests show of one.
inline std::ostream& operator<<(std::ostream& stream, const Golden& golden) {
  return stream << golden.name;
}

/// \param repository  that holds tests/golden/goldens.json
base::Result<std::vector<Golden>> ReadGoldens(const std::filesystem::path& repository);

/// A golden while it is played.
class GoldenPlay {
 public:
  /// \param scratch  folder for a patient that is generated
  /// \param threads  of the solver
  static base::Result<GoldenPlay> Make(const Golden& golden, const std::filesystem::path& repository,
                                       const std::filesystem::path& scratch, int threads);

  bool IsOver() const;
  /// What the script or the surgeon does in the next tick.
  scene::Input DecideInput();
  void Step(const scene::Input& input) { simulation_.Step(input); }
  const simulation::Simulation& GetSimulation() const { return simulation_; }

 private:
  GoldenPlay(std::shared_ptr<const scene::Scene> scene, simulation::Simulation simulation,
             std::unique_ptr<agent::Surgeon> surgeon);

  std::shared_ptr<const scene::Scene> scene_;  // also the simulation's and the surgeon's
  simulation::Simulation simulation_;
  std::unique_ptr<agent::Surgeon> surgeon_;  // nobody where a script plays
  std::uint64_t most_ticks_ = 0;             // of a script
  double most_seconds_ = 3600;               // of a surgeon, as `trocar play` allows [s]
};

}  // namespace trocar::bits
