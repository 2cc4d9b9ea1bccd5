// SPDX-License-Identifier: Apache-2.0
#include "tissue_model_file.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "field_ranges.h"
#include "scene_objects.h"
#include "trocar/base/to_integer.h"
#include "trocar/patient/patient.h"
#include "trocar/procedures/find_procedure.h"

namespace trocar::files {
namespace {

using base::ErrorCode;
using host::JsonView;

constexpr double kShortest = 0.005;  // of a duct or band [m]
constexpr std::size_t kMostTubes = 8, kMostBands = 64, kMostSheets = 4;

template <typename Things>
void CheckName(const JsonView& view, const Things& things, const char* what) {
  const auto same = [&](const auto& one) { return one.name == things.back().name; };
  if (std::any_of(things.begin(), things.end() - 1, same))
    view.Complain("another " + std::string(what) + " is called \"" + things.back().name +
                      "\" already; names must differ",
                  ErrorCode::kSceneInvalid);
}

/// Both ends leave the scene, so that they are held where they are.
patient::Tube ReadTube(const JsonView& view, const math::Vec3& origin) {
  view.AllowOnly({"name", "about", "kind", "from_mm", "to_mm", "radius_mm", "sag_mm", "spacing_mm"});
  patient::Tube tube{view.Text("name")};
  const auto kind = patient::FindKind(view.TextOr("kind", patient::KindName(tube.kind)));
  if (!kind) view.Complain("kind is duct or artery", ErrorCode::kUnknownName);
  tube.kind = kind.value_or(tube.kind);
  const math::Vec3 from = origin + ReadPointMm(view, "from_mm"), to = origin + ReadPointMm(view, "to_mm");
  const double radius = 0.001 * view.Number("radius_mm", range::kTubeRadiusMm);
  const double sag = 0.001 * view.NumberOr("sag_mm", 0.0, range::kSagMm);
  const double spacing = 0.001 * view.NumberOr("spacing_mm", 2.5, range::kTubeSpacingMm);
  const double length = math::Distance(from, to);
  if (!(length >= kShortest))
    view.Complain("from_mm and to_mm must be at least 5 mm apart", ErrorCode::kSceneInvalid);
  const int pieces = std::max(4, base::RoundTo<int>(length / spacing));
  for (int i = 0; i <= pieces; ++i) {
    const double s = static_cast<double>(i) / pieces;
    tube.line.points.push_back(math::Lerp(from, to, s) - math::Vec3{0, 0, 4 * sag * s * (1 - s)});
    tube.line.radii.push_back(radius);
  }
  return tube;
}

scene::ModelBand ReadBand(const JsonView& view, const math::Vec3& origin) {
  view.AllowOnly({"name", "about", "colour", "from_mm", "to_mm", "radius_mm"});
  scene::ModelBand band;
  band.name = view.Text("name");
  const std::string colour = view.TextOr("colour", "red");
  const auto found = scene::FindColour(colour);
  if (!found)
    view.Complain("there is no colour \"" + colour + "\"; see docs/tasks.md", ErrorCode::kUnknownName);
  band.colour = found.value_or(scene::ObjectColour::kRed);
  band.from = origin + ReadPointMm(view, "from_mm");
  band.to = origin + ReadPointMm(view, "to_mm");
  band.radius = 0.001 * view.NumberOr("radius_mm", 1e3 * band.radius, range::kBandRadiusMm);
  if (!(math::Distance(band.from, band.to) >= kShortest))
    view.Complain("from_mm and to_mm must be at least 5 mm apart", ErrorCode::kSceneInvalid);
  return band;
}

scene::ModelSheet ReadSheet(const JsonView& view, const math::Vec3& origin) {
  view.AllowOnly({"name", "about", "centre_mm", "half_mm", "spacing_mm", "circle_mm", "prestrain"});
  scene::ModelSheet sheet;
  sheet.name = view.Text("name");
  sheet.centre = origin + ReadPointMm(view, "centre_mm");
  const auto half = view.Numbers("half_mm", 2, range::kSheetHalfMm);
  sheet.half = {1e-3 * half[0], 1e-3 * half[1], 0};
  sheet.spacing = 1e-3 * view.NumberOr("spacing_mm", 1e3 * sheet.spacing, range::kSheetSpacingMm);
  sheet.circle = 1e-3 * view.Number("circle_mm", range::kCircleMm);
  sheet.prestrain = view.NumberOr("prestrain", 0.0, range::kPrestrain);
  const double least = std::min(sheet.half.x, sheet.half.y);
  if (!(sheet.circle <= least - 2 * sheet.spacing))
    view.Complain("circle_mm must stay two spacings clear of the border", ErrorCode::kSceneInvalid);
  return sheet;
}

/// A grid of triangles that faces up, its border in a region of its own.
patient::Organ MakeSheet(const scene::ModelSheet& sheet) {
  patient::Organ organ{sheet.name, {}, {{kHeldRegion, {}}}};
  const auto count = [&](double half) { return base::RoundTo<std::uint32_t>(2 * half / sheet.spacing); };
  const std::uint32_t columns = count(sheet.half.x), rows = count(sheet.half.y);
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i <= columns; ++i) {
      if (i == 0 || j == 0 || i == columns || j == rows)
        organ.regions[0].vertices.push_back(static_cast<std::uint32_t>(organ.mesh.positions.size()));
      organ.mesh.positions.push_back(sheet.centre + math::Vec3{sheet.half.x * (2.0 * i / columns - 1),
                                                               sheet.half.y * (2.0 * j / rows - 1), 0});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * (columns + 1) + i; };
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      // diagonals take turns, so that no direction is stiffer
      if ((i + j) % 2 == 0) {
        organ.mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        organ.mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      } else {
        organ.mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        organ.mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  return organ;
}

}  // namespace

void ReadTissueModel(const JsonView& view, scene::Scene& scene) {
  view.AllowOnly({"about", "at_mm", "tubes", "bands", "sheets"});
  const math::Vec3 origin = view.Has("at_mm") ? ReadPointMm(view, "at_mm") : math::Vec3{};
  scene::ModelSetup model;
  patient::Patient& made = scene.patient;
  made.name = "model";
  made.provenance = "made by the scene";
  const auto limit = [&](std::size_t count, std::size_t most, const char* what) {
    if (count > most)
      view.Complain("a model may have at most " + std::to_string(most) + " " + what,
                    ErrorCode::kSceneInvalid);
  };
  if (view.Has("tubes")) {
    for (const JsonView& one : view.Array("tubes")) {
      made.tubes.push_back(ReadTube(one, origin));
      CheckName(one, made.tubes, "tube");
    }
  }
  limit(made.tubes.size(), kMostTubes, "tubes");
  if (view.Has("bands")) {
    for (const JsonView& one : view.Array("bands")) {
      model.bands.push_back(ReadBand(one, origin));
      CheckName(one, model.bands, "band");
    }
  }
  limit(model.bands.size(), kMostBands, "bands");
  if (view.Has("sheets")) {
    for (const JsonView& one : view.Array("sheets")) {
      model.sheets.push_back(ReadSheet(one, origin));
      CheckName(one, model.sheets, "sheet");
    }
  }
  limit(model.sheets.size(), kMostSheets, "sheets");
  if (!made.tubes.empty() && !model.sheets.empty())
    view.Complain("a model has either tubes or sheets: tools push tubes, and pass through sheets",
                  ErrorCode::kSceneInvalid);
  for (const scene::ModelSheet& sheet : model.sheets) {
    if (sheet.half.x > 0) made.organs.push_back(MakeSheet(sheet));
  }
  if (made.tubes.empty() && model.bands.empty() && model.sheets.empty())
    view.Complain("a model needs tubes, bands or sheets; without them leave it out",
                  ErrorCode::kSceneInvalid);
  scene.model = std::move(model);
  scene::OperationSetup operation;
  operation.fat_spacing = 0;
  operation.procedure = procedures::FindProcedure(procedures::kTissueTask);
  scene.operation = operation;
}

}  // namespace trocar::files
