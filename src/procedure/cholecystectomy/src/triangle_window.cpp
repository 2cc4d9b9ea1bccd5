// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triangle_window.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "trocar/math/elementary.h"

namespace trocar::cholecystectomy {

using math::Vec3;
namespace {

constexpr double kPatch = 0.001;  // side of a patch: half of a lobule's radius [m]

/// A place in the triangle's plane [m].
struct Flat {
  double x = 0, y = 0;
};

/// The plane through where the ducts meet and their far ends.
class Plane {
 public:
  explicit Plane(const TriangleBorders& borders)
      : origin_(borders.cystic_duct.front()),
        x_(math::Normalized(borders.cystic_duct.back() - origin_)),
        y_(math::Normalized(math::Cross(math::Cross(x_, borders.hepatic_duct.back() - origin_), x_))) {}
  Flat Project(const Vec3& p) const { return {math::Dot(p - origin_, x_), math::Dot(p - origin_, y_)}; }

 private:
  Vec3 origin_, x_, y_;
};

double DistanceToSegment(const Flat& p, const Flat& a, const Flat& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double along =
      squared > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
  return math::Hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

bool IsInside(std::span<const Flat> outline, const Flat& p) {
  bool is_inside = false;
  for (std::size_t i = 0, before = outline.size() - 1; i < outline.size(); before = i++) {
    const Flat &a = outline[before], &b = outline[i];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) is_inside = !is_inside;
  }
  return is_inside;
}

/// Middles of the patches inside of an outline.
std::vector<Flat> CutIntoPatches(std::span<const Flat> outline) {
  const auto [left, right] = std::minmax_element(outline.begin(), outline.end(),
                                                 [](const Flat& a, const Flat& b) { return a.x < b.x; });
  const auto [low, high] = std::minmax_element(outline.begin(), outline.end(),
                                               [](const Flat& a, const Flat& b) { return a.y < b.y; });
  std::vector<Flat> patches;
  for (double y = low->y + 0.5 * kPatch; y < high->y; y += kPatch) {
    for (double x = left->x + 0.5 * kPatch; x < right->x; x += kPatch) {
      if (IsInside(outline, {x, y})) patches.push_back({x, y});
    }
  }
  return patches;
}

}  // namespace

TriangleWindow::TriangleWindow(const TriangleBorders& borders, std::span<const TriangleFat> fat,
                               const TriangleWindowSettings& settings) {
  if (borders.cystic_duct.size() < 2 || borders.hepatic_duct.size() < 2) return;
  const Plane plane(borders);
  std::vector<Flat> outline, kept;
  for (const Vec3& p : borders.cystic_duct) outline.push_back(plane.Project(p));
  for (std::size_t i = borders.hepatic_duct.size(); i-- > 0;)
    outline.push_back(plane.Project(borders.hepatic_duct[i]));
  for (const Vec3& p : borders.main_ducts) kept.push_back(plane.Project(p));

  const std::vector<Flat> all = CutIntoPatches(outline);
  std::vector<Flat> patches;
  std::copy_if(all.begin(), all.end(), std::back_inserter(patches), [&](const Flat& patch) {
    return std::none_of(kept.begin(), kept.end(), [&](const Flat& duct) {
      return math::Hypot(patch.x - duct.x, patch.y - duct.y) < settings.kept_fat;
    });
  });
  if (patches.empty()) patches = all;
  area_ = kPatch * kPatch * static_cast<double>(patches.size());

  for (const TriangleFat& strand : fat) {
    const Vec3 middle = 0.5 * (strand.ends[0] + strand.ends[1]);
    const bool is_sheath = std::any_of(
        borders.main_arteries.begin(), borders.main_arteries.end(),
        [&](const Vec3& artery) { return math::Distance(middle, artery) < settings.kept_sheath; });
    if (is_sheath) continue;
    const Flat a = plane.Project(strand.ends[0]), b = plane.Project(strand.ends[1]);
    const bool reaches_over = std::any_of(patches.begin(), patches.end(), [&](const Flat& patch) {
      return DistanceToSegment(patch, a, b) < settings.lobule_radius;
    });
    if (reaches_over) strands_.push_back(strand.strand);
  }
}

double TriangleWindow::CalcClearedShare(std::span<const std::uint8_t> is_intact) const noexcept {
  if (strands_.empty()) return 1.0;
  const auto left = std::count_if(strands_.begin(), strands_.end(),
                                  [&](std::uint32_t strand) { return is_intact[strand] != 0; });
  return 1.0 - static_cast<double>(left) / static_cast<double>(strands_.size());
}

}  // namespace trocar::cholecystectomy
