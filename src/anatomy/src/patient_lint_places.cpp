// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "patient_linter.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/meshing/nearest_surface.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

constexpr double kLandmarkReach = 0.005;  // between a gallbladder landmark and its surface [m]
constexpr double kDeepInside = 0.002;     // of the gallbladder in the liver [m]

/// Centre of a surface by its area: also meaningful for an open mesh.
Vec3 CalcCentre(const TriangleMesh& mesh) {
  Vec3 centre;
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
  for (const char* name : {"umbilicus", "fundus", "infundibulum"}) {
    if (patient_.FindLandmark(name) == nullptr)
      Add("L-LANDMARK-MISSING", name, "there is no such landmark; place it");
  }
  for (const Landmark& landmark : patient_.landmarks) {
    if (!math::IsFinite(landmark.position))
      Add("L-LANDMARK-NUMBER", landmark.name, "its position is not finite; place it again");
  }
  const Organ* gallbladder = FindUsable("gallbladder");
  if (gallbladder == nullptr || !is_unit_right_) return;
  const meshing::NearestSurface surface(gallbladder->mesh);
  for (const char* name : {"fundus", "infundibulum"}) {
    const Landmark* landmark = patient_.FindLandmark(name);
    if (landmark == nullptr || !math::IsFinite(landmark->position)) continue;
    const double distance = surface.Find(landmark->position).distance;
    if (distance > kLandmarkReach) {
      Add("L-LANDMARK-FAR", name,
          "it lies " + Mm(distance) + " from the surface of the gallbladder; place it there (at most 5 mm)");
    }
  }
}

void Linter::LintSides() {
  const auto umbilicus = FindPlace("umbilicus");
  for (const char* name : {"liver", "gallbladder"}) {
    const Organ* organ = FindUsable(name);
    if (!umbilicus || organ == nullptr) continue;
    const double left = CalcCentre(organ->mesh).x - umbilicus->x;
    if (left <= 0) continue;
    Add("L-SIDE-LEFT-RIGHT", name,
        "its centre lies " + Mm(left) +
            " to the patient's left of the umbilicus, and it belongs to the right: left and right are "
            "swapped "
            "(RAS read as LPS?)");
  }
  const auto fundus = FindPlace("fundus");
  auto inner = FindPlace("infundibulum");
  const Tube* hepatic = FindTube("common_hepatic_duct");
  if (!inner && hepatic != nullptr && IsWellFormed(*hepatic)) inner = hepatic->line.points.front();
  if (!fundus || !inner) return;
  if (fundus->y >= inner->y) {
    Add("L-SIDE-CRANIAL-CAUDAL", "gallbladder",
        "the fundus does not lie caudal to the infundibulum: cranial and caudal are swapped (slices in the "
        "wrong order?)");
  }
  if (fundus->z <= inner->z) {
    Add("L-SIDE-ANTERIOR-POSTERIOR", "gallbladder",
        "the fundus does not lie anterior to the infundibulum: anterior and posterior are swapped (RAS "
        "read as "
        "LPS?)");
  }
}

void Linter::LintDepth() {
  const Organ *liver = FindUsable("liver"), *gallbladder = FindUsable("gallbladder");
  if (liver == nullptr || gallbladder == nullptr || !is_unit_right_) return;
  const TriangleMesh mesh = Outward(liver->mesh);
  const meshing::NearestSurface surface(mesh);
  std::size_t inside = 0;
  double deepest = 0;
  Vec3 place;
  for (const Vec3& p : gallbladder->mesh.positions) {
    const double depth = surface.Find(p).distance;
    if (depth <= kDeepInside || !surface.IsInside(p)) continue;
    ++inside;
    if (depth > deepest) deepest = depth, place = p;
  }
  if (inside == 0) return;
  Add("L-GALLBLADDER-DEEP", "gallbladder",
      Count(inside, "vertex lies", "vertices lie") + " deeper than 2 mm inside the liver, the deepest " +
          Mm(deepest) + " at " + PlaceText(place) + "; part the two contours there");
}

}  // namespace trocar::anatomy
