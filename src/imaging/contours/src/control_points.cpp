// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/control_points.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "trocar/base/to_integer.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/roles/roles.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using base::ErrorCode;
using host::JsonView;
using roles::TissueRole;

constexpr int kVersion = 1;
constexpr const char* kFormat = "trocar-control-points";
constexpr std::size_t kMinContourPoints = 3;
constexpr std::size_t kMinTubePoints = 2;
constexpr double kMaxSide = 16384;  // pixels

struct Direction {
  const char* name;
  int axis;
  double sign;
};
constexpr Direction kDirections[] = {{"left", 0, 1.0},      {"right", 0, -1.0},   {"superior", 1, 1.0},
                                     {"inferior", 1, -1.0}, {"anterior", 2, 1.0}, {"posterior", 2, -1.0}};

const Direction* FindDirection(std::string_view name) {
  for (const Direction& direction : kDirections) {
    if (direction.name == name) return &direction;
  }
  return nullptr;
}

std::string NumberText(double value) {
  std::string text = host::FormatJson(nlohmann::json(std::round(value * 100.0) / 100.0));
  if (text.size() > 2 && text.ends_with(".0")) text.resize(text.size() - 2);
  return text;
}

void CheckInside(const ControlPoints& points, const JsonView& view, const Vec2& p) {
  if (p.x >= 0 && p.y >= 0 && p.x <= points.width - 1 && p.y <= points.height - 1) return;
  view.Complain("control point (" + NumberText(p.x) + ", " + NumberText(p.y) + ") lies outside the " +
                    std::to_string(points.width) + " x " + std::to_string(points.height) +
                    " image; move it inside or correct width and height",
                ErrorCode::kControlPointOutside);
}

std::vector<std::vector<Vec2>> ReadPolygons(const ControlPoints& points, const JsonView& slice,
                                            std::string_view key, const std::string& where) {
  std::vector<std::vector<Vec2>> polygons;
  for (const JsonView& polygon : slice.Array(key)) {
    std::vector<Vec2> corners;
    for (const JsonView& corner : polygon.Elements()) {
      const auto xy = corner.AsNumbers(2);
      corners.push_back({xy[0], xy[1]});
      CheckInside(points, corner, corners.back());
    }
    std::set<std::pair<double, double>> distinct;
    for (const Vec2& p : corners) distinct.insert({p.x, p.y});
    if (distinct.size() < kMinContourPoints) {
      polygon.Complain(where + ": this contour has " + std::to_string(distinct.size()) +
                           " different points; a closed curve needs at least 3",
                       ErrorCode::kContourTooShort);
    }
    polygons.push_back(std::move(corners));
  }
  return polygons;
}

std::vector<Vec2> ReadOpenContour(const ControlPoints& points, const JsonView& slice) {
  std::vector<Vec2> open;
  for (const JsonView& corner : slice.Array("open")) {
    const auto xy = corner.AsNumbers(2);
    open.push_back({xy[0], xy[1]});
    CheckInside(points, corner, open.back());
  }
  return open;
}

Structure ReadStructure(const ControlPoints& points, const JsonView& view, Completeness completeness) {
  view.AllowOnly({"name", "triangle_budget", "reference_label", "reference_left_out", "adaption", "slices"});
  Structure structure;
  structure.name = view.Text("name");
  if (structure.name.empty()) view.Complain("needs a name");
  structure.triangle_budget = view.Integer("triangle_budget", {100, 1000000});
  structure.reference_label = view.IntegerOr("reference_label", 0, {0, images::kLargestLabel});
  if (view.Has("reference_left_out")) {
    const auto slices = view.Numbers("reference_left_out", 2, {-1e6, 1e6});
    structure.reference_left_out = {base::TruncateTo<int>(slices[0]), base::TruncateTo<int>(slices[1])};
  }
  if (view.Has("adaption")) {
    const JsonView adaption = view.Object("adaption");
    adaption.AllowOnly({"max_shift_px", "blur_px", "min_gradient", "nearness", "smoothness",
                        "skipped_shift_px", "insert_points"});
    EdgeAdaptionSettings& s = structure.adaption;
    s.max_shift_px = adaption.NumberOr("max_shift_px", s.max_shift_px, {0.0, 30.0});
    s.blur_px = adaption.NumberOr("blur_px", s.blur_px, {0.3, 10.0});
    s.min_gradient = adaption.NumberOr("min_gradient", s.min_gradient, {0.0, 1000.0});
    s.nearness = adaption.NumberOr("nearness", s.nearness, {0.0, 1.0});
    s.smoothness = adaption.NumberOr("smoothness", s.smoothness, {0.0, 100.0});
    s.skipped_shift_px = adaption.NumberOr("skipped_shift_px", s.skipped_shift_px, {0.0, 30.0});
    s.inserts_points = adaption.BooleanOr("insert_points", s.inserts_points);
  }
  for (const JsonView& slice : view.Array("slices")) {
    slice.AllowOnly({"slice", "contours", "holes", "open"});
    SliceContours contours;
    contours.slice = slice.Integer("slice");
    if (contours.slice < points.first_slice || contours.slice > points.last_slice) {
      slice.Complain("slice " + std::to_string(contours.slice) +
                     " is not between first_slice and last_slice");
    }
    if (!structure.slices.empty() && contours.slice <= structure.slices.back().slice) {
      slice.Complain("slices must ascend; slice " + std::to_string(contours.slice) + " follows " +
                     std::to_string(structure.slices.back().slice));
    }
    const std::string where = structure.name + ", slice " + std::to_string(contours.slice);
    contours.contours = ReadPolygons(points, slice, "contours", where);
    if (slice.Has("holes")) contours.holes = ReadPolygons(points, slice, "holes", where);
    if (slice.Has("open")) contours.open = ReadOpenContour(points, slice);
    const bool is_draft = completeness == Completeness::kDraft;
    if (!is_draft && !contours.open.empty()) {
      slice.Complain(where + " has a contour that is not closed; close or drop it in the contour window",
                     ErrorCode::kContourTooShort);
    }
    if (contours.contours.empty() && !(is_draft && contours.holes.empty() && !contours.open.empty())) {
      slice.Complain(where + " has no contour; remove the slice or place points",
                     ErrorCode::kContourTooShort);
    }
    structure.slices.push_back(std::move(contours));
  }
  if (structure.slices.size() < 2 && completeness == Completeness::kPatient) {
    view.Complain("a volume needs contours in at least two slices", ErrorCode::kContourTooShort);
  }
  return structure;
}

TubePoints ReadTube(const ControlPoints& points, const JsonView& view) {
  view.AllowOnly({"name", "kind", "from", "to", "seen", "points"});
  TubePoints tube;
  tube.name = view.Text("name");
  if (tube.name.empty()) view.Complain("needs a name");
  tube.kind = view.Text("kind");
  if (tube.kind != NameOf(TissueRole::kDuct) && tube.kind != NameOf(TissueRole::kArtery))
    view.Complain("kind must be \"duct\" or \"artery\"");
  tube.from = view.TextOr("from", "");
  tube.to = view.TextOr("to", "");
  tube.is_seen = view.BooleanOr("seen", true);
  for (const JsonView& point : view.Array("points")) {
    const auto numbers = point.AsNumbers(4);
    tube.points.push_back({numbers[0], {numbers[1], numbers[2]}, numbers[3]});
    CheckInside(points, point, tube.points.back().pixel);
    if (numbers[0] < points.first_slice || numbers[0] > points.last_slice) {
      point.Complain("its slice is not between first_slice and last_slice");
    }
    if (!(numbers[3] > 0.0 && numbers[3] < 50.0)) point.Complain("radius_mm must lie between 0 and 50");
  }
  if (tube.points.size() < kMinTubePoints) {
    view.Complain("tube " + tube.name + " needs at least two points", ErrorCode::kContourTooShort);
  }
  return tube;
}

void CheckPattern(const JsonView& root, const std::string& pattern) {
  const auto open = pattern.find("{slice");
  const bool is_usable = open != std::string::npos && pattern.find('}', open) != std::string::npos &&
                         pattern.find('/') == std::string::npos && pattern.find('\\') == std::string::npos;
  if (!is_usable) root.Complain("image_pattern must be a file name with {slice} or {slice:04} in it");
}

std::string FormatPolygon(const std::vector<Vec2>& polygon) {
  std::string text = "[";
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    text += (k == 0 ? "[" : ", [") + NumberText(polygon[k].x) + ", " + NumberText(polygon[k].y) + "]";
  }
  return text + "]";
}

std::string FormatPolygons(const std::vector<std::vector<Vec2>>& polygons) {
  std::string text = "[";
  for (std::size_t i = 0; i < polygons.size(); ++i) text += (i == 0 ? "" : ", ") + FormatPolygon(polygons[i]);
  return text + "]";
}

std::string Quoted(const std::string& text) {
  return host::FormatJson(nlohmann::json(text));
}

}  // namespace

const Structure* ControlPoints::FindStructure(std::string_view structure_name) const {
  for (const Structure& structure : structures) {
    if (structure.name == structure_name) return &structure;
  }
  return nullptr;
}

const LandmarkPoint* ControlPoints::FindLandmark(std::string_view landmark_name) const {
  for (const LandmarkPoint& landmark : landmarks) {
    if (landmark.name == landmark_name) return &landmark;
  }
  return nullptr;
}

std::array<std::array<double, 3>, 3> AxisDirections(const ControlPoints& points) {
  std::array<std::array<double, 3>, 3> directions = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const Direction* direction = FindDirection(points.axes[i]);
    TROCAR_ASSERT(direction != nullptr);
    directions[i][direction->axis] = direction->sign;
  }
  return directions;
}

base::Result<ControlPoints> ParseControlPoints(std::string_view text, std::string_view source,
                                               Completeness completeness) {
  auto document = host::JsonDocument::Parse(text, std::string(source), host::kLargeJson);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly(
      {"format", "version", "name", "provenance", "images", "origin", "structures", "tubes", "landmarks"});
  ControlPoints points;
  if (root.Text("format") != kFormat) root.Complain(std::string("format must be \"") + kFormat + "\"");
  root.Integer("version", {kVersion, kVersion});
  points.name = root.Text("name");
  points.provenance = root.Text("provenance");

  const JsonView images = root.Object("images");
  images.AllowOnly(
      {"pattern", "first_slice", "last_slice", "width", "height", "pixel_mm", "slice_mm", "axes"});
  points.image_pattern = images.TextOr("pattern", "");
  if (images.Has("pattern")) CheckPattern(images, points.image_pattern);
  points.first_slice = images.Integer("first_slice", {0, 1e6});
  points.last_slice = images.Integer("last_slice", {0, 1e6});
  if (points.last_slice < points.first_slice) images.Complain("last_slice comes before first_slice");
  points.width = images.Integer("width", {2, kMaxSide});
  points.height = images.Integer("height", {2, kMaxSide});
  points.pixel_mm = images.Number("pixel_mm", {0.01, 20.0});
  points.slice_mm = images.Number("slice_mm", {0.01, 50.0});
  const JsonView axes = images.Object("axes");
  axes.AllowOnly({"column", "row", "slice"});
  points.axes = {axes.Text("column"), axes.Text("row"), axes.Text("slice")};
  std::set<int> used;
  for (const std::string& name : points.axes) {
    if (const Direction* direction = FindDirection(name)) used.insert(direction->axis);
  }
  if (used.size() != 3) {
    axes.Complain(
        "column, row and slice must be one each of left/right, superior/inferior and anterior/posterior");
  }

  if (root.Has("origin")) {
    const JsonView origin = root.Object("origin");
    origin.AllowOnly({"landmark", "world_mm"});
    points.origin_landmark = origin.Text("landmark");
    const auto place = origin.Numbers("world_mm", 3);
    std::copy(place.begin(), place.end(), points.origin_mm.begin());
  }
  std::set<std::string> names;
  for (const JsonView& view : root.Array("structures")) {
    points.structures.push_back(ReadStructure(points, view, completeness));
    if (!names.insert(points.structures.back().name).second) view.Complain("this name is used twice");
  }
  if (points.structures.empty() && completeness == Completeness::kPatient)
    root.Complain("there are no structures");
  if (root.Has("tubes")) {
    for (const JsonView& view : root.Array("tubes")) {
      points.tubes.push_back(ReadTube(points, view));
      if (!names.insert(points.tubes.back().name).second) view.Complain("this name is used twice");
    }
  }
  if (root.Has("landmarks")) {
    for (const JsonView& view : root.Array("landmarks")) {
      view.AllowOnly({"name", "point"});
      const auto numbers = view.Numbers("point", 3);
      points.landmarks.push_back({view.Text("name"), numbers[0], {numbers[1], numbers[2]}});
      CheckInside(points, view, points.landmarks.back().pixel);
    }
  }
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return points;
}

base::Result<ControlPoints> ReadControlPoints(const std::filesystem::path& path, Completeness completeness) {
  const auto text = host::ReadFile(path, host::kLargeJson.bytes);
  if (!text.ok()) return text.error();
  return ParseControlPoints(*text, path.string(), completeness);
}

std::string FormatControlPoints(const ControlPoints& points) {
  const auto exact = [](double value) { return host::FormatJson(nlohmann::json(value)); };
  std::string text = "{\n";
  text += "\"format\": \"" + std::string(kFormat) + "\",\n\"version\": " + std::to_string(kVersion) + ",\n";
  text += "\"name\": " + Quoted(points.name) + ",\n\"provenance\": " + Quoted(points.provenance) + ",\n";
  text += "\"images\": {";
  if (!points.image_pattern.empty()) text += "\"pattern\": " + Quoted(points.image_pattern) + ", ";
  text += "\"first_slice\": " + std::to_string(points.first_slice) +
          ", \"last_slice\": " + std::to_string(points.last_slice) +
          ",\n  \"width\": " + std::to_string(points.width) +
          ", \"height\": " + std::to_string(points.height) + ", \"pixel_mm\": " + exact(points.pixel_mm) +
          ", \"slice_mm\": " + exact(points.slice_mm) +
          ",\n  \"axes\": {\"column\": " + Quoted(points.axes[0]) + ", \"row\": " + Quoted(points.axes[1]) +
          ", \"slice\": " + Quoted(points.axes[2]) + "}},\n";
  if (!points.origin_landmark.empty()) {
    text += "\"origin\": {\"landmark\": " + Quoted(points.origin_landmark) + ", \"world_mm\": [" +
            exact(points.origin_mm[0]) + ", " + exact(points.origin_mm[1]) + ", " +
            exact(points.origin_mm[2]) + "]},\n";
  }
  text += "\"structures\": [";
  for (std::size_t i = 0; i < points.structures.size(); ++i) {
    const Structure& s = points.structures[i];
    text += (i == 0 ? "\n  {\"name\": " : ",\n  {\"name\": ") + Quoted(s.name) +
            ", \"triangle_budget\": " + std::to_string(s.triangle_budget) +
            ", \"reference_label\": " + std::to_string(s.reference_label) + ", \"reference_left_out\": [" +
            std::to_string(s.reference_left_out[0]) + ", " + std::to_string(s.reference_left_out[1]) +
            "],\n   \"adaption\": {\"max_shift_px\": " + exact(s.adaption.max_shift_px) +
            ", \"blur_px\": " + exact(s.adaption.blur_px) +
            ", \"min_gradient\": " + exact(s.adaption.min_gradient) +
            ", \"nearness\": " + exact(s.adaption.nearness) +
            ", \"smoothness\": " + exact(s.adaption.smoothness) +
            ", \"skipped_shift_px\": " + exact(s.adaption.skipped_shift_px) +
            (s.adaption.inserts_points ? "" : ", \"insert_points\": false") + "},\n   \"slices\": [";
    for (std::size_t k = 0; k < s.slices.size(); ++k) {
      text += (k == 0 ? "\n    {\"slice\": " : ",\n    {\"slice\": ") + std::to_string(s.slices[k].slice) +
              ", \"contours\": " + FormatPolygons(s.slices[k].contours);
      if (!s.slices[k].holes.empty()) text += ", \"holes\": " + FormatPolygons(s.slices[k].holes);
      if (!s.slices[k].open.empty()) text += ", \"open\": " + FormatPolygon(s.slices[k].open);
      text += "}";
    }
    text += "]}";
  }
  text += "],\n\"tubes\": [";
  for (std::size_t i = 0; i < points.tubes.size(); ++i) {
    const TubePoints& t = points.tubes[i];
    text += (i == 0 ? "\n  {\"name\": " : ",\n  {\"name\": ") + Quoted(t.name) +
            ", \"kind\": " + Quoted(t.kind) + ", \"from\": " + Quoted(t.from) + ", \"to\": " + Quoted(t.to) +
            ", \"seen\": " + (t.is_seen ? "true" : "false") + ",\n   \"points\": [";
    for (std::size_t k = 0; k < t.points.size(); ++k) {
      text += (k == 0 ? "[" : ", [") + NumberText(t.points[k].slice) + ", " +
              NumberText(t.points[k].pixel.x) + ", " + NumberText(t.points[k].pixel.y) + ", " +
              NumberText(t.points[k].radius_mm) + "]";
    }
    text += "]}";
  }
  text += "],\n\"landmarks\": [";
  for (std::size_t i = 0; i < points.landmarks.size(); ++i) {
    const LandmarkPoint& l = points.landmarks[i];
    text += (i == 0 ? "\n  {\"name\": " : ",\n  {\"name\": ") + Quoted(l.name) + ", \"point\": [" +
            NumberText(l.slice) + ", " + NumberText(l.pixel.x) + ", " + NumberText(l.pixel.y) + "]}";
  }
  return text + "]\n}\n";
}

base::Status WriteControlPoints(const std::filesystem::path& path, const ControlPoints& points) {
  return host::WriteFile(path, FormatControlPoints(points));
}

}  // namespace trocar::contours
