// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triangle_sight.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::cholecystectomy {

using math::Vec3;
namespace {

/// What is seen may lie this near behind a surface [m]: sight ends at the skin of a duct, not at its axis.
constexpr double kSkin = 0.004;
constexpr std::size_t kDuctPoints = 3;
/// So far may fat that is kept beside the hepatic duct reach beyond that [m]: a lobule is kept that touches it.
constexpr double kReach = 0.003;
constexpr int kSteps = 8;  // back to the cystic duct

}  // namespace

TriangleSight::TriangleSight(std::vector<std::uint32_t> cystic_duct, std::vector<std::uint32_t> hepatic_duct,
                             double kept_share, std::vector<TubeEntry> entries, surgery::FatLobules fat,
                             double kept_fat)
    : cystic_duct_(std::move(cystic_duct)),
      hepatic_duct_(std::move(hepatic_duct)),
      kept_share_(kept_share),
      entries_(std::move(entries)),
      enters_(entries_.size(), 1),
      points_(kDuctPoints + entries_.size()),
      fat_(std::move(fat)),
      kept_fat_(kept_fat) {}

std::span<const Vec3> TriangleSight::FindPoints(std::span<const Vec3> positions) noexcept {
  TROCAR_ASSERT(HasTriangle());
  const auto at = [&](const std::vector<std::uint32_t>& nodes, double share) {
    return positions[nodes[base::TruncateTo<std::size_t>(share * static_cast<double>(nodes.size() - 1))]];
  };
  const auto on_duct = [&](double share) {
    if (share >= kept_share_) return at(cystic_duct_, share);
    // the first node that is exposable
    const auto last = static_cast<double>(cystic_duct_.size() - 1);
    return positions[cystic_duct_[base::CeilTo<std::size_t>(kept_share_ * last)]];
  };
  const Vec3 beside = on_duct(0.5), across = at(hepatic_duct_, 0.5);
  const double apart = math::Distance(beside, across);
  const double window = apart > kept_fat_ ? 1.0 - kept_fat_ / apart : 0.0;  // of the way across
  points_[0] = on_duct(0.3);
  points_[1] = on_duct(0.7);
  points_[2] = math::Lerp(beside, across, 0.5 * window);
  const auto may_be_hidden = [&](const Vec3& p) {
    return std::any_of(hepatic_duct_.begin(), hepatic_duct_.end(), [&](std::uint32_t node) {
      return math::Distance(positions[node], p) < kept_fat_ + kReach;
    });
  };
  for (int step = kSteps - 1; step >= 0 && may_be_hidden(points_[2]); --step)
    points_[2] = math::Lerp(beside, across, 0.5 * window * step / kSteps);
  std::size_t count = kDuctPoints;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const TubeEntry& entry = entries_[i];
    if (enters_[i] != 0)
      points_[count++] = math::Lerp(positions[entry.nodes[0]], positions[entry.nodes[1]], entry.share);
  }
  return std::span(points_).first(count);
}

collision::Segment TriangleSight::LineTo(const Vec3& point, const Vec3& eye) noexcept {
  return {eye, point + kSkin * math::Normalized(eye - point)};
}

}  // namespace trocar::cholecystectomy
