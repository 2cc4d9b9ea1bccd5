// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "trocar/device/hand_calibration.h"
#include "trocar/host/console.h"
#include "trocar/host/translate.h"

namespace trocar::device {

using math::Pose;
using math::Quaternion;
using math::Vec3;

namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

/// The shaft's direction settles in a few rounds; far more are never needed.
constexpr int kMaxRounds = 200;
constexpr double kSettled = 1e-12;  // change of a unit vector [-]
constexpr double kDegrees = 57.29577951308232;
/// Poses that count for the uncertainty: those in succession share the error of a tip that creeps in its hole and of a
/// field bent by metal, so that a thousand poses of one swing say hardly more than one a second.
constexpr double kIndependentPoses = static_cast<double>(kMinFitPoses);
/// At which a wrong direction of the shaft counts like a wrong place of the trocar [m]: a usual insertion depth.
constexpr double kShaftLever = 0.1;

Vector3 ToEigen(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Vec3 FromEigen(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
Matrix3 ToMatrix(const Quaternion& q) {
  Matrix3 rotation;
  rotation << ToEigen(math::Rotate(q, {1, 0, 0})), ToEigen(math::Rotate(q, {0, 1, 0})),
      ToEigen(math::Rotate(q, {0, 0, 1}));
  return rotation;
}

base::Error Poor(const std::string& text) {
  return {base::ErrorCode::kCalibrationPoor, text};
}

base::Status CheckPoses(std::span<const Pose> poses) {
  if (poses.size() < kMinFitPoses) {
    return Poor("only " + std::to_string(poses.size()) + " poses were seen, " + std::to_string(kMinFitPoses) +
                " are needed; keep the sensor within reach of the source and repeat");
  }
  for (const Pose& pose : poses) {
    const Quaternion& q = pose.rotation;
    if (!math::IsFinite(pose.translation) || !std::isfinite(q.w + q.x + q.y + q.z))
      return Poor("a pose is not finite; repeat");
  }
  return {};
}

/// Largest angle between two of the directions [rad].
double FindSpread(const std::vector<Vec3>& directions) {
  double least = 1.0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t j = i + 1; j < directions.size(); ++j)
      least = std::min(least, math::Dot(directions[i], directions[j]));
  }
  return std::acos(std::clamp(least, -1.0, 1.0));
}

/// Largest angle between two orientations [rad].
double FindTurn(std::span<const Pose> poses) {
  double least = 1.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = i + 1; j < poses.size(); ++j) {
      const Quaternion &a = poses[i].rotation, &b = poses[j].rotation;
      least = std::min(least, std::fabs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z));
    }
  }
  return 2.0 * std::acos(std::clamp(least, -1.0, 1.0));
}

FitQuality MakeQuality(const std::vector<double>& distances, double spread) {
  FitQuality quality;
  quality.spread = spread;
  for (const double distance : distances) {
    quality.residual += distance * distance;
    quality.worst = std::max(quality.worst, distance);
  }
  quality.residual = std::sqrt(quality.residual / static_cast<double>(distances.size()));
  return quality;
}

/// Motion first: a motion that leaves a direction open makes any residual small.
///
/// \param still    what should have stood still: "the tip"
/// \param missing  which motion was missing where quality.motion is too small, and its remedy
base::Status CheckQuality(const FitQuality& quality, const char* still, const char* missing) {
  char text[300];
  if (!(quality.spread >= kMinFitSpread)) {
    std::snprintf(text, sizeof text,
                  "it was turned by %.0f degrees only, 30 are needed; swing it further and repeat",
                  quality.spread * kDegrees);
    return Poor(text);
  }
  if (!(quality.motion >= kMinFitMotion)) return Poor(missing);
  if (!(quality.residual <= kMaxFitResidual)) {
    std::snprintf(text, sizeof text,
                  "%s did not stand still: %.1f mm RMS, 3 are allowed; fix it, keep metal away from the "
                  "source, and repeat",
                  still, 1e3 * quality.residual);
    return Poor(text);
  }
  if (!(quality.uncertainty <= kMaxFitUncertainty)) {
    std::snprintf(text, sizeof text, "%s is known to %.1f mm only, 5 are allowed; %s", still,
                  1e3 * quality.uncertainty, missing);
    return Poor(text);
  }
  return {};
}

/// Refuses a point farther away than anything of the kind can be.
base::Status CheckDistance(const char* what, double distance, double most) {
  if (distance <= most) return {};
  char text[200];
  std::snprintf(text, sizeof text,
                "%s came out %.0f mm away, %.0f at most can be; check that the sensor sits firmly on this "
                "instrument, and repeat",
                what, 1e3 * distance, 1e3 * most);
  return Poor(text);
}

/// Two standard errors of a point along its worst direction [m].
///
/// \param square     mean square of one component of the residual [m^2]
/// \param weakest    smallest eigenvalue of the normal matrix of one pose, for the point [-], > 0
double CalcUncertainty(double square, double weakest) {
  return 2.0 * std::sqrt(square / (kIndependentPoses * weakest));
}

/// Point nearest to all lines through tips[i] along shafts[i].
Vec3 MeetingPoint(const std::vector<Vec3>& tips, const std::vector<Vec3>& shafts) {
  Matrix3 sum = Matrix3::Zero();
  Vector3 right = Vector3::Zero();
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const Vector3 a = ToEigen(shafts[i]);
    const Matrix3 across = Matrix3::Identity() - a * a.transpose();
    sum += across;
    right += across * ToEigen(tips[i]);
  }
  return FromEigen(sum.completeOrthogonalDecomposition().solve(right));
}

/// Fills in motion and uncertainty of a fit from its linearised normal matrix, for the trocar and two angles of the shaft.
///
/// \param tips  (poses) in the source's frame [m]
/// \return which motion was weakest, and its remedy
const char* JudgeTrocarMotion(std::span<const Pose> poses, const std::vector<Vec3>& tips, TrocarFit& fit) {
  using Normal = Eigen::Matrix<double, 5, 5>;
  const Vector3 axis = ToEigen(fit.axis_sensor);
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = axis.unitOrthogonal();
  across.col(1) = axis.cross(across.col(0));
  Normal normal = Normal::Zero();
  Vector3 mean_shaft = Vector3::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Matrix3 rotation = ToMatrix(poses[i].rotation);
    const Vector3 shaft = rotation * axis;
    const double depth = shaft.dot(ToEigen(tips[i] - fit.p_source_trocar));
    Eigen::Matrix<double, 3, 5> row;
    row.leftCols<3>() = Matrix3::Identity() - shaft * shaft.transpose();
    row.rightCols<2>() = depth / kShaftLever * rotation * across;
    normal += row.transpose() * row;
    mean_shaft += shaft;
  }
  const double count = static_cast<double>(poses.size());
  const Eigen::SelfAdjointEigenSolver<Normal> solver(normal / count);
  const double weakest = solver.eigenvalues()[0];
  fit.quality.motion = std::sqrt(std::max(0.0, weakest));
  // of the trocar alone, whichever way the shaft is turned
  double loosest = 0;
  if (weakest > 0.0) {
    const Matrix3 covariance = (normal / count).inverse().topLeftCorner<3, 3>();
    loosest = Eigen::SelfAdjointEigenSolver<Matrix3>(covariance).eigenvalues()[2];
  }
  const double square = fit.quality.residual * fit.quality.residual * count / (2.0 * count - 5.0);
  fit.quality.uncertainty = CalcUncertainty(square, loosest > 0.0 ? 1.0 / loosest : 0.0);
  const double along = std::fabs(solver.eigenvectors().col(0).head<3>().dot(mean_shaft.normalized()));
  return along > 0.7
             ? "its shafts are nearly parallel, and along them the trocar cannot be found; swing it wider, "
               "in "
               "all directions, and repeat"
             : "it was hardly moved in and out, and so the trocar's place and the shaft's direction cannot "
               "be "
               "told apart; move it in and out by more than 50 mm, turn it about its shaft, and repeat";
}

}  // namespace

std::string FormatQuality(const FitQuality& quality, std::size_t poses) {
  return host::TranslateWith(
      "known to {1} mm (5 allowed); residual {2} mm RMS (3 allowed), worst {3} mm, turned by {4} degrees "
      "(30 needed), {5} poses",
      {host::ShownFixed(1e3 * quality.uncertainty, 1), host::ShownFixed(1e3 * quality.residual, 2),
       host::ShownFixed(1e3 * quality.worst, 2), host::ShownFixed(kDegrees * quality.spread, 0),
       std::to_string(poses)});
}

base::Result<PivotFit> FitPivot(std::span<const Pose> poses) {
  if (const base::Status good = CheckPoses(poses); !good) return good.error();
  const auto count = static_cast<Eigen::Index>(poses.size());
  Eigen::MatrixXd rows(3 * count, 6);
  Eigen::VectorXd right(3 * count);
  Matrix3 mean = Matrix3::Zero();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Pose& pose = poses[static_cast<std::size_t>(i)];
    const Matrix3 rotation = ToMatrix(pose.rotation);
    mean += rotation;
    rows.block<3, 3>(3 * i, 0) = rotation;
    rows.block<3, 3>(3 * i, 3) = -Matrix3::Identity();
    right.segment<3>(3 * i) = -ToEigen(pose.translation);
  }
  mean /= static_cast<double>(count);
  const Eigen::VectorXd solved = rows.completeOrthogonalDecomposition().solve(right);
  PivotFit fit;
  fit.p_sensor_pivot = FromEigen(solved.head<3>());
  fit.p_source_pivot = FromEigen(solved.tail<3>());
  std::vector<double> distances;
  for (const Pose& pose : poses)
    distances.push_back(math::Distance(pose * fit.p_sensor_pivot, fit.p_source_pivot));
  fit.quality = MakeQuality(distances, FindTurn(poses));

  // with the fixed point eliminated: how far each direction of the sensor was turned about the mean
  Matrix3 normal = Matrix3::Zero();
  for (const Pose& pose : poses) {
    const Matrix3 turned = ToMatrix(pose.rotation) - mean;
    normal += turned.transpose() * turned;
  }
  const double weakest =
      Eigen::SelfAdjointEigenSolver<Matrix3>(normal / static_cast<double>(count)).eigenvalues()[0];
  fit.quality.motion = std::sqrt(std::max(0.0, weakest));
  const double square = fit.quality.residual * fit.quality.residual * static_cast<double>(count) /
                        static_cast<double>(3 * count - 6);
  fit.quality.uncertainty = CalcUncertainty(square, weakest);
  if (const base::Status good = CheckQuality(
          fit.quality, "the tip",
          "it was turned about one axis only, and along that axis the tip cannot be found; swing the "
          "handle forwards and backwards as well as sideways, and repeat");
      !good)
    return good.error();
  if (const base::Status good =
          CheckDistance("the tip, seen from its sensor,", math::Norm(fit.p_sensor_pivot), kMostTipDistance);
      !good)
    return good.error();
  if (const base::Status good = CheckDistance("the hole, seen from the tracker's source,",
                                              math::Norm(fit.p_source_pivot), kMostTrocarDistance);
      !good)
    return good.error();
  return fit;
}

base::Result<TrocarFit> FitTrocar(std::span<const Pose> poses, const Vec3& p_sensor_tip) {
  if (const base::Status good = CheckPoses(poses); !good) return good.error();
  std::vector<Vec3> tips, shafts(poses.size());
  for (const Pose& pose : poses) tips.push_back(pose * p_sensor_tip);

  // start: as if the sensor sat on the shaft; each round then brings point and direction nearer together
  TrocarFit fit;
  fit.axis_sensor = math::Normalized(p_sensor_tip, {1, 0, 0});
  for (int round = 0; round < kMaxRounds; ++round) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      shafts[i] = math::Rotate(poses[i].rotation, fit.axis_sensor);
    fit.p_source_trocar = MeetingPoint(tips, shafts);
    // the direction that the ways from the trocar to the tip share, seen from the sensor
    Matrix3 sum = Matrix3::Zero();
    Vec3 mean;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Vec3 way = math::Rotate(math::Inverse(poses[i].rotation), tips[i] - fit.p_source_trocar);
      sum += ToEigen(way) * ToEigen(way).transpose();
      mean += way;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3> solver(sum);
    Vec3 axis = FromEigen(solver.eigenvectors().col(2));
    if (math::Dot(axis, mean) < 0.0) axis = -axis;
    const double change = math::Distance(axis, fit.axis_sensor);
    fit.axis_sensor = axis;
    if (change < kSettled) break;
  }
  std::vector<double> distances;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    shafts[i] = math::Rotate(poses[i].rotation, fit.axis_sensor);
    distances.push_back(math::Norm(math::Cross(fit.p_source_trocar - tips[i], shafts[i])));
  }
  fit.quality = MakeQuality(distances, FindSpread(shafts));
  const char* const missing = JudgeTrocarMotion(poses, tips, fit);
  if (const base::Status good = CheckQuality(fit.quality, "the trocar", missing); !good) return good.error();
  if (const base::Status good = CheckDistance("the trocar, seen from the tracker's source,",
                                              math::Norm(fit.p_source_trocar), kMostTrocarDistance);
      !good)
    return good.error();
  for (const Vec3& tip : tips) {
    const double depth = math::Distance(tip, fit.p_source_trocar);
    if (const base::Status good = CheckDistance("the trocar, seen from the tip,", depth, kMostTipDistance);
        !good)
      return good.error();
  }
  return fit;
}

}  // namespace trocar::device
