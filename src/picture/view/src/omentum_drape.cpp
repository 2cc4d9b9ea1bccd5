// SPDX-License-Identifier: Apache-2.0
#include "omentum_drape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "trocar/geometry/mesh_topology.h"
#include "trocar/math/noise.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr double kNear = 0.006;                  // m; an end so near to something runs into it
constexpr double kStep = 0.002;                  // m between places
constexpr double kBack = 0.007, kAhead = 0.024;  // m along a tube from its loose end that are covered
constexpr double kSink = 0.6, kLevel = 0.006;    // of the way ahead, after some, that it sinks
constexpr double kBareLength = 0.008, kCoveredLength = 0.018;  // m from where another joins
constexpr double kThick = 0.0028;                              // m of fat over a tube
constexpr double kTop = 0.005;                                 // m, half of a ridge's breadth
constexpr double kSteepness = 0.75;                            // of its sides
constexpr double kFoot = 0.006;                                // m over which it runs out
constexpr double kSteep = 0.0025;  // m that a rim stands over its lowest neighbour
constexpr int kRimRounds = 8;
constexpr double kLobule = 0.0065, kLobuleHeight = 0.0022;  // m

double NearestDistance(const Vec3& p, std::span<const Vec3> others) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& other : others) nearest = std::min(nearest, math::Distance(other, p));
  return nearest;
}

double Smooth(double share) {
  share = std::clamp(share, 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

/// The larger of two, without a crease where they are equal.
double SmoothMax(double a, double b, double width) {
  const double share = std::clamp(0.5 + 0.5 * (a - b) / width, 0.0, 1.0);
  return b + share * (a - b) + width * share * (1.0 - share);
}

}  // namespace

std::vector<CoveredPlace> FindCoveredPlaces(std::span<const TubeLine> tubes, std::span<const Vec3> organs) {
  std::vector<CoveredPlace> places;
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    const TubeLine& tube = tubes[i];
    if (tube.nodes.size() < 2) continue;
    std::vector<Vec3> joints, loose;
    for (std::size_t j = 0; j < tubes.size(); ++j) {
      if (j == i || tubes[j].nodes.empty()) continue;
      for (const Vec3& end : {tubes[j].nodes.front(), tubes[j].nodes.back()})
        if (NearestDistance(end, tube.nodes) < kNear) joints.push_back(end);
    }
    const auto add = [&](const Vec3& p, double cover) {
      // where it is not covered it comes out of the fat gradually
      if (cover > 0.0)
        places.push_back({p, cover * (tube.radius + kThick) - (1.0 - cover) * (tube.radius + kThick)});
    };
    for (const bool is_first : {true, false}) {
      const Vec3 end = is_first ? tube.nodes.front() : tube.nodes.back();
      const Vec3 before = is_first ? tube.nodes[1] : tube.nodes[tube.nodes.size() - 2];
      bool is_loose = NearestDistance(end, organs) > kNear;
      for (std::size_t j = 0; j < tubes.size(); ++j)
        is_loose = is_loose && (j == i || NearestDistance(end, tubes[j].nodes) > kNear);
      if (!is_loose) continue;
      loose.push_back(end);
      const Vec3 out = math::Normalized(end - before, {1, 0, 0});
      for (double along = 0; along < kAhead; along += kStep)
        add(end + along * out - Vec3{0, 0, kSink * std::max(0.0, along - kLevel)}, 1.0);
    }
    for (std::size_t n = 0; n + 1 < tube.nodes.size(); ++n) {
      const Vec3 way = tube.nodes[n + 1] - tube.nodes[n];
      const int steps = std::max(1, static_cast<int>(math::Norm(way) / kStep));
      for (int k = 0; k < steps; ++k) {
        const Vec3 p = tube.nodes[n] + (static_cast<double>(k) / steps) * way;
        double cover = Smooth(1.5 - NearestDistance(p, loose) / kBack);
        if (tube.is_in_fat)
          cover = std::max(
              cover, Smooth((NearestDistance(p, joints) - kBareLength) / (kCoveredLength - kBareLength)));
        add(p, cover);
      }
    }
  }
  return places;
}

std::vector<double> DrapeOmentum(std::span<const CoveredPlace> places, geometry::TriangleMesh& omentum) {
  std::vector<double> raised(omentum.positions.size(), 0.0);
  for (std::size_t v = 0; v < raised.size(); ++v) {
    Vec3& p = omentum.positions[v];
    double top = -std::numeric_limits<double>::infinity();
    for (const CoveredPlace& place : places) {
      const double aside = std::hypot(p.x - place.centre.x, p.y - place.centre.y);
      const double down = std::max(0.0, aside - kTop);
      top = std::max(top, place.centre.z + place.height - kSteepness * down);
    }
    if (top < p.z - kFoot) continue;
    const math::CellNoise lobule = math::CalcCellNoise(p / kLobule, 0);
    top += kLobuleHeight * (0.7 - lobule.nearest * lobule.nearest);
    const double z = SmoothMax(top, p.z, kFoot);
    raised[v] = z - p.z;
    p.z = z;
  }
  return raised;
}

void RoundRims(geometry::TriangleMesh& omentum) {
  const geometry::Rows neighbours =
      geometry::FindVertexNeighbours(omentum.triangles, omentum.positions.size());
  std::vector<double> heights(omentum.positions.size());
  for (int round = 0; round < kRimRounds; ++round) {
    for (std::size_t v = 0; v < heights.size(); ++v) {
      const double here = heights[v] = omentum.positions[v].z;
      double lowest = here, sum = 0;
      for (const std::uint32_t other : neighbours.Row(v)) {
        lowest = std::min(lowest, omentum.positions[other].z);
        sum += omentum.positions[other].z;
      }
      const auto count = static_cast<double>(neighbours.Row(v).size());
      if (here - lowest > kSteep) heights[v] = std::min(here, 0.4 * here + 0.6 * sum / count);
    }
    for (std::size_t v = 0; v < heights.size(); ++v) omentum.positions[v].z = heights[v];
  }
}

}  // namespace trocar::view
