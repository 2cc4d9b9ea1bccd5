// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_workspace.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <system_error>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/contours/contour_propagation.h"
#include "trocar/contours/reference_judge.h"
#include "trocar/host/safe_file.h"
#include "trocar/math/vector.h"
#include "trocar/meshing/volume_mesher.h"
#include "trocar/roles/roles.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using base::Error;
using base::ErrorCode;
using roles::OrganRole;

constexpr double kPathTolerance = 1.0;  // pixels

Error Refused(std::string why) {
  return {ErrorCode::kEditRefused, std::move(why)};
}

/// Contours for a series that nobody has worked on. They do not say where its files lie: such a folder often
/// carries a person's name, and what is written here goes on into the patient.
ControlPoints BeginPoints(const images::ImageSeriesInfo& info) {
  ControlPoints points;
  points.name = "Patient from contours";
  points.provenance = "Contours placed in Trocar's contour window";
  points.image_pattern = info.pattern;
  points.first_slice = info.slice_numbers.front(), points.last_slice = info.slice_numbers.back();
  points.width = info.width, points.height = info.height;
  points.pixel_mm = info.pixel_mm, points.slice_mm = info.slice_mm;
  points.axes = info.axes;
  for (const auto& [name, triangles] :
       {std::pair(NameOf(OrganRole::kLiver), meshing::kLiverTriangles),
        std::pair(NameOf(OrganRole::kGallbladder), meshing::kGallbladderTriangles)}) {
    Structure structure;
    structure.name = name;
    structure.triangle_budget = triangles;
    points.structures.push_back(std::move(structure));
  }
  return points;
}

base::Status CheckReference(const images::LabelVolume& reference, const ControlPoints& points) {
  // the judge knows whether labels cover a series; it wants a label that occurs, and no mesh
  for (const std::int32_t label : reference.labels) {
    if (label == 0) continue;
    const auto judged = Judge(reference, points, label, {}, {0, -1});
    if (!judged.ok()) return judged.error();
    return {};
  }
  return Error{ErrorCode::kLabelsMismatch, "the reference holds no label at all; name another file"};
}

}  // namespace

ContourWorkspace::ContourWorkspace() = default;
ContourWorkspace::ContourWorkspace(ContourWorkspace&&) noexcept = default;
ContourWorkspace& ContourWorkspace::operator=(ContourWorkspace&&) noexcept = default;
ContourWorkspace::~ContourWorkspace() = default;

base::Result<ContourWorkspace> ContourWorkspace::Open(const WorkspaceOptions& options,
                                                      const images::Progress& progress) {
  ContourWorkspace workspace;
  workspace.options_ = options;
  images::ImageSeriesOptions series = options.series;
  std::optional<ControlPoints> points;
  std::error_code failure;
  if (!options.points.empty() && std::filesystem::exists(options.points, failure)) {
    auto read = ReadControlPoints(options.points, Completeness::kDraft);
    if (!read.ok()) return read.error();
    points = std::move(*read);
    workspace.saved_text_ = FormatControlPoints(*points);
    // pictures know neither their size nor how they lie; volumes know better than any file beside them
    if (!points->image_pattern.empty()) {
      series.pattern = points->image_pattern;
      series.pixel_mm = points->pixel_mm, series.slice_mm = points->slice_mm;
      series.axes = points->axes;
    }
  }
  auto opened = images::ImageSeries::Open(options.images, series, progress);
  if (!opened.ok()) return opened.error();
  workspace.series_ = std::move(*opened);
  const images::ImageSeriesInfo& info = workspace.series_->Info();
  if (points && (points->width != info.width || points->height != info.height)) {
    return Error{ErrorCode::kImageSizeDiffers,
                 options.points.filename().string() + " was drawn on pictures of " +
                     std::to_string(points->width) + " x " + std::to_string(points->height) +
                     " pixels, these have " + std::to_string(info.width) + " x " +
                     std::to_string(info.height) + "; name its own pictures"};
  }
  workspace.document_ = std::make_unique<ContourDocument>(points ? std::move(*points) : BeginPoints(info));
  workspace.store_ = std::make_shared<SliceStore>([source = *workspace.series_](int slice) {
    return source.ReadSlice(slice, source.Info().suggested_window);
  });
  workspace.fits_ = std::make_shared<SliceFits>(workspace.store_);
  if (!options.reference.empty()) {
    auto reference = images::ReadLabelVolume(options.reference);
    if (!reference.ok()) return reference.error();
    if (auto status = CheckReference(*reference, workspace.document_->Points()); !status.ok()) {
      return status.error();
    }
    workspace.reference_ = std::move(*reference);
  }
  return workspace;
}

void ContourWorkspace::Replace(ControlPoints points) {
  document_ = std::make_unique<ContourDocument>(std::move(points));
  document_->MarkUnsaved();
  scissors_seed_.reset();
}

base::Status ContourWorkspace::Save(const std::filesystem::path& path) {
  const std::string text = document_->Text();
  if (auto status = host::WriteFile(path, text); !status.ok()) return status;
  options_.points = path;
  saved_text_ = text;
  document_->MarkSaved();
  return {};
}

int ContourWorkspace::StepSlice(int slice, int steps) const {
  const auto& numbers = Slices();
  auto nearest = std::lower_bound(numbers.begin(), numbers.end(), slice);
  if (nearest == numbers.end() || (nearest != numbers.begin() && slice - *(nearest - 1) < *nearest - slice)) {
    --nearest;
  }
  const auto index = std::clamp<std::ptrdiff_t>((nearest - numbers.begin()) + steps, 0,
                                                static_cast<std::ptrdiff_t>(numbers.size()) - 1);
  return numbers[static_cast<std::size_t>(index)];
}

base::Result<images::ColorImage> ContourWorkspace::PictureInWindow(
    int slice, const images::DisplayWindow& window) const {
  return series_->ReadSlice(slice, window);
}

base::Result<std::shared_ptr<const SliceFit>> ContourWorkspace::Fit(int structure, int slice,
                                                                    FitEffort effort) {
  const SliceContours& contours = document_->At(structure, slice);
  if (contours.contours.empty()) return std::make_shared<const SliceFit>();
  return fits_->Find(structure, contours, document_->Points().structures[structure].adaption, effort);
}

MeshRequest ContourWorkspace::MakeMeshRequest(int structure) const {
  const ControlPoints& points = document_->Points();
  TROCAR_ASSERT(structure >= 0 && structure < static_cast<int>(points.structures.size()));
  MeshRequest request{structure, points.structures[structure], points.pixel_mm, points.slice_mm};
  for (SliceContours& slice : request.content.slices) slice.open.clear();
  return request;
}

GrowthRequest ContourWorkspace::MakeGrowthRequest(int structure, int slice, const Vec2& click) const {
  return contours::MakeGrowthRequest(*series_, document_->Points(), structure, slice, click);
}

base::Result<Propagation> ContourWorkspace::Propagate(int structure, int from, int to, bool is_replacing) {
  const SliceContours source = document_->At(structure, from);
  if (source.contours.empty()) {
    return Refused("slice " + std::to_string(from) + " has no closed contour to carry on; close one first");
  }
  const auto& numbers = Slices();
  const auto find = [&](int slice) { return std::find(numbers.begin(), numbers.end(), slice); };
  const auto begin = find(from), end = find(to);
  if (begin == numbers.end() || end == numbers.end() || begin == end) {
    return Refused("there is no further slice to carry the contour to");
  }
  if (!document_->At(structure, to).contours.empty() && !is_replacing) {
    return Refused("slice " + std::to_string(to) +
                   " has contours already; clear it there first (Ctrl+Delete), or go on from it");
  }
  PropagationSettings settings;
  settings.adaption = document_->Points().structures[structure].adaption;
  Propagation result{to, 1.0, source.contours.size() + source.holes.size()};
  std::vector<std::vector<Vec2>> contours = source.contours, holes = source.holes;
  // slice by slice, as far apart as the pictures are
  const std::ptrdiff_t way = end > begin ? 1 : -1;
  for (auto here = begin; here != end; here += way) {
    const auto field = store_->Field(*here, settings.adaption.blur_px);
    if (!field.ok()) return field.error();
    const auto next = store_->Field(*(here + way), settings.adaption.blur_px);
    if (!next.ok()) return next.error();
    for (auto* group : {&contours, &holes}) {
      for (auto& polygon : *group) {
        PropagatedContour carried = PropagateContour(**field, **next, polygon, settings);
        for (const double c : carried.confidence) result.confidence = std::min(result.confidence, c);
        polygon = std::move(carried.points);
      }
    }
  }
  if (auto status = document_->SetContours(structure, to, std::move(contours), std::move(holes),
                                           "carry the contours to slice " + std::to_string(to));
      !status.ok()) {
    return status.error();
  }
  return result;
}

base::Result<std::vector<Vec2>> ContourWorkspace::FindScissorsPath(int structure, int slice,
                                                                   const Vec2& target) {
  const auto& open = document_->At(structure, slice).open;
  if (open.empty()) return std::vector<Vec2>{target};
  if (scissors_ == nullptr || scissors_slice_ != slice) {
    const auto picture = store_->Picture(slice);
    if (!picture.ok()) return picture.error();
    scissors_ = std::make_unique<IntelligentScissors>(**picture);
    scissors_slice_ = slice;
    scissors_seed_.reset();
  }
  if (scissors_seed_ != open.back()) {
    scissors_->SetSeed(open.back());
    scissors_seed_ = open.back();
  }
  return scissors_->PathTo(target);
}

base::Status ContourWorkspace::FollowEdge(int structure, int slice, const Vec2& target) {
  auto path = FindScissorsPath(structure, slice, target);
  if (!path.ok()) return path.error();
  std::vector<Vec2> few = SimplifyPath(*path, kPathTolerance);
  // the path begins at the pixel of the point that is there already
  if (!document_->At(structure, slice).open.empty() && few.size() > 1) few.erase(few.begin());
  return document_->AddPath(structure, slice, few);
}

std::vector<ContourWorkspace::ReferenceLines> ContourWorkspace::FindReference(int slice) const {
  if (!reference_) return {};
  const ControlPoints& points = document_->Points();
  const images::LabelVolume& labels = *reference_;
  std::array<double, 3> step;  // [mm]
  for (int axis = 0; axis < 3; ++axis) {
    const auto& d = labels.direction[axis];
    step[axis] = math::Norm(math::Vec3{d[0], d[1], d[2]});
  }
  const int k = base::FloorTo<int>((slice - points.first_slice + 0.5) * points.slice_mm / step[2]);
  if (k < 0 || k >= labels.size[2]) return {};
  const int width = labels.size[0], height = labels.size[1];
  const auto label_at = [&](int x, int y) -> int {
    if (x < 0 || y < 0 || x >= width || y >= height) return 0;
    return labels.labels[(static_cast<std::size_t>(k) * height + y) * width + x];
  };
  // corner (x, y) of the labels' pixels, in pixels of the picture
  const auto corner = [&](int x, int y) -> Vec2 {
    return {x * step[0] / points.pixel_mm - 0.5, y * step[1] / points.pixel_mm - 0.5};
  };
  std::set<int> present;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) present.insert(label_at(x, y));
  }
  present.erase(0);
  std::vector<ReferenceLines> result;
  for (const int label : present) {
    ReferenceLines lines{label, {}};
    // runs along rows, then along columns
    for (int y = 0; y <= height; ++y) {
      int begin = -1;
      for (int x = 0; x <= width; ++x) {
        const bool is_border = x < width && (label_at(x, y - 1) == label) != (label_at(x, y) == label);
        if (is_border && begin < 0) begin = x;
        if (!is_border && begin >= 0) lines.lines.push_back({corner(begin, y), corner(x, y)}), begin = -1;
      }
    }
    for (int x = 0; x <= width; ++x) {
      int begin = -1;
      for (int y = 0; y <= height; ++y) {
        const bool is_border = y < height && (label_at(x - 1, y) == label) != (label_at(x, y) == label);
        if (is_border && begin < 0) begin = y;
        if (!is_border && begin >= 0) lines.lines.push_back({corner(x, begin), corner(x, y)}), begin = -1;
      }
    }
    result.push_back(std::move(lines));
  }
  return result;
}

std::optional<std::array<double, 3>> FindPatientPlace(const images::ImageSeriesInfo& series, int slice,
                                                      const Vec2& p) {
  if (series.file_frame.empty() || series.slice_numbers.empty()) return std::nullopt;
  const double along[3] = {p.x * series.pixel_mm, p.y * series.pixel_mm,
                           (slice - series.slice_numbers.front()) * series.slice_mm};
  std::array<double, 3> place = series.origin_mm;
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 3; ++k) place[k] += along[axis] * series.direction[axis][k];
  }
  return place;
}

}  // namespace trocar::contours
