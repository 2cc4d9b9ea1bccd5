// SPDX-License-Identifier: Apache-2.0
/// \file hand_motion.h  How a hand moves a tool's tip: smooth straight reaches, limited speed, tremor.
/// Source: Flash and Hogan, "The coordination of arm movements", J. Neurosci. 1985 (minimum jerk).
#pragma once

#include <array>
#include <cstdint>

#include "trocar/base/state_archive.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::agent {

/// How able a hand is.
struct HandSkill {
  double speed = 0.12;     ///< greatest of a reach [m/s], > 0
  double shortest = 0.25;  ///< of a reach [s], > 0
  double tremor = 0.0001;  ///< amplitude, 8 to 12 Hz [m]
  double aim_error = 0;    ///< of a reach's end, the most along each axis [m]
  double jaw_rate = 2.5;   ///< [rad/s]
  double spin_rate = 3.0;  ///< [rad/s]
  /// Share of a reach by which it first goes past its end, 6 mm at most [-], >= 0.
  double overshoot = 0;
  /// Share of a reach by which its path bulges, to a side that is chosen anew each time; short ones do not [-], >= 0.
  double wander = 0;
};

/// One tool in its trocar. Verbs begin something; Step goes on with it.
class HandMotion {
 public:
  HandMotion(const math::Vec3& p_world_port, const instrument::TrocarJoints& start, const HandSkill& skill,
             std::uint64_t seed);

  /// Straight reach, from where the tip is now. \param hurry  times the skill's speed
  void MoveTo(const math::Vec3& p_world_tip, double hurry = 1);
  /// Turns about the shaft; the nearest of the angles a whole turn apart.
  void Turn(double spin);
  void SetJaw(double jaw);

  bool IsMoving() const;
  bool IsTurning() const;
  math::Vec3 Tip() const { return tip_; }  ///< where the hand means to be, without tremor
  math::Vec3 BehindTip(double way) const;  ///< on the shaft, `way` towards the port [m]
  double Spin() const { return spin_; }
  double Jaw() const { return jaw_; }
  const math::Vec3& Port() const { return p_world_port_; }

  void VisitState(base::StateArchive& archive);
  /// \param dt  [s], > 0 \return joints after it
  instrument::TrocarJoints Step(double dt);

 private:
  static constexpr int kSines = 3;
  struct Sine {
    double frequency, phase;
  };
  math::Vec3 CalcTremor() const;
  void BeginReach(const math::Vec3& to, double speed);

  math::Vec3 p_world_port_;
  HandSkill skill_;
  std::uint64_t random_;
  std::array<std::array<Sine, kSines>, 3> tremor_;
  double time_ = 0;
  math::Vec3 from_, to_, tip_;
  math::Vec3 aim_;        // where the reach ends that first went past it
  math::Vec3 bulge_;      // of the path, in its middle [m]
  double speed_ = 0;      // of the reach [m/s]
  bool is_past_ = false;  // on the way past the aim
  double reach_time_ = 0, reach_duration_ = 0;
  double spin_, spin_goal_, jaw_, jaw_goal_;
};

/// Spin with which the jaws of a tool at `p_world_tip` open as nearly as can be along `across`.
double FindSpin(const math::Vec3& p_world_port, const math::Vec3& p_world_tip,
                const math::Vec3& across) noexcept;

/// Change of spin that turns what a tool at `p_world_tip` holds about an axis: as much of the turn as lies along the shaft.
/// \param axis   unit
/// \param angle  [rad]
/// \return [rad]
double FindRoll(const math::Vec3& p_world_port, const math::Vec3& p_world_tip, const math::Vec3& axis,
                double angle) noexcept;

}  // namespace trocar::agent
