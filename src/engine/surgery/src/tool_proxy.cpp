// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/tool_proxy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/collision/queries.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

using instrument::TrocarJoints;

/// Of the offset that contact no longer needs, this much is left after a tick [-].
constexpr double kFading = 0.7;
/// Offsets below are none [rad], [m].
constexpr double kNoOffset = 1e-7;
constexpr int kSweeps = 40;
/// What a limit gives way, of the way that it holds back [-]. In a narrow fold, limits from both sides leave no place but
/// far away along it: better a little overlap than a jump there.
constexpr double kCompliance = 0.005;
/// Overlap that is not worth a correction [m].
constexpr double kTouching = 1e-5;

using Row = std::array<double, 3>;  // pan, tilt, depth

/// What a small change of each joint does to the place of `point` along `normal`.
Row CalcRow(const ToolDrive& drive, const ProxyLimit& limit) noexcept {
  const Vec3 arm = limit.point - drive.p_world_port;
  const Vec3 pan_axis{0, 1, 0};
  const Vec3 tilt_axis = math::Rotate(math::RotationAbout(pan_axis, drive.device.pan), {1, 0, 0});
  const Vec3 inwards =
      math::Rotate(instrument::CalcToolPose(drive.p_world_port, drive.device).rotation, {0, 0, -1});
  return {math::Dot(limit.normal, math::Cross(pan_axis, arm)),
          math::Dot(limit.normal, math::Cross(tilt_axis, arm)), math::Dot(limit.normal, inwards)};
}

double Fade(double offset) noexcept {
  return std::fabs(offset) > kNoOffset ? kFading * offset : 0.0;
}

/// The overlap of one body with one surface as a limit on the way from the device to the proxy.
void AddOverlap(const Vec3& on_proxy, const Vec3& on_device, const Vec3& normal, double depth,
                ProxyLimits& limits) noexcept {
  limits.Add({on_device, normal, math::Dot(normal, on_proxy - on_device) - depth});
}

}  // namespace

void AddContactLimits(std::uint8_t hand, const ContactSet& contacts, std::span<const Vec3> positions,
                      ProxyLimits& limits) noexcept {
  for (std::size_t i = 0; i < contacts.springs.size(); ++i) {
    const ContactLink& link = contacts.links[i];
    if (link.hand != hand || link.is_friction || link.is_pinch) continue;
    const tissue::ContactSpring& spring = contacts.springs[i];
    limits.Add({link.p_device, spring.normal, -tissue::CalcContactDepth(spring, positions) - link.held_back});
  }
}

TrocarJoints FindProxy(const ToolDrive& drive, const TrocarJoints& last_offset,
                       std::span<const ProxyLimit> limits) noexcept {
  // a turn counts as the way of the tip
  const double lever = std::max(drive.device.depth, 0.01);
  const Row mobility{1.0 / (lever * lever), 1.0 / (lever * lever), 1.0};
  Row offset{Fade(last_offset.pan), Fade(last_offset.tilt), Fade(last_offset.depth)};
  static_assert(ProxyLimits::kCapacity < 1024);
  std::array<double, ProxyLimits::kCapacity> pushes{};
  std::array<Row, ProxyLimits::kCapacity> rows;
  const std::size_t count = std::min(limits.size(), rows.size());
  for (std::size_t i = 0; i < count; ++i) rows[i] = CalcRow(drive, limits[i]);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Row& row = rows[i];
      double give = 0, now = 0;
      for (int joint = 0; joint < 3; ++joint) {
        give += mobility[joint] * row[joint] * row[joint];
        now += row[joint] * offset[joint];
      }
      if (!(give > 0.0)) continue;
      const double push = std::max(
          0.0, pushes[i] + (now - limits[i].clearance - kCompliance * pushes[i]) / (give + kCompliance));
      const double change = push - pushes[i];
      pushes[i] = push;
      largest = std::max(largest, std::fabs(change) * give);
      for (int joint = 0; joint < 3; ++joint) offset[joint] -= mobility[joint] * row[joint] * change;
    }
    if (largest < 0.1 * kTouching) break;
  }
  TrocarJoints proxy = drive.device;
  proxy.pan += offset[0];
  proxy.tilt += offset[1];
  proxy.depth += offset[2];
  return proxy;
}

double AddOverlapLimits(const instrument::Tool& tool, const math::Pose& X_world_proxy,
                        const math::Pose& X_world_device, double jaw, const ContactCandidates& candidates,
                        std::int32_t grasped_surface, ProxyLimits& limits) noexcept {
  const auto proxy = CalcToolBodies(tool, jaw, X_world_proxy),
             device = CalcToolBodies(tool, jaw, X_world_device);
  double greatest = 0;
  const auto add = [&](int body, double parameter, const Vec3& normal, double depth) {
    if (!(depth > kTouching) || IsPinch(tool, static_cast<ToolBody>(body), X_world_proxy, normal)) return;
    greatest = std::max(greatest, depth);
    AddOverlap(math::Lerp(proxy[body].axis.start, proxy[body].axis.end, parameter),
               math::Lerp(device[body].axis.start, device[body].axis.end, parameter), normal, depth, limits);
  };
  for (int body = 0; body < kToolBodyCount; ++body) {
    const bool is_jaw = body != static_cast<int>(ToolBody::kShaft);
    if (!HasBody(tool, static_cast<ToolBody>(body))) continue;
    const double radius = proxy[body].radius;
    for (std::size_t surface = 0; surface < candidates.organs.size(); ++surface) {
      if (is_jaw && static_cast<std::int32_t>(surface) == grasped_surface) continue;
      const OrganSurface& organ = candidates.organs[surface];
      const auto nodes = organ.Nodes(candidates.positions);
      const auto near = organ.tree.FindNearestToSegment(nodes, proxy[body].axis, {.max_distance = radius});
      if (!near.Found()) continue;
      const auto side =
          collision::FindSide(nodes, organ.triangles, organ.vertex_triangles, near.on_segment, near.nearest);
      const Vec3 away = near.nearest.point - near.on_segment;
      const double distance = math::Norm(away);
      // run through: which way is out, nobody can say
      if (!(distance > 0.0)) continue;
      const bool is_outside = side.distance > 0.0;
      add(body, near.parameter, is_outside ? away / distance : -side.normal,
          is_outside ? radius - distance : radius + distance);
    }
    if (candidates.tubes == nullptr || (is_jaw && ClosesAroundTubes(tool))) continue;
    const auto near = candidates.tubes->tree.FindNearest(candidates.positions, proxy[body].axis, radius);
    if (!near.Found()) continue;
    const std::size_t surface = candidates.organs.size() + candidates.tubes->tube_of_piece[near.piece];
    if (is_jaw && static_cast<std::int32_t>(surface) == grasped_surface) continue;
    const Vec3 away = near.axes.on_b - near.axes.on_a;
    if (!(math::SquaredNorm(away) > 0.0)) continue;
    add(body, near.axes.parameter_a, math::Normalized(away), radius - near.distance);
  }
  return greatest;
}

}  // namespace trocar::surgery
