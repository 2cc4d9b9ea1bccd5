// SPDX-License-Identifier: Apache-2.0
// Random cuts through random tissue while it is pulled, as a session cuts: after each the surface is whole and a hundred
// ticks go on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "cuttable_fixture.h"
#include "random_cuts.h"
#include "trocar/geometry/openings.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/state_guard.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

using geometry::EditableMesh;

constexpr int kTicksAfter = 100;
constexpr double kTick = 1.0 / 120.0;  // s
constexpr double kLeastHole = 1e-6;    // of a cut in a hollow organ, as an operation has it [m^2]

/// What the strokes of one run did.
struct Counts {
  std::size_t strokes = 0, tissues = 0, taken_back = 0, cutting = 0, ticks = 0, opened = 0, walls = 0,
              refused = 0, full = 0;
};

/// The built-in patient's organs in metres.
std::vector<geometry::NamedSurface> ReadOrgans() {
  std::vector<geometry::NamedSurface> organs;
  for (geometry::NamedSurface& surface : geometry::MakeSurfaces()) {
    if (surface.name != "liver.ply" && surface.name != "gallbladder.ply") continue;
    for (Vec3& p : surface.mesh.positions) p *= 1e-3;
    organs.push_back(std::move(surface));
  }
  return organs;
}

/// A random wall. Its membrane spreads a load over 0.05 to 5 times the tissue's size before the foundation bears it:
/// sqrt(E t / foundation) is 0.07 of the built-in liver and 1.4 of the gallbladder.
WallMaterial RandomWall(double size, math::Random& random) {
  WallMaterial wall;
  wall.membrane_modulus = std::pow(10.0, random.Uniform(1, 3));
  wall.bending_share = random.Uniform(0, 0.5);
  const double spread = 0.05 * std::pow(100.0, random.Uniform()) * size;
  wall.foundation = wall.membrane_modulus / (spread * spread);
  wall.mass_by_area = 2.0;
  return wall;
}

/// What anatomy holds of a tissue: the vertices in a ball about one of them; of some tissues nothing.
std::vector<std::uint32_t> PickFixed(const geometry::TriangleMesh& mesh, math::Random& random) {
  std::vector<std::uint32_t> fixed;
  if (random.Uniform() < 0.3) return fixed;
  const geometry::Box box = geometry::CalcBox(mesh.positions);
  const double reach = random.Uniform(0.0, 0.3) * math::Distance(box.min, box.max);
  const Vec3 centre = mesh.positions[geometry::RandomIndex(mesh.positions.size(), random)];
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (math::Distance(mesh.positions[v], centre) <= reach) fixed.push_back(v);
  }
  return fixed;
}

/// One organ in a session's loop: cut, taken into model, solver, volume and guard in the same tick, solved.
class CutTissue {
 public:
  /// \param fixed  vertices that anatomy holds
  CutTissue(const geometry::TriangleMesh& mesh, const std::vector<std::uint32_t>& fixed,
            const WallMaterial& wall, const geometry::CutSettings& cut, std::uint32_t spare_count)
      : system_(MakeSystem(mesh, fixed, wall, cut, spare_count)),
        is_closed_(geometry::InspectMesh(mesh).closed),
        size_(CalcSize(mesh)),
        solver_(system_.model, {.spare_share = 0.5}),
        conservation_(system_.model, {ClosedOrgans(), {}, {}}),
        conserved_(conservation_.MakeState(system_.state)),
        guard_(system_.model) {}

  double Size() const { return size_; }

  /// The surface where its nodes are now.
  EditableMesh Surface() const {
    EditableMesh mesh = system_.organ->Mesh();
    std::vector<Vec3> positions(mesh.VertexCount());
    for (std::uint32_t v = 0; v < positions.size(); ++v)
      positions[v] = system_.state.position[system_.organ->Node(v)];
    mesh.SetPositions(positions);
    return mesh;
  }

  geometry::CutReport Cut(const geometry::BladeEdge& before, const geometry::BladeEdge& now) {
    const auto report = system_.Cut(before, now);
    if (report.HasChanged()) {
      solver_.UpdateTopology(system_.model);
      conservation_.UpdateTopology(system_.model, ClosedOrgans(), conserved_);
      if (is_closed_ && !system_.organ->Settings().cut.has_walls) Perforate();
      guard_.UpdateTopology(system_.model, system_.state);
    }
    return report;
  }
  void LiftBlade() { system_.front = {}; }

  /// One tick without a blade. \return empty, or what is wrong
  std::string Solve() {
    tissue::TissueLoad load;
    const auto report =
        tissue::SolveConserving(solver_, {}, kTick, conservation_, load, system_.state, conserved_);
    if (!report.is_finite) return "the solve is not finite";
    for (const Vec3& p : system_.state.position) {
      if (!math::IsFinite(p)) return "a position is not finite";
    }
    const auto verdict = guard_.Check(system_.state);
    taken_back_ += verdict == tissue::GuardVerdict::kGood ? 0 : 1;
    if (verdict == tissue::GuardVerdict::kFrozen) return "the guard froze the state";
    return {};
  }
  /// Ticks that the guard took back.
  std::size_t TakenBack() const { return taken_back_; }

  /// Whether some node is farther from rest than a hand could have taken it.
  bool IsFlungAway() const {
    for (std::size_t i = 0; i < system_.state.position.size(); ++i) {
      if (math::Distance(system_.state.position[i], system_.model.rest[i]) > 2.0 * size_) return true;
    }
    return false;
  }

  void Hold(std::uint32_t v) { Condition(v) = tissue::NodeCondition::kPrescribed; }
  void Pull(std::uint32_t v, const Vec3& by) { system_.state.position[system_.organ->Node(v)] += by; }
  void Release(std::uint32_t v) {
    const bool is_fixed = system_.model.is_fixed[system_.organ->Node(v)] != 0;
    Condition(v) = is_fixed ? tissue::NodeCondition::kPrescribed : tissue::NodeCondition::kFree;
  }

  /// Every vertex belongs to the system by a spring. \return empty, or what is wrong
  std::string FindLooseNode() const {
    std::vector<std::uint8_t> is_held(system_.definition.rest.size(), 0);
    for (const tissue::Spring& spring : system_.definition.springs) {
      if (spring.stiffness > 0.0) is_held[spring.a] = is_held[spring.b] = 1;
    }
    for (std::uint32_t v = 0; v < system_.organ->Mesh().VertexCount(); ++v) {
      const std::uint32_t node = system_.organ->Node(v);
      if (is_held[node] == 0) return "node " + std::to_string(node) + " has no spring";
    }
    return {};
  }

 private:
  static double CalcSize(const geometry::TriangleMesh& mesh) {
    const geometry::Box box = geometry::CalcBox(mesh.positions);
    return math::Distance(box.min, box.max);
  }
  static CuttableSystem MakeSystem(const geometry::TriangleMesh& mesh,
                                   const std::vector<std::uint32_t>& fixed, const WallMaterial& wall,
                                   const geometry::CutSettings& cut, std::uint32_t spare_count) {
    CuttableSystem system(mesh, wall, cut, spare_count);
    system.definition.fixed.insert(system.definition.fixed.end(), fixed.begin(), fixed.end());
    system.Rebuild();
    system.state = tissue::MakeRestState(system.model);
    return system;
  }
  /// An opened hollow organ leaks from all that is open.
  void Perforate() {
    std::array<geometry::Opening, 64> openings;
    const std::size_t found =
        std::min(openings.size(), geometry::FindOpenings(system_.organ->Mesh(), openings));
    double area = 0;
    for (std::size_t i = 0; i < found; ++i) area += openings[i].area;
    const double before = conserved_.organs[0].opening_area;
    if (found > 0) conservation_.Perforate(0, std::max(kLeastHole, area - before), conserved_);
  }
  tissue::NodeCondition& Condition(std::uint32_t v) {
    return system_.state.condition[system_.organ->Node(v)];
  }
  /// Volumes of closed surfaces are kept; what a cut opened is closed by lids.
  std::vector<tissue::ClosedOrgan> ClosedOrgans() const {
    if (!is_closed_) return {};
    const EditableMesh& mesh = system_.organ->Mesh();
    tissue::ClosedOrgan organ;
    organ.node_count = static_cast<std::uint32_t>(system_.definition.rest.size());
    organ.triangles = system_.organ->NodeTriangles();
    for (geometry::Triangle lid : geometry::MakeLids(mesh)) {
      for (std::uint32_t& v : lid) v = system_.organ->Node(v);
      organ.triangles.push_back(lid);
    }
    return {std::move(organ)};
  }

  CuttableSystem system_;
  bool is_closed_;
  double size_;
  tissue::EquilibriumSolver solver_;
  tissue::Conservation conservation_;
  tissue::ConservationState conserved_;
  tissue::StateGuard guard_;
  std::size_t taken_back_ = 0;
};

/// One stroke with a solve in each of its ticks, then a hundred ticks in which a random vertex is pulled.
/// \return empty, or what is wrong
std::string CutAndPull(CutTissue& tissue, bool has_walls, math::Random& random, Counts& counts) {
  const geometry::Stroke stroke = geometry::MakeStroke(tissue.Surface(), random);
  bool has_cut = false;
  tissue.LiftBlade();
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    const geometry::Uncut uncut = geometry::Measure(tissue.Surface());
    const geometry::CutReport report = tissue.Cut(stroke[i - 1], stroke[i]);
    ++counts.ticks;
    counts.opened += report.opened;
    counts.walls += report.wall_triangles;
    counts.refused += report.refused;
    counts.full += report.is_full ? 1 : 0;
    if (report.HasChanged()) {
      has_cut = true;
      std::string fault = geometry::FindFault(tissue.Surface(), uncut, has_walls);
      if (fault.empty()) fault = tissue.FindLooseNode();
      if (!fault.empty()) return fault + " in tick " + std::to_string(i) + " of the stroke";
    }
    const std::string fault = tissue.Solve();
    if (!fault.empty()) return fault + " in tick " + std::to_string(i) + " of the stroke";
  }
  ++counts.strokes;
  counts.cutting += has_cut ? 1 : 0;
  const std::uint32_t held = geometry::RandomIndex(tissue.Surface().VertexCount(), random);
  const Vec3 pull = geometry::RandomVector(0.2 * tissue.Size() / kTicksAfter, random);
  tissue.Hold(held);
  for (int tick = 0; tick < kTicksAfter; ++tick) {
    tissue.Pull(held, pull);
    const std::string fault = tissue.Solve();
    if (!fault.empty()) return fault + ", " + std::to_string(tick) + " ticks after the stroke";
  }
  tissue.Release(held);
  return tissue.IsFlungAway() ? "a node was flung away by the stroke" : "";
}

/// \param cuts  strokes that cut; those that miss come on top
/// \param organ_share  of the tissues that are the built-in patient's, which take the longest
Counts RunRandomCuts(std::uint64_t seed, std::size_t cuts, double organ_share) {
  const auto surfaces = ReadOrgans();
  math::Random random(seed);
  Counts counts;
  constexpr std::size_t kStrokesATissue = 5;
  while (counts.cutting < cuts) {
    const std::uint64_t word = random.NextWord();
    math::Random own(word);  // so that one tissue can be repeated alone
    const geometry::NamedSurface surface = own.Uniform() < organ_share
                                               ? surfaces[geometry::RandomIndex(surfaces.size(), own)]
                                               : geometry::MakeRandomSurface(own);
    const geometry::Box box = geometry::CalcBox(surface.mesh.positions);
    const double size = math::Distance(box.min, box.max);
    const WallMaterial wall = RandomWall(size, own);
    geometry::CutSettings cut;
    cut.has_walls = geometry::InspectMesh(surface.mesh).closed && own.Uniform() < 0.5;
    cut.depth = size * own.Uniform(0.01, 0.3);
    cut.step = size * own.Uniform(0.01, 0.2);
    const std::uint32_t spare_count = own.Uniform() < 0.2 ? 10 : 1500;  // pools that run full
    const auto fixed = PickFixed(surface.mesh, own);
    CutTissue tissue(surface.mesh, fixed, wall, cut, spare_count);
    ++counts.tissues;
    for (std::size_t k = 0; k < kStrokesATissue && counts.cutting < cuts; ++k) {
      const std::size_t before = tissue.TakenBack();
      const std::string fault = CutAndPull(tissue, cut.has_walls, own, counts);
      counts.taken_back += tissue.TakenBack() - before;
      if (fault.empty()) continue;
      ADD_FAILURE() << fault << ": tissue " << word << ", its stroke " << k << ", " << surface.name
                    << (cut.has_walls ? ", walls" : "") << ", foundation " << wall.foundation;
      return counts;
    }
  }
  std::printf(
      "%zu tissues, %zu strokes, %zu of them cut; %zu ticks of a blade: %zu edges opened, %zu wall "
      "triangles, %zu edges left uncut, pools full in %zu ticks; %zu ticks after; the guard took %zu ticks "
      "back\n",
      counts.tissues, counts.strokes, counts.cutting, counts.ticks, counts.opened, counts.walls,
      counts.refused, counts.full, kTicksAfter * counts.strokes, counts.taken_back);
  return counts;
}

TEST(RandomCuts, LeaveTissueThatGoesOn) {
  const Counts counts = RunRandomCuts(1, 150, 0.0);
  EXPECT_EQ(counts.cutting, 150u);
  EXPECT_GT(counts.opened, 300u);
  EXPECT_GT(counts.walls, 200u);
  EXPECT_GT(counts.full, 0u);
}

/// In parts that can be run side by side, or one by one.
class TenThousandRandomCutsSlow : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Parts, TenThousandRandomCutsSlow, testing::Range<std::uint64_t>(2, 22));

TEST_P(TenThousandRandomCutsSlow, LeaveTissueThatGoesOn) {
  EXPECT_EQ(RunRandomCuts(GetParam(), 500, 0.05).cutting, 500u);
}

}  // namespace
}  // namespace trocar::surgery
