// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/generate_patient.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "duct_template.h"
#include "generated_body.h"
#include "trocar/anatomy/patient_builder.h"
#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/meshing/volume_mesher.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;
using math::Vec3;

constexpr int kSmoothingRounds = 40;  // the distances are smooth already: little smoothing is needed
constexpr double kLiverSpacingMm = 2.0;
constexpr double kGallbladderSpacingMm = 1.25;
constexpr double kMlPerCubicMm = 1e-3;

/// Samples of minus the distance. Only the surface's place counts: a block of samples whose middle lies so
/// far from the surface that all of it must be on the same side takes the middle's value.
template <typename Function>
meshing::ScalarVolume Sample(const geometry::Box& box, double spacing, Function distance) {
  constexpr int kBlock = 4;           // samples along each side
  constexpr double kSteepness = 2.5;  // no distance grows faster than this; they are first-order estimates
  const double clear = kSteepness * 0.5 * std::sqrt(3.0) * (kBlock + 1) * spacing;
  meshing::ScalarVolume volume;
  volume.spacing = spacing;
  for (int axis = 0; axis < 3; ++axis) {
    volume.first[axis] = base::FloorTo<int>(box.min[axis] / spacing) - 1;
    volume.size[axis] = base::CeilTo<int>(box.max[axis] / spacing) + 2 - volume.first[axis];
  }
  volume.values.resize(static_cast<std::size_t>(volume.size[0]) * volume.size[1] * volume.size[2]);
  const auto blocks = [&](int axis) { return (volume.size[axis] + kBlock - 1) / kBlock; };
  oneapi::tbb::parallel_for(0, blocks(2) * blocks(1), [&](int row) {
    const int k0 = row / blocks(1) * kBlock, j0 = row % blocks(1) * kBlock;
    for (int i0 = 0; i0 < volume.size[0]; i0 += kBlock) {
      constexpr double kMiddle = 0.5 * (kBlock - 1);
      const Vec3 middle = spacing * Vec3{volume.first[0] + i0 + kMiddle, volume.first[1] + j0 + kMiddle,
                                         volume.first[2] + k0 + kMiddle};
      const double there = distance(middle);
      const bool is_clear = std::fabs(there) > clear;
      for (int k = k0; k < std::min(k0 + kBlock, volume.size[2]); ++k) {
        for (int j = j0; j < std::min(j0 + kBlock, volume.size[1]); ++j) {
          for (int i = i0; i < std::min(i0 + kBlock, volume.size[0]); ++i) {
            volume.values[volume.Index(i, j, k)] =
                static_cast<float>(is_clear ? -there : -distance(volume.Position(i, j, k)));
          }
        }
      }
    }
  });
  return volume;
}

base::Result<meshing::StructureMesh> MakeStructure(const char* name, meshing::ScalarVolume volume,
                                                   int triangles) {
  meshing::MeshingSettings settings;
  settings.triangle_budget = triangles;
  settings.smoothing.iterations = kSmoothingRounds;
  settings.distance_samples = 0;
  auto meshed = meshing::MeshVolume(std::move(volume), settings);
  if (!meshed.ok()) return Error{meshed.error().code, std::string(name) + ": " + meshed.error().message};
  if (!meshed->quality.IsSound()) {
    return Error{ErrorCode::kMeshInvalid,
                 std::string(name) +
                     ": its mesh cuts itself with these parameters; take another seed "
                     "or milder settings"};
  }
  return meshing::StructureMesh{name, std::move(meshed->mesh)};
}

}  // namespace

base::Result<patient::Patient> GeneratePatient(std::uint64_t seed,
                                               std::span<const ParameterSetting> settings) {
  auto parameters = DrawParameters(seed, settings);
  if (!parameters.ok()) return parameters.error();
  const GeneratedBody body(*parameters, seed);

  auto liver = MakeStructure(
      NameOf(roles::OrganRole::kLiver),
      Sample(body.LiverBox(), kLiverSpacingMm, [&](const Vec3& p) { return body.LiverDistance(p); }),
      meshing::kLiverTriangles);
  if (!liver.ok()) return liver.error();
  geometry::Box box = geometry::CalcBox(body.Gallbladder().points);
  const double reach =
      *std::max_element(body.Gallbladder().radii.begin(), body.Gallbladder().radii.end()) + 3.0;
  box.min -= Vec3{reach, reach, reach}, box.max += Vec3{reach, reach, reach};
  auto gallbladder = MakeStructure(
      NameOf(roles::OrganRole::kGallbladder),
      Sample(box, kGallbladderSpacingMm, [&](const Vec3& p) { return body.GallbladderDistance(p); }),
      meshing::kGallbladderTriangles);
  if (!gallbladder.ok()) return gallbladder.error();

  contours::ControlPoints frame = MakeWorldFrame();
  frame.name = "Generated patient, seed " + std::to_string(seed);
  frame.provenance = "Made by a computer from the seed and the parameters listed here; no person's images";
  frame.tubes = PlaceDucts(liver->mesh, gallbladder->mesh, body.Neck(), *parameters);
  const Vec3 fissure = body.FissurePoint();
  frame.landmarks = {{NameOf(roles::LandmarkRole::kUmbilicalFissure), fissure.z, {fissure.x, fissure.y}}};

  const auto measure = [&](const char* name, double value, const char* unit) {
    parameters->push_back({name, value, unit, "measured on the result"});
  };
  const auto liver_box = geometry::CalcBox(liver->mesh.positions);
  measure("measured_liver_transverse", liver_box.max.x - liver_box.min.x, "mm");
  measure("measured_liver_vertical", liver_box.max.y - liver_box.min.y, "mm");
  measure("measured_liver_depth", liver_box.max.z - liver_box.min.z, "mm");
  measure("measured_liver_volume",
          kMlPerCubicMm * geometry::CalcVolume(liver->mesh.positions, liver->mesh.triangles), "mL");
  measure("measured_gallbladder_volume",
          kMlPerCubicMm * geometry::CalcVolume(gallbladder->mesh.positions, gallbladder->mesh.triangles),
          "mL");
  for (const contours::TubePoints& tube : frame.tubes) {
    const std::string name = "measured_" + tube.name + "_length";
    measure(name.c_str(), CalcLengthMm(tube), "mm");
  }
  auto patient = AssemblePatient(frame, {std::move(*liver), std::move(*gallbladder)});
  if (!patient.ok()) return patient.error();
  patient->parameters = std::move(*parameters);
  return patient;
}

}  // namespace trocar::anatomy
