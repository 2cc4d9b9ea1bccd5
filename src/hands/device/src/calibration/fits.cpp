// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "trocar/device/hand_calibration.h"
#include "trocar/host/console.h"
#include "trocar/host/translate.h"
#include "trocar/math/small_solver.h"
#include "trocar/math/symmetric_eigen.h"

namespace trocar::device {

using math::Pose;
using math::Quaternion;
using math::Vec3;

namespace {

using Matrix3 = math::SmallMatrix<3>;
using Vector3 = math::SmallVector<3>;

/// The shaft's direction settles in a few rounds; far more are never needed.
constexpr int kMaxRounds = 200;
constexpr double kSettled = 1e-12;  // change of a unit vector [-]
constexpr double kDegrees = 57.29577951308232;
/// Poses that count for the uncertainty: those in succession share the error of a tip that creeps in its hole and of a
/// field bent by metal, so that a thousand poses of one swing say hardly more than one a second.
constexpr double kIndependentPoses = static_cast<double>(kMinFitPoses);
/// At which a wrong direction of the shaft counts like a wrong place of the trocar [m]: a usual insertion depth.
constexpr double kShaftLever = 0.1;

Vector3 ToArray(const Vec3& v) {
  return {v.x, v.y, v.z};
}
Vec3 ToVector(const Vector3& v) {
  return {v[0], v[1], v[2]};
}
Matrix3 ToMatrix(const Quaternion& q) {
  const std::array<Vec3, 3> columns = {math::Rotate(q, {1, 0, 0}), math::Rotate(q, {0, 1, 0}),
                                       math::Rotate(q, {0, 0, 1})};
  Matrix3 rotation{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 column = ToArray(columns[k]);
    for (std::size_t i = 0; i < 3; ++i) rotation[i][k] = column[i];
  }
  return rotation;
}
/// I - a a^T, of a unit vector.
Matrix3 ProjectionAcross(const Vec3& a) {
  const Vector3 along = ToArray(a);
  Matrix3 across{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) across[i][k] = (i == k ? 1.0 : 0.0) - along[i] * along[k];
  }
  return across;
}
/// sum += rows^T rows
template <std::size_t kRows, std::size_t kCount>
void AddGram(const std::array<math::SmallVector<kCount>, kRows>& rows, math::SmallMatrix<kCount>& sum) {
  for (const math::SmallVector<kCount>& row : rows) {
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t k = 0; k < kCount; ++k) sum[i][k] += row[i] * row[k];
    }
  }
}
template <std::size_t kCount>
math::SmallMatrix<kCount> DividedBy(math::SmallMatrix<kCount> matrix, double divisor) {
  for (math::SmallVector<kCount>& row : matrix) {
    for (double& entry : row) entry /= divisor;
  }
  return matrix;
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

/// Point nearest to all lines through tips[i] along shafts[i]; where they are parallel, of those nearest to the source.
Vec3 MeetingPoint(const std::vector<Vec3>& tips, const std::vector<Vec3>& shafts) {
  Matrix3 sum{};
  Vec3 right;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const Matrix3 across = ProjectionAcross(shafts[i]);
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k) sum[row][k] += across[row][k];
    }
    right += tips[i] - math::Dot(shafts[i], tips[i]) * shafts[i];
  }
  const math::SymmetricEigen<3> eigen = math::CalcSymmetricEigen(sum);
  const double least = 3.0 * std::numeric_limits<double>::epsilon() * eigen.values[2];
  Vec3 point;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 direction = ToVector(eigen.vectors[i]);
    if (eigen.values[i] > least) point += math::Dot(direction, right) / eigen.values[i] * direction;
  }
  return point;
}

/// Fills in motion and uncertainty of a fit from its linearised normal matrix, for the trocar and two angles of the shaft.
///
/// \param tips  (poses) in the source's frame [m]
/// \return which motion was weakest, and its remedy
const char* JudgeTrocarMotion(std::span<const Pose> poses, const std::vector<Vec3>& tips, TrocarFit& fit) {
  const Vec3& axis = fit.axis_sensor;
  const Vec3 first = math::AnyPerpendicular(axis), second = math::Cross(axis, first);
  math::SmallMatrix<5> normal{};
  Vec3 mean_shaft;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vec3 shaft = math::Rotate(poses[i].rotation, axis);
    const double lever = math::Dot(shaft, tips[i] - fit.p_source_trocar) / kShaftLever;
    const Matrix3 across = ProjectionAcross(shaft);
    const Vector3 by_first = ToArray(lever * math::Rotate(poses[i].rotation, first)),
                  by_second = ToArray(lever * math::Rotate(poses[i].rotation, second));
    std::array<math::SmallVector<5>, 3> rows{};
    for (std::size_t row = 0; row < 3; ++row)
      rows[row] = {across[row][0], across[row][1], across[row][2], by_first[row], by_second[row]};
    AddGram(rows, normal);
    mean_shaft += shaft;
  }
  const double count = static_cast<double>(poses.size());
  const math::SymmetricEigen<5> eigen = math::CalcSymmetricEigen(DividedBy(normal, count));
  const double weakest = eigen.values[0];
  fit.quality.motion = std::sqrt(std::max(0.0, weakest));
  // of the trocar alone, whichever way the shaft is turned
  double loosest = 0;
  if (weakest > 0.0) {
    Matrix3 covariance{};
    for (std::size_t mode = 0; mode < 5; ++mode) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k)
          covariance[i][k] += eigen.vectors[mode][i] * eigen.vectors[mode][k] / eigen.values[mode];
      }
    }
    loosest = math::CalcSymmetricEigen(covariance).values[2];
  }
  const double square = fit.quality.residual * fit.quality.residual * count / (2.0 * count - 5.0);
  fit.quality.uncertainty = CalcUncertainty(square, loosest > 0.0 ? 1.0 / loosest : 0.0);
  const Vec3 open = {eigen.vectors[0][0], eigen.vectors[0][1], eigen.vectors[0][2]};
  const double along = std::fabs(math::Dot(open, math::Normalized(mean_shaft)));
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
  const double count = static_cast<double>(poses.size());
  std::vector<math::SmallVector<6>> rows;
  std::vector<double> right;
  Matrix3 mean{};
  for (const Pose& pose : poses) {
    const Matrix3 rotation = ToMatrix(pose.rotation);
    const Vector3 translation = ToArray(pose.translation);
    for (std::size_t i = 0; i < 3; ++i) {
      math::SmallVector<6> row = {rotation[i][0], rotation[i][1], rotation[i][2], 0.0, 0.0, 0.0};
      row[3 + i] = -1.0;
      rows.push_back(row);
      right.push_back(-translation[i]);
      for (std::size_t k = 0; k < 3; ++k) mean[i][k] += rotation[i][k] / count;
    }
  }
  const math::SmallVector<6> solved = math::SolveLeastSquares<6>(rows, right);
  PivotFit fit;
  fit.p_sensor_pivot = {solved[0], solved[1], solved[2]};
  fit.p_source_pivot = {solved[3], solved[4], solved[5]};
  std::vector<double> distances;
  for (const Pose& pose : poses)
    distances.push_back(math::Distance(pose * fit.p_sensor_pivot, fit.p_source_pivot));
  fit.quality = MakeQuality(distances, FindTurn(poses));

  // with the fixed point eliminated: how far each direction of the sensor was turned about the mean
  Matrix3 normal{};
  for (const Pose& pose : poses) {
    Matrix3 turned = ToMatrix(pose.rotation);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) turned[i][k] -= mean[i][k];
    }
    AddGram(turned, normal);
  }
  const double weakest = math::CalcSymmetricEigen(DividedBy(normal, count)).values[0];
  fit.quality.motion = std::sqrt(std::max(0.0, weakest));
  const double square = fit.quality.residual * fit.quality.residual * count / (3.0 * count - 6.0);
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
    Matrix3 sum{};
    Vec3 mean;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Vec3 way = math::Rotate(math::Inverse(poses[i].rotation), tips[i] - fit.p_source_trocar);
      AddGram(std::array<Vector3, 1>{ToArray(way)}, sum);
      mean += way;
    }
    Vec3 axis = ToVector(math::CalcSymmetricEigen(sum).vectors[2]);
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
