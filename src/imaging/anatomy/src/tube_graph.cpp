// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/tube_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

constexpr std::size_t kFollowers = 4;  // points beside a moved end that follow it

bool IsUsable(const patient::Tube& tube) {
  return tube.line.points.size() >= 2 && tube.line.points.size() == tube.line.radii.size() &&
         std::all_of(tube.line.points.begin(), tube.line.points.end(),
                     [](const math::Vec3& p) { return math::IsFinite(p); });
}

std::uint32_t EndPoint(const patient::Tube& tube, TubeEnd end) {
  return end == TubeEnd::kFrom ? 0 : static_cast<std::uint32_t>(tube.line.points.size() - 1);
}

const std::string& EndName(const patient::Tube& tube, TubeEnd end) {
  return end == TubeEnd::kFrom ? tube.from : tube.to;
}

std::uint32_t FindNearestPoint(const geometry::CentreLine& line, const math::Vec3& p) {
  const auto nearest = std::min_element(
      line.points.begin(), line.points.end(),
      [&](const math::Vec3& a, const math::Vec3& b) { return Distance(a, p) < Distance(b, p); });
  return static_cast<std::uint32_t>(nearest - line.points.begin());
}

/// Classes of things that are the same.
class Unions {
 public:
  explicit Unions(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::size_t Find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// \return false when they were one already
  bool Join(std::size_t a, std::size_t b) {
    a = Find(a), b = Find(b);
    if (a == b) return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Gap between a tube's end and the skin of another one at its nearest point [m], 0 inside.
double CalcGap(const math::Vec3& end, const geometry::CentreLine& other, std::uint32_t nearest) {
  return std::max(0.0, Distance(end, other.points[nearest]) - other.radii[nearest]);
}

/// The other tube that this end names and reaches, or -1.
int FindJoined(const patient::Patient& patient, std::size_t tube, TubeEnd end, double reach) {
  const patient::Tube& self = patient.tubes[tube];
  const int other = patient.FindTube(EndName(self, end));
  if (other < 0 || other == static_cast<int>(tube) || !IsUsable(patient.tubes[other])) return -1;
  const math::Vec3& at = self.line.points[EndPoint(self, end)];
  const auto& line = patient.tubes[other].line;
  return CalcGap(at, line, FindNearestPoint(line, at)) <= reach ? other : -1;
}

}  // namespace

TubeGraph MakeTubeGraph(const patient::Patient& patient) {
  // every point has a number; those in one place become one
  std::vector<std::size_t> first(patient.tubes.size() + 1, 0);
  for (std::size_t t = 0; t < patient.tubes.size(); ++t)
    first[t + 1] = first[t] + (IsUsable(patient.tubes[t]) ? patient.tubes[t].line.points.size() : 0);
  Unions places(first.back());
  std::vector<char> is_node(first.back(), 0);
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    if (!IsUsable(patient.tubes[t])) continue;
    for (const TubeEnd end : {TubeEnd::kFrom, TubeEnd::kTo}) {
      const std::uint32_t point = EndPoint(patient.tubes[t], end);
      is_node[first[t] + point] = 1;
      const int other = FindJoined(patient, t, end, kJoinReach);
      if (other < 0) continue;
      const std::uint32_t met =
          FindNearestPoint(patient.tubes[other].line, patient.tubes[t].line.points[point]);
      is_node[first[other] + met] = 1;
      places.Join(first[t] + point, first[other] + met);
    }
  }

  TubeGraph graph;
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> node_of(first.back(), kNone);
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    for (std::uint32_t i = 0; first[t] + i < first[t + 1]; ++i) {
      if (!is_node[first[t] + i]) continue;
      const std::size_t place = places.Find(first[t] + i);
      if (node_of[place] == kNone) {
        node_of[place] = static_cast<std::uint32_t>(graph.nodes.size());
        graph.nodes.emplace_back();
      }
      node_of[first[t] + i] = node_of[place];
      graph.nodes[node_of[place]].vertices.push_back({t, i});
    }
  }
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    std::uint32_t last = 0;
    for (std::uint32_t i = 1; first[t] + i < first[t + 1]; ++i) {
      if (!is_node[first[t] + i]) continue;
      graph.pieces.push_back({t, last, i, node_of[first[t] + last], node_of[first[t] + i]});
      last = i;
    }
  }
  for (TubeNode& node : graph.nodes) {
    if (node.vertices.size() > 1) continue;
    const patient::Tube& tube = patient.tubes[node.vertices[0].tube];
    const TubeEnd end = node.vertices[0].point == 0 ? TubeEnd::kFrom : TubeEnd::kTo;
    const std::string& name = EndName(tube, end);
    node.organ = patient.FindOrgan(name);
    node.kind = name.empty()      ? TubeNode::Kind::kOpen
                : node.organ >= 0 ? TubeNode::Kind::kOrgan
                                  : TubeNode::Kind::kNowhere;
  }
  return graph;
}

std::vector<std::uint32_t> FindEnteringTubes(const patient::Patient& patient, const TubeGraph& graph,
                                             roles::OrganRole organ) {
  const int wanted = patient.OrganOf(organ);
  std::vector<std::uint32_t> tubes;
  for (const TubeNode& node : graph.nodes) {
    if (node.kind == TubeNode::Kind::kOrgan && node.organ == wanted) tubes.push_back(node.vertices[0].tube);
  }
  std::sort(tubes.begin(), tubes.end());
  tubes.erase(std::unique(tubes.begin(), tubes.end()), tubes.end());
  return tubes;
}

std::vector<std::uint32_t> FindConnectedTubes(const patient::Patient& patient, const TubeGraph& graph,
                                              std::uint32_t tube) {
  Unions tubes(patient.tubes.size());
  for (const TubeNode& node : graph.nodes) {
    for (const TubeVertex& a : node.vertices) {
      for (const TubeVertex& b : node.vertices) {
        if (patient.tubes[a.tube].kind == patient.tubes[b.tube].kind) tubes.Join(a.tube, b.tube);
      }
    }
  }
  std::vector<std::uint32_t> connected;
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    if (tubes.Find(t) == tubes.Find(tube)) connected.push_back(t);
  }
  return connected;
}

std::vector<std::uint32_t> FindCycleTubes(const patient::Patient& patient, const TubeGraph& graph) {
  // what hangs on a single thread is no cycle: such pieces fall off until only cycles are left
  std::vector<char> is_left(graph.pieces.size(), 1);
  // each kind has nodes of its own
  const auto key = [&](const TubePiece& piece, std::uint32_t node) {
    return 2 * node + (patient.tubes[piece.tube].kind == patient::TubeKind::kArtery ? 1 : 0);
  };
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    std::vector<int> degree(2 * graph.nodes.size(), 0);
    for (std::size_t i = 0; i < graph.pieces.size(); ++i) {
      if (!is_left[i]) continue;
      ++degree[key(graph.pieces[i], graph.pieces[i].from)];
      ++degree[key(graph.pieces[i], graph.pieces[i].to)];
    }
    for (std::size_t i = 0; i < graph.pieces.size(); ++i) {
      const TubePiece& piece = graph.pieces[i];
      if (!is_left[i] || (degree[key(piece, piece.from)] > 1 && degree[key(piece, piece.to)] > 1)) continue;
      is_left[i] = 0;
      has_changed = true;
    }
  }
  std::vector<std::uint32_t> tubes;
  for (std::size_t i = 0; i < graph.pieces.size(); ++i) {
    if (is_left[i]) tubes.push_back(graph.pieces[i].tube);
  }
  tubes.erase(std::unique(tubes.begin(), tubes.end()), tubes.end());
  return tubes;
}

std::vector<OpenJoint> JoinTubes(patient::Patient& patient, double reach) {
  std::vector<OpenJoint> open;
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    patient::Tube& tube = patient.tubes[t];
    if (!IsUsable(tube)) continue;
    for (const TubeEnd end : {TubeEnd::kFrom, TubeEnd::kTo}) {
      const std::string& name = EndName(tube, end);
      if (name.empty()) continue;
      const std::uint32_t point = EndPoint(tube, end);
      const math::Vec3 here = tube.line.points[point];
      math::Vec3 wanted = here;
      double gap = 0;
      const int other = patient.FindTube(name), organ = patient.FindOrgan(name);
      if (organ >= 0 && !patient.organs[organ].mesh.triangles.empty()) {
        const meshing::NearestSurface surface(patient.organs[organ].mesh);
        const meshing::SurfacePoint near = surface.Find(here);
        // ducts and arteries of the liver run on inside it
        if (patient.organs[organ].role != roles::OrganRole::kLiver || !surface.IsInside(here))
          wanted = near.at.point, gap = near.distance;
      } else if (other >= 0 && other != static_cast<int>(t) && IsUsable(patient.tubes[other])) {
        const auto& line = patient.tubes[other].line;
        const std::uint32_t met = FindNearestPoint(line, here);
        wanted = line.points[met], gap = CalcGap(here, line, met);
      }
      if (gap > reach) {
        open.push_back({t, end, gap});
        continue;
      }
      auto& points = tube.line.points;
      const math::Vec3 shift = wanted - here;
      const std::size_t followers = std::min(kFollowers, points.size() - 2);
      for (std::size_t i = 1; i <= followers; ++i) {
        const std::size_t at = end == TubeEnd::kFrom ? i : points.size() - 1 - i;
        points[at] += (1.0 - static_cast<double>(i) / static_cast<double>(followers + 1)) * shift;
      }
      points[point] = wanted;
    }
  }
  return open;
}

}  // namespace trocar::anatomy
