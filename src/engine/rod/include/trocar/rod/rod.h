// SPDX-License-Identifier: Apache-2.0
/// \file rod.h  Thin elastic rods that bend and twist and keep their length: suture, loop, cable. Their equilibrium, tick by tick.
///
/// A discrete elastic rod (Bergou, Wardetzky, Robinson, Audoly, Grinspun, "Discrete elastic rods", ACM Trans. Graph. 27, 2008;
/// Bergou, Audoly, Vouga, Wardetzky, Grinspun, "Discrete viscous threads", ACM Trans. Graph. 29, 2010): a chain of nodes, and an
/// angle of twist on each segment. The cross section is round and the rod is straight at rest. docs/rods.md explains the method
/// and says how it is judged.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/state_archive.h"
#include "trocar/math/vector.h"
#include "trocar/rod/rod_contact.h"

namespace trocar::rod {

/// What a rod is made of.
struct RodMaterial {
  double radius = 0;           ///< [m], > 0
  double bending = 0;          ///< E I [N m^2], >= 0; 0 for a chain
  double twisting = 0;         ///< G J [N m^2], >= 0
  double stretching = 0;       ///< E A [N], > 0: a tension T makes a segment longer by T / E A of its length
  double mass_per_length = 0;  ///< [kg/m], >= 0
};

/// A round solid rod.
///
/// \param diameter       [m], > 0
/// \param young_modulus  [Pa], > 0
/// \param poisson_ratio  [-], above -1 and at most 0.5
/// \param density        [kg/m^3], >= 0
RodMaterial MakeRoundMaterial(double diameter, double young_modulus, double poisson_ratio, double density);

/// A rod as it is given: checked by MakeRodModel.
struct RodDefinition {
  std::vector<math::Vec3>
      nodes;  ///< (n), n >= 3: where the nodes are at first [m]; their distances are the lengths that are kept
  RodMaterial material;
};

/// Constant while a simulation runs.
struct RodModel {
  std::vector<double> length;  ///< (n - 1) of each segment [m]
  std::vector<double> reach;   ///< (n) half of the segments beside each node [m]
  RodMaterial material;

  std::size_t NodeCount() const noexcept { return reach.size(); }
  std::size_t SegmentCount() const noexcept { return length.size(); }
};

/// \return kSceneInvalid with what is wrong and how to mend it: fewer than three nodes, no length, a number that is not finite or
///         out of range
base::Result<RodModel> MakeRodModel(const RodDefinition& definition);

/// The state of a rod: saved and restored with everything else.
struct RodState {
  std::vector<math::Vec3> position;  ///< (n) [m]
  /// (n - 1) Twist of each segment's material frame against its reference frame [rad].
  std::vector<double> angle;
  /// (n - 1) Of each segment when the rod was last solved: unit vectors.
  std::vector<math::Vec3> direction;
  /// (n - 1) Unit vector of the reference frame, square to `direction`.
  std::vector<math::Vec3> reference;
  /// (n) Of the reference frame from segment i - 1 to i; 0 at the ends [rad].
  std::vector<double> reference_twist;
  /// (n - 1) When the rod was last solved; below 0 where a segment is pressed [N].
  std::vector<double> tension;
  std::vector<std::uint8_t> is_held;        ///< (n) 1 where the position is prescribed
  std::vector<std::uint8_t> is_angle_held;  ///< (n - 1) 1 where the angle is prescribed
};

/// Free, without twist or tension, at the definition's nodes. The reference frame is carried along the rod without twist.
RodState MakeRodState(const RodModel& model, std::span<const math::Vec3> nodes);
void VisitState(base::StateArchive& archive, RodState& state);

/// What acts in one solve.
struct RodLoad {
  math::Vec3 gravity{};                 ///< [m/s^2]
  std::span<const math::Vec3> force{};  ///< (n) on the nodes besides weight [N]; may be empty
  /// Force that holds each node back, by how far it has gone from where the solve began [N/m], >= 0: what a viscous surrounding
  /// does in a tick. With 0 the solve looks for the equilibrium itself.
  double drag = 0;
  /// What the rod may press on. Solve leaves in each what presses and where it sticks.
  std::span<RodContact> contacts{};
  std::span<RodCrossing> crossings{};
  RodContactSettings contact{};
};

struct RodSettings {
  int max_steps = 8;        ///< of Newton's method, > 0
  double tolerance = 1e-6;  ///< a solve ends where no force is farther from balance, over the largest one [-]
  double max_move = 0.5;    ///< of a node in one step, over the mean segment length [-], > 0
  /// Of a free node in one solve [m], > 0: no farther than contacts and crossings look. What is left is for the next solve.
  double max_way = INFINITY;
};

struct RodReport {
  int steps = 0;
  /// Largest force, or moment over a segment's length, that is not balanced, over `force_scale` [-].
  double residual = 0;
  double force_scale = 0;   ///< largest force of one segment, bend, load or contact alone [N]
  double length_error = 0;  ///< largest, over the segment's length [-]
  double energy = 0;        ///< of bending and twist [J]
  /// The stiffness at the end is positive definite: a minimum of the energy, not a saddle.
  bool is_stable = true;
  bool converged = false;
  bool is_finite = true;  ///< false: the state is as it was
};

class RodStiffness;

/// Finds the equilibrium of one rod. Holds the memory that solves need.
class RodSolver {
 public:
  /// \param model  must outlive this
  explicit RodSolver(const RodModel& model);
  ~RodSolver();
  RodSolver(RodSolver&&) noexcept;
  RodSolver& operator=(RodSolver&&) noexcept;

  /// Newton's method, its steps shortened until the energy falls; the linear systems are banded and solved directly. Each step is
  /// bent back to the elongations that the linear system foresaw, because a stiff length allows none of second order. Bounded by
  /// settings.max_steps, so the bits do not depend on the clock.
  ///
  /// \pre the state fits the model
  /// \note Real-time safe.
  RodReport Solve(const RodSettings& settings, const RodLoad& load, RodState& state) noexcept;

  /// Force that whatever holds a node must apply there [N], as the last Solve left the rod; 0 for a free node.
  math::Vec3 Reaction(std::size_t node) const noexcept;
  /// Moment along a segment that whatever holds its angle must apply [N m]; 0 where it is free.
  double TwistReaction(std::size_t segment) const noexcept;

 private:
  /// Where a rod is, or would be after a step.
  struct Shape {
    std::vector<math::Vec3> position, direction, reference;
    std::vector<double> angle, reference_twist;
  };
  /// What is summed over the rod besides forces.
  struct Sums {
    double elastic = 0;       // energy of bending and twist [J]
    double potential = 0;     // of all that Newton's method lowers [J]
    double force_scale = 0;   // [N]
    double length_error = 0;  // [-]
  };

  void Take(const RodState& state) noexcept;
  void FollowFrames(const Shape& from, Shape& to) const noexcept;
  Sums Assemble(const RodLoad& load, const Shape& at, bool has_stiffness) noexcept;
  void AddSegment(const Shape& at, std::size_t segment, bool has_stiffness, Sums& sums) noexcept;
  void AddBend(const Shape& at, std::size_t node, bool has_stiffness, Sums& sums) noexcept;
  void AddContact(const RodContactSettings& settings, const RodContact& contact, const Shape& at,
                  bool has_stiffness, Sums& sums) noexcept;
  void AddLoad(const RodLoad& load, const Shape& at, std::size_t node, bool has_stiffness,
               Sums& sums) noexcept;
  void AddPointForce(std::size_t segment, double at, const math::Vec3& force) noexcept;
  void AddPointStiffness(const RodContact& contact, double along, double across,
                         const math::Vec3& slips) noexcept;
  void UpdateContacts(const RodLoad& load) const noexcept;
  void LetSlip(const RodLoad& load) const noexcept;
  void AddCrossing(const RodContactSettings& settings, const RodCrossing& crossing, const Shape& at,
                   bool has_stiffness, Sums& sums) noexcept;
  bool CalcStep(const RodSettings& settings, const RodLoad& load) noexcept;
  bool SearchLine(const RodLoad& load, const Sums& before) noexcept;
  void RestoreLengths() noexcept;
  double LimitByContacts(const RodLoad& load) const noexcept;
  bool Judge(const RodSettings& settings, const Sums& sums, RodReport& report) const noexcept;

  const RodModel* model_;
  std::unique_ptr<RodStiffness> stiffness_;
  double mean_length_ = 0, shortest_ = 0;  // of a segment [m]
  Shape here_, trial_;
  std::vector<math::Vec3> start_;        // (n) where the solve began
  std::vector<double> gradient_, step_;  // (4 n): position of a node, angle of the segment behind it
  std::vector<std::uint8_t> is_fixed_;   // (4 n)
  std::vector<double> tension_;          // (n - 1) [N]
  // (n - 1) where the step begins, of the whole step in linear terms, and what RestoreLengths brings about [m]
  std::vector<double> elongation_, foreseen_, wanted_;
  std::vector<double> diagonal_, beside_, pull_;  // (n - 1) of RestoreLengths
};

/// How often a closed curve winds round another one: its sign tells the sense (Gauss's integral over polygons).
///
/// \param a, b  (>= 3) corners [m]; the last is joined to the first; the curves do not touch
/// \return a whole number but for rounding
/// Source: Klenin and Langowski, Biopolymers 54, 2000, eq. 16 (a segment's share of the Gauss integral).
double CalcLinkingNumber(std::span<const math::Vec3> a, std::span<const math::Vec3> b) noexcept;

/// How much a closed curve winds round itself [-].
///
/// \param curve  (>= 4) corners [m]; the last is joined to the first
/// Source: as CalcLinkingNumber.
double CalcWrithe(std::span<const math::Vec3> curve) noexcept;

}  // namespace trocar::rod
