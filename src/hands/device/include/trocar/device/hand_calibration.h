// SPDX-License-Identifier: Apache-2.0
/// \file hand_calibration.h  Where the tip, the shaft and the trocar are, seen from a tracker's sensor, and how they are
/// found.
/// Source: pivot calibration and least-squares meeting point of lines; kinematics as in
/// instrument/trocar_kinematics.h.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "trocar/base/result.h"
#include "trocar/device/hand_sample.h"
#include "trocar/math/pose.h"

namespace trocar::device {

/// Farther than this from its sensor no instrument has its tip [m]: the longest are 450 mm, and a handle.
inline constexpr double kMostTipDistance = 0.6;
/// Reach of any tracker here, and so of a trocar from its source [m].
inline constexpr double kMostTrocarDistance = 5.0;

/// One instrument with a sensor on it. The defaults fit no instrument in particular; they let an uncalibrated one move.
struct HandCalibration {
  math::Vec3 p_sensor_tip{0.25, 0, 0};  ///< tip in the sensor's frame [m]
  math::Vec3 axis_sensor{1, 0, 0};      ///< unit vector along the shaft towards the tip, sensor frame
  math::Vec3 up_sensor{0, 0,
                       -1};  ///< unit vector along which the jaws open at spin 0; perpendicular to the axis
  math::Vec3 p_source_trocar{0.3, 0, 0};  ///< trocar point in the frame of the tracker's source [m]
  bool is_measured = false;               ///< by a fit, not the defaults

  friend bool operator==(const HandCalibration&, const HandCalibration&) = default;
};

/// Joints of a tracked instrument. Jaw, time and validity are left alone.
///
/// \param R_world_source  turns the source's frame into the world's
/// \note Real-time safe.
void SetJoints(const HandCalibration& calibration, const math::Quaternion& R_world_source,
               const math::Pose& X_source_sensor, HandSample& sample) noexcept;

/// Pose of the sensor that gives these joints: the other way round, for emulators and tests.
math::Pose CalcSensorPose(const HandCalibration& calibration, const math::Quaternion& R_world_source,
                          const HandSample& joints) noexcept;

/// Rotation from two directions that the person can see on the source.
///
/// \param right  unit vector to the person's right in the source's frame: world x
/// \param up     upwards, away from the patient's back, in the source's frame: world z
/// \return R_world_source; the error kDeviceSettings where the two are not at right angles within 10 degrees
base::Result<math::Quaternion> FindSourceRotation(const math::Vec3& right, const math::Vec3& up);

// --- fits

/// How well a fit holds.
struct FitQuality {
  double residual = 0;  ///< RMS distance [m]
  double worst = 0;     ///< largest distance [m]
  double spread = 0;    ///< largest angle between two shafts, or between two orientations [rad]
  /// Smallest singular value of a pose's linearised equations, RMS over the poses [-]: how far the motion moves what is
  /// sought in the direction that it shows worst; 0 where the motion leaves a direction open.
  double motion = 0;
  /// Two standard errors of the point in its worst direction [m], poses in succession not taken for independent.
  double uncertainty = 0;
};
/// "known to 0.4 mm (5 allowed); residual 0.21 mm RMS ..."
std::string FormatQuality(const FitQuality& quality, std::size_t poses);

/// Above this RMS distance a calibration is refused [m], and below this spread, 30 degrees [rad].
/// Source: domain facts, section 6.5.
inline constexpr double kMaxFitResidual = 0.003;
inline constexpr double kMinFitSpread = 0.5235987755982988;
inline constexpr std::size_t kMinFitPoses = 12;
/// Below this motion a calibration is refused [-]: 3 degrees RMS across the main swing.
inline constexpr double kMinFitMotion = 0.05;
/// Above this uncertainty, too [m].
inline constexpr double kMaxFitUncertainty = 0.005;

struct PivotFit {
  math::Vec3 p_sensor_pivot;  ///< the point that stood still, sensor frame [m]
  math::Vec3 p_source_pivot;  ///< the same in the source's frame [m]
  FitQuality quality;
};

/// The point of the instrument that stood still while the rest turned about it: R_i t - c = -x_i in least squares.
///
/// \param poses  (n) X_source_sensor, n >= kMinFitPoses, about one fixed point
/// \return kCalibrationPoor with the remedy: too few, too little turning, turned about one axis only, the point did not
///         stand still or came out too far away
base::Result<PivotFit> FitPivot(std::span<const math::Pose> poses);

struct TrocarFit {
  math::Vec3 p_source_trocar;  ///< where all shafts pass, source frame [m]
  math::Vec3 axis_sensor;      ///< direction of the shaft towards the tip, sensor frame
  FitQuality quality;          ///< distances of the trocar point from the shafts
};

/// The point where the shaft passes the wall, and the shaft's direction, from moving the instrument in its trocar:
/// sum (I - a a^T) p = sum (I - a a^T) x, with a found along the way.
///
/// \param p_sensor_tip  from FitPivot [m]
/// \return kCalibrationPoor as above; also where it was not moved in and out nor turned about its shaft
base::Result<TrocarFit> FitTrocar(std::span<const math::Pose> poses, const math::Vec3& p_sensor_tip);

}  // namespace trocar::device
