// SPDX-License-Identifier: Apache-2.0
/// \file conservation.h  Shape and volume of organs, kept while any solver finds their equilibrium.
///
/// All of it acts through TissueLoad::external_force: a turned rest shape and a pressure are, between two
/// iterations, constant forces. So every solver serves that calls a hook now and then; there the volume is
/// projected and the pressure follows. docs/conservation.md derives why that converges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/linear_response.h"
#include "trocar/tissue/rest_frame.h"
#include "trocar/tissue/tissue_model.h"
#include "trocar/tissue/volume_constraint.h"

namespace trocar::tissue {

/// Most organs whose volume is kept.
inline constexpr std::size_t kMaxClosedOrgans = 8;

/// A closed surface among the nodes of a model.
struct ClosedOrgan {
  std::uint32_t first_node = 0, node_count = 0;
  std::vector<geometry::Triangle> triangles;  ///< indices from 0 at first_node
  double fluid_density = kBileDensity;        ///< of what would leak [kg/m^3]
};

struct ConservationSettings {
  std::vector<ClosedOrgan> organs;         ///< at most kMaxClosedOrgans, each a closed surface
  std::vector<std::uint8_t> strand_binds;  ///< see FindFreeRegions; empty: all bind
  /// Gravity in which the rest shape was imaged [m/s^2]. A piece that hangs free feels its whole weight, not
  /// the difference to this.
  math::Vec3 imaging_gravity;
};

/// Volume of one organ. Sealed: volume = target at any pressure. Perforated: pressure >= 0, and target +
/// leaked is what was inside before.
struct OrganVolume {
  double target = 0;    ///< of the fluid inside [m^3]
  double volume = 0;    ///< enclosed by the surface after the last Enforce [m^3]; measured anew in every tick
  double pressure = 0;  ///< above the surroundings: the constraint's multiplier [Pa]
  double compliance = 0;    ///< dV/dP of the last Enforce [m^3/Pa]; computed anew in every tick
  double opening_area = 0;  ///< of perforations [m^2]; 0: sealed
  double leaked = 0;        ///< since the start [m^3]
};

/// Displacement of the tissue by a pressure of 1 Pa in each organ, at rest, with the links and scales of now. Computed over
/// several ticks after these changed; meanwhile the old one steers the projections well enough.
struct VolumeResponses {
  std::vector<std::vector<math::Vec3>> displacement;  ///< (organs)(n) in the rest frame [m/Pa]
  double stiffness_scale = 1, shape_scale = 1;        ///< of the load for which they were computed
  bool is_settled = false;                            ///< computed to the end
  bool has_new_topology = false;                      ///< a cut was made since the last Enforce
  int ticks_waited = 0;                               ///< ticks without time that left them to a later one
};

/// Part of the conservation's state that every tick changes. A tick that went wrong is undone by copying it back.
struct ConservationTick {
  std::vector<OrganVolume> organs;
  FreeRegions regions;
  std::array<math::Pose, kMaxFreeRegions> X_world_rest;  ///< of each region: identity where it was imaged
  std::uint64_t intact_links = 0;                        ///< strands and springs, for which `regions` hold
  std::vector<math::Vec3> last_position;  ///< (n) after the last PredictRigidMotion or Enforce [m]
  std::vector<math::Vec3> last_motion;    ///< (n) how far the last tick's solve moved each node [m]
};

/// All that the conservation remembers from tick to tick, beside TissueState: saved and restored by copying.
struct ConservationState : ConservationTick {
  VolumeResponses responses;
};

/// Volumes and compliances are left out, being measured anew in every tick.
/// \pre when restoring: the state is one of the model, as Conservation::MakeState makes it
void VisitState(base::StateArchive& archive, OrganVolume& organ);
void VisitState(base::StateArchive& archive, VolumeResponses& responses);
void VisitState(base::StateArchive& archive, ConservationTick& state);
void VisitState(base::StateArchive& archive, ConservationState& state);

using SmallMatrix = std::array<std::array<double, kMaxClosedOrgans>, kMaxClosedOrgans>;

/// Constant data and scratch of the conservation of one model: what it remembers from tick to tick is in
/// ConservationState, so that one made anew for the same model goes on to the same bits.
class Conservation {
 public:
  /// \param model  must outlive this
  /// \pre at most kMaxClosedOrgans, indices in range, volumes > 0 (TROCAR_ASSERT)
  Conservation(const TissueModel& model, ConservationSettings settings);

  /// State at rest: every organ at its rest volume and without pressure, frames where anatomy was imaged, responses of the
  /// whole tissue under the usual scales.
  ///
  /// \note Not real-time safe: computes the responses, which takes as long as some hundred ticks.
  ConservationState MakeState(const TissueState& rest_state);

  /// Goes on with a model that a cut has changed: as many nodes, and strands, as before. The old responses are
  /// kept as an initial guess and computed anew over the next ticks.
  ///
  /// \param model  must outlive this
  /// \param organs  as many as before, each a closed surface
  /// \param[in,out] state  finds its free regions anew
  /// \note Not real-time safe: allocates.
  void UpdateTopology(const TissueModel& model, std::vector<ClosedOrgan> organs, ConservationState& state);

  /// Takes held free pieces along: the rigid motion that their held nodes made since the last Enforce moves
  /// the rest of the piece and its frame. A better start for the solver than a piece left behind, which would
  /// crumple.
  ///
  /// \note Real-time safe.
  void PredictRigidMotion(TissueState& tissue, ConservationState& state) noexcept;

  /// Force of pressure, frames and weight of free pieces, for one solve.
  ///
  /// \param load  scales; its external_force, if any, is added
  /// \return (n) [N], valid until the next call: give it to the solver as load.external_force
  /// \note Real-time safe.
  std::span<const math::Vec3> CalcForce(const TissueState& tissue, const TissueLoad& load,
                                        ConservationState& state) noexcept;

  /// Between iterations: one projection of the volumes, with the pressures that go with it; the force of
  /// CalcForce follows.
  /// \param before  see ConstraintSet::Project
  ///
  /// \note Real-time safe.
  void KeepVolumes(TissueState& tissue, std::span<math::Vec3> before, ConservationState& state) noexcept;

  /// Gradient of each node's organ's volume where it was last evaluated, (n) [m^2].
  std::span<const math::Vec3> VolumeGradient() const { return gradient_; }
  std::span<const ConstraintSet::NodeRange> OrganNodes() const { return organ_nodes_; }
  /// False for an organ out of which fluid runs freely.
  static bool IsSealed(const OrganVolume& organ) noexcept {
    return !(organ.opening_area > 0.0 && organ.pressure == 0.0 && organ.volume > organ.target);
  }
  /// Whether one projection could bring every volume to its target, or each is no farther off than when it was last
  /// measured. Where it says so, the next KeepVolumes() takes what it measured: of the same positions.
  /// \note Real-time safe.
  bool AreVolumesInReach(const TissueState& tissue, const ConservationState& state) noexcept;
  /// Adds to an organ's pressure, not below zero where it has a hole; the force of CalcForce follows in
  /// the next KeepVolumes(). [Pa]
  /// \note Real-time safe.
  void AddPressure(std::size_t organ, double change, ConservationState& state) const noexcept;

  /// After a solve: lets fluid leak for `dt` [s], brings each volume to its target exactly, and moves the
  /// frames of held free regions to their best fit.
  ///
  /// \param has_time  whether this tick can afford to update the responses after a change of topology or stiffness; after
  ///                  kMaxTicksWaited ticks without time they are updated all the same
  /// \note Real-time safe; a state that is not finite is left for the state guard.
  void Enforce(const TissueLoad& load, double dt, TissueState& tissue, ConservationState& state,
               bool has_time = true) noexcept;
  static constexpr int kMaxTicksWaited = 30;  ///< ticks

  /// Makes a hole, or a larger one, in an organ.
  ///
  /// \param area  [m^2], >= 0, added
  void Perforate(std::size_t organ, double area, ConservationState& state) const;

  const ConservationSettings& Settings() const { return settings_; }

 private:
  void SetOrgans(std::vector<ClosedOrgan> organs);
  void SetRestStiffness(const TissueState& tissue, const TissueLoad& load) noexcept;
  bool UpdateResponses(const TissueState& tissue, const TissueLoad& load, int max_iterations,
                       double tolerance, VolumeResponses& responses) noexcept;
  void UpdateRegions(const TissueState& tissue, ConservationState& state) noexcept;
  void AddFrameForce(const TissueState& tissue, const TissueLoad& load,
                     const ConservationState& state) noexcept;
  double MeasureVolume(std::size_t organ, const TissueState& tissue) const noexcept;
  double MeasureGradient(std::size_t organ, const TissueState& tissue,
                         std::span<math::Vec3> gradient) const noexcept;
  bool TakeMeasuredAhead(ConservationState& state) noexcept;
  bool MeasureVolumes(const TissueState& tissue, ConservationState& state) noexcept;
  bool CalcCompliance(const TissueState& tissue, ConservationState& state) noexcept;
  /// Whether every volume was at its target, or the state moved, or moved and came back but for rounding.
  enum class Projection { kNone, kDone, kTakenBack };
  Projection ProjectOnce(TissueState& tissue, std::span<math::Vec3> before,
                         ConservationState& state) noexcept;
  void SetPressureForce(const ConservationState& state) noexcept;
  void Leak(double dt, ConservationState& state) const noexcept;
  void FitFrames(const TissueLoad& load, const TissueState& tissue, ConservationState& state) const noexcept;
  bool IsHeld(std::uint32_t region, const TissueState& tissue, const ConservationState& state) const noexcept;
  std::span<math::Vec3> OrganPart(std::size_t organ, std::span<math::Vec3> nodes) const noexcept;

  const TissueModel* model_;
  ConservationSettings settings_;
  LinearResponse linear_;
  TissueState rest_;  // with the strands and spring factors of linear_
  double linear_stiffness_scale_ = 1, linear_shape_scale_ = 1;  // of linear_
  bool has_stiffness_ = false;  // linear_ has the stiffness of rest_ under these scales
  std::vector<std::vector<math::Vec3>>
      shifts_;  // (organs)(n) the responses where nodes are now; zero where they are held
  std::vector<math::Vec3> gradient_;        // (n) of each node's organ; zero elsewhere
  std::vector<math::Vec3> ahead_gradient_;  // (n) the same as AreVolumesInReach() found it, and the volumes
  std::array<double, kMaxClosedOrgans> ahead_volume_{};
  bool has_ahead_ = false;              // for the next KeepVolumes()
  std::vector<math::Vec3> base_force_;  // (n) without pressure
  std::vector<math::Vec3> force_;       // (n)
  std::vector<ConstraintSet::NodeRange> organ_nodes_;
  SmallMatrix compliance_{};  // dV_i by one pascal in organ j, of this tick [m^3/Pa]
  bool has_compliance_ = false;
  FreeRegions next_regions_;
};

/// Iterations from one projection to the next. Solves at constant pressure let a sac under 10 kPa swing by a
/// tenth of its volume from tick to tick: the softer it gets, the less may happen between two projections.
inline constexpr int kProjectionInterval = 5;

/// One tick's equilibrium with shape and volume kept: predict rigid motions, solve with projections, enforce.
///
/// \param[in,out] load  external_force is added to, and left as the solver saw it, so that CalcReaction
/// agrees
/// \param dt  length of the tick, for what leaks [s]
///
/// \note Real-time safe.
SolveReport SolveConserving(EquilibriumSolver& solver, const SolverSettings& settings, double dt,
                            Conservation& conservation, TissueLoad& load, TissueState& tissue,
                            ConservationState& state) noexcept;

/// Fills an organ until it stands under `pressure` in equilibrium, and seals that volume: a tense hollow
/// organ.
///
/// \param pressure  [Pa], within +-20 kPa
/// \return relative difference between the last two volumes; small when the filling came to rest
/// \note Not real-time safe: seconds for a high pressure.
double FillToPressure(EquilibriumSolver& solver, std::size_t organ, double pressure, const TissueLoad& load,
                      Conservation& conservation, TissueState& tissue, ConservationState& state);

}  // namespace trocar::tissue
