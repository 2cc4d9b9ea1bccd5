// SPDX-License-Identifier: Apache-2.0
#include "tissue_model_file.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "scene_objects.h"

namespace trocar::session {
namespace {

using core::ErrorCode;
using core::JsonView;

constexpr core::NumberRange kSpacing{0.5, 20.0};  // of nodes [mm]
constexpr double kShortest = 0.005;               // of a duct or band [m]
constexpr std::size_t kMostTubes = 8, kMostBands = 64;

template <typename Things>
void CheckName(const JsonView& view, const Things& things, const char* what) {
  const auto same = [&](const auto& one) { return one.name == things.back().name; };
  if (std::any_of(things.begin(), things.end() - 1, same))
    view.Complain("another " + std::string(what) + " is called \"" + things.back().name +
                      "\" already; names must differ",
                  ErrorCode::kSceneInvalid);
}

/// Both ends leave the scene, so that they are held where they are.
anatomy::Tube ReadTube(const JsonView& view, const Vec3& origin) {
  view.AllowOnly({"name", "about", "kind", "from_mm", "to_mm", "radius_mm", "sag_mm", "spacing_mm"});
  anatomy::Tube tube;
  tube.name = view.Text("name");
  const std::string kind = view.TextOr("kind", "duct");
  if (kind != "duct" && kind != "artery") view.Complain("kind is duct or artery", ErrorCode::kUnknownName);
  tube.kind = kind == "artery" ? anatomy::TubeKind::kArtery : anatomy::TubeKind::kDuct;
  const Vec3 from = origin + ReadPointMm(view, "from_mm"), to = origin + ReadPointMm(view, "to_mm");
  const double radius = 0.001 * view.Number("radius_mm", {0.3, 10.0});
  const double sag = 0.001 * view.NumberOr("sag_mm", 0.0, {0.0, 50.0});
  const double spacing = 0.001 * view.NumberOr("spacing_mm", 2.5, kSpacing);
  const double length = math::Distance(from, to);
  if (!(length >= kShortest))
    view.Complain("from_mm and to_mm must be at least 5 mm apart", ErrorCode::kSceneInvalid);
  const int pieces = std::max(4, static_cast<int>(std::lround(length / spacing)));
  for (int i = 0; i <= pieces; ++i) {
    const double s = static_cast<double>(i) / pieces;
    tube.line.points.push_back(math::Lerp(from, to, s) - Vec3{0, 0, 4 * sag * s * (1 - s)});
    tube.line.radii.push_back(radius);
  }
  return tube;
}

ModelBand ReadBand(const JsonView& view, const Vec3& origin) {
  view.AllowOnly({"name", "about", "colour", "from_mm", "to_mm", "radius_mm"});
  ModelBand band;
  band.name = view.Text("name");
  const std::string colour = view.TextOr("colour", "red");
  const auto found = FindColour(colour);
  if (!found)
    view.Complain("there is no colour \"" + colour + "\"; see docs/tasks.md", ErrorCode::kUnknownName);
  band.colour = found.value_or(ObjectColour::kRed);
  band.from = origin + ReadPointMm(view, "from_mm");
  band.to = origin + ReadPointMm(view, "to_mm");
  band.radius = 0.001 * view.NumberOr("radius_mm", 1e3 * band.radius, {0.1, 5.0});
  if (!(math::Distance(band.from, band.to) >= kShortest))
    view.Complain("from_mm and to_mm must be at least 5 mm apart", ErrorCode::kSceneInvalid);
  return band;
}

}  // namespace

void ReadTissueModel(const JsonView& view, Scene& scene) {
  view.AllowOnly({"about", "at_mm", "tubes", "bands"});
  const Vec3 origin = view.Has("at_mm") ? ReadPointMm(view, "at_mm") : Vec3{};
  ModelSetup model;
  anatomy::Patient& made = scene.patient;
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
  if (made.tubes.empty() && model.bands.empty())
    view.Complain("a model needs tubes or bands; without them leave it out", ErrorCode::kSceneInvalid);
  scene.model = std::move(model);
  OperationSetup operation;
  operation.fat_spacing = 0;
  scene.operation = operation;
}

}  // namespace trocar::session
