// SPDX-License-Identifier: Apache-2.0
/// \file build_organs.h  Control points and photographs become one closed mesh an organ.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.1 and Fig. 1.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"
#include "trocar/contours/overlay.h"
#include "trocar/contours/reference_judge.h"
#include "trocar/images/image_series.h"
#include "trocar/meshing/mesh_quality.h"
#include "trocar/meshing/structure_mesh.h"

namespace trocar::contours {

/// One organ in the table of results.
struct OrganReport {
  std::string name;
  std::size_t slices = 0, control_points = 0;
  std::size_t followed_slices = 0;                 ///< skipped by the person, contoured by their pictures
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

/// Gives the pictures of some slices, ascending.
using PictureReader =
    std::function<base::Result<std::map<int, images::ColorImage>>(const std::vector<int>& slices)>;

struct OrganOptions {
  double spacing_mm = 1.0;  ///< of the volume's lattice, 0.4 to 4
  double gap_mm = 0.7;      ///< left free around an organ where another one touches it, 0 to 5
  const images::LabelVolume* reference = nullptr;  ///< judges the result; may be null
  std::stop_token stop;                            ///< gives up at the next slice or mesh: kCancelled
  /// Of skipped slices that are not among the images, a few at a time; only for structures whose edges are
  /// followed there.
  PictureReader read_skipped;
  /// Slices that have a picture, ascending in equal steps; empty: all from first_slice to last_slice.
  std::vector<int> series;
};

struct BuiltOrgans {
  std::vector<OrganReport> organs;  ///< in the order of the structures
  std::vector<meshing::StructureMesh>
      meshes;  ///< in the frame of the pictures: column, row, slice times their distances [mm]
  std::map<int, Overlay> overlays;  ///< of each contoured slice
};

/// The series that the points were placed on. What the images say of size and place must agree with the
/// points.
///
/// \param folder  any series that image_series.h opens
/// \param numbers  slices that are needed, ascending; empty: all, which must have no gaps
/// \param dicom_series  as ImageSeriesOptions::series
/// \return kImageSizeDiffers, and what ImageSeries::Open returns
base::Result<images::ImageSeries> OpenContouredSeries(const ControlPoints& points,
                                                      const std::filesystem::path& folder,
                                                      const std::vector<int>& numbers,
                                                      const images::Progress& progress = {},
                                                      int dicom_series = 0);

/// Some of its pictures at once.
///
/// \param window  of grey images; the suggested one if not given
/// \return picture by slice number; what OpenContouredSeries and ReadSlices return
base::Result<std::map<int, images::ColorImage>> ReadContouredSlices(
    const ControlPoints& points, const std::filesystem::path& folder, const std::vector<int>& numbers,
    std::optional<images::DisplayWindow> window = {}, const images::Progress& progress = {},
    int dicom_series = 0);

/// Any structure follows edges in skipped slices.
bool FollowsSkippedSlices(const ControlPoints& points);

/// Opens the whole series for following edges in skipped slices: sets read_skipped and series.
/// \return what OpenContouredSeries returns; a series with gaps names the way out
base::Status ReadSkippedFrom(const ControlPoints& points, const std::filesystem::path& folder,
                             std::optional<images::DisplayWindow> window, OrganOptions& options,
                             int dicom_series = 0);

/// Follows the contours, fills them, interpolates between the slices and meshes the volumes.
///
/// Where two structures overlap, the one later in the list keeps the place.
/// \param images  at least the slices that the control points name, of the size that they name; what
/// options.read_skipped gives must have that size too
/// \return kUsage for options out of range; kContourEmpty with structure and slice; kCancelled; what decimation
/// and judging return
base::Result<BuiltOrgans> BuildOrgans(const ControlPoints& points,
                                      const std::map<int, images::ColorImage>& images,
                                      const OrganOptions& options = {},
                                      const images::Progress& progress = {});

/// Writes what is said of a mesh [mm] into the report.
void AddMeshQuality(OrganReport& report, const meshing::MeshQuality& quality);

}  // namespace trocar::contours
