// SPDX-License-Identifier: Apache-2.0
/// \file patient_lint.h  Check of a patient: its faults, and where they are. docs/patient-check.md lists every finding.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// One organ's mesh in figures.
struct MeshSummary {
  std::string name;
  std::size_t triangles = 0;
  bool closed = false;
  bool manifold = false;
  std::size_t self_intersections = 0;  ///< pairs of triangles
  double volume_ml = 0;                ///< 0 where the mesh cannot be measured
};

/// One thing that is wrong.
struct LintFinding {
  std::string code;   ///< stable, "L-MESH-OPEN"
  std::string where;  ///< "liver", "liver/falciform", "cystic_duct/to"
  std::string text;   ///< what is wrong and what to do; places in the files' frame, LPS millimetres
};

struct LintReport {
  std::vector<MeshSummary> meshes;  ///< (organs)
  std::vector<patient::SourceLabel>
      labels;  ///< what each label of the segmentation was taken for; none without a segmentation
  std::vector<LintFinding> findings;
};

/// Looks at every organ, region, attachment, tube and landmark. Accepts whatever the structures can hold:
/// indices out of range and numbers that are not finite are findings. What a finding makes meaningless is not
/// judged: sizes and distances where the unit is wrong, a mesh's sides where it is open.
/// Sources of the ranges: docs/patient-check.md.
/// \note Not real-time safe; pure.
LintReport LintPatient(const patient::Patient& patient);

/// Reads a folder and looks at it, also where ReadPatient refuses it; a mesh that cannot be read is a
/// finding.
/// \return an error only where patient.json cannot be read
base::Result<LintReport> LintPatientFolder(const std::filesystem::path& folder);

}  // namespace trocar::anatomy
