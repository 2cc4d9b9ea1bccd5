// SPDX-License-Identifier: Apache-2.0
/// \file generated_body.h  Liver and gallbladder of a generated patient, as functions of the place.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "trocar/anatomy/patient_parameters.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/vector.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

// distances are negative inside, in millimetres

struct Ellipsoid {
  math::Vec3 centre, radii;

  /// First-order distance: exact at the surface.
  double Distance(const math::Vec3& p) const;
  math::Vec3 OutwardAt(const math::Vec3& p) const;
};

/// Balls along a polyline, radii in between.
struct Worm {
  std::vector<math::Vec3> points;
  std::vector<double> radii;

  double Distance(const math::Vec3& p) const;
};

/// Frame: left, cranial, anterior of the porta hepatis [mm].
class GeneratedBody {
 public:
  GeneratedBody(std::span<const patient::Parameter> parameters, std::uint64_t seed);

  double LiverDistance(const math::Vec3& p) const;
  double GallbladderDistance(const math::Vec3& p) const { return gallbladder_.Distance(p); }

  const Worm& Gallbladder() const { return gallbladder_; }
  const math::Vec3& FissurePoint() const { return fissure_.points.back(); }
  const math::Vec3& Neck() const { return neck_; }
  const geometry::Box& LiverBox() const { return box_; }

 private:
  Ellipsoid Scaled(const math::Vec3& centre, const math::Vec3& radii) const;
  double DomeDistance(const math::Vec3& p) const;
  double LobesDistance(const math::Vec3& p) const;
  void MakeLobes(double pitch);
  void MakeGrooves();
  geometry::Box FindLiverBox() const;
  math::Vec3 OnViscera(double x, double z) const;
  std::vector<std::pair<math::Vec3, double>> FindVisceralWay(double x, double z,
                                                             const math::Vec3& direction) const;
  double FindEdge(const std::vector<std::pair<math::Vec3, double>>& way) const;
  double MakeGallbladder(std::span<const patient::Parameter> parameters);
  void FoldFundus(Worm& axis) const;
  void FindPitch(std::span<const patient::Parameter> parameters);

  std::uint64_t seed_;
  double cirrhosis_ = 0, edge_blend_ = 9, taper_ = 0;
  double deep_ = 0;  // 0: as deep as the textbook's liver, 1: as deep as it is wide
  math::Vec3 scale_ = {1, 1, 1};
  geometry::Box box_;  // of the liver
  Ellipsoid right_, lateral_, left_, tip_, viscera_, stomach_, kidney_, spine_, caudate_;
  Worm fissure_, porta_, gallbladder_;
  math::Vec3 neck_;  // where the cystic duct leaves the gallbladder
};

}  // namespace trocar::anatomy
