// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>

#include "patient_linter.h"
#include "trocar/anatomy/tube_graph.h"
#include "trocar/files/patient_frame.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using geometry::TriangleMesh;

struct TubeRange {
  roles::TubeRole role;
  patient::TubeKind kind;
  Range radius_mm, length_mm;
};

/// Normal calibre and length widened by the variations and dilatations that are known; the last two stand for
/// every other duct and artery.
constexpr TubeRange kTubeRanges[] = {
    {roles::TubeRole::kCysticDuct, patient::TubeKind::kDuct, {0.5, 2.5}, {5.0, 80.0}},
    {roles::TubeRole::kCommonHepaticDuct, patient::TubeKind::kDuct, {0.5, 5.0}, {10.0, 60.0}},
    {roles::TubeRole::kCommonBileDuct, patient::TubeKind::kDuct, {0.75, 7.5}, {30.0, 120.0}},
    {roles::TubeRole::kCysticArtery, patient::TubeKind::kArtery, {0.3, 2.0}, {3.0, 60.0}},
    {roles::TubeRole::kOther, patient::TubeKind::kDuct, {0.25, 7.5}, {1.0, 200.0}},
    {roles::TubeRole::kOther, patient::TubeKind::kArtery, {0.25, 6.0}, {1.0, 300.0}},
};

const TubeRange& FindRange(const patient::Tube& tube) {
  for (const TubeRange& range : kTubeRanges) {
    if (range.role == roles::TubeRole::kOther ? range.kind == tube.kind : range.role == tube.role)
      return range;
  }
  return *std::prev(std::end(kTubeRanges));
}

/// \return distance to the skin of the tube [m], 0 inside
double DistanceToTube(const math::Vec3& p, const geometry::CentreLine& line) {
  double nearest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
    const double t = geometry::FindNearestOnSegment(p, line.points[i], line.points[i + 1]);
    const double radius = line.radii[i] + t * (line.radii[i + 1] - line.radii[i]);
    nearest = std::min(nearest, Distance(p, math::Lerp(line.points[i], line.points[i + 1], t)) - radius);
  }
  return std::max(nearest, 0.0);
}

}  // namespace

bool IsWellFormed(const patient::Tube& tube) {
  const auto& line = tube.line;
  return line.points.size() >= 2 && line.points.size() == line.radii.size() &&
         std::all_of(line.points.begin(), line.points.end(),
                     [](const math::Vec3& p) { return math::IsFinite(p); }) &&
         std::all_of(line.radii.begin(), line.radii.end(), [](double r) { return std::isfinite(r); });
}

void Linter::LintTubeEnd(const patient::Tube& tube, const std::string& target, const math::Vec3& end,
                         const std::string& where) {
  if (target.empty()) return;  // leaves the scene
  const int organ_index = patient_.FindOrgan(target), tube_index = patient_.FindTube(target);
  const patient::Tube* other = tube_index < 0 ? nullptr : &patient_.tubes[tube_index];
  const bool is_known = organ_index >= 0 || (other != nullptr && other != &tube);
  if (!is_known) {
    Add("L-TUBE-END", where,
        "it ends nowhere: '" + target +
            "' is neither an organ nor another tube; name what it joins, or nothing where it leaves the "
            "scene");
    return;
  }
  if (!is_unit_right_ || !IsWellFormed(tube)) return;
  double distance = 0;
  if (const patient::Organ* organ = FindUsable(organ_index); organ != nullptr) {
    const TriangleMesh mesh = Outward(organ->mesh);
    const meshing::NearestSurface surface(mesh);
    distance = surface.Find(end).distance;
    // ducts and arteries of the liver run on inside it
    if (organ->role == roles::OrganRole::kLiver && distance > kJoinReach && surface.IsInside(end))
      distance = 0;
  } else if (other != nullptr && IsWellFormed(*other)) {
    distance = DistanceToTube(end, other->line);
  }
  if (distance > kJoinReach) {
    Add("L-TUBE-FAR", where,
        "the end at " + PlaceText(end) + " lies " + Mm(distance) + " from " + target +
            ", which it claims to join; move it there (at most 3 mm)");
  }
}

void Linter::LintTubes() {
  for (const patient::Tube& tube : patient_.tubes) {
    const auto& line = tube.line;
    if (line.points.size() < 2 || line.points.size() != line.radii.size()) {
      Add("L-TUBE-POINTS", tube.name, "it needs two points or more, and a radius for each");
    } else if (!IsWellFormed(tube)) {
      Add("L-TUBE-NUMBER", tube.name, "a point or radius is not finite; write the file again");
    } else if (is_unit_right_) {
      LintTubeSize(tube);
    }
    const math::Vec3 nowhere;
    const bool has_points = !line.points.empty();
    LintTubeEnd(tube, tube.from, has_points ? line.points.front() : nowhere, tube.name + "/from");
    LintTubeEnd(tube, tube.to, has_points ? line.points.back() : nowhere, tube.name + "/to");
    LintTubeLinks(tube);
  }
}

/// What leaves the scene must still be joined to something in it.
void Linter::LintTubeLinks(const patient::Tube& tube) {
  if (tube.role == roles::TubeRole::kCysticDuct && (tube.from.empty() || tube.to.empty())) {
    Add("L-TUBE-END", tube.name + (tube.from.empty() ? "/from" : "/to"),
        "it ends nowhere: a cystic duct joins the gallbladder to a duct and never leaves the scene");
    return;
  }
  if (tube.role == roles::TubeRole::kCysticArtery &&
      patient_.FindOrganRole(tube.from) != roles::OrganRole::kGallbladder &&
      patient_.FindOrganRole(tube.to) != roles::OrganRole::kGallbladder) {
    Add("L-TUBE-END", tube.name, "it ends nowhere: a cystic artery leads to the gallbladder");
    return;
  }
  if (!tube.from.empty() || !tube.to.empty()) return;
  const bool is_joined =
      std::any_of(patient_.tubes.begin(), patient_.tubes.end(), [&](const patient::Tube& other) {
        return &other != &tube && (other.from == tube.name || other.to == tube.name);
      });
  if (!is_joined) Add("L-TUBE-END", tube.name, "it ends nowhere: it joins nothing, and nothing joins it");
}

void Linter::LintTubeSize(const patient::Tube& tube) {
  const TubeRange& range = FindRange(tube);
  const auto [thin, thick] = std::minmax_element(tube.line.radii.begin(), tube.line.radii.end());
  const double min_mm = files::kMmPerMetre * *thin, max_mm = files::kMmPerMetre * *thick;
  // file and arithmetic round: a radius on the border is inside
  constexpr double kRound = 1e-9;
  if (min_mm < range.radius_mm.min - kRound || max_mm > range.radius_mm.max + kRound) {
    Add("L-TUBE-RADIUS", tube.name,
        "its radius runs from " + Rounded(min_mm) + " to " + Rounded(max_mm) + " mm, plausible is " +
            Rounded(range.radius_mm.min) + " to " + Rounded(range.radius_mm.max) + " mm; correct the radii");
  }
  const double length_mm = files::kMmPerMetre * geometry::CalcLength(tube.line);
  // of a tube that leaves the scene only a part is there
  const bool is_whole = !tube.from.empty() && !tube.to.empty();
  if (length_mm > range.length_mm.max || (is_whole && length_mm < range.length_mm.min)) {
    Add("L-TUBE-LENGTH", tube.name,
        "it is " + Rounded(length_mm) + " mm long, plausible is " + Rounded(range.length_mm.min) + " to " +
            Rounded(range.length_mm.max) + " mm; check its points");
  }
}

void Linter::LintTubeGraph() {
  if (!is_unit_right_) return;
  const TubeGraph graph = MakeTubeGraph(patient_);
  const auto cycle = FindCycleTubes(patient_, graph);
  if (!cycle.empty()) {
    std::string names;
    for (const auto tube : cycle) names += (names.empty() ? "" : ", ") + patient_.tubes[tube].name;
    Add("L-TUBE-CYCLE", patient_.tubes[cycle.front()].name,
        "there is a closed way along " + names +
            ": ducts and arteries branch and never meet again; cut or rename one of the ends");
  }
  // bile must get out: from the cystic duct there is a way to an end that leaves the scene
  const int index = patient_.TubeOf(roles::TubeRole::kCysticDuct);
  if (index < 0) return;
  const patient::Tube& cystic = patient_.tubes[index];
  if (!IsWellFormed(cystic) || cystic.from.empty() || cystic.to.empty()) return;
  const auto ducts = FindConnectedTubes(patient_, graph, static_cast<std::uint32_t>(index));
  const bool is_alone = ducts.size() == 1;
  const bool has_outlet = std::any_of(graph.nodes.begin(), graph.nodes.end(), [&](const TubeNode& node) {
    return node.kind == TubeNode::Kind::kOpen &&
           std::find(ducts.begin(), ducts.end(), node.vertices[0].tube) != ducts.end();
  });
  // a duct that joins nothing has its own finding
  if (!has_outlet && !is_alone) {
    Add("L-DUCT-CLOSED", cystic.name,
        "no duct that it joins leaves the scene, so bile cannot flow off: leave the lower end of the common "
        "bile duct without a name");
  }
}

}  // namespace trocar::anatomy
