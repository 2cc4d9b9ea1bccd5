// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/surface_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "crossing_finder.h"
#include "split_quality.h"
#include "trench.h"
#include "trocar/base/assert.h"
#include "trocar/base/state_archive.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::geometry {
namespace {

/// A vertex put into a triangle leaves no angle below this many times the limit: the cut goes on from there [-].
constexpr double kInsertAngles = 3.0;

}  // namespace

struct SurfaceCutter::Content {
  explicit Content(const EditableMesh& cut_mesh)
      : finder(cut_mesh.VertexCapacity(), cut_mesh.TriangleCapacity()),
        trench(cut_mesh.VertexCapacity(), cut_mesh.TriangleCapacity()),
        on_stamp(cut_mesh.VertexCapacity(), 0),
        tick_stamp(cut_mesh.VertexCapacity(), 0),
        passed_stamp(cut_mesh.VertexCapacity(), 0),
        parted_stamp(cut_mesh.VertexCapacity(), 0) {
    on.reserve(cut_mesh.VertexCapacity());
    parted.reserve(cut_mesh.VertexCapacity());
    seeds.reserve(cut_mesh.TriangleCapacity());
    scored.reserve(3 * cut_mesh.TriangleCapacity());
  }

  void CutTip(std::uint32_t tip, const BladeEdge& now) noexcept;
  void CutAnew(const FlatSweep& sweep) noexcept;
  void CutPath(const FlatSweep& sweep) noexcept;
  void SplitOrSnap(const Crossing& crossing) noexcept;
  void ScorePath(const FlatSweep& sweep) noexcept;
  void Open(const FlatSweep& sweep) noexcept;
  void OpenWithoutWalls() noexcept;
  struct Pierced {
    std::uint32_t triangle = 0;
    math::Vec3 point;  // [m]
  };
  void FindPierced(const BladeEdge& now) noexcept;
  std::uint32_t FindEnd(const Pierced& at, const CutFront& front) const noexcept;
  std::uint32_t InsertAt(const Pierced& at) noexcept;
  void MoveTips(const BladeEdge& now, CutFront& front) noexcept;

  void StartPath() noexcept {
    ++path;
    on.clear();
  }
  void MarkOn(std::uint32_t v) noexcept {
    tick_stamp[v] = tick;
    if (on_stamp[v] == path) return;
    on_stamp[v] = path;
    on.push_back(v);
  }
  bool IsOn(std::uint32_t v) const { return on_stamp[v] == path; }
  int SideOf(std::uint32_t t, const FlatSweep& sweep) const noexcept;
  bool LeavesLooseTriangle(std::uint32_t h) const noexcept;

  CrossingFinder finder;
  TrenchBuilder trench;
  std::vector<std::uint32_t> on;            // vertices in the path that is being cut
  std::vector<std::uint32_t> on_stamp;      // (nv) path in which it lies
  std::vector<std::uint32_t> tick_stamp;    // (nv) tick in which it lay in a path
  std::vector<std::uint32_t> passed_stamp;  // (nv) tick in which a cut went through it: not its end
  std::vector<std::uint32_t> parted;        // vertices that opening may part
  std::vector<std::uint32_t> parted_stamp;  // (nv) path in which it lies there
  std::vector<std::uint32_t> seeds;         // triangles
  std::vector<std::uint32_t> scored;        // half-edges to open
  std::array<Pierced, CutFront::kCapacity> pierced;
  std::size_t pierced_count = 0;
  std::uint32_t path = 0, tick = 0;
  // of the call
  EditableMesh* mesh = nullptr;
  CutSettings settings;
  CutReport report;
};

SurfaceCutter::SurfaceCutter(const EditableMesh& mesh) : content_(std::make_unique<Content>(mesh)) {}
SurfaceCutter::~SurfaceCutter() = default;
SurfaceCutter::SurfaceCutter(SurfaceCutter&&) noexcept = default;
SurfaceCutter& SurfaceCutter::operator=(SurfaceCutter&&) noexcept = default;

CutReport SurfaceCutter::Cut(const BladeEdge& before, const BladeEdge& now, const CutSettings& settings,
                             CutFront& front, EditableMesh& mesh) noexcept {
  Content& content = *content_;
  TROCAR_ASSERT(mesh.VertexCapacity() == content.on_stamp.size());
  content.mesh = &mesh;
  content.settings = settings;
  content.settings.snap = std::clamp(settings.snap, 0.05, 0.5);
  content.report = {};
  ++content.tick;
  content.finder.StartTick(mesh);
  if (front.count == 0) content.MoveTips(before, front);
  const BladeMoves moves = MakeFlatMoves(before, now);
  for (const FlatMove& move : moves.Moves()) {
    for (const auto tip : front.Tips()) content.CutTip(tip, move.now);
    content.CutAnew(move.sweep);
    content.MoveTips(move.now, front);
  }
  return content.report;
}

void SurfaceCutter::Content::CutTip(std::uint32_t tip, const BladeEdge& now) noexcept {
  if (tip >= mesh->VertexCount()) return;
  const auto sweep = MakeFlatSweep(mesh->Positions()[tip], now);
  seeds.clear();
  mesh->ForEachAround(tip, [&](std::uint32_t h) { seeds.push_back(EditableMesh::TriangleOf(h)); });
  if (!sweep) return;
  finder.Find(*sweep, *mesh);
  finder.Follow(seeds);
  StartPath();
  MarkOn(tip);
  CutPath(*sweep);
}

void SurfaceCutter::Content::CutAnew(const FlatSweep& sweep) noexcept {
  finder.Find(sweep, *mesh);
  finder.ChooseUntouched();
  StartPath();
  CutPath(sweep);
}

void SurfaceCutter::Content::CutPath(const FlatSweep& sweep) noexcept {
  if (finder.Chosen().empty()) return;
  report.crossings += finder.Chosen().size();
  // crossings near a vertex come first: an edge whose end is already in the path is then not split
  for (const auto index : finder.Chosen()) {
    const Crossing& crossing = finder.Crossings()[index];
    if (crossing.t <= settings.snap || crossing.t >= 1.0 - settings.snap) {
      MarkOn(crossing.t < 0.5 ? crossing.a : crossing.b);
      ++report.snaps;
    }
  }
  for (const auto index : finder.Chosen()) SplitOrSnap(finder.Crossings()[index]);
  ScorePath(sweep);
  Open(sweep);
}

void SurfaceCutter::Content::SplitOrSnap(const Crossing& crossing) noexcept {
  if (IsOn(crossing.a) || IsOn(crossing.b)) return;
  const std::uint32_t h = mesh->FindHalfEdge(crossing.a, crossing.b);
  TROCAR_ASSERT(h != kNone);
  for (const double t : {crossing.t, 0.5}) {
    if (!MaySplit(*mesh, h, t, settings.min_angle)) continue;
    if (!mesh->HasCapacity(1, 2)) {
      report.is_full = true;
      break;
    }
    MarkOn(mesh->SplitEdge(h, t));
    ++report.splits;
    return;
  }
  MarkOn(crossing.t < 0.5 ? crossing.a : crossing.b);
  ++report.snaps;
}

/// Sign of the side of the sweep on which a triangle lies: that of its corner that lies farthest off, but for those
/// in the path. Where that one is as near as a vertex to which crossings go, an earlier vertex of the same cut, the
/// middle decides.
int SurfaceCutter::Content::SideOf(std::uint32_t t, const FlatSweep& sweep) const noexcept {
  double farthest = 0, farthest_on = 0, middle = 0;
  for (const auto v : mesh->Triangles()[t]) {
    const double height = sweep.Height(mesh->Positions()[v]);
    middle += height;
    double& so_far = IsOn(v) ? farthest_on : farthest;
    if (std::fabs(height) > std::fabs(so_far)) so_far = height;
  }
  const bool is_clear = (1.0 - settings.snap) * std::fabs(farthest) > settings.snap * std::fabs(farthest_on);
  return (is_clear ? farthest : middle) < 0.0 ? -1 : 1;
}

/// Whether an edge is all that still holds one of its two triangles.
bool SurfaceCutter::Content::LeavesLooseTriangle(std::uint32_t h) const noexcept {
  const auto is_held = [&](std::uint32_t side) { return mesh->Twin(side) != kNone && !mesh->IsScored(side); };
  for (const auto side : {h, mesh->Twin(h)}) {
    if (!is_held(EditableMesh::Next(side)) && !is_held(EditableMesh::Previous(side))) return true;
  }
  return false;
}

void SurfaceCutter::Content::ScorePath(const FlatSweep& sweep) noexcept {
  for (const auto v : on) {
    mesh->ForEachAround(v, [&](std::uint32_t h) {
      const std::uint32_t twin = mesh->Twin(h), other = mesh->To(h);
      if (twin == kNone || other < v || !IsOn(other) || mesh->IsScored(h)) return;
      if (SideOf(EditableMesh::TriangleOf(h), sweep) == SideOf(EditableMesh::TriangleOf(twin), sweep)) return;
      if (LeavesLooseTriangle(h)) {
        ++report.refused;
        return;
      }
      mesh->SetScored(h, true);
      ++report.scored;
    });
  }
}

void SurfaceCutter::Content::Open(const FlatSweep& sweep) noexcept {
  const std::size_t vertices_before = mesh->VertexCount();
  if (settings.has_walls) {
    trench.Open(on, sweep, settings, *mesh, report);
  } else {
    OpenWithoutWalls();
  }
  for (auto v = static_cast<std::uint32_t>(vertices_before); v < mesh->VertexCount(); ++v) {
    const VertexSource& source = mesh->Sources()[v];
    if (source.origin != VertexOrigin::kCopy) continue;
    passed_stamp[v] = passed_stamp[source.from[0]] = tick;
    ++report.copies;
  }
}

void SurfaceCutter::Content::OpenWithoutWalls() noexcept {
  std::size_t copies = 0;
  scored.clear();
  parted.clear();
  const auto see = [&](std::uint32_t v) {
    if (parted_stamp[v] == path) return;
    parted_stamp[v] = path;
    parted.push_back(v);
  };
  for (const auto v : on) see(v);
  // a vertex that is parted opens all of its scored edges, and with them the vertices at their other ends. Some of these edges may
  // be of an earlier path: they were scored when the pools were full
  for (std::size_t next = 0; next < parted.size(); ++next) {
    const std::uint32_t v = parted[next];
    copies += static_cast<std::size_t>(mesh->CountCopies(v));
    mesh->ForEachAround(v, [&](std::uint32_t h) {
      if (!mesh->IsScored(h)) return;
      see(mesh->To(h));
      if (v < mesh->To(h)) scored.push_back(h);
    });
  }
  if (!mesh->HasCapacity(copies, 0)) {
    report.is_full = true;
    return;
  }
  for (const auto v : parted) mesh->SeparateParts(v);
  for (const auto h : scored) report.opened += mesh->Open(h) ? 1 : 0;
}

/// Where the blade meets the surface now, in the triangles that it is in.
void SurfaceCutter::Content::FindPierced(const BladeEdge& now) noexcept {
  pierced_count = 0;
  const Box box{math::Min(now.a, now.b), math::Max(now.a, now.b)};
  const auto x = mesh->Positions();
  for (std::uint32_t t = 0; t < mesh->TriangleCount() && pierced_count < pierced.size(); ++t) {
    const Triangle& corners = mesh->Triangles()[t];
    const math::Vec3 &a = x[corners[0]], &b = x[corners[1]], &c = x[corners[2]];
    if (!BoxesOverlap(box, {math::Min(math::Min(a, b), c), math::Max(math::Max(a, b), c)})) continue;
    if (const auto point = FindPiercing(now, a, b, c)) pierced[pierced_count++] = {t, *point};
  }
}

/// The end of a cut of this stroke that is the nearest corner of the triangle in which the blade stands.
std::uint32_t SurfaceCutter::Content::FindEnd(const Pierced& at, const CutFront& front) const noexcept {
  const auto tips = front.Tips();
  const auto x = mesh->Positions();
  std::uint32_t nearest = kNone;
  for (const auto v : mesh->Triangles()[at.triangle]) {
    const bool is_of_stroke = tick_stamp[v] == tick || std::find(tips.begin(), tips.end(), v) != tips.end();
    if (!is_of_stroke || passed_stamp[v] == tick) continue;
    if (nearest == kNone ||
        math::SquaredDistance(x[v], at.point) < math::SquaredDistance(x[nearest], at.point))
      nearest = v;
  }
  return nearest;
}

/// Puts a vertex where the blade stands in a triangle; kNone where that would make slivers.
std::uint32_t SurfaceCutter::Content::InsertAt(const Pierced& at) noexcept {
  const auto weights = CalcWeights(*mesh, at.triangle, at.point);
  if (!MayInsert(*mesh, at.triangle, weights, kInsertAngles * settings.min_angle)) return kNone;
  if (!mesh->HasCapacity(1, 2)) {
    report.is_full = true;
    return kNone;
  }
  ++report.inserted;
  return mesh->SplitTriangle(at.triangle, weights);
}

/// Follows the blade into the triangles in which it stands: starts cuts there, lets them grow, and keeps their ends.
void SurfaceCutter::Content::MoveTips(const BladeEdge& now, CutFront& front) noexcept {
  CutFront next;
  FindPierced(now);
  for (std::size_t i = 0; i < pierced_count; ++i) {
    // an insertion before this one may have divided the triangle: then this point waits for the next tick
    const Pierced at = pierced[i];
    std::uint32_t end = FindEnd(at, front);
    if (end == kNone) {
      if (!finder.IsOfPath(at.triangle)) end = InsertAt(at);
    } else if (math::Distance(mesh->Positions()[end], at.point) > settings.step) {
      const auto sweep = MakeFlatSweep(mesh->Positions()[end], now);
      const std::uint32_t grown = sweep ? InsertAt(at) : kNone;
      if (grown != kNone) {
        StartPath();
        MarkOn(end);
        MarkOn(grown);
        mesh->SetScored(mesh->FindHalfEdge(end, grown), true);
        ++report.scored;
        Open(*sweep);
        end = grown;
      }
    }
    const auto found = next.Tips();
    if (end == kNone || next.count == CutFront::kCapacity ||
        std::find(found.begin(), found.end(), end) != found.end())
      continue;
    next.tips[next.count++] = end;
  }
  front = next;
}

void VisitState(base::StateArchive& archive, CutFront& front) {
  archive.Field("tips", front.tips);
  archive.Field("count", front.count);
  if (archive.IsRestoring() && front.count > CutFront::kCapacity) {
    front.count = 0;
    archive.Fail("has more tips than the capacity");
  }
}

}  // namespace trocar::geometry
