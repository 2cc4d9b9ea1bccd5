// SPDX-License-Identifier: Apache-2.0
/// \file build_patient.h  The whole chain: control points and photographs become a patient folder.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1 and Fig. 1.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/build_organs.h"
#include "trocar/images/image_series.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

struct BuildOptions {
  std::filesystem::path control_points;            ///< file, see control_points.h
  std::filesystem::path images;                    ///< any series that image_series.h opens
  int dicom_series = 0;                            ///< which one, where a folder holds several: 1, 2, ...
  std::optional<images::DisplayWindow> window;     ///< of grey images; the suggested one if not given
  std::filesystem::path output;                    ///< patient folder to write; empty: nothing is written
  std::optional<std::filesystem::path> reference;  ///< NIfTI label map that judges the result
  std::optional<std::filesystem::path> overlays;   ///< folder for one PNG a slice
  double spacing_mm = 1.0;                         ///< of the volume's lattice, 0.4 to 4
  double gap_mm = 0.7;                             ///< left free around an organ where another one touches it
  /// How far the edges of skipped slices may move the contours interpolated there [pixels], 0 to 30; what the
  /// file says if not given.
  std::optional<double> skipped_shift_px;
  bool has_surroundings = true;  ///< template neighbours, ports and table; else organs and tubes alone
  std::stop_token stop;          ///< gives up before anything is written: kCancelled
};

/// One neighbour in the table of results.
struct NeighbourReport {
  std::string name;
  bool is_seen = true;  ///< false: a template
  std::size_t triangles = 0;
  int parts = 0;           ///< that do not hang together
  double volume_ml = 0;    ///< of the mesh
  double voxels_ml = 0;    ///< of the voxels that it is made of; 0 for a template
  double left_out_ml = 0;  ///< of voxels in parts too small for a mesh
  double min_angle_deg = 0;
  std::size_t self_intersections = 0;
};

struct BuildReport {
  patient::Patient patient;
  std::vector<contours::OrganReport> organs;
  std::vector<NeighbourReport> neighbours;  ///< as Patient::neighbours
  std::vector<std::string> sinking;         ///< sentences: which neighbours sink under the gas, and how far
  std::vector<std::string> notes;           ///< sentences: what the images have and the patient has not
  std::size_t overlays = 0;                 ///< pictures written
};

/// Reads control points and the slices they name, adapts, fills, builds volumes, meshes and the patient,
/// judges them when a reference is given, and writes patient and overlays last.
///
/// Where two structures overlap, the one later in the file keeps the place.
/// \return the first error of any step; then nothing has been written
base::Result<BuildReport> BuildPatient(const BuildOptions& options, const images::Progress& progress = {});

/// The table of results as text, one line an organ.
std::string FormatReport(const BuildReport& report);

/// Neighbours as a table, ports and table with their reasons; empty where there is none of it.
std::string FormatSurroundings(const BuildReport& report);

}  // namespace trocar::anatomy
