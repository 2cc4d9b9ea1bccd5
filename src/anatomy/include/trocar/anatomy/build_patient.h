// SPDX-License-Identifier: Apache-2.0
/// \file build_patient.h  The whole chain: control points and photographs become a patient folder.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1 and Fig. 1.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/anatomy/image_series.h"
#include "trocar/anatomy/mesh_quality.h"
#include "trocar/anatomy/patient.h"
#include "trocar/anatomy/reference_judge.h"
#include "trocar/core/result.h"

namespace trocar::anatomy {

struct BuildOptions {
  std::filesystem::path control_points;            ///< file, see control_points.h
  std::filesystem::path images;                    ///< any series that image_series.h opens
  std::optional<DisplayWindow> window;             ///< of grey images; the suggested one if not given
  std::filesystem::path output;                    ///< patient folder to write; empty: nothing is written
  std::optional<std::filesystem::path> reference;  ///< NIfTI label map that judges the result
  std::optional<std::filesystem::path> overlays;   ///< folder for one PNG a slice
  double spacing_mm = 1.0;                         ///< of the volume's lattice, 0.4 to 4
  double gap_mm = 0.7;                             ///< left free around an organ where another one touches it
};

/// One organ in the table of results.
struct OrganReport {
  std::string name;
  std::size_t slices = 0, control_points = 0;
  double mean_shift_px = 0, largest_shift_px = 0;  ///< of the edge adaption
  std::size_t triangles = 0;
  bool closed = false, manifold = false, outward = false;
  int genus = 0;
  std::size_t self_intersections = 0;
  double min_angle_deg = 0;
  double mean_min_angle_deg = 0;  ///< mean over the triangles of their smallest angle
  double volume_ml = 0;
  double volume_change = 0;            ///< against the volume's own surface, as a share of it [-]
  double hausdorff_mm = 0;             ///< between mesh and the volume's own surface, both ways, sampled
  double mean_distance_mm = 0;         ///< of the mesh from that surface
  double samples_per_square_mm = 0;    ///< density of the samples on the mesh
  std::optional<Judgement> judgement;  ///< with a reference only
};

struct BuildReport {
  Patient patient;
  std::vector<OrganReport> organs;
  std::size_t overlays = 0;  ///< pictures written
};

/// Reads control points and the slices they name, adapts, fills, builds volumes, meshes and the patient,
/// judges them when a reference is given, and writes patient and overlays last.
///
/// Where two structures overlap, the one later in the file keeps the place.
/// \return the first error of any step; then nothing has been written
core::Result<BuildReport> BuildPatient(const BuildOptions& options, const Progress& progress = {});

/// Writes what is said of a mesh [mm] into the report.
void AddMeshQuality(OrganReport& report, const MeshQuality& quality);

/// The table of results as text, one line an organ.
std::string FormatReport(const BuildReport& report);

}  // namespace trocar::anatomy
