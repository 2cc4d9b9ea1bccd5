// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_from_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "body_shape.h"
#include "duct_template.h"
#include "label_names.h"
#include "label_neighbours.h"
#include "label_plausibility.h"
#include "surround_patient.h"
#include "trocar/anatomy/patient_builder.h"
#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/printable.h"
#include "trocar/meshing/label_volume.h"
#include "trocar/meshing/volume.h"
#include "trocar/meshing/volume_mesher.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;
using math::Vec3;

constexpr double kMaxPixels = 4e6;  // of one slice after it was given square pixels

Error Mismatch(const std::string& why) {
  return {ErrorCode::kLabelsMismatch, why};
}

Error GivenUp() {
  return {ErrorCode::kCancelled, "the patient was given up; nothing was written"};
}

/// The end of the gallbladder that is more cranial and posterior.
Vec3 FindNeck(const geometry::TriangleMesh& gallbladder) {
  Vec3 centre;
  for (const Vec3& p : gallbladder.positions) centre += p / static_cast<double>(gallbladder.positions.size());
  const auto furthest = [&](const Vec3& from) {
    return *std::max_element(
        gallbladder.positions.begin(), gallbladder.positions.end(),
        [&](const Vec3& a, const Vec3& b) { return SquaredDistance(a, from) < SquaredDistance(b, from); });
  };
  const Vec3 one = furthest(centre), other = furthest(one);
  const Vec3 upwards = {0.4, 0.6, -1.0};
  return Dot(one, upwards) > Dot(other, upwards) ? one : other;
}

/// Liver and gallbladder of the map as meshes (left, cranial, anterior). What the map holds beside their largest parts
/// is taken out of it, and told in the notes of `report`.
base::Result<std::vector<meshing::StructureMesh>> MeshOrgans(
    images::LabelVolume& volume, const MeasuredLabels& measured, const VoxelFrame& frame,
    const LabelOptions& options, const images::Progress& progress, BuildReport& report) {
  const std::array<double, 3>& step = frame.step_mm;
  const double pixel = std::max(0.5, std::min(step[0], step[1]));
  if (volume.size[0] * step[0] / pixel * (volume.size[1] * step[1] / pixel) > kMaxPixels)
    return Mismatch("a slice covers too large an area; crop the map");
  struct Part {
    const char* name;
    int label, triangles;
    const std::vector<CutSide>& cuts;
  };
  const Part parts[] = {{NameOf(roles::OrganRole::kLiver), measured.labels.liver, meshing::kLiverTriangles,
                         measured.liver.cuts},
                        {NameOf(roles::OrganRole::kGallbladder), measured.labels.gallbladder,
                         meshing::kGallbladderTriangles, measured.gallbladder.cuts}};
  std::vector<meshing::ScalarVolume> volumes;
  for (const Part& part : parts) {
    if (options.stop.stop_requested()) return GivenUp();
    progress(std::string("filling ") + part.name, 0.1);
    std::vector<double> parts_ml;
    for (const std::size_t voxels : meshing::KeepLargestPart(volume, part.label))
      parts_ml.push_back(static_cast<double>(voxels) * frame.VoxelMm3() / 1000.0);
    if (const auto status = CheckParts(part.name, parts_ml, options.takes_largest_part); !status.ok())
      return status.error();
    for (std::string& note : DescribeLosses(part.name, parts_ml, part.cuts))
      report.notes.push_back(std::move(note));
    auto slices = meshing::FillLabelSlices(volume, part.label, step, pixel);
    contours::OrganReport organ;
    organ.name = part.name;
    organ.slices = slices.size();
    meshing::LabelVolumeSettings settings;
    settings.spacing_mm = options.spacing_mm;
    auto distances = meshing::MakeLabelVolume(std::move(slices), pixel, 1000.0 * parts_ml.front(), settings);
    if (!distances.ok()) {
      return Error{distances.error().code, std::string(part.name) + ", label " + std::to_string(part.label) +
                                               ": " + distances.error().message};
    }
    volumes.push_back(std::move(*distances));
    report.organs.push_back(organ);
  }
  meshing::Subtract(volumes[0], volumes[1], options.gap_mm);

  std::vector<meshing::StructureMesh> meshes;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    if (options.stop.stop_requested()) return GivenUp();
    progress(std::string("meshing ") + parts[i].name, 0.3 + 0.3 * static_cast<double>(i));
    meshing::MeshingSettings settings;
    settings.triangle_budget = parts[i].triangles;
    auto meshed = meshing::MeshVolume(std::move(volumes[i]), settings);
    if (!meshed.ok())
      return Error{meshed.error().code, std::string(parts[i].name) + ": " + meshed.error().message};
    contours::AddMeshQuality(report.organs[i], meshed->quality);
    geometry::TriangleMesh& mesh = meshed->mesh;
    for (Vec3& p : mesh.positions) p = p.x * frame.axes[0] + p.y * frame.axes[1] + p.z * frame.axes[2];
    // a mirrored frame turns the triangles inside out
    if (geometry::CalcVolume(mesh.positions, mesh.triangles) < 0) {
      for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    meshes.push_back({parts[i].name, std::move(mesh)});
  }
  return meshes;
}

/// Neighbours, ports and table of an assembled patient.
/// \param shift  of the map's frame [m]: world = 0.001 map + shift
void AddSurroundings(const images::LabelVolume& volume, const OrganLabels& organs, const VoxelFrame& frame,
                     const Vec3& shift, const images::Progress& progress, BuildReport& report) {
  progress("meshing the neighbours", 0.75);
  patient::Patient& patient = report.patient;
  const LabelBoxes boxes = FindLabelBoxes(volume);
  const NeighbourLabels labels = FindNeighbourLabels(organs, boxes);
  for (NeighbourMesh& one : MeshNeighbours(volume, labels, organs, boxes, frame, report.notes)) {
    for (Vec3& p : one.mesh.positions) p = 0.001 * p + shift;
    report.neighbours.push_back(one.report);
    patient.neighbours.push_back({one.report.name, std::move(one.mesh), true, one.role});
  }
  progress("placing ports", 0.9);
  SurroundPatient(MeasureBody(volume, labels, frame, shift), report);
}

}  // namespace

base::Result<BuildReport> BuildPatientFromLabels(const LabelOptions& options,
                                                 const images::Progress& progress) {
  const auto report_progress = [&](std::string_view what, double part) {
    if (progress) progress(what, part);
  };
  if (!(options.spacing_mm >= 0.4 && options.spacing_mm <= 4.0) ||
      !(options.gap_mm >= 0.0 && options.gap_mm <= 5.0)) {
    return Error{ErrorCode::kUsage, "spacing_mm must lie between 0.4 and 4, gap_mm between 0 and 5"};
  }
  report_progress("reading labels", 0.0);
  auto volume = images::ReadLabelVolume(options.labels);
  if (!volume.ok()) return volume.error();
  if (!options.names.empty()) {
    auto names = ReadLabelNames(options.names);
    if (!names.ok()) return names.error();
    volume->names = std::move(names->names);
    volume->codes = std::move(names->codes);
  }
  const auto frame = MakeVoxelFrame(*volume, options.is_mirrored);
  if (!frame.ok())
    return Error{frame.error().code, host::Printable(options.labels.string()) + ": " + frame.error().message};
  report_progress("looking at the labels", 0.05);
  BuildReport report;
  LabelDensities densities;
  if (!options.images.empty()) {
    const auto series = images::ImageSeries::Open(options.images, options.opening);
    if (!series.ok()) return series.error();
    auto measured_hu = MeasureDensities(*volume, *series);
    if (!measured_hu.ok()) return measured_hu.error();
    densities = std::move(*measured_hu);
    if (densities.empty())
      report.notes.emplace_back(
          "the images hold no Hounsfield units, so the densities of the labels were not looked at");
  }
  const auto labels = FindLabels(*volume, options, densities);
  if (!labels.ok()) return labels.error();
  JoinParts(*labels, *volume);
  if (options.stop.stop_requested()) return GivenUp();
  const MeasuredLabels measured = MeasureOrgans(*volume, *labels, *frame);
  if (const auto status = CheckBody(measured, options.is_mirrored); !status.ok()) return status.error();

  auto meshes = MeshOrgans(*volume, measured, *frame, options, report_progress, report);
  if (!meshes.ok()) return meshes.error();

  if (options.stop.stop_requested()) return GivenUp();
  report_progress("assembling the patient", 0.9);
  auto usual = DrawParameters(0, MakeUsualSettings());
  if (!usual.ok()) return usual.error();
  contours::ControlPoints world = MakeWorldFrame();
  // a file name may name a person: it is not kept
  world.name = "Patient from a label map";
  world.provenance = "Liver and gallbladder from a label map (" + labels->convention +
                     "); ducts and arteries placed by landmarks, not seen in the images";
  world.tubes = PlaceDucts((*meshes)[0].mesh, (*meshes)[1].mesh, FindNeck((*meshes)[1].mesh), *usual);
  auto patient = AssemblePatient(world, *meshes);
  if (!patient.ok()) return patient.error();
  report.patient = std::move(*patient);
  report.patient.labels = labels->taken;
  const auto liver = static_cast<std::size_t>(report.patient.OrganOf(roles::OrganRole::kLiver));
  const Vec3 shift =
      report.patient.organs[liver].mesh.positions.front() - 0.001 * (*meshes)[0].mesh.positions.front();
  AddSurroundings(*volume, *labels, *frame, shift, report_progress, report);
  if (options.stop.stop_requested()) return GivenUp();
  if (!options.output.empty()) {
    if (const auto status = files::WritePatient(options.output, report.patient); !status.ok())
      return status.error();
  }
  report_progress("done", 1.0);
  return report;
}

}  // namespace trocar::anatomy
