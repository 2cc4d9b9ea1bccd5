// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "patient_linter.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

constexpr double kLandmarkReach = 0.005;  // between a gallbladder landmark and its surface [m]
constexpr double kDeepInside = 0.002;     // of the gallbladder in the liver [m]

/// Centre of a surface by its area: also meaningful for an open mesh.
math::Vec3 CalcCentre(const TriangleMesh& mesh) {
  math::Vec3 centre;
  double total = 0;
  for (const auto& t : mesh.triangles) {
    const double area = math::Norm(geometry::CalcAreaNormal(mesh.positions, t));
    centre += area / 3.0 * (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]);
    total += area;
  }
  return total > 0 ? centre / total : mesh.positions.front();
}

}  // namespace

void Linter::LintLandmarks() {
  for (const roles::LandmarkRole role :
       {roles::LandmarkRole::kUmbilicus, roles::LandmarkRole::kFundus, roles::LandmarkRole::kInfundibulum}) {
    if (patient_.LandmarkOf(role) == nullptr)
      Add("L-LANDMARK-MISSING", roles::NameOf(role), "there is no such landmark; place it");
  }
  for (const patient::Landmark& landmark : patient_.landmarks) {
    if (!math::IsFinite(landmark.position))
      Add("L-LANDMARK-NUMBER", landmark.name, "its position is not finite; place it again");
  }
  const patient::Organ* gallbladder = FindUsable(roles::OrganRole::kGallbladder);
  if (gallbladder == nullptr || !is_unit_right_) return;
  const meshing::NearestSurface surface(gallbladder->mesh);
  for (const roles::LandmarkRole role : {roles::LandmarkRole::kFundus, roles::LandmarkRole::kInfundibulum}) {
    const patient::Landmark* landmark = patient_.LandmarkOf(role);
    if (landmark == nullptr || !math::IsFinite(landmark->position)) continue;
    const double distance = surface.Find(landmark->position).distance;
    if (distance > kLandmarkReach) {
      Add("L-LANDMARK-FAR", landmark->name,
          "it lies " + Mm(distance) + " from the surface of the gallbladder; place it there (at most 5 mm)");
    }
  }
}

void Linter::LintSides() {
  const auto umbilicus = FindPlace(roles::LandmarkRole::kUmbilicus);
  for (const roles::OrganRole role : {roles::OrganRole::kLiver, roles::OrganRole::kGallbladder}) {
    const patient::Organ* organ = FindUsable(role);
    if (!umbilicus || organ == nullptr) continue;
    const double left = CalcCentre(organ->mesh).x - umbilicus->x;
    if (left <= 0) continue;
    Add("L-SIDE-LEFT-RIGHT", organ->name,
        "its centre lies " + Mm(left) +
            " to the patient's left of the umbilicus, and it belongs to the right: left and right are "
            "swapped "
            "(RAS read as LPS?)");
  }
  const auto fundus = FindPlace(roles::LandmarkRole::kFundus);
  auto inner = FindPlace(roles::LandmarkRole::kInfundibulum);
  const int hepatic = patient_.TubeOf(roles::TubeRole::kCommonHepaticDuct);
  if (!inner && hepatic >= 0 && IsWellFormed(patient_.tubes[hepatic]))
    inner = patient_.tubes[hepatic].line.points.front();
  if (!fundus || !inner) return;
  const int gallbladder = patient_.OrganOf(roles::OrganRole::kGallbladder);
  const std::string where =
      gallbladder < 0 ? roles::NameOf(roles::OrganRole::kGallbladder) : patient_.organs[gallbladder].name;
  if (fundus->y >= inner->y) {
    Add("L-SIDE-CRANIAL-CAUDAL", where,
        "the fundus does not lie caudal to the infundibulum: cranial and caudal are swapped (slices in the "
        "wrong order?)");
  }
  if (fundus->z <= inner->z) {
    Add("L-SIDE-ANTERIOR-POSTERIOR", where,
        "the fundus does not lie anterior to the infundibulum: anterior and posterior are swapped (RAS "
        "read as "
        "LPS?)");
  }
}

void Linter::LintDepth() {
  const patient::Organ *liver = FindUsable(roles::OrganRole::kLiver),
                       *gallbladder = FindUsable(roles::OrganRole::kGallbladder);
  if (liver == nullptr || gallbladder == nullptr || !is_unit_right_) return;
  const TriangleMesh mesh = Outward(liver->mesh);
  const meshing::NearestSurface surface(mesh);
  std::size_t inside = 0;
  double deepest = 0;
  math::Vec3 place;
  for (const math::Vec3& p : gallbladder->mesh.positions) {
    const double depth = surface.Find(p).distance;
    if (depth <= kDeepInside || !surface.IsInside(p)) continue;
    ++inside;
    if (depth > deepest) deepest = depth, place = p;
  }
  if (inside == 0) return;
  Add("L-GALLBLADDER-DEEP", gallbladder->name,
      Count(inside, "vertex lies", "vertices lie") + " deeper than 2 mm inside the liver, the deepest " +
          Mm(deepest) + " at " + PlaceText(place) + "; part the two contours there");
}

}  // namespace trocar::anatomy
