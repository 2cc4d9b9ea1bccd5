// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "trocar/device/hand_calibration.h"

namespace trocar::device {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

/// The shaft's direction settles in a few rounds; far more are never needed.
constexpr int kMaxRounds = 200;
constexpr double kSettled = 1e-12;  // change of a unit vector [-]

Vector3 ToEigen(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Vec3 FromEigen(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

core::Error Poor(const std::string& text) {
  return {core::ErrorCode::kCalibrationPoor, text};
}

core::Status CheckPoses(std::span<const Pose> poses) {
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

core::Status CheckQuality(const FitQuality& quality, const char* still) {
  char text[200];
  if (!(quality.spread >= kMinFitSpread)) {
    std::snprintf(text, sizeof text,
                  "it was turned by %.0f degrees only, 30 are needed; swing it further and repeat",
                  quality.spread * 57.29577951308232);
    return Poor(text);
  }
  if (!(quality.residual <= kMaxFitResidual)) {
    std::snprintf(text, sizeof text,
                  "%s did not stand still: %.1f mm RMS, 3 are allowed; fix it, keep metal away from the "
                  "source, and repeat",
                  still, 1e3 * quality.residual);
    return Poor(text);
  }
  return {};
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

}  // namespace

core::Result<PivotFit> FitPivot(std::span<const Pose> poses) {
  if (const core::Status good = CheckPoses(poses); !good) return good.error();
  const auto count = static_cast<Eigen::Index>(poses.size());
  Eigen::MatrixXd rows(3 * count, 6);
  Eigen::VectorXd right(3 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Pose& pose = poses[static_cast<std::size_t>(i)];
    Matrix3 rotation;
    rotation << ToEigen(math::Rotate(pose.rotation, {1, 0, 0})),
        ToEigen(math::Rotate(pose.rotation, {0, 1, 0})), ToEigen(math::Rotate(pose.rotation, {0, 0, 1}));
    rows.block<3, 3>(3 * i, 0) = rotation;
    rows.block<3, 3>(3 * i, 3) = -Matrix3::Identity();
    right.segment<3>(3 * i) = -ToEigen(pose.translation);
  }
  const Eigen::VectorXd solved = rows.completeOrthogonalDecomposition().solve(right);
  PivotFit fit;
  fit.p_sensor_pivot = FromEigen(solved.head<3>());
  fit.p_source_pivot = FromEigen(solved.tail<3>());
  std::vector<double> distances;
  for (const Pose& pose : poses)
    distances.push_back(math::Distance(pose * fit.p_sensor_pivot, fit.p_source_pivot));
  fit.quality = MakeQuality(distances, FindTurn(poses));
  if (const core::Status good = CheckQuality(fit.quality, "the tip"); !good) return good.error();
  return fit;
}

core::Result<TrocarFit> FitTrocar(std::span<const Pose> poses, const Vec3& p_sensor_tip) {
  if (const core::Status good = CheckPoses(poses); !good) return good.error();
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
  if (const core::Status good = CheckQuality(fit.quality, "the trocar"); !good) return good.error();
  return fit;
}

}  // namespace trocar::device
