// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/build_patient.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "surround_patient.h"
#include "trocar/anatomy/patient_builder.h"
#include "trocar/base/to_integer.h"
#include "trocar/contours/control_points.h"
#include "trocar/contours/overlay.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/console.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/translate.h"
#include "trocar/images/png_file.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::Error;

base::Status WriteOverlays(const std::filesystem::path& folder,
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

base::Result<BuildReport> BuildPatient(const BuildOptions& options, const images::Progress& progress) {
  const auto report_progress = [&](std::string_view what, double part) {
    if (progress) progress(what, part);
  };
  const Error given_up{base::ErrorCode::kCancelled, "the patient was given up; nothing was written"};
  auto points = contours::ReadControlPoints(options.control_points);
  if (!points.ok()) return points.error();
  if (options.skipped_shift_px) {
    if (!(*options.skipped_shift_px >= 0 && *options.skipped_shift_px <= 30))
      return Error{base::ErrorCode::kUsage, "skipped_shift_px must lie between 0 and 30"};
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
  if (options.has_surroundings) SurroundPatient({}, report);
  if (options.stop.stop_requested()) return given_up;

  if (!options.output.empty()) {
    if (const auto status = files::WritePatient(options.output, report.patient); !status.ok())
      return status.error();
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
  using host::ShownFixed;
  const auto yes = [](bool is_so) { return host::Translate(is_so ? "yes" : "NO"); };
  std::vector<std::vector<std::string>> rows = {
      {"organ", "slices", "followed", "points", "shift mean/max [px]", "triangles", "closed", "manifold",
       "outward", "genus", "cuts", "min angle [deg]", "distance max/mean [mm]", "volume [mL]",
       "reference [mL]", "ratio", "Dice"}};
  for (const contours::OrganReport& organ : report.organs) {
    rows.push_back({host::Translate(organ.name), std::to_string(organ.slices),
                    std::to_string(organ.followed_slices), std::to_string(organ.control_points),
                    ShownFixed(organ.mean_shift_px, 2) + " / " + ShownFixed(organ.largest_shift_px, 2),
                    std::to_string(organ.triangles), yes(organ.closed), yes(organ.manifold),
                    yes(organ.outward), std::to_string(organ.genus), std::to_string(organ.self_intersections),
                    ShownFixed(organ.min_angle_deg, 1),
                    ShownFixed(organ.hausdorff_mm, 2) + " / " + ShownFixed(organ.mean_distance_mm, 3),
                    ShownFixed(organ.volume_ml, 0)});
    if (const auto& judgement = organ.judgement) {
      for (const auto& [value, decimals] :
           {std::pair{judgement->reference_ml, 1}, {judgement->ratio, 3}, {judgement->dice, 3}})
        rows.back().push_back(ShownFixed(value, decimals));
    }
  }
  return host::FormatShownTable(std::move(rows));
}

std::string FormatSurroundings(const BuildReport& report) {
  using host::ShownFixed;
  std::string text;
  if (!report.neighbours.empty()) {
    std::vector<std::vector<std::string>> rows = {{"neighbour", "from", "parts", "triangles",
                                                   "min angle [deg]", "volume [mL]", "of voxels [mL]",
                                                   "left out [mL]"}};
    for (const NeighbourReport& one : report.neighbours) {
      rows.push_back({host::Translate(roles::SpokenName(one.name)),
                      host::Translate(one.is_seen ? host::Mark("images") : host::Mark("template")),
                      std::to_string(one.is_seen ? one.parts : 1), std::to_string(one.triangles),
                      ShownFixed(one.min_angle_deg, 1), ShownFixed(one.volume_ml, 0)});
      if (!one.is_seen) continue;
      rows.back().push_back(ShownFixed(one.voxels_ml, 1));
      rows.back().push_back(ShownFixed(one.left_out_ml, 1));
    }
    text += host::FormatShownTable(std::move(rows));
  }
  for (const std::string& sentence : report.sinking)
    text += host::PrintableLine(host::TranslateComposed(sentence)) + "\n";
  for (const patient::Port& port : report.patient.ports) {
    const auto mm = [](double metres) {
      return std::to_string(base::RoundTo<std::int64_t>(1000 * metres));
    };  // prints no "-0"
    text += host::TranslateWith("Port for {1} at {2}, {3}, {4} mm (left, cranial, anterior).",
                                {host::Translate(roles::SpokenName(NameOf(port.use))), mm(port.position.x),
                                 mm(port.position.y), mm(port.position.z)}) +
            " " + host::PrintableLine(host::TranslatePieces(port.reason)) + "\n";
  }
  if (const auto& table = report.patient.table) {
    text += host::TranslateWith("Table {1} degrees head up, {2} degrees right side up.",
                                {ShownFixed(table->head_up * 180.0 / M_PI, 0),
                                 ShownFixed(table->right_up * 180.0 / M_PI, 0)}) +
            " " + host::TranslatePieces(table->reason) + "\n";
  }
  return text;
}

}  // namespace trocar::anatomy
