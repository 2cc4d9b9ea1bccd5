// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/build_patient.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "trocar/anatomy/patient_builder.h"
#include "trocar/contours/control_points.h"
#include "trocar/contours/overlay.h"
#include "trocar/images/png_file.h"

namespace trocar::anatomy {
namespace {

using core::Error;

core::Status WriteOverlays(const std::filesystem::path& folder,
                           const std::map<int, images::ColorImage>& images,
                           const std::map<int, contours::Overlay>& overlays,
                           const images::Progress& progress) {
  std::size_t done = 0;
  for (const auto& [slice, overlay] : overlays) {
    if (progress)
      progress("writing overlays", static_cast<double>(done++) / static_cast<double>(overlays.size()));
    char name[32];
    std::snprintf(name, sizeof(name), "overlay-%04d.png", slice);
    if (auto status = images::WritePng(folder / name, contours::DrawOverlay(images.at(slice), overlay));
        !status.ok())
      return status;
  }
  return {};
}

}  // namespace

core::Result<BuildReport> BuildPatient(const BuildOptions& options, const images::Progress& progress) {
  const auto report_progress = [&](std::string_view what, double part) {
    if (progress) progress(what, part);
  };
  const Error given_up{core::ErrorCode::kCancelled, "the patient was given up; nothing was written"};
  auto points = contours::ReadControlPoints(options.control_points);
  if (!points.ok()) return points.error();
  if (options.skipped_shift_px) {
    if (!(*options.skipped_shift_px >= 0 && *options.skipped_shift_px <= 30))
      return Error{core::ErrorCode::kUsage, "skipped_shift_px must lie between 0 and 30"};
    for (contours::Structure& structure : points->structures)
      structure.adaption.skipped_shift_px = *options.skipped_shift_px;
  }
  std::optional<images::LabelVolume> reference;
  if (options.reference) {
    auto read = images::ReadLabelVolume(*options.reference);
    if (!read.ok()) return read.error();
    reference = std::move(*read);
  }

  // only slices with contours are opened
  std::set<int> used;
  for (const contours::Structure& structure : points->structures) {
    for (const contours::SliceContours& slice : structure.slices) used.insert(slice.slice);
  }
  const std::vector<int> numbers(used.begin(), used.end());
  const auto images = contours::ReadContouredSlices(*points, options.images, numbers, options.window,
                                                    progress, options.dicom_series);
  if (!images.ok()) return images.error();
  if (options.stop.stop_requested()) return given_up;

  contours::OrganOptions organs{
      options.spacing_mm, options.gap_mm, reference ? &*reference : nullptr, options.stop, {}, {}};
  if (contours::FollowsSkippedSlices(*points)) {
    if (auto status =
            contours::ReadSkippedFrom(*points, options.images, options.window, organs, options.dicom_series);
        !status)
      return status.error();
  }
  auto built = contours::BuildOrgans(*points, *images, organs, progress);
  if (!built.ok()) return built.error();
  BuildReport report;
  report.organs = std::move(built->organs);
  report_progress("assembling the patient", 0.0);
  auto patient = AssemblePatient(*points, built->meshes);
  if (!patient.ok()) return patient.error();
  report.patient = std::move(*patient);
  if (options.stop.stop_requested()) return given_up;

  if (!options.output.empty()) {
    if (const auto status = WritePatient(options.output, report.patient); !status.ok()) return status.error();
  }
  if (options.overlays) {
    if (const auto status = WriteOverlays(*options.overlays, *images, built->overlays, progress);
        !status.ok())
      return status.error();
    report.overlays = built->overlays.size();
  }
  report_progress("done", 1.0);
  return report;
}

std::string FormatReport(const BuildReport& report) {
  std::string text =
      "organ        slices followed points shift mean/max px  triangles closed manifold outward genus cuts "
      "min angle  "
      "distance max/mean mm  volume  "
      "reference ratio  Dice\n";
  for (const contours::OrganReport& organ : report.organs) {
    char line[256];
    std::snprintf(
        line, sizeof(line),
        "%-12s %6zu %8zu %6zu %9.2f / %-8.2f %9zu %6s %8s %7s %5d %4zu %6.1f deg %11.2f / %-6.3f %5.0f mL",
        organ.name.c_str(), organ.slices, organ.followed_slices, organ.control_points, organ.mean_shift_px,
        organ.largest_shift_px, organ.triangles, organ.closed ? "yes" : "NO", organ.manifold ? "yes" : "NO",
        organ.outward ? "yes" : "NO", organ.genus, organ.self_intersections, organ.min_angle_deg,
        organ.hausdorff_mm, organ.mean_distance_mm, organ.volume_ml);
    text += line;
    if (organ.judgement) {
      std::snprintf(line, sizeof(line), " %7.1f mL %5.3f %5.3f", organ.judgement->reference_ml,
                    organ.judgement->ratio, organ.judgement->dice);
      text += line;
    }
    text += "\n";
  }
  return text;
}

std::string FormatSurroundings(const BuildReport& report) {
  std::string text;
  char line[320];
  if (!report.neighbours.empty()) {
    text +=
        "neighbour                     from      parts triangles  min angle   volume  of voxels  left out\n";
    for (const NeighbourReport& one : report.neighbours) {
      std::snprintf(line, sizeof line, "%-29s %-9s %5d %9zu %6.1f deg %5.0f mL", one.name.c_str(),
                    one.is_seen ? "map" : "template", one.is_seen ? one.parts : 1, one.triangles,
                    one.min_angle_deg, one.volume_ml);
      text += line;
      if (one.is_seen) {
        std::snprintf(line, sizeof line, "   %5.1f mL   %4.1f mL", one.voxels_ml, one.left_out_ml);
        text += line;
      }
      text += "\n";
    }
  }
  for (const std::string& sentence : report.sinking) text += sentence + "\n";
  for (const Port& port : report.patient.ports) {
    const auto mm = [](double metres) { return std::lround(1000 * metres); };  // prints no "-0"
    std::snprintf(line, sizeof line, "Port for %s at %ld, %ld, %ld mm (left, cranial, anterior). ",
                  roles::SpokenName(NameOf(port.use)).c_str(), mm(port.position.x), mm(port.position.y),
                  mm(port.position.z));
    text += line + port.reason + "\n";
  }
  if (const auto& table = report.patient.table) {
    std::snprintf(line, sizeof line, "Table %.0f degrees head up, %.0f degrees right side up. ",
                  table->head_up * 180.0 / M_PI, table->right_up * 180.0 / M_PI);
    text += line + table->reason + "\n";
  }
  return text;
}

}  // namespace trocar::anatomy
