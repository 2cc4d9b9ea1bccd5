// SPDX-License-Identifier: Apache-2.0
/// \file patient_linter.h  One pass over a patient: what the stages of the check share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/anatomy/patient_lint.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// Each stage adds its findings; later stages use what earlier ones found usable.
class Linter {
 public:
  /// \param mesh_errors  (organs, then neighbours), or empty where all meshes were read
  Linter(const patient::Patient& patient, const std::vector<base::Error>& mesh_errors)
      : patient_(patient), mesh_errors_(mesh_errors) {}

  LintReport Run();

 private:
  void Add(const char* code, std::string where, std::string text);
  /// An organ whose mesh is usable, or null.
  const patient::Organ* FindUsable(int organ) const;
  const patient::Organ* FindUsable(roles::OrganRole role) const { return FindUsable(patient_.OrganOf(role)); }
  /// A finite landmark's place.
  std::optional<math::Vec3> FindPlace(roles::LandmarkRole role) const;

  // patient_lint.cpp
  void LintNames();
  void LintLabels();
  // patient_lint_mesh.cpp
  void LintMesh(std::size_t index);
  void LintSurface(const patient::Organ& organ, MeshSummary& summary);
  void LintNeighbour(std::size_t index);
  void LintUnit();
  void LintVolumes();
  // patient_lint_regions.cpp
  void LintRegions(std::size_t index);
  void LintFixedFaces();
  void LintAttachments();
  // patient_lint_tubes.cpp
  void LintTubes();
  void LintTubeEnd(const patient::Tube& tube, const std::string& target, const math::Vec3& end,
                   const std::string& where);
  void LintTubeLinks(const patient::Tube& tube);
  void LintTubeSize(const patient::Tube& tube);
  void LintTubeGraph();
  // patient_lint_places.cpp
  void LintLandmarks();
  void LintSides();
  void LintDepth();

  const patient::Patient& patient_;
  const std::vector<base::Error>& mesh_errors_;
  std::vector<bool> is_usable_;  // (organs) finite, indices in range, not empty
  bool is_unit_right_ = true;
  LintReport report_;
};

struct Range {
  double min = 0, max = 0;
};

/// A number with about four digits.
std::string Rounded(double value, int digits = 1);
/// A length in metres as millimetres.
std::string Mm(double metres);
/// A place as the files give it.
std::string PlaceText(const math::Vec3& world);
/// "1 vertex", "7 vertices".
std::string Count(std::size_t count, const char* one, const char* many);
/// Two points or more, a radius for each, all finite.
bool IsWellFormed(const patient::Tube& tube);
/// The mesh with its triangles outwards: an inside-out mesh is one finding, not several.
geometry::TriangleMesh Outward(geometry::TriangleMesh mesh);

}  // namespace trocar::anatomy
