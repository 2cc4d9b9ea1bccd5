// SPDX-License-Identifier: Apache-2.0
#include "surgeon_view.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/to_integer.h"
#include "trocar/instrument/camera.h"
#include "trocar/math/elementary.h"
#include "trocar/tissue/rest_frame.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;

namespace {

constexpr double kSightClear = 0.0002;   // of a line of sight from organs [m]
constexpr double kDirectionOver = 0.08;  // of a tube's length, to either side [-]

}  // namespace

const instrument::Tool& SurgeonView::ToolOf(int hand) const {
  const auto h = static_cast<std::size_t>(hand);
  return scene.instruments[h].tray[seen.operation.tools[h]];
}

Vec3 SurgeonView::TubePoint(std::size_t tube, double share) const {
  const auto& nodes = known.tube_nodes[tube];
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(nodes.size() - 1);
  const auto i = std::min(nodes.size() - 2, base::TruncateTo<std::size_t>(at));
  return math::Lerp(seen.positions[nodes[i]], seen.positions[nodes[i + 1]], at - static_cast<double>(i));
}

Vec3 SurgeonView::TubeDirection(std::size_t tube, double share) const {
  return math::Normalized(TubePoint(tube, share + kDirectionOver) - TubePoint(tube, share - kDirectionOver));
}

TubeLine SurgeonView::LineOf(std::size_t tube) const {
  TubeLine line{{}, known.tube_radii[tube]};
  for (const std::uint32_t node : known.tube_nodes[tube]) line.points.push_back(seen.positions[node]);
  return line;
}

std::vector<TubeLine> SurgeonView::Lines() const {
  std::vector<TubeLine> lines;
  for (std::size_t tube = 0; tube < known.tube_nodes.size(); ++tube) lines.push_back(LineOf(tube));
  return lines;
}

std::vector<std::vector<double>> SurgeonView::FindClips(const std::vector<TubeLine>& lines) const {
  std::vector<std::vector<double>> clips(lines.size());
  for (std::size_t i = 0; i < seen.operation.clip_count; ++i) {
    const surgery::ClipSnapshot& clip = seen.operation.clips[i];
    if (clip.is_lost) continue;
    std::vector<TubeLine::Near> near;
    for (const TubeLine& line : lines) near.push_back(line.FindNearest(clip.X_world_clip.translation));
    const auto nearest = std::min_element(
        near.begin(), near.end(),
        [](const TubeLine::Near& a, const TubeLine::Near& b) { return a.distance < b.distance; });
    if (nearest != near.end())
      clips[static_cast<std::size_t>(nearest - near.begin())].push_back(nearest->arc);
  }
  for (std::vector<double>& arcs : clips) std::sort(arcs.begin(), arcs.end());
  return clips;
}

bool SurgeonView::IsDivided(std::size_t tube) const {
  return seen.operation.topology.IsDivided(known.surfaces, known.first_tube + tube);
}

void SurgeonView::LookAtFat() const {
  sight.Update(seen.operation.strand_is_intact, [&](std::uint32_t tube) { return IsDivided(tube); });
}

bool SurgeonView::Shows(const Pose& X_world_lens, std::span<const Vec3> points) const {
  const Vec3& eye = X_world_lens.translation;
  return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    return instrument::IsInView(X_world_lens, scene.laparoscope.field_of_view, p) &&
           Clearance(cholecystectomy::TriangleSight::LineTo(p, eye)) > kSightClear &&
           !sight.DoesFatHide(seen.positions, p, eye);
  });
}

double CalcAzimuth(const PatientKnowledge& known, std::span<const Vec3> positions, const Vec3& eye,
                   double first) {
  tissue::MotionMoments moments;
  for (const std::uint32_t node : known.neck_nodes) moments.AddPoint(1.0, known.rest[node], positions[node]);
  const Pose X_world_neck = tissue::FitRigidMotion(moments, math::Quaternion{});
  const auto& duct = known.tube_nodes[known.cystic_duct];
  const Vec3 along = math::Normalized(known.DuctAtRest());
  const Vec3 front = math::Normalized(Vec3{0, 0, 1} - along * along.z, {1, 0, 0});
  const Vec3 to_eye =
      math::Rotate(math::Inverse(X_world_neck.rotation), eye - X_world_neck * known.rest[duct.front()]);
  const double azimuth = math::Atan2(math::Dot(to_eye, math::Cross(along, front)), math::Dot(to_eye, front));
  return std::remainder(azimuth - first, 2.0 * M_PI);
}

}  // namespace trocar::agent
