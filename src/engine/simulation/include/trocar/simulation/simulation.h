// SPDX-License-Identifier: Apache-2.0
/// \file simulation.h  The tick: fixed, deterministic, staged and timed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/engine_bits.h"
#include "trocar/simulation/model_description.h"
#include "trocar/simulation/operation_result.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/simulation/tool_contact.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/local_patch.h"

namespace trocar::simulation {

/// Services that the program gives a simulation from outside: threads, a device's solver, a clock.
struct Services {
  base::Threads threads{};
  /// Makes the solver of another device, which has other bits than the processor's; empty: the processor solves.
  std::function<std::unique_ptr<tissue::DeviceSolver>(const tissue::TissueModel& model,
                                                      const base::Threads& threads)>
      make_device_solver{};
  /// Monotonic time [ns], for Snapshot::stage_seconds alone, which are 0 where it is null.
  std::int64_t (*now)() noexcept = nullptr;
};

/// Constant data of a surgery: scene, patient, the tissue at rest. Shared by any number of simulations.
struct SimulationModel;

/// \param threads  used to fill tense organs
/// \return kSceneInvalid or kPatientInvalid
base::Result<std::shared_ptr<const SimulationModel>> MakeSimulationModel(
    std::shared_ptr<const scene::Scene> scene, const base::Threads& threads = {});

/// Parts of a simulation's state.
enum class StatePart : std::uint8_t {
  kAll,
  kWorld  ///< without events, errors, phases, task rules and all else that only looks
};

/// One running surgery: a model, a state, and scratch. The same model and the same inputs give the same bits, for any
/// number of threads. It has no clock and no hands of its own: whoever steps it says when, and with which Input.
///
///     auto scene = std::make_shared<const Scene>(*files::ReadScene("scenes/retraction.json"));
///     Simulation simulation = std::move(*Simulation::Make(scene));
///     Input input = scene::CalcScriptInput(*scene, 0.0);      // or hands of one's own, as joints in the trocars
///     simulation.Step(input);
///     simulation.GetSnapshot().positions;                     // nodes after the tick [m]
///
/// A whole program is samples/headless_scene.cpp.
class Simulation {
 public:
  /// \return kSceneInvalid or kPatientInvalid
  static base::Result<Simulation> Make(std::shared_ptr<const scene::Scene> scene,
                                       const Services& services = {});
  /// One more of the same model.
  static base::Result<Simulation> Make(std::shared_ptr<const SimulationModel> model,
                                       const Services& services = {});

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// One tick, of Scene::tick_seconds: see docs/step.md.
  /// \note No lock or file. Allocates only in a tick in which a blade parts an organ, a duct or a vessel.
  void Step(const scene::Input& input) noexcept;
  /// One tick in which nothing is judged or published: the world is the same after it, the snapshot that of before.
  void StepWorld(const scene::Input& input) noexcept;
  /// Back to the first tick.
  void Reset();
  /// Back to the first tick with hands and laparoscope elsewhere; a task's clock runs from their first movement from there.
  /// \param start  hands, with their jaws as the scene has them, and laparoscope; within their limits. The rest is not used
  /// \note A state that is saved later holds where they are, not where they began: Restore it after a Reset to the same
  ///     start, or the clock of a task that nobody has begun may start at once.
  void Reset(const scene::Input& start);

  const scene::Scene& GetScene() const;
  /// Organs, then tubes; constant.
  std::span<const scene::SurfaceInfo> Surfaces() const;
  /// Strands that dissection divides, constant; empty where the scene is no operation.
  std::span<const scene::StrandInfo> Strands() const;
  /// Snapshot that Make, Step, Restore or Reset has published last; overwritten by the next of them.
  const Snapshot& GetSnapshot() const;
  /// How the operation stands; nothing where the scene is none.
  /// \note Allocates.
  std::optional<OperationResult> GetOperationResult() const;

  /// Where the tools touch tissue and things after the last tick: the left hand's first. What jaws hold is not among them, nor
  /// the patient's neighbours, nor where one tool touches the other.
  /// \param[out] contacts  replaced
  /// \note Allocates. Changes nothing.
  void FindToolContacts(std::vector<ToolContact>& contacts) const;

  /// All that decides the future, as bytes with format, model and checksum, for a file, another process or Restore.
  /// \param[out] bytes  replaced; its memory is used again
  void Save(std::vector<std::byte>& bytes) const;
  /// Takes up a saved state: from then on the same inputs give the same bits as where it was saved.
  /// \return kStateInvalid where it is damaged, of another format or another model; then all is as it was
  base::Status Restore(std::span<const std::byte> bytes);
  /// Fingerprint of the model: scene, patient and tissue at rest. States of one model fit each other.
  std::uint64_t ModelFingerprint(ModelFingerprintKind kind = ModelFingerprintKind::kEveryField) const;
  /// Fingerprint of the state.
  std::uint64_t Hash(StatePart part = StatePart::kAll) const;
  /// Names and fingerprints of all fields of the state, in their order: where two states differ.
  std::vector<std::pair<std::string, std::uint64_t>> HashFields() const;
  /// Restore for tests: leaves one field out, "world/tissue/position" for instance, which keeps its value.
  base::Status RestoreWithout(std::span<const std::byte> bytes, const std::string& field);
  /// \param field  that has no fields of its own
  /// \param bytes  of the field, at the end of the span; lengths of the lists that it is in may come before them
  using AlterField = std::function<void(const std::string& field, std::span<std::byte> bytes)>;
  /// Save for tests: a state that no hand may ever bring about.
  /// \param alter  called with each field in turn; may change its bytes
  void SaveAltered(std::vector<std::byte>& bytes, const AlterField& alter) const;

  /// Cuts out the tissue around one tool for the haptic loop, after a Step.
  /// \note Real-time safe: no allocation, lock or throw.
  void CutPatch(instrument::Hand hand, tissue::LocalPatch& patch) noexcept;
  /// Name of the device that solves; empty when the processor does.
  std::string_view DeviceName() const;
  /// Why the device that was asked for does not solve, from the tick in which it failed; else nullptr.
  const base::Error* DeviceError() const;
  /// How far the tissue was from equilibrium when the last tick's solve ended: the largest distance of a node
  /// to the equilibrium that an exact solver reaches from there under the same load and with the same volumes,
  /// over the largest distance of any node from rest [-]. NaN where that solver does not come to rest.
  /// \note For tests and benchmarks: takes many times as long as a tick, and allocates.
  double CalcEquilibriumError() const;

 private:
  struct Content;
  explicit Simulation(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::simulation
